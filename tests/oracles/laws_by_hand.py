"""The built-in laws once more, by hand and in plain NumPy, and the increment asked of them."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

import duhem
from duhem.law.formula_law import Criterion
from duhem.projection.increment import Increment
from duhem.projection.result import Array, Solution

ANTONI = {"mu_a_plus": 0.2, "mu_a_minus": 0.08, "mu_b_plus": 0.12, "mu_b_minus": 0.15}
FULL = np.array([[1.0, 0.4], [0.4, 2.0]])


def increment(
    law: str | Criterion, trial: Any, pressure: Any, stiffness: Any = 1.0, parameters: Mapping[str, Any] | None = None
) -> Increment:
    """The question as the solver gets it, put together by hand."""
    law = duhem.load(law) if isinstance(law, str) else law
    fixed = law.fix({name: repr(value) for name, value in (parameters or {}).items()})
    known = {fixed.symbols()[name]: domain.value for name, domain in fixed.parameters.items()}
    points = np.atleast_2d(np.asarray(trial, dtype=float))
    k = np.asarray(stiffness, dtype=float) * np.eye(points.shape[1]) if np.ndim(stiffness) == 0 else np.asarray(stiffness, dtype=float)
    return Increment(
        law=law,
        g=fixed.g.xreplace(known),
        trial=points,
        pressure=np.broadcast_to(np.asarray(pressure, dtype=float), (len(points),)),
        stiffness=k,
        diagonal=bool(np.all(k == np.diag(np.diag(k)))),
        parameters=dict(parameters or {}),
    )


def norm(*x: Any) -> Any:
    return np.sqrt(sum(np.square(y) for y in x))


def pnorm(p: float, *x: Any) -> Any:
    return sum(np.abs(y) ** p for y in x) ** (1 / p)


def quarters(a: Any, b: Any) -> Any:
    return norm(np.where(a > 0, a / 0.2, -a / 0.08), np.where(b > 0, b / 0.12, -b / 0.15))


def twelve_sides(a: Any, b: Any) -> Any:
    x, y = np.abs(a), np.abs(b)
    return np.max(np.stack([x, y, (4 * x + 3 * y) / 5, (3 * x + 4 * y) / 5]), axis=0)


@dataclass(frozen=True)
class Law:
    """A built-in law, its set {gauge(sigma - centre N) <= radius(N)}, and sigma . dg/dsigma there, for the multiplier."""

    name: str
    gauge: Callable[..., Any]
    parameters: dict[str, float]
    radius: Callable[[float], float] = lambda load: load
    euler: Callable[[float], float] | None = None  # (sigma - centre N) . dg/dsigma on the boundary; the radius if left out
    centre: tuple[float, float] = (0.0, 0.0)
    stresses: tuple[str, ...] = ()  # parameters in the unit of the stresses
    principal: bool = False
    degree: int = 1

    def label(self) -> str:
        return "-".join([self.name, *(f"{x}{self.parameters[x]}" for x in ("p", "m") if x in self.parameters)])


def principal(f: Callable[..., Any]) -> Callable[..., Any]:
    """A function of the differences of principal stresses, over the deviatoric plane with its orthonormal axes."""

    def on_plane(x: Any, y: Any) -> Any:
        s1, s2, s3 = (x * e + y * n for e, n in zip(*PLANE, strict=True))
        return f(s1 - s2, s2 - s3, s3 - s1)

    return on_plane


PLANE = np.array([[1, -1, 0], [1, 1, -2]]) / np.sqrt([[2], [6]])
LAWS = [
    Law("coulomb", norm, {"mu": 0.3}, lambda n: 0.3 * n),
    Law("orthotropic", lambda a, b: norm(a / 0.3, b / 0.1), {"mu_a": 0.3, "mu_b": 0.1}),
    Law("antoni2007", quarters, ANTONI),
    Law("box", lambda a, b: np.maximum(np.abs(a) / 0.3, np.abs(b) / 0.1), {"mu_a": 0.3, "mu_b": 0.1}),
    Law("polygon", twelve_sides, {"mu": 0.3}, lambda n: 0.3 * n),
    Law("capped", norm, {"mu": 0.3, "tau_max": 0.2}, lambda n: min(0.3 * n, 0.2), stresses=("tau_max",)),
    Law("shifted-ellipse", lambda a, b: norm(a / 0.3, b / 0.2), {"mu_a": 0.3, "mu_b": 0.2, "shift": 0.1}, centre=(0.1, 0.0)),
    Law("cohesive", norm, {"mu": 0.3, "cohesion": 0.1}, lambda n: 0.1 + 0.3 * n, stresses=("cohesion",)),
    Law(
        "regularised",
        norm,
        {"mu": 0.3, "c": 0.1},
        lambda n: math.sqrt((0.3 * n) ** 2 + 0.2 * 0.3 * n),
        lambda n: ((0.3 * n) ** 2 + 0.2 * 0.3 * n) / (0.3 * n + 0.1),
        stresses=("c",),
    ),
    Law("superellipse", lambda a, b: pnorm(1.5, a / 0.3, b / 0.2), {"mu_a": 0.3, "mu_b": 0.2, "p": 1.5}),
    Law("superellipse", lambda a, b: pnorm(4, a / 0.3, b / 0.2), {"mu_a": 0.3, "mu_b": 0.2, "p": 4}),
    Law("quartic", lambda a, b: pnorm(4, a, b), {"mu": 0.3, "c": 0}, lambda n: 0.3 * n, lambda n: 4 * (0.3 * n) ** 4, degree=4),
    Law(
        "hosford",
        principal(lambda *d: pnorm(4, *d) / 2**0.25),
        {"yield_stress": 0.7, "m": 4},
        lambda n: 0.7,
        stresses=("yield_stress",),
        principal=True,
    ),
    Law(
        "tresca",
        principal(lambda *d: np.max(np.abs(np.stack(d)), axis=0)),
        {"yield_stress": 0.7},
        lambda n: 0.7,
        stresses=("yield_stress",),
        principal=True,
    ),
    Law(
        "von-mises",
        principal(lambda *d: norm(*d) / 2**0.5),
        {"yield_stress": 0.7},
        lambda n: 0.7,
        stresses=("yield_stress",),
        principal=True,
    ),
]


@dataclass(frozen=True)
class Question:
    """Points around K, in the plane of two forces or of the deviator, and the same question to the solver."""

    law: Law
    load: float
    plane: Array
    stiffness: Array
    scale: float = 1.0
    asked: Increment = field(init=False)

    def __post_init__(self) -> None:
        law, s = self.law, self.scale
        parameters = {name: value * (s if name in law.stresses else 1.0) for name, value in law.parameters.items()}
        trial = (self.plane @ PLANE + 0.3 if law.principal else self.plane) * s
        k = 2.0 if law.principal else self.stiffness
        object.__setattr__(self, "asked", increment(law.name, trial, 0.0 if law.principal else -self.load * s, k, parameters))

    def metric(self) -> Array:
        return np.eye(2) / 2.0 if self.law.principal else np.linalg.inv(self.stiffness)

    def stresses(self, solution: Solution) -> Array:
        """The answer in the plane, in units of the scale; the mean of principal stresses must be that of the trial."""
        if not self.law.principal:
            return solution.stress / self.scale
        np.testing.assert_allclose(solution.stress.mean(axis=1), self.asked.trial.mean(axis=1), rtol=1e-7)
        return solution.stress @ PLANE.T / self.scale

    def boundary(self, angle: Array) -> Array:
        ray = np.stack([np.cos(angle), np.sin(angle)])
        unit = self.law.radius(self.load) / self.law.gauge(*ray)
        return (unit * ray).T + np.array(self.law.centre) * self.load

    def inside(self, point: Array) -> bool:
        return bool(self.law.gauge(*(point - np.array(self.law.centre) * self.load)) <= self.law.radius(self.load))

    def closest(self, point: Array) -> Array:
        """By brute force: the best of many boundary points, then a finer comb around the best, again and again."""
        if self.inside(point):
            return point
        middle, half = 0.0, math.pi
        for count in (4001, *[201] * 6):
            angles = middle + half * np.linspace(-1.0, 1.0, count)
            off = point - self.boundary(angles)
            middle, half = angles[np.argmin(np.einsum("ni,ij,nj->n", off, self.metric(), off))], 3 * half / count
        return self.boundary(np.array([middle]))[0]

    def violation(self, stress: Array) -> Array:
        """How far each answer is from optimal: (trial - sigma) . k^-1 (tau - sigma) <= 0 for all tau of K, and sigma in K."""
        comb = self.boundary(np.linspace(-math.pi, math.pi, 4001))
        push = (self.plane - stress) @ self.metric()
        unit = np.sqrt(np.einsum("ni,ij,nj->n", self.plane, self.metric(), self.plane))
        drift = np.max(push @ comb.T - np.sum(push * stress, axis=1)[:, None], axis=1) / unit**2
        shifted = stress - np.array(self.law.centre) * self.load
        return np.maximum(drift, self.law.gauge(*shifted.T) / self.law.radius(self.load) - 1.0)


def question(law: Law, scale: float = 1.0, count: int = 10) -> Question:
    points = np.random.default_rng(7).normal(size=(count, 2)) * 1.2
    return Question(law, 1.3, points, FULL, scale)
