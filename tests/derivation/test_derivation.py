"""Every line of a derivation against an independent computation: differences, brute force, or the paper's print."""

from __future__ import annotations

from collections.abc import Iterator
from random import Random
from typing import Any

import mpmath
import pytest
import sympy as sp

import duhem
from duhem.derivation import Derivation, derive
from duhem.derivation.derive import _degree
from duhem.derivation.support_function import sample_values, varies
from duhem.errors import InputError
from duhem.expression import mpmath_
from duhem.expression.parse import parse_expression
from duhem.law.catalogue import load, names
from duhem.law.domain import POSITIVE
from duhem.law.formula_law import Criterion
from tests.derivation.derived import DPS, EVERY_RUN, LAWS, at, derived, holds
from tests.long import long_but, mostly_long

WITH_POTENTIAL = (
    "antoni2007", "antoni2007-1d", "box", "capped", "cohesive", "coulomb", "orthotropic", "polygon", "regularised", "shifted-ellipse",
    "superellipse", "tresca", "von-mises",
)  # fmt: skip
OWN_FLOW = ("radial-flow", "rotated-flow")
R = sp.Rational


@pytest.fixture(autouse=True)
def _digits() -> Iterator[None]:
    with mpmath.workdps(DPS):
        yield


def parameters(law: Criterion, seed: int) -> dict[sp.Symbol, sp.Rational]:
    return next(sample_values(law, (), Random(seed), 1))


def anywhere(symbols: Any, random: Random) -> dict[sp.Symbol, sp.Rational]:
    return {s: R(random.choice((-1, 1)) * random.randint(3, 60), random.randint(7, 30)) for s in symbols}


def stiffness_values(d: Derivation, random: Random) -> dict[sp.Symbol, sp.Rational]:
    """Positive on the diagonal and dominant there."""
    k = d.names.stiffness
    return {s: R(random.randint(4, 9)) if s in k.diagonal() else R(random.randint(-1, 1)) for s in sorted(k.free_symbols, key=str)}


def boundary_point(law: Criterion, values: dict[sp.Symbol, sp.Rational], random: Random) -> dict[sp.Symbol, Any]:
    """A point of g = 0 on a random ray from the origin, to 35 digits."""
    ray = anywhere(law.force_symbols(), random)
    if len(ray) == 3:  # yield criteria are cylinders along s1 = s2 = s3
        mean = sum(ray.values()) / 3
        ray = {s: v - mean for s, v in ray.items()}

    context = mpmath.MPContext()
    context.dps = DPS
    level = mpmath_.compiled([law.g], [*values, *ray], context)

    def g(t: Any) -> Any:
        return level(*values.values(), *(t * mpmath.mpf(int(v.p)) / int(v.q) for v in ray.values()))[0]

    low, high = mpmath.mpf(10) ** -9, mpmath.mpf(10) ** 6
    assert g(low) <= 0 < g(high)
    for _ in range(140):
        middle = (low + high) / 2
        low, high = (middle, high) if g(middle) <= 0 else (low, middle)
    return {s: low * mpmath.mpf(int(v.p)) / int(v.q) for s, v in ray.items()}


def slope(expr: sp.Expr, point: dict[sp.Symbol, Any], along: sp.Symbol) -> Any:
    """Central difference with a step of 1e-13 in 40 digits."""
    h = mpmath.mpf(10) ** -13
    x = mpmath.mpf(int(point[along].p)) / int(point[along].q)
    return (at(expr, point | {along: x + h}) - at(expr, point | {along: x - h})) / (2 * h)


# State laws

ELASTIC = [(name, kind) for name in ("antoni2007-1d", "antoni2007", "tresca") for kind in ("orthotropic", "isotropic", "full")]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "kind"), long_but([0, 2, 4], ELASTIC))
def test_state_laws_are_slopes_of_the_free_energy(name: str, kind: str) -> None:
    d, random = derived(name, kind), Random(3)
    point = {**anywhere((*d.names.total, *d.names.inelastic), random), **stiffness_values(d, random)}
    psi = d["free_energy"].rhs
    for i, (u, p) in enumerate(zip(d.names.total, d.names.inelastic, strict=True)):
        assert abs(at(d["state_law"].rhs[i], point) - slope(psi, point, u)) < 1e-20
        assert abs(at(d["thermodynamic_forces"].rhs[i], point) + slope(psi, point, p)) < 1e-20
        assert d["state_law"].lhs[i] == d.names.forces[i]
    elastic = {e: point[u] - point[p] for e, u, p in zip(d.names.elastic, d.names.total, d.names.inelastic, strict=True)}
    both = zip(d["state_law"].rhs, d["state_law_elastic"].rhs, strict=True)
    assert all(abs(at(a, point) - at(b, point | elastic)) < 1e-35 for a, b in both)


