"""The built-in laws: complete, short, documented, and right at points computed by hand."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest
import sympy as sp
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from duhem.errors import InputError
from duhem.expression import mpmath_, numpy_
from duhem.expression.balls import ball, enclose, precision
from duhem.expression.number import exact_number
from duhem.law import builtin, catalogue
from duhem.law.builtin.lobes import lobe_law
from duhem.law.domain import POSITIVE, Domain
from duhem.law.formula_law import Criterion
from duhem.proof.verdict import Verdict
from tests.long import long_but, mostly_long
from tests.oracles.literature import CLAIMS, KNOWN, LOBES, OUTSIDE, THRESHOLDS

FILES = {file.stem.replace("_", "-"): file for file in sorted(Path(builtin.__path__[0]).glob("[!_]*.*"))}
LAWS = {name: law for name in FILES if isinstance(law := catalogue.load(name), Criterion)}
LIKE_OTHERS = (  # built of the same words as one of the others
    "box", "capped", "coulomb", "drucker1949", "lobes", "matchstick", "orthotropic", "polygon", "radial-flow", "regularised",
    "shifted-ellipse", "von-mises",
)  # fmt: skip
R = sp.Rational

# law: (values of every name, g there, values of the forces that lie on the boundary, all by hand)
Point = tuple[dict[str, Any], Any, list[tuple[Any, ...]]]
BY_HAND: dict[str, Point] = {
    "coulomb": ({"sigma_a": 3, "sigma_b": -4, "sigma_n": -10, "mu": R(1, 5)}, 3, [(2, 0), (R(-6, 5), R(8, 5))]),
    "orthotropic": ({"sigma_a": 3, "sigma_b": 2, "sigma_n": -10, "mu_a": 1, "mu_b": R(1, 2)}, -5, [(10, 0), (6, -4)]),
    "antoni2007": (
        {"sigma_a": -3, "sigma_b": 2, "sigma_n": -1, "mu_a_plus": R(1, 5), "mu_a_minus": 1, "mu_b_plus": R(1, 2), "mu_b_minus": R(1, 4)},
        4,
        [(R(1, 5), 0), (-1, 0), (0, R(1, 2)), (0, R(-1, 4)), (R(-3, 5), R(-4, 20)), (R(3, 25), R(2, 5))],
    ),
    "antoni2007-1d": ({"sigma_t": -3, "sigma_n": -2, "mu_plus": R(1, 5), "mu_minus": R(1, 2)}, 4, [(R(2, 5),), (-1,)]),
    "superellipse": ({"sigma_a": -3, "sigma_b": 2, "sigma_n": -1, "mu_a": 1, "mu_b": R(1, 2), "p": 2}, 4, [(-1, 0), (R(3, 5), R(-2, 5))]),
    "box": ({"sigma_a": -3, "sigma_b": 2, "sigma_n": -10, "mu_a": 1, "mu_b": R(1, 4)}, -2, [(10, 0), (-10, R(5, 2)), (3, R(-5, 2))]),
    "polygon": ({"sigma_a": -3, "sigma_b": 4, "sigma_n": -10, "mu": R(1, 5)}, 3, [(2, 0), (R(8, 5), R(6, 5)), (2, R(-2, 3))]),
    "capped": ({"sigma_a": 3, "sigma_b": 4, "sigma_n": -10, "mu": R(1, 5), "tau_max": 1}, 4, [(1, 0), (R(-3, 5), R(4, 5))]),
    "shifted-ellipse": (
        {"sigma_a": 5, "sigma_b": 2, "sigma_n": -10, "mu_a": R(1, 2), "mu_b": R(1, 4), "shift": R(1, 5)},
        0,
        [(7, 0), (-3, 0), (2, R(5, 2))],
    ),
    "limacon": (
        {"sigma_a": 3, "sigma_b": 4, "sigma_n": -1, "mu": 1, "e": R(1, 3)},
        19,
        [(R(4, 3), 0), (R(-2, 3), 0), (0, 1), (R(18, 25), R(24, 25))],
    ),
    "lobes": (
        {"sigma_a": 3, "sigma_b": 4, "sigma_n": -1, "mu": 1, "e": R(1, 2)},
        R(1117, 2),
        [(R(3, 2), 0), (R(-1, 2), 0), (0, 1), (R(-3, 4), 3 * sp.sqrt(3) / 4)],
    ),
    "matchstick": ({"sigma_a": 3, "sigma_b": 4, "sigma_n": -1, "mu_a": 2, "mu_b": 2}, 15, [(2, 0), (0, -2)]),
    "quartic": ({"sigma_a": 1, "sigma_b": 2, "sigma_n": -1, "mu": 2, "c": 3}, 13, [(2, 0), (0, -2), (R(16, 5) ** R(1, 4),) * 2]),
    "cohesive": ({"sigma_a": 3, "sigma_b": 4, "sigma_n": -10, "mu": R(1, 5), "cohesion": 1}, 2, [(3, 0), (R(9, 5), R(-12, 5))]),
    "regularised": ({"sigma_a": 3, "sigma_b": 4, "sigma_n": -5, "mu": R(1, 5), "c": 12}, 0, [(5, 0), (-3, 4)]),
    "hosford": ({"s1": 4, "s2": 1, "s3": 2, "yield_stress": 1, "m": 4}, 2 * R(98, 32) ** R(1, 4) - 1, [(1, 0, 0), (0, 0, -1), (7, 7, 8)]),
    "tresca": ({"s1": 4, "s2": 1, "s3": 2, "yield_stress": 1}, 2, [(1, 0, 0), (5, R(11, 2), 6), (0, -1, -1)]),
    "von-mises": (
        {"s1": 4, "s2": 1, "s3": 2, "yield_stress": 1},
        sp.sqrt(7) - 1,
        [(1, 0, 0), (5, 5, 4), (1 / sp.sqrt(3), -1 / sp.sqrt(3), 0)],
    ),
    "drucker1949": (
        {"s1": 4, "s2": 1, "s3": 2, "k": 1, "c": R(9, 4)},
        R(343, 27) - R(9, 4) * R(400, 729) - 1,
        [(1, -1, 0), (3, 2, 1), (R(81, 2) ** R(1, 6), 0, 0)],
    ),
    "radial-flow": ({"sigma_a": 3, "sigma_b": 2, "sigma_n": -10, "mu_a": 1, "mu_b": R(1, 2)}, -5, [(10, 0), (6, -4)]),
    "rotated-flow": ({"sigma_a": 3, "sigma_b": -4, "sigma_n": -10, "mu": R(1, 5), "delta": 1}, 3, [(2, 0), (R(-6, 5), R(8, 5))]),
}


def _at(law: Criterion, expr: sp.Expr, values: dict[str, Any]) -> sp.Expr:
    """The expression at exact values, simplified to a constant."""
    return sp.simplify(expr.subs({law.symbols()[name]: value for name, value in values.items()}).rewrite(sp.Pow))


# -- the catalogue ----------------------------------------------------------------------------------------------------


def test_the_catalogue_is_complete() -> None:
    assert set(LAWS) == set(BY_HAND) == set(KNOWN)


@pytest.mark.parametrize("name", FILES)
def test_one_file_is_one_short_documented_law(name: str) -> None:
    law, text = catalogue.load(name), FILES[name].read_text("utf-8")
    assert law.name == name
    code = text.split('"""', 2)[2] if FILES[name].suffix == ".py" else re.sub(r"^#.*\n", "", text, flags=re.M)
    assert 5 <= len([line for line in code.splitlines() if line.strip()]) <= 15
    stated = "g = " if isinstance(law, Criterion) else "boundary"
    for part in (stated, "Force", "Verdicts:", "Source:", *(["sigma_n <= 0"] if law.pressure else [])):
        assert part in catalogue.description(name)
    assert law.summary and law.source


