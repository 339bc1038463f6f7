"""Questions about increments where doubles are at their end, by family; :mod:`tests.campaigns.numbers` asks them."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from mpmath import MPContext

import duhem
from duhem.expression.numpy_ import compiled
from duhem.law.formula_law import Criterion
from duhem.projection.increment import increment

__all__ = ["BUILT_IN", "FAMILIES", "Question", "aspects", "disk", "mp"]

LOADS = (1e-290, 1e-200, 1e-80, 1e-20, 1.0, 1e20, 1e80, 1e200, 1e290)
ULPS = (1 - 1e-15, 1 + 1e-15, 1 + 1e-14, 1 + 1e-13, 1 + 1e-12, 1 + 1e-11, 1 + 1e-10, 1 + 1e-9, 1 + 1e-8, 1 + 1e-6)
FAR = (0.3, 1.01, 2.3, 1e3, 1e12)
ANGLES = (0.1, 0.7, 2.0, 3.9)
RATIOS = (1e-12, 1e-6, 1.0, 1e6, 1e12)

# every built-in law that has increments, at convex parameters, those of the unit of a stress last
BUILT_IN: tuple[tuple[str, dict[str, Any], dict[str, float]], ...] = (
    ("antoni2007", {"mu_a_plus": 0.2, "mu_a_minus": 0.08, "mu_b_plus": 0.12, "mu_b_minus": 0.15}, {}),
    ("antoni2007-1d", {"mu_plus": 0.2, "mu_minus": 0.08}, {}),
    ("box", {"mu_a": 0.3, "mu_b": 0.1}, {}),
    ("capped", {"mu": 0.5}, {"tau_max": 0.4}),
    ("cohesive", {"mu": 0.5}, {"cohesion": 0.1}),
    ("coulomb", {"mu": 0.5}, {}),
    ("drucker1949", {"c": 2.0}, {"k": 0.7}),
    ("hosford", {"m": 8}, {"yield_stress": 0.7}),
    ("hosford", {"m": 20}, {"yield_stress": 0.7}),
    ("limacon", {"mu": 0.3, "e": 0.375}, {}),
    ("lobes", {"mu": 0.3, "e": 0.0625}, {}),
    ("matchstick", {"mu_a": 0.3, "mu_b": 0.375}, {}),
    ("orthotropic", {"mu_a": 0.3, "mu_b": 0.1}, {}),
    ("polygon", {"mu": 0.3}, {}),
    ("quartic", {"mu": 0.3, "c": 1}, {}),
    ("regularised", {"mu": 0.5}, {"c": 0.125}),
    ("shifted-ellipse", {"mu_a": 0.3, "mu_b": 0.1, "shift": 0.125}, {}),
    ("superellipse", {"mu_a": 0.3, "mu_b": 0.1, "p": 4}, {}),
    ("superellipse", {"mu_a": 0.3, "mu_b": 0.1, "p": 1.25}, {}),
    ("tresca", {}, {"yield_stress": 0.7}),
    ("von-mises", {}, {"yield_stress": 0.7}),
)

mp = MPContext()
mp.dps = 60


@dataclass(frozen=True)
class Question:
    """Trials (N, d) of one law; ``radius`` in many digits where K is a disk and k one number, of an angle where K is not convex."""

    law: str | Criterion
    parameters: dict[str, Any]
    trial: np.ndarray
    pressure: float | None
    stiffness: Any = 1.0
    radius: Any = None


def ring(radius: Any, shares: Sequence[float]) -> np.ndarray:
    """Trials at these shares of a radius, of which they keep the digits."""
    with np.errstate(over="ignore"):
        found = np.array([[float(radius * mp.mpf(f) * w(mp.mpf(a))) for w in (mp.cos, mp.sin)] for f in shares for a in ANGLES])
    return found[np.isfinite(found).all(axis=1)]


def disk(
    law: str | Criterion, parameters: dict[str, Any], pressure: float, radius: Any, shares: Sequence[float], k: float = 1.0
) -> Question:
    return Question(law, parameters, ring(radius, shares), pressure, k, radius)


def cancelling() -> Iterator[Question]:
    """Radii that are differences of numbers much larger."""
    written = Criterion("hyperbola", "sqrt(1 + sigma_a**2 + sigma_b**2) - 1 - abs(sigma_n)")
    cosh = Criterion("catenary", "cosh(norm(sigma_a, sigma_b)) - 1 - abs(sigma_n)")
    shifted = Criterion("far", "(sigma_a + 1000)**2 + (sigma_b - 500)**2 - 2000*sigma_a + 1000*sigma_b - 1250000 - sigma_n**2")
    spread = Criterion("spread", "sqrt((sigma_a - 3*sigma_b)**2 - 8*sigma_b**2 + 6*sigma_a*sigma_b) - abs(sigma_n)")
    for load in (1e-2, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14, 1e-15):
        n = mp.mpf(load)
        yield disk("regularised", {"mu": 1.0, "c": 1.0}, -load, mp.sqrt(n * n + 2 * n), FAR[:4])
        yield disk(written, {}, -load, mp.sqrt(n * n + 2 * n), FAR[:4])
        yield disk(cosh, {}, -load, mp.acosh(1 + n), FAR[1:3])
        yield disk(shifted, {}, -load, n, FAR[:4])
        yield disk(spread, {}, -load, n, FAR[:4])


SATURATING: tuple[tuple[str | Criterion, dict[str, Any], Callable[[Any], Any]], ...] = (
    ("shaw", {"mu": 0.25, "k": 1.0}, lambda n: -mp.expm1(-n / 4)),
    (Criterion("log", "norm(sigma_a, sigma_b) - log(1 + abs(sigma_n))"), {}, lambda n: mp.log1p(n)),
    (Criterion("exp", "norm(sigma_a, sigma_b) - exp(abs(sigma_n)) + 1"), {}, lambda n: mp.expm1(n)),
    (
        Criterion("tanh", "norm(sigma_a, sigma_b) - tanh(1/2 + abs(sigma_n)) + tanh(1/2)"),
        {},
        lambda n: mp.tanh(mp.mpf(1) / 2 + n) - mp.tanh(mp.mpf(1) / 2),
    ),
    (Criterion("root", "norm(sigma_a, sigma_b) - (1 + abs(sigma_n))**(1/3) + 1"), {}, lambda n: mp.cbrt(1 + n) - 1),
    (Criterion("square", "sigma_a**2 + sigma_b**2 - (1 - exp(-abs(sigma_n)))**2"), {}, lambda n: -mp.expm1(-n)),
    (Criterion("soft", "norm(sigma_a, sigma_b) - (1 - exp(-abs(sigma_n)))/2 - 2"), {}, lambda n: 2 - mp.expm1(-n) / 2),
)


def saturating() -> Iterator[Question]:
    """Radii that are a function of the load in which digits cancel, such as 1 - exp(-x), beside trials of any size."""
    for load in (1e-2, 1e-6, 1e-10, 1e-14, 1e-15, 3e-16, 1e-17, 1e-25):
        for law, parameters, radius in SATURATING:
            yield disk(law, parameters, -load, radius(mp.mpf(load)), (*FAR, 1e6, 3e7))


def grazing() -> Iterator[Question]:
    """Ellipses that nearly touch no stress, and trials beside that end."""
    for gap, load, ratio, sense in itertools.product((1e-3, 1e-6, 1e-9, 1e-12), (1.0, 0.7, 3e5), (1.0, 1e-4), (1.0, -1.0)):
        near = [(d * np.cos(a), d * np.sin(a)) for d in (gap / 3, 2 * gap, 30 * gap, 1e-8, 1e-4, 0.3) for a in ANGLES[:3]]
        trial = np.array(near) * load * np.array([-0.3 * sense, 0.1])
        parameters = {"mu_a": 0.3, "mu_b": 0.1, "shift": 0.3 * sense * (1 - gap)}
        yield Question("shifted-ellipse", parameters, trial, -load, np.array([1.0, ratio]))


def powers() -> Iterator[Question]:
    """Formulas of a degree, at loads whose powers a double does not hold."""
    for load in LOADS:
        n = mp.mpf(load)
        yield disk("coulomb", {"mu": 0.5}, -load, n / 2, FAR)
        yield disk("quartic", {"mu": 0.5, "c": 2}, -load, n / 2, FAR)
        yield disk("limacon", {"mu": 0.5, "e": 0}, -load, n / 2, FAR)
        yield disk("matchstick", {"mu_a": 0.5, "mu_b": 0.5}, -load, n / 2, FAR)
        yield disk("lobes", {"mu": 0.5, "e": 0}, -load, n / 2, FAR)
        yield disk("superellipse", {"mu_a": 0.5, "mu_b": 0.5, "p": 2}, -load, n / 2, FAR)
        yield disk("orthotropic", {"mu_a": 0.5, "mu_b": 0.5}, -load, n / 2, FAR, 3e11)
        yield disk("capped", {"mu": 0.5, "tau_max": 0.1}, -load, min(n / 2, mp.mpf(0.1)), FAR)
        yield disk("cohesive", {"mu": 0.5, "cohesion": 1.0}, -load, n / 2 + 1, FAR)
        yield disk("regularised", {"mu": 0.5, "c": 0.125}, -load, mp.sqrt(n * n / 4 + n / 8), FAR)


def ulps() -> Iterator[Question]:
    """Trials next to the boundary."""
    for load in (1e-200, 1.0, 1e200):
        n = mp.mpf(load)
        yield disk("coulomb", {"mu": 0.5}, -load, n / 2, ULPS)
        yield disk("quartic", {"mu": 0.5, "c": 2}, -load, n / 2, ULPS)
        yield disk("limacon", {"mu": 0.5, "e": 0}, -load, n / 2, ULPS, 3e11)
        yield disk("superellipse", {"mu_a": 0.5, "mu_b": 0.5, "p": 2}, -load, n / 2, ULPS)
        yield disk("cohesive", {"mu": 0.5, "cohesion": 1.0}, -load, n / 2 + 1, ULPS)
        yield disk("regularised", {"mu": 0.5, "c": 0.125}, -load, mp.sqrt(n * n / 4 + n / 8), ULPS)
    for law, parameters, strengths in BUILT_IN:
        for ratio in (2.0, 1e6):
            yield beyond(law, parameters, strengths, ULPS[1::3], _apart(law, ratio))


def loads() -> Iterator[Question]:
    """Every law at every load."""
    for (law, parameters, strengths), load in itertools.product(BUILT_IN, LOADS):
        yield beyond(law, parameters, strengths, FAR, _apart(law, 2.0), load)


def stiff() -> Iterator[Question]:
    """Every law at stiffnesses far apart, and at one whose axes are turned."""
    for law, parameters, strengths in BUILT_IN:
        d = len(duhem.load(law).forces)
        for ratio in RATIOS[:2] + RATIOS[3:] if d > 1 else ():
            yield beyond(law, parameters, strengths, (1 + 1e-7, *FAR[1:]), _apart(law, ratio))
        if d > 1:
            turned = np.linalg.qr(np.add.outer(np.arange(d), np.arange(d)) ** 2 + np.eye(d))[0]
            full = turned @ np.diag(1e8 ** (np.arange(d) / (d - 1))) @ turned.T
            yield beyond(law, parameters, strengths, (1 + 1e-7, *FAR[1:]), (full + full.T) / 2)


def slender() -> Iterator[Question]:
    """Every law with several coefficients, one of them far from the others."""
    for (law, parameters, strengths), e in itertools.product(BUILT_IN, (1e-12, 1e-6, 1e6)):
        several = [name for name in parameters if name.startswith("mu")]
        if len(several) < 2 or law == "matchstick":  # not convex so far apart
            continue
        for ratio in (1e-6, 1.0, 1e6):
            yield beyond(law, {**parameters, several[-1]: parameters[several[-1]] * e}, strengths, (1 + 1e-7, *FAR[1:]), _apart(law, ratio))


def joined() -> Iterator[Question]:
    """Flats that join curves, and ellipses as thin as a line."""
    for power in (2, 3, 4, 6):
        law = Criterion("joined", f"pos(abs(sigma_a) - 1)**{power} + abs(sigma_b)**{power} - 1", pressure=None)
        for ratio in RATIOS:
            trial = np.array([[14.93165762337459, 9.343254542223587], [2.5, 0.3], [0.4, 1.7], [-1.001, -40.0], [3e3, 1.02], [1.1, 1.00001]])
            yield Question(law, {}, trial, None, np.array([ratio, 1.0]))
    for long, ratio in itertools.product((10, 1000, 1000000), (1e-8, 1.0, 1e8)):
        law = Criterion("thin", f"norm(sigma_a/{long}, sigma_b*{long}) - 1", pressure=None)
        trial = np.array([[2.0 * long, 1.0 / long], [0.5 * long, 3.0 / long], [0.3 * long, 1.0], [1.0, 1.0], [10.0 * long, 1e-7]])
        yield Question(law, {}, trial, None, np.array([ratio, 1.0]))


def aspects() -> Iterator[Question]:
    """Coefficients and stiffnesses far apart."""
    for e, f in itertools.product((1e-12, 1e-6, 1.0, 1e6), (1e-12, 1e-6, 1.0, 1e6, 1e12)):
        for law, parameters in (
            ("orthotropic", {"mu_a": 1.0, "mu_b": e}),
            ("box", {"mu_a": 1.0, "mu_b": e}),
            ("superellipse", {"mu_a": 1.0, "mu_b": e, "p": 4}),
        ):
            trial = np.array([[2.0, 1.5 * e], [0.3, 3.0 * e], [1e3, -e], [-1.1, 1e3 * e]])
            yield Question(law, parameters, trial, -1.0, np.array([1.0, f]))


def not_convex() -> Iterator[Question]:
    """Sets that are not convex: the closest of all stationary points, or a flag."""

    def trials(reach: float) -> np.ndarray:
        return np.array(
            [[s * reach * np.cos(a), s * reach * np.sin(a)] for s in (1.05, 1.6, 4.0, 100.0) for a in np.arange(12) * 0.53 + 0.07]
        )

    for ratio in (1.0, 4.0, 1e6):
        k = np.array([1.0, ratio])
        for e in (0.625, 0.875):
            yield Question("limacon", {"mu": 0.5, "e": e}, trials(0.5), -1.0, k, lambda a, e=e: (1 + e * mp.cos(a)) / 2)
        for e in (0.25, 0.75):
            yield Question("lobes", {"mu": 0.5, "e": e}, trials(0.5), -1.0, k, lambda a, e=e: (1 + e * mp.cos(3 * a)) / 2)
        for b in (0.125, 0.25):
            waist = Question("matchstick", {"mu_a": 0.5, "mu_b": b}, trials(0.5), -1.0, k)
            yield replace(waist, radius=lambda a, b=b: mp.sqrt((mp.cos(a) / 2) ** 2 + (b * mp.sin(a)) ** 2))


FAMILIES: dict[str, Callable[[], Iterator[Question]]] = {
    "cancelling": cancelling,
    "saturating": saturating,
    "grazing": grazing,
    "powers": powers,
    "ulps": ulps,
    "loads": loads,
    "stiff": stiff,
    "aspects": aspects,
    "slender": slender,
    "joined": joined,
    "not convex": not_convex,
}


def _apart(law: str, ratio: float) -> np.ndarray:
    """Stiffnesses of which the last is ``ratio`` times the first."""
    d = len(duhem.load(law).forces)
    return ratio ** (np.arange(d) / max(d - 1, 1))


def beyond(
    law: str, parameters: dict[str, Any], strengths: dict[str, float], shares: Sequence[float], k: np.ndarray, load: float = 1.0
) -> Question:
    """Trials at shares of how far K reaches, everything of the unit of a stress times ``load``."""
    declared = duhem.load(law)
    pressure = -1.0 if declared.pressure else None
    edge = _edge(declared, {**parameters, **strengths}, pressure)
    with np.errstate(over="ignore"):
        trial = np.concatenate([share * edge for share in shares]) * load
    values = {**parameters, **{name: value * load for name, value in strengths.items()}}
    return Question(law, values, trial[np.isfinite(trial).all(axis=1)], pressure and -load, k)


def _edge(law: Criterion, parameters: dict[str, Any], pressure: float | None) -> np.ndarray:
    """Points where K ends, a ray each, by a bisection in doubles."""
    posed = increment(law, np.ones((1, len(law.forces))), pressure, 1.0, parameters)
    symbols = (*law.force_symbols(), *([law.symbols()[law.pressure]] if law.pressure else []))
    g = compiled(posed.g, symbols)
    tail = () if pressure is None else (pressure,)

    def reach(way: np.ndarray) -> np.ndarray:
        low, high = np.full(len(way), 1e-15), np.full(len(way), 1e9)
        for _ in range(120):
            middle = np.sqrt(low * high)
            inside = g(*(middle[:, None] * way).T, *tail) <= 0
            low, high = np.where(inside, middle, low), np.where(inside, high, middle)
        return low

    d = len(law.forces)
    if d == 1:
        return reach(np.array([[1.0], [-1.0]]))[:, None] * [[1.0], [-1.0]]
    if d == 2:  # as seen from K's own shape
        extent = np.minimum(reach(np.eye(2)), reach(-np.eye(2)))
        way = np.array([[np.cos(a), np.sin(a)] for a in ANGLES]) * extent / extent.max()
    else:
        way = np.array([[1.0, -0.3, 0.1], [0.2, 1.0, -0.7], [-0.6, -0.1, 1.0], [1.0, 1.0, -0.4]])
    return reach(way)[:, None] * way