def test_one_direction_has_the_reversible_slip_of_equation_19() -> None:
    d = derived("antoni2007-1d")
    assert d["elastic_slip"].number == "19" and list(d["elastic_slip"].lhs) == [*d.names.elastic]
    stress = d["state_law_elastic"].rhs[0].subs(d.names.elastic[0], d["elastic_slip"].rhs[0])
    assert stress == d.names.forces[0] and "elastic_slip" not in derived("coulomb")


@pytest.mark.slow
def test_stiffness_kinds_differ_as_they_say() -> None:
    assert {len(derived("antoni2007", kind).names.stiffness.free_symbols) for kind in ("isotropic", "orthotropic", "full")} == {1, 2, 3}
    minors = derived("antoni2007", "full")["free_energy_convex"].relation
    k_aa, k_ab, k_bb = (derived("antoni2007", "full").names.stiffness[i] for i in (0, 1, 3))
    assert any(sp.expand(c.lhs - (k_aa * k_bb - k_ab**2)) == 0 for c in minors.args)


@pytest.mark.parametrize("kind", ["orthotropic", "full"])
def test_clausius_duhem_reduces_to_the_power_on_the_slip(kind: str) -> None:
    d, random = derived("antoni2007", kind), Random(4)
    n = d.names
    point = {**anywhere((*n.total, *n.inelastic, *n.speed, *n.rates), random), **stiffness_values(d, random)}
    point |= {s: mpmath_.evaluate(law, point, DPS) for s, law in zip(n.forces, d["state_law"].rhs, strict=True)}
    assert abs(at(d["intrinsic_dissipation"].rhs, point) - at(d["reduced_dissipation"].rhs, point)) < 1e-30


# Criterion and branches


def quadrant(sign_a: int, sign_b: int) -> tuple[sp.Expr, dict[str, sp.Symbol]]:
    """Equation (35) as printed, one quadrant."""
    s = load("antoni2007").symbols()
    mu_a = s["mu_a_plus"] if sign_a > 0 else s["mu_a_minus"]
    mu_b = s["mu_b_plus"] if sign_b > 0 else s["mu_b_minus"]
    return sp.sqrt((s["sigma_a"] / mu_a) ** 2 + (s["sigma_b"] / mu_b) ** 2) - sp.Abs(s["sigma_n"]), s


def test_antoni_has_the_four_branches_of_the_paper_in_its_order() -> None:
    rows = derived("antoni2007")["criterion_branches"].rhs.args
    assert len(rows) == 4
    for (expr, condition), (a, b) in zip(rows, [(1, 1), (-1, 1), (-1, -1), (1, -1)], strict=True):
        printed, s = quadrant(a, b)
        assert sp.simplify(expr - printed) == 0
        inside = {s["sigma_a"]: R(a), s["sigma_b"]: R(b)}
        assert holds(condition, inside)
        assert not holds(condition, {s["sigma_a"]: R(-a), s["sigma_b"]: R(b)})
        assert not holds(condition, {s["sigma_a"]: R(a), s["sigma_b"]: R(-b)})


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(LAWS, *EVERY_RUN))
def test_branches_equal_the_formula(name: str) -> None:
    law, d, random = load(name), derived(name), Random(5)
    if "criterion_branches" not in d:
        assert not law.g.has(sp.Abs, sp.Max) or not any(x.has(*law.force_symbols()) for x in law.g.atoms(sp.Abs, sp.Max))
        return
    for seed in range(3):
        values = parameters(law, seed)
        for _ in range(12):
            point = {**values, **anywhere(law.force_symbols(), random)}
            assert abs(at(d["criterion_branches"].rhs, point) - at(law.g, point)) < 1e-25 * (1 + abs(at(law.g, point)))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["antoni2007", "box", "limacon", "tresca"])