@pytest.mark.parametrize("name", LAWS)
def test_formulas_are_exact(name: str) -> None:
    law = LAWS[name]
    for expr in (law.g, *(law.flow or ())):
        assert not expr.atoms(sp.Float)


# -- values by hand ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", BY_HAND)
def test_value_by_hand(name: str) -> None:
    law, (values, expected, _) = LAWS[name], BY_HAND[name]
    assert set(values) == set(law.symbols())
    assert sp.simplify(_at(law, law.g, values) - expected) == 0


@pytest.mark.slow
@pytest.mark.parametrize("name", BY_HAND)
def test_known_points_lie_on_the_boundary(name: str) -> None:
    law, (values, _, points) = LAWS[name], BY_HAND[name]
    for point in points:
        assert _at(law, law.g, values | dict(zip(law.forces, point, strict=True))) == 0
        further = dict(zip(law.forces, (2 * x for x in point), strict=True))
        assert _at(law, law.g, values | further) > 0


def test_flows_by_hand() -> None:
    law = LAWS["rotated-flow"]
    assert law.flow is not None
    quarter = {"sigma_a": 2, "sigma_b": 1, "sigma_n": -1, "mu": 1, "delta": sp.pi / 2}
    assert [_at(law, component, quarter) for component in law.flow] == [-1, 2]
    assert LAWS["radial-flow"].flow == LAWS["radial-flow"].force_symbols()