def test_indicator_and_set_are_the_formula(name: str) -> None:
    law, d, random = load(name), derived(name), Random(6)
    values = parameters(law, 6)
    rim, seen = [boundary_point(law, values, random) for _ in range(4)], set()
    for _ in range(60):
        share = mpmath.mpf(random.randint(1, 30)) / 20
        point = {**values, **{s: share * v for s, v in random.choice(rim).items()}}
        inside = bool(at(law.g, point) <= 0)
        seen.add(inside)
        (zero, condition), (infinite, _) = d["indicator"].rhs.args
        assert (zero, infinite) == (0, sp.oo)
        assert holds(condition, point) is inside
        assert holds(d["admissible_set"].rhs.condition, point) is inside
    assert seen == {True, False}


# Normality and dissipation


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long([n for n in LAWS if n not in OWN_FLOW], *(n for n in EVERY_RUN if n not in OWN_FLOW)))
def test_normal_is_the_slope_of_g(name: str) -> None:
    law, d, random = load(name), derived(name), Random(7)
    for seed in range(2):
        values = parameters(law, seed)
        for _ in range(4):
            point = {**values, **anywhere(law.force_symbols(), random)}
            for normal, force in zip(d["normal"].rhs, law.force_symbols(), strict=True):
                expected = slope(law.g, point, force)
                assert abs(at(normal, point) - expected) < 1e-8 * (1 + abs(expected))


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(LAWS, *EVERY_RUN))
def test_dissipation_is_the_power_of_the_flow_on_the_boundary(name: str) -> None:
    law, d, random = load(name), derived(name), Random(8)
    for seed in range(3):
        values = parameters(law, seed) | {d.names.multiplier: R(3, 2)}
        stress = boundary_point(law, values, random)
        point = {**values, **stress}
        flow = [at(c, point) for c in (law.flow or d["normal"].rhs)]
        power = mpmath.mpf(3) / 2 * mpmath.fsum(s * f for s, f in zip(stress.values(), flow, strict=True))
        assert abs(at(d["dissipation"].rhs, point) - power) < 1e-25 * (1 + abs(power))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["antoni2007", "capped", "cohesive", "coulomb", "orthotropic"])
def test_dissipation_of_a_gauge_needs_no_stress(name: str) -> None:
    assert not derived(name)["dissipation"].rhs.has(*load(name).force_symbols())


def test_a_right_side_has_its_value_at_numbers_by_name() -> None:
    potential = derived("antoni2007")["dissipation_potential"]
    given = {"mu_a_plus": 7, "mu_a_minus": "0.08", "mu_b_plus": 0.12, "mu_b_minus": 7}
    assert potential.at(d_a=-1, d_b=1, sigma_n=-1, **given) == sp.sqrt(sp.Rational(8, 100) ** 2 + sp.Rational(12, 100) ** 2)
    assert potential.at(sigma_n=0) == 0 and potential.at() == potential.rhs
    with pytest.raises(InputError, match=r"dissipation_potential: mu is no symbol on the right side; it has d_a, d_b, mu_a_minus"):
        potential.at(mu=1)
    with pytest.raises(InputError, match="d_a: 'fast' is not a number"):
        potential.at(d_a="fast")


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(LAWS, *EVERY_RUN))
def test_which_laws_have_a_dissipation_potential(name: str) -> None:
    assert ("dissipation_potential" in derived(name)) is (name in WITH_POTENTIAL)


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(WITH_POTENTIAL, *(name for name in WITH_POTENTIAL if name in EVERY_RUN)))
def test_potential_at_the_normal_is_the_dissipation(name: str) -> None:
    law, d, random = load(name), derived(name), Random(9)
    for seed in range(3):
        values = parameters(law, seed)
        stress = boundary_point(law, values, random)
        point = {**values, **stress}
        normal = [at(c, point) for c in d["normal"].rhs]
        phi = at(d["dissipation_potential"].rhs, {**values, **dict(zip(d.names.rates, normal, strict=True))})
        power = mpmath.fsum(s * c for s, c in zip(stress.values(), normal, strict=True))
        assert abs(phi - power) < 1e-25 * (1 + abs(power))
        for form in (d[k].lhs for k in d.titles if k.startswith("potential_domain")):
            assert abs(at(form, dict(zip(d.names.rates, normal, strict=True)))) < 1e-30


def test_own_flow_is_stated_instead_of_normality() -> None:
    for name in OWN_FLOW:
        d = derived(name)
        assert "normality" not in d and "dissipation_potential" not in d and "step_objective" not in d
        assert d["flow"].rhs[0] == d.names.multiplier * load(name).flow[0]
        assert any("its own flow direction" in reason for _, reason in d.left_out)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "count"), [("box", 4), ("tresca", 6), ("polygon", 12), ("antoni2007", 0), ("superellipse", 0), ("hosford", 0)]
)
def test_corners_are_counted_right(name: str, count: int) -> None:
    assert sum(key.startswith("corner") for key in derived(name).titles) == count


@pytest.mark.slow
@pytest.mark.parametrize("name", ["box", "tresca", "polygon"])
def test_cones_at_corners_are_normal_to_the_set(name: str) -> None:
    """At every corner, the extreme elements of the cone are normals of K: no point of the boundary lies beyond."""
    law, d, random = load(name), derived(name), Random(10)
    values = parameters(law, 10)
    cloud = [boundary_point(law, values, random) for _ in range(16)]
    support = d["dissipation_potential"].rhs
    one, two = sp.Symbol("lambda_1", nonnegative=True), sp.Symbol("lambda_2", nonnegative=True)
    for key in (k for k in d.titles if k.startswith("corner")):
        reached = []
        for pair in ({one: R(1), two: R(0)}, {one: R(0), two: R(1)}, {one: R(2), two: R(3)}):
            rate = dict(zip(d.names.rates, (at(c, {**values, **pair}) for c in d[key].rhs), strict=True))
            phi = at(support, {**values, **rate})
            assert all(
                mpmath.fsum(s * r for s, r in zip(x.values(), rate.values(), strict=True)) <= phi * (1 + mpmath.mpf(10) ** -30)
                for x in cloud
            )
            reached.append(phi)
        # The support function is linear on the normal cone of one point, and on no larger set.
        assert abs(2 * reached[0] + 3 * reached[1] - reached[2]) < 1e-25


def test_smoothness_is_told_apart() -> None:
    assert "continuous where branches meet" in derived("antoni2007")["normal"].note
    assert "jumps where" in derived("box")["normal"].note
    assert "(0, 0), where g = -|sigma_n|" in derived("antoni2007")["normal"].note


@pytest.mark.parametrize(
    "g", ["abs(sigma_a) + max(sigma_b, -2*sigma_b) + log(mu - sigma_b) - mu", "abs(sigma_a) + pos(sigma_b)*sqrt(mu - sigma_b) - mu"]
)
def test_a_law_undefined_far_from_its_set_is_derived(g: str) -> None:
    law = Criterion("odd", g, pressure=None, parameters={"mu": POSITIVE})
    (said,) = (line for line in derive(law).text().splitlines() if "[normal]" in line)
    assert "jumps where" in said and "sigma_b = 0" in said


@pytest.mark.slow
def test_tip_is_where_the_set_shrinks_to_a_point() -> None:
    assert list(derived("antoni2007")["tip"].rhs) == [0, 0]
    assert "tip" not in derived("cohesive") and "tip" not in derived("tresca")


# Increment and one direction

REFERENCE = [  # mu = (0.2, 0.08, 0.12, 0.15), |sigma_n| = 1: trial stress, stiffness, stress by a 40-digit computation
    (("0.3", "0.2"), (1, 1), ("0.16948295870263982786", "0.063711769834024715701")),
    (("-0.3", "0.2"), (1, 1), ("-0.0626859952990218239", "0.074555673728327216011")),
    (("-0.3", "-0.2"), (1, 4), ("-0.076140510365716901921", "-0.046028201830649999767")),
    (("0.3", "-0.01"), (1, 1), ("0.1998756124412152275284", "-0.0052894704439702478874")),
]