def test_one_lobe_is_the_limacon() -> None:
    one, limacon = lobe_law(1), LAWS["limacon"]
    assert sp.expand(one.g.xreplace({one.symbols()["e"]: limacon.symbols()["e"]}) - limacon.g) == 0


# -- anywhere in the domain -------------------------------------------------------------------------------------------


def exact(domain: Domain) -> st.SearchStrategy[sp.Rational]:
    """Exact values of a domain: open ends by decades, closed ends often met."""
    size = st.builds(lambda k, digits: R(digits, 100) * R(10) ** k, st.integers(-4, 4), st.integers(100, 999))
    if domain.positive:
        return size
    if domain.low is not None and domain.high is not None:
        return st.integers(0, 64).map(lambda k: domain.low + (domain.high - domain.low) * R(k, 64))
    if domain.low is not None:
        return st.one_of(st.just(domain.low), size.map(lambda x: domain.low + x))
    return st.one_of(st.just(sp.S.Zero), size, size.map(lambda x: -x))


@st.composite
def states(draw: st.DrawFn, law: Criterion) -> dict[str, sp.Rational]:
    """Parameters inside the domain and the constraints, a pressure, and forces of one decade with it."""
    values = {name: draw(exact(domain)) for name, domain in law.parameters.items()}
    assume(all(c.subs({law.symbols()[n]: v for n, v in values.items()}) == sp.true for c in law.constraints))
    unit = R(10) ** draw(st.integers(-6, 6))
    if law.pressure:
        values[law.pressure] = -unit * R(draw(st.integers(1, 1000)), 100)
    return values | {name: unit * R(draw(st.integers(-1000, 1000)), 100) for name in law.forces}


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(LAWS, *(name for name in LAWS if name not in LIKE_OTHERS)))
@given(data=st.data())
@settings(max_examples=12, deadline=None)
def test_the_origin_is_admissible(name: str, data: st.DataObject) -> None:
    law = LAWS[name]
    values = data.draw(states(law)) | dict.fromkeys(law.forces, sp.S.Zero)
    assert mpmath_.evaluate(law.g, {law.symbols()[n]: v for n, v in values.items()}, 40) <= 0


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(LAWS, *(name for name in LAWS if name not in LIKE_OTHERS)))
@given(data=st.data())
@settings(max_examples=12, deadline=None)
def test_numpy_and_mpmath_agree_within_what_rounding_allows(name: str, data: st.DataObject) -> None:
    """Both lie in an enclosure computed with 40 bits, whose radius is the conditioning of the formula at the point."""
    law = LAWS[name]
    values = {n: sp.Rational(float(v)) for n, v in data.draw(states(law)).items()}
    at = {law.symbols()[n]: v for n, v in values.items()}
    with precision(40):
        enclosure = enclose(law.g, {s: ball(v) for s, v in at.items()})
        assert enclosure.is_finite()
    low, high = (mpmath.mpf(end) for end in _ends(enclosure))
    assert low <= float(numpy_.evaluate(law.g, {s: float(v) for s, v in at.items()})) <= high
    assert low <= mpmath_.evaluate(law.g, at, 40) <= high


def _ends(enclosure: Any) -> tuple[str, str]:
    return tuple(end.str(30, radius=False) for end in (enclosure.lower(), enclosure.upper()))  # type: ignore[return-value]


# -- the table of the literature --------------------------------------------------------------------------------------