@pytest.mark.parametrize(("trial", "stiffness", "stress"), REFERENCE)
def test_reference_steps_satisfy_the_optimality_conditions(trial: Any, stiffness: Any, stress: Any) -> None:
    d = derived("antoni2007")
    s = load("antoni2007").symbols()
    coefficients = ("mu_a_plus", "1/5"), ("mu_a_minus", "2/25"), ("mu_b_plus", "3/25"), ("mu_b_minus", "3/20")
    point = {s[name]: R(value) for name, value in coefficients} | {s["sigma_n"]: R(-1)}
    point |= dict(zip(d.names.forces, map(mpmath.mpf, stress), strict=True)) | dict(zip(d.names.trial, map(R, trial), strict=True))
    point |= dict(zip(d.names.stiffness.diagonal(), map(R, stiffness), strict=True))
    residual = d["step_stationarity"].lhs
    at_zero, at_one = ([at(c, point | {d.names.step: R(t)}) for c in residual] for t in (0, 1))
    multiplier = -at_zero[0] / (at_one[0] - at_zero[0])
    assert multiplier > 0
    assert all(abs(at(c, point | {d.names.step: multiplier})) < 1e-17 for c in residual)
    assert all(holds(c, point | {d.names.step: multiplier}) for c in d["step_complementarity"].relation.args[:1])
    assert abs(at(load("antoni2007").g, point)) < 1e-17
    slip = [at(c, point) for c in d["step_slip"].rhs]
    normal = [at(c, point) for c in d["normal"].rhs]
    assert all(abs(a - multiplier * b) < 1e-17 for a, b in zip(slip, normal, strict=True))


@pytest.mark.parametrize("kind", ["orthotropic", "full"])
def test_discrete_energy_identity(kind: str) -> None:
    d, random = derived("antoni2007", kind), Random(11)
    n = d.names
    point = {**anywhere((*n.elastic, *n.elastic_step, *n.slip_step), random), **stiffness_values(d, random)}
    point |= {s: at(c, point) for s, c in zip(n.forces, d["state_law_elastic"].rhs, strict=True)}
    begin = {e: point[e] - point[step] for e, step in zip(n.elastic, n.elastic_step, strict=True)}

    def stored(elastic: dict[sp.Symbol, Any]) -> Any:
        zero = dict.fromkeys(n.inelastic, R(0))
        return at(d["free_energy"].rhs, point | zero | {u: elastic[e] for u, e in zip(n.total, n.elastic, strict=True)})

    change = stored({e: point[e] for e in n.elastic}) - stored(begin)
    gap = at(d["step_energy"].lhs, point) - at(d["step_energy"].rhs, point | {sp.Symbol("Delta_psi_C", real=True): change})
    assert abs(gap) < 1e-30


def test_one_direction_gives_the_interval_of_equation_1() -> None:
    d, s = derived("antoni2007"), load("antoni2007").symbols()
    for tail in ("a", "b"):
        ends = d[f"interval_{tail}"].rhs
        assert ends.start == s[f"mu_{tail}_minus"] * s["sigma_n"]
        assert ends.end == -s[f"mu_{tail}_plus"] * s["sigma_n"]
    line, t = derived("antoni2007-1d"), load("antoni2007-1d").symbols()
    assert line["interval_t"].rhs == sp.Interval(t["mu_minus"] * t["sigma_n"], -t["mu_plus"] * t["sigma_n"])
    assert line["one_dimensional_t"].number == "1"


def test_equation_1_is_elastic_then_perfectly_plastic() -> None:
    d, s = derived("antoni2007"), load("antoni2007").symbols()
    values = {s["mu_a_plus"]: R(1, 5), s["mu_a_minus"]: R(2, 25), s["sigma_n"]: R(-10), d.names.stiffness[0]: R(4)}
    for u, expected in [(R(1, 4), 1), (R(9, 10), 2), (R(1, 2), 2), (-R(1, 10), -R(2, 5)), (-R(1, 5), -R(4, 5)), (-R(3), -R(4, 5))]:
        assert abs(at(d["one_dimensional_a"].rhs, values | {d.names.total[0]: u}) - mpmath_.evaluate(sp.sympify(expected), {}, DPS)) < 1e-30


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(LAWS, *EVERY_RUN))
def test_intervals_are_where_g_vanishes_on_the_line(name: str) -> None:
    law, d = load(name), derived(name)
    for key in (k for k in d.titles if k.startswith("interval")):
        force, ends = d[key].lhs, d[key].rhs
        for seed in range(20, 23):
            values = parameters(law, seed) | dict.fromkeys(law.force_symbols(), R(0))
            for end in (ends.start, ends.end):
                assert abs(at(law.g, values | {force: at(end, values)})) < 1e-25


def test_an_interval_that_holds_for_some_parameters_only_is_left_out() -> None:
    law = Criterion("tilted", "norm(x, y) + mu*(x + y) - nu", {"mu": POSITIVE, "nu": POSITIVE}, ("x", "y"), None)
    d = derive(law)  # the root nu/(mu - 1) is an end only for mu < 1
    assert not any(key.startswith("interval") for key in d.titles)
    assert any("reduction to x alone" in part for part, _ in d.left_out)


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(LAWS, *EVERY_RUN))
def test_text_states_the_criterion_in_the_language_of_criterion_files(name: str) -> None:
    law, d = load(name), derived(name)
    line = next(line for line in d.text().splitlines() if line.startswith("(35) "))
    formula = line.split(" g = ", 1)[1]
    if law.pressure:
        formula = formula.replace(f"|{law.pressure}|", f"abs({law.pressure})")
    read, random = parse_expression(formula, law.symbols()), Random(12)
    point = {**parameters(law, 12), **anywhere(law.force_symbols(), random)}
    assert abs(at(read, point) - at(law.g, point)) < 1e-28 * (1 + abs(at(law.g, point)))


@pytest.mark.slow
def test_fixed_parameters_are_put_in() -> None:
    d = derive(load("antoni2007"), {"mu_a_plus": "0.2", "mu_a_minus": "0.08"})
    assert "mu_a_plus" not in d.text()
    assert "sigma_a in [-2*|sigma_n|/25, |sigma_n|/5]" in d.text()


def test_misuse_is_told() -> None:
    with pytest.raises(InputError, match="unknown stiffness 'soft'"):
        derive(load("coulomb"), stiffness="soft")
    with pytest.raises(InputError, match="unknown parameter 'nu'"):
        derive(load("coulomb"), {"nu": 1})
    with pytest.raises(InputError, match="no law"):
        derive(3)  # type: ignore[arg-type]
    with pytest.raises(KeyError, match="state_law"):
        derived("coulomb")["no_such_equation"]


@pytest.mark.slow
def test_any_number_of_forces_and_clashing_names() -> None:
    law = Criterion(
        "four", "norm(norm(x, y)/k_x, max(abs(z), abs(w))) - abs(p)*D", {"k_x": POSITIVE, "D": POSITIVE}, ("x", "y", "z", "w"), "p"
    )
    d = derive(law)
    assert "dissipation_potential" in d and len(d["normal"].lhs) == 4
    assert len(set(map(str, (*law.symbols().values(), *d.names.stiffness.free_symbols)))) == 7 + 4


def test_public_names() -> None:
    assert duhem.derive("coulomb")["criterion"].rhs == load("coulomb").g
    assert set(LAWS) <= set(names())


def test_a_degree_with_a_symbol_in_it_gives_the_dissipation_without_stress() -> None:
    law = Criterion(
        "powers",
        "(norm(sigma_a, sigma_b) + mu*sigma_a)**m + (norm(sigma_a, 2*sigma_b) - sigma_b/3)**m - s**m",
        {"m": POSITIVE, "s": POSITIVE, "mu": POSITIVE},
        pressure=None,
    )
    known = law.symbols()
    assert derive(law)["dissipation"].rhs.coeff(sp.Symbol("lambda_dot", nonnegative=True)) == known["m"] * known["s"] ** known["m"]


def test_the_degree_is_seen_in_the_form() -> None:
    a, b, m = (sp.Symbol(name, real=True) for name in "abm")
    assert _degree((sp.Abs(a) + 2 * b) ** m + 3 * a**2 * (a * b) ** (m / 2 - 1), (a, b)) == m
    assert _degree(a**m + a**2, (a, b)) is None and _degree(sp.cos(a) * b, (a, b)) is None and _degree(m**2, (a, b)) == 0


def test_numbers_tell_that_a_quotient_depends_on_the_stress() -> None:
    law = Criterion("mixed", "sigma_a**2 + mu*sigma_b - 1", {"mu": POSITIVE}, pressure=None)
    a, b = law.force_symbols()
    assert varies(law, (2 * a**2 + b) / (a**2 + b)) and not varies(law, (2 * a**2 + 2 * b) / (a**2 + b))