def _inside(law: Criterion, values: dict[str, str]) -> bool:
    """Whether the constraints hold at the values, those with other free parameters aside."""
    at = {law.symbols()[name]: exact_number(value) for name, value in values.items()}
    assert all(exact_number(value) in law.parameters[name] for name, value in values.items())
    return all(c.subs(at) != sp.false for c in law.constraints)


def test_the_table_names_known_claims_and_admissible_values() -> None:
    assert all(set(claims) <= set(CLAIMS) for claims in KNOWN.values())
    assert all(claim in CLAIMS and _inside(LAWS[name], values) for name, values, claim, _ in THRESHOLDS)
    assert not any(_inside(LAWS[name], values) for name, values in OUTSIDE)


def _curvatures(law: Criterion, values: dict[str, str], angles: int = 720) -> np.ndarray:
    """Level-set curvature of the boundary at unit size, on rays; only g and its derivatives enter."""
    u, v, r = sp.symbols("u v r", real=True)
    plane = {2: (u, v), 3: (u / sp.sqrt(2) + v / sp.sqrt(6), -u / sp.sqrt(2) + v / sp.sqrt(6), -2 * v / sp.sqrt(6))}[len(law.forces)]
    free = {s: exact_number(values.get(n, 1)) for n, s in law.symbols().items() if n in law.parameters}
    pressed = {law.symbols()[law.pressure]: -1} if law.pressure else {}
    g = law.g.subs(free | pressed).subs(dict(zip(law.force_symbols(), plane, strict=True)))
    theta = 2 * np.pi * np.arange(angles) / angles
    value = numpy_.compiled(g, [u, v])
    low, high = np.full(angles, 1e-3), np.full(angles, 10.0)
    for _ in range(60):
        r = (low + high) / 2
        inside = value(r * np.cos(theta), r * np.sin(theta)) <= 0
        low, high = np.where(inside, r, low), np.where(inside, high, r)
    at = (low * np.cos(theta), low * np.sin(theta))
    gu, gv, guu, guv, gvv = (numpy_.compiled(g.diff(*by), [u, v])(*at) for by in [(u,), (v,), (u, u), (u, v), (v, v)])
    return (guu * gv**2 - 2 * guv * gu * gv + gvv * gu**2) / np.hypot(gu, gv) ** 3


CURVED = [
    (LAWS[name], values, verdict)
    for name, values, claim, verdict in THRESHOLDS
    if claim == "convexity" and KNOWN[name]["convexity"] is Verdict.REFUTED
]
FAMILY = [(lobe_law(n), {"e": e}, verdict) for n, e, verdict in LOBES]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("law", "values", "verdict"),
    long_but([*range(7), *range(8, 17), 19, *range(22, 26), 27, 30], CURVED + FAMILY),
    ids=lambda x: x.name if isinstance(x, Criterion) else None,
)
def test_thresholds_agree_with_the_curvature_of_the_boundary(law: Criterion, values: dict[str, str], verdict: Verdict) -> None:
    least = _curvatures(law, values).min()
    assert least > -1e-10 if verdict is Verdict.PROVED else least < -1e-8


def test_an_empty_domain_is_said_with_its_ends() -> None:
    for make, ends in ((lambda: Domain(high=0, positive=True), "(0, 0]"), (lambda: Domain(high=-2, positive=True), "(0, -2]"),
                       (lambda: Domain.between(2, 1), "[2, 1]")):  # fmt: skip
        with pytest.raises(InputError, match=re.escape(f"the domain {ends} is empty")):
            make()


def test_a_positive_parameter_has_no_other_least_value() -> None:
    assert Domain(positive=True) == POSITIVE and -1 not in Domain(positive=True)
    with pytest.raises(InputError, match="a positive parameter has the least value 1"):
        Domain(low=sp.Integer(1), high=sp.Integer(2), positive=True)


def test_ends_of_a_domain_are_read_exactly_however_it_is_made() -> None:
    assert Domain("1/10", 0.5) == Domain.between(sp.Rational(1, 10), "1/2") and Domain(high="0.3", positive=True).high == sp.Rational(3, 10)
    assert 9.5 in Domain("9", "10") and 0.3 not in Domain("9", "10")
    with pytest.raises(InputError, match="a positive parameter has the least value 1/10"):
        Domain("0.1", positive=True)
    for wrong in ("x", True, "1/0"):
        with pytest.raises(InputError):
            Domain(wrong)
