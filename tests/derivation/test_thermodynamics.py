"""Every line of the derivation of a law with a state, against differences of its free energy at states drawn at random; and mutants."""

from __future__ import annotations

import copy
import pickle
import re
import shutil
import subprocess
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path
from random import Random
from typing import Any

import mpmath
import pytest
import sympy as sp

import duhem
from duhem import Criterion, Derivation, Domain, InputError, YieldSurface
from duhem.derivation.support_function import sample_values
from duhem.derivation.thermodynamics import in_state, on_boundary
from duhem.expression import mpmath_
from duhem.law.state import Variable
from tests.derivation.derived import at
from tests.long import long_but

DIGITS, STEP = 50, mpmath.mpf(10) ** -12
POSITIVE = Domain(low=sp.S.Zero, positive=True)
AT_LEAST_0 = Domain.between(0, None)
SLIP = {"u": Variable("sigma", observable=True), "u_in": Variable("sigma")}
WARM = {"T": Variable(temperature=True, domain=POSITIVE)}
STORED, HEAT = "k/2*(u - u_in)**2", "c*(T*log(T/T0) - T + T0)"
SOFTER = "C/2*(1 + b*T)*alpha**2"
ALONG = "(sigma + X)/norm(sigma + X)"
Point = dict[sp.Symbol, Any]


def law(name: str, g: str, energy: str, variables: Mapping[str, Variable], **more: Any) -> Criterion:
    forces = tuple(dict.fromkeys(own.force for own in variables.values() if own.force is not None))
    named = set(re.findall(r"[a-zA-Z_]\w*", " ".join([g, energy, *more.get("flow", ()), *more.pop("words", ())])))
    free = named - {*forces, *variables, "norm", "abs", "pos", "log", "exp", "sign", "max", "sinh", "cosh"}
    parameters = dict.fromkeys(sorted(free), POSITIVE) | more.pop("parameters", {})
    return Criterion(name, g, parameters, forces, None, energy=energy, variables=variables, **more)


KINEMATIC = law(
    "kinematic", "norm(sigma + X) - R*exp(-a*T)", f"{STORED} + {SOFTER} - {HEAT}", SLIP | {"alpha": Variable("X")} | WARM
)  # fmt: skip
RECOVERING = law(
    "recovering", "norm(sigma + X) - R", f"{STORED} + {SOFTER} - {HEAT}",
    SLIP | {"alpha": Variable("X"), "w": Variable()} | WARM,
    flow=(ALONG, f"{ALONG} - gamma*alpha"), unforced={"w": "abs(sigma)/C"}, rates={"alpha": "r/C*abs(X)**(m - 1)*X", "w": "T"},
    words=("r m",), parameters={"m": Domain.between(1, None)},
)  # fmt: skip
ISOTROPIC = law(
    "isotropic", "abs(sigma) + A - R", f"{STORED} + H/2*alpha**2 + h/4*alpha**4", SLIP | {"alpha": Variable("A", domain=AT_LEAST_0)}
)  # fmt: skip
PLANE = {"u": Variable("a", observable=True), "v": Variable("b", observable=True), "u_in": Variable("a"), "v_in": Variable("b")}
ADHESION = law(
    "adhesion", "norm(a, b) - mu*exp(-q*T)", f"beta**2*C*((u - u_in)**2 + (v - v_in)**2)/2 - w*beta - {HEAT}",
    PLANE | {"beta": Variable("B", domain=Domain.between(0, 1))} | WARM, heat={"T1": "h1", "T2": "h2*(1 + q*T)*T1"}, words=("h1 h2",),
)  # fmt: skip
SHEARED = "k/2*((u - u_in)**2 + (v - v_in)**2) + j*(u - u_in)*(v - v_in)/7"
BINGHAM = law(
    "bingham", "pos(norm(a, b) + B - R)**2/(2*eta)", f"{SHEARED}*(1 + q*T) + H/2*p**2 - {HEAT}", PLANE | {"p": Variable("B")} | WARM,
    viscous=True, rates={"p": "B/eta"},
)  # fmt: skip
NORTON = law("norton", "A/(n + 1)*norm(a, b)**(n + 1)", SHEARED, PLANE, viscous=True)
KOITER = replace(
    KINEMATIC, name="koiter", g=sp.nan, written="",
    surfaces=(YieldSurface("sigma + X - R", ("1", "1")), YieldSurface("-sigma - X - R", ("-1", "-1 - alpha"))),
)  # fmt: skip
GENERAL = law(  # nothing is quadratic, and the observable acts on the heat
    "general", "abs(sigma + X) + X**2/R - R", f"k*cosh(u - u_in)*(1 + b*T) + C*cosh(alpha + b*T) - {HEAT}",
    SLIP | {"alpha": Variable("X")} | WARM, flow=("sign(sigma + X)", "sign(sigma + X) + 2*X/R"),
)  # fmt: skip
LAWS = (KINEMATIC, RECOVERING, ISOTROPIC, ADHESION, BINGHAM, NORTON, KOITER, GENERAL)
MULTIPLIED = tuple(own for own in LAWS if not own.viscous and not own.surfaces)
every = pytest.mark.parametrize("own", LAWS, ids=lambda own: own.name)


@pytest.fixture(autouse=True)
def _digits() -> Iterator[None]:
    with mpmath.workdps(DIGITS):
        yield


@cache
def derived(own: Criterion) -> Derivation:
    return duhem.derive(own)


# -- states, and what the energy alone says of them -------------------------------------------------------------------


def states(own: Criterion, count: int = 3, seed: int = 22) -> Iterator[Point]:
    """Exact values of the variables and parameters."""
    return sample_values(own, (), Random(seed), count)


def names(own: Criterion, kind: str) -> list[str]:
    return [name for name, variable in own.variables.items() if getattr(variable, kind)]


@cache
def compiled(own: Criterion) -> Callable[..., list[Any]]:
    assert own.energy is not None
    return mpmath_.compiled([own.energy] if own.surfaces else [own.energy, own.g], own.symbols().values(), mpmath_.digits(DIGITS))


def psi(own: Criterion, point: Point, **moved: Any) -> Any:
    return compiled(own)(*(moved.get(name, point.get(x, 0)) for name, x in own.symbols().items()))[0]


def number(value: Any) -> Any:
    return mpmath.mpf(int(value.p)) / int(value.q) if isinstance(value, sp.Rational) else mpmath.mpf(value)


def slope(own: Criterion, point: Point, name: str, other: str = "", step: Any = STEP) -> Any:
    """The central difference of psi by a variable, or by two, apart or the same."""
    x = number(point[own.symbols()[name]])
    if other and other != name:
        table = own.symbols()
        ends = [slope(own, point | {table[name]: x + way * step}, other, step=step) for way in (1, -1)]
        return (ends[0] - ends[1]) / (2 * step)
    ends = [psi(own, point, **{name: x + way * step}) for way in (1, -1)]
    return (ends[0] - 2 * psi(own, point) + ends[1]) / step**2 if other else (ends[0] - ends[1]) / (2 * step)


def forces(own: Criterion, point: Point) -> Point:
    """Y = -d psi/d alpha by differences."""
    return {own.symbols()[own.variables[x].force]: -slope(own, point, x) for x in names(own, "internal") if own.variables[x].force}


def moving(own: Criterion, d: Derivation, seed: int) -> Point:
    """Any rates of the variables, heat from the bodies and their temperatures."""
    random = Random(seed)
    bodies = () if own.heat else d.names.state.bodies
    free = [*d.names.state.rate.values(), *(q for _, q in bodies)]
    rates: Point = {x: sp.Rational(random.randint(-40, 40), random.randint(3, 9)) for x in free}
    return rates | {body: sp.Rational(random.randint(10, 40), 7) for body, _ in bodies}


def given(own: Criterion, there: Point) -> list[tuple[Any, Any]]:
    """Of each body its temperature and the heat that it gives: any, or by its conductance."""
    warm = own.symbols()[own.temperature]
    if not own.heat:
        return [(number(there[body]), number(there[q])) for body, q in derived(own).names.state.bodies]
    bodies = [(number(there[own.symbols()[name]]), at(h, there)) for name, h in own.heat.items()]
    return [(body, h * (body - number(there[warm]))) for body, h in bodies]


def along(own: Criterion, d: Derivation, point: Point, rates: Point, function: Callable[[Point], Any]) -> Any:
    """The rate of a function of the state when its variables have these rates, by a difference."""
    table = own.symbols()

    def ahead(time: Any) -> Any:
        return function(point | {table[x]: number(point[table[x]]) + time * number(rates[rate]) for x, rate in d.names.state.rate.items()})

    return (ahead(STEP) - ahead(-STEP)) / (2 * STEP)


def near(one: Any, other: Any) -> bool:
    return bool(abs(one - other) < mpmath.mpf(10) ** -14 * (1 + abs(one) + abs(other)))


# -- state laws and the inequality ------------------------------------------------------------------------------------


def check_state_laws(own: Criterion, d: Derivation) -> None:
    table = own.symbols()
    for point in states(own):
        for force, value in zip(d["state_law"].lhs, d["state_law"].rhs, strict=True):
            (name,) = (x for x in names(own, "observable") if table[own.variables[x].force] == force)
            assert near(at(value, point), slope(own, point, name))
        differences = forces(own, point)
        assert {*d["thermodynamic_forces"].lhs} == {*differences}
        for force, value in zip(d["thermodynamic_forces"].lhs, d["thermodynamic_forces"].rhs, strict=True):
            assert near(at(value, point), differences[force])
        if own.temperature is not None:
            assert near(at(d["entropy"].rhs, point), -slope(own, point, own.temperature))


def check_balance(own: Criterion, d: Derivation) -> None:
    """d psi/dt = sigma . du/dt - Y . d alpha/dt - s dT/dt along any motion, and D_intr is what (23) says."""
    state = d.names.state
    for seed, point in enumerate(states(own)):
        rates = moving(own, d, seed)
        there = point | rates | forces(own, point) | {state.entropy: -slope(own, point, own.temperature) if own.temperature else 0}
        change = along(own, d, point, rates, lambda state: psi(own, state))
        assert near(at(d["energy_rate"].rhs, there), change)
        power = mpmath.fsum(there[own.symbols()[own.variables[x].force]] * number(rates[state.rate[x]]) for x in names(own, "observable"))
        cold = there[state.entropy] * number(rates[state.rate[own.temperature]]) if own.temperature else 0
        assert near(at(d["intrinsic_dissipation"].rhs, there), power - change - cold)
        assert near(at(d["reduced_dissipation"].rhs, there), power - change - cold)


@pytest.mark.slow
@every
def test_forces_and_entropy_are_slopes_of_the_energy(own: Criterion) -> None:
    check_state_laws(own, derived(own))


@pytest.mark.slow
@every
def test_the_energy_changes_by_power_dissipation_and_entropy(own: Criterion) -> None:
    check_balance(own, derived(own))


@pytest.mark.slow
@every
def test_nothing_is_there_that_the_law_does_not_declare(own: Criterion) -> None:
    d, table = derived(own), own.symbols()
    assert d["state_variables"].rhs == sp.Tuple(*(table[name] for name in own.variables))
    state, n = d.names.state, d.names
    named = {*table.values(), *state.rate.values(), *n.rates, *n.normal, *n.other, n.multiplier, *n.multipliers, n.power}
    named |= {state.variables, state.energy, state.energy_rate, state.entropy, state.entropy_rate, state.total, state.thermal}
    named |= {state.capacity, *(x for pair in state.bodies for part in pair for x in part.free_symbols), *sp.symbols("g K"), *(
        sp.symbols("lambda_1 lambda_2", nonnegative=True))}  # fmt: skip
    for equation in d:
        assert equation.relation.free_symbols <= named, equation
    assert n.total == n.inelastic == n.elastic == n.trial == ()
    assert {x.name for x in n.rates} == {f"{x}_rate" for x in own.variables.driven().values()}
    assert len({e.number for e in d}) == len({e.name for e in d}) == len(d)
    assert ("entropy" in d) is ("heat_equation" in d) is ("thermal_dissipation" in d) is (own.temperature is not None)
    assert any("the law has no temperature" in reason for _, reason in d.left_out) is (own.temperature is None)


# -- evolution --------------------------------------------------------------------------------------------------------


def on_the_boundary(own: Criterion, seed: int) -> Point:
    """A state at which the forces, by differences, lie on g = 0: u is moved until they do."""
    table = own.symbols()
    for point in states(own, 40, seed):

        def level(u: Any, point: Point = point) -> Any:
            there = point | {table["u"]: u}
            there |= forces(own, there)
            return compiled(own)(*(there[x] for x in table.values()))[1]

        low, high = number(point[table["u_in"]]), number(point[table["u_in"]]) + 60
        if level(low) < 0 < level(high):
            for _ in range(90):
                middle = (low + high) / 2
                low, high = (middle, high) if level(middle) <= 0 else (low, middle)
            return point | {table["u"]: low}
    raise AssertionError("no state on g = 0 was found")


def declared_rates(own: Criterion, there: Point, multiplier: Any) -> dict[str, Any]:
    """The rate of each internal variable, from the law alone: its flow, or the difference of g or of the potential by the force."""
    table, found = own.symbols(), {}
    values = {x: number(v) for x, v in there.items()}

    def value(expr: sp.Expr, **moved: Any) -> Any:
        return mpmath_.evaluate(expr, values | {table[x]: v for x, v in moved.items()}, DIGITS)

    for name in names(own, "internal"):
        force = own.variables[name].force
        if force is None:
            found[name] = multiplier * value(own.unforced[name]) if name in own.unforced else mpmath.mpf(0)
        elif own.flow is not None:
            found[name] = multiplier * value(own.flow[own.forces.index(force)])
        else:
            ends = [value(own.g, **{force: values[table[force]] + way * STEP}) for way in (1, -1)]
            found[name] = (1 if own.viscous else multiplier) * (ends[0] - ends[1]) / (2 * STEP)
        found[name] += value(own.rates[name]) if name in own.rates else 0
    return found


def check_evolution(own: Criterion, d: Derivation) -> None:
    state, multiplier = d.names.state, sp.Rational(3, 2)
    key = "evolution" if own.viscous else "flow" if own.flow is not None else "normality"
    for seed in range(2):
        point = next(states(own, 1, seed)) if own.viscous else on_the_boundary(own, seed)
        there = point | forces(own, point)
        wanted = declared_rates(own, there, number(multiplier))
        there[d.names.multiplier] = multiplier
        if not own.viscous:
            there |= {n: at(value, there) for n, value in zip(d.names.normal, d["normal"].rhs if "normal" in d else (), strict=False)}
        given = {rate: at(value, there) for rate, value in zip(d[key].lhs, d[key].rhs, strict=True)}
        assert {*given} == {state.rate[name] for name in wanted}
        assert all(near(given[state.rate[name]], wanted[name]) for name in wanted)
        power = mpmath.fsum(there[own.symbols()[own.variables[x].force]] * wanted[x] for x in wanted if own.variables[x].force)
        assert near(at(d["dissipation"].rhs, there), power)
        if "dissipation_in_state" in d:
            assert near(at(d["dissipation_in_state"].rhs, point | {d.names.multiplier: multiplier}), power)
        if "fenchel_equality" in d:
            assert near(at(d["fenchel_equality"].rhs, there | given), power)
            zero = (d[title].lhs for title in d.titles if title.startswith("potential_domain"))
            assert all(near(at(form, there | given), 0) for form in zero)


@pytest.mark.slow
@pytest.mark.parametrize("own", (*MULTIPLIED, BINGHAM, NORTON), ids=lambda own: own.name)
def test_rates_and_dissipation_are_those_of_the_law(own: Criterion) -> None:
    check_evolution(own, derived(own))


@pytest.mark.slow
def test_where_the_dissipation_has_its_closed_form() -> None:
    """R lambda of the associated law, and (R + C gamma alpha^2) lambda beside C alpha^2 r (C|alpha|)^(m-1) of recall and recovery."""
    s = {name: x for own in (KINEMATIC, RECOVERING) for name, x in own.symbols().items()}
    rate = derived(KINEMATIC).names.multiplier
    assert derived(KINEMATIC)["dissipation"].rhs == rate * s["R"] * sp.exp(-s["a"] * s["T"])
    assert "dissipation_in_state" not in derived(KINEMATIC)
    own = RECOVERING.symbols()
    stiff = own["C"] * (1 + own["b"] * own["T"])
    recovered = own["r"] / own["C"] * sp.Abs(stiff * own["alpha"]) ** (own["m"] - 1) * (stiff * own["alpha"]) ** 2
    wanted = derived(RECOVERING).names.multiplier * (own["R"] + own["gamma"] * stiff * own["alpha"] ** 2) + recovered
    assert sp.simplify(derived(RECOVERING)["dissipation_in_state"].rhs - wanted) == 0
    assert derived(NORTON)["dissipation"].rhs == (NORTON.symbols()["n"] + 1) * NORTON.g


@pytest.mark.slow
def test_recall_in_three_dimensions_has_its_closed_form() -> None:
    """Chaboche's law with one back stress and a radius of its own: D = lambda (R + gamma C alpha . alpha), whatever the stress is."""
    axes = ("11", "22", "33", "23", "13", "12")
    shifted = [f"(s{i} + X{i})" for i in axes]
    args = [f"{x} - ({' + '.join(shifted[:3])})/3" for x in shifted[:3]] + [f"sqrt(2)*{x}" for x in shifted[3:]]
    size = f"norm({', '.join(args)})"
    flow = [f"({x})/{size}" for x in args[:3]] + [f"2*{x}/{size}" for x in shifted[3:]]
    elastic = [f"(e{i} - p{i})" for i in axes]
    stored = f"la/2*({' + '.join(elastic[:3])})**2 + G*({' + '.join(f'{x}**2' for x in elastic)})"
    hardened = f"C/2*({' + '.join(f'a{i}**2' for i in axes)}) + Q*(r + exp(-b*r)/b)"
    variables = {f"e{i}": Variable(f"s{i}", observable=True) for i in axes} | {f"p{i}": Variable(f"s{i}") for i in axes}
    variables |= {f"a{i}": Variable(f"X{i}") for i in axes} | {"r": Variable("A", domain=AT_LEAST_0)}
    recalled = [f"{x} - gamma*a{i}" for x, i in zip(flow, axes, strict=True)]
    forces = (*(f"s{i}" for i in axes), *(f"X{i}" for i in axes), "A")
    parameters = dict.fromkeys(("R", "C", "G", "la", "Q", "b", "gamma"), POSITIVE)
    own = Criterion("chaboche", f"{size} + A - R", parameters, forces, None, energy=f"{stored} + {hardened}", variables=variables,
                    flow=(*flow, *recalled, "1"))  # fmt: skip
    d, s = duhem.derive(own), own.symbols()
    wanted = s["R"] + s["gamma"] * s["C"] * sp.Add(*(s[f"a{i}"] ** 2 for i in axes))
    assert sp.expand(d["dissipation_in_state"].rhs - d.names.multiplier * wanted) == 0
    assert d["thermodynamic_forces"].rhs[-1] == -s["Q"] * (1 - sp.exp(-s["b"] * s["r"]))


@pytest.mark.slow
def test_the_support_function_is_found_where_it_was_without_a_state() -> None:
    potential, state = derived(KINEMATIC)["dissipation_potential"], derived(KINEMATIC).names.state
    assert potential.rhs.has(state.rate["u_in"], state.rate["alpha"]) and "dissipation_potential" not in derived(ISOTROPIC)
    assert "unbounded along" in derived(KINEMATIC)["stress_of_slip"].note and "tip" not in derived(ADHESION)
    slow = replace(KINEMATIC, rates={"alpha": "X/C"}, name="slow")
    check_evolution(slow, derived(slow))
    assert derived(slow)["potential_domain_1"].lhs.has(slow.symbols()["X"])


def test_a_k_that_is_a_line_without_pressure_has_no_tip() -> None:
    pressed = replace(KINEMATIC, name="pressed", g="abs(sigma + X) - R*abs(p)", written="", pressure="p")
    d = duhem.derive(pressed)
    assert "potential_domain_1" in d and "tip" not in d


def test_rates_without_a_multiplier_are_in_corners_too() -> None:
    own = replace(ISOTROPIC, name="recovering at rest", rates={"alpha": "A/h"})
    more = [one - other for one, other in zip(duhem.derive(own)["corner_1"].rhs, duhem.derive(ISOTROPIC)["corner_1"].rhs, strict=True)]
    assert more == [0, own.symbols()["A"] / own.symbols()["h"]]


def test_the_power_on_the_boundary() -> None:
    a, b, x, n = sp.symbols("a b x n", real=True)
    size = duhem.expression.Norm(a, b)
    assert on_boundary(size - x, (a**2 + b**2) / size + x * n, (a, b)) == x + x * n
    assert on_boundary(sp.Abs(a) - x, a * sp.sign(n), (a, b)) == a * sp.sign(n)
    assert on_boundary(size + sp.Abs(a) - x, a, (a, b)) is None  # two roots
    assert on_boundary(size**2 - x, a, (a, b)) is None  # not linear in it
    assert on_boundary(size - sp.exp(a), a, (a, b)) is None  # not rational


@pytest.mark.slow
def test_each_surface_has_its_multiplier() -> None:
    d = derived(KOITER)
    for point in states(KOITER):
        there = point | forces(KOITER, point) | {m: sp.Rational(i, 3) for i, m in enumerate(d.names.multipliers, 1)}
        one, two = mpmath.mpf(1) / 3, mpmath.mpf(2) / 3
        alpha, (sigma, back) = number(point[KOITER.symbols()["alpha"]]), (there[KOITER.symbols()[x]] for x in ("sigma", "X"))
        rates = [at(value, there) for value in d["flow"].rhs]
        assert near(rates[0], one - two) and near(rates[1], one - two - two * alpha)
        assert near(at(d["dissipation"].rhs, there), sigma * rates[0] + back * rates[1])
        assert near(at(d["dissipation_in_state"].rhs, there), sigma * rates[0] + back * rates[1])
    more = replace(KOITER, variables={**KOITER.variables, "w": Variable()}, unforced={"w": "1"})
    assert "rate of w" in {part for part, _ in duhem.derive(more).left_out}


# -- heat -------------------------------------------------------------------------------------------------------------


def check_heat(own: Criterion, d: Derivation) -> None:
    """The rate of the temperature is that at which T ds/dt is dissipation and heat that flows in; then both principles hold."""
    state, table = d.names.state, own.symbols()
    warm, rate = table[own.temperature], state.rate[own.temperature]
    for seed, point in enumerate(states(own)):
        rates = moving(own, d, seed)
        there = point | rates | forces(own, point)
        there[d.names.power] = at(d["reduced_dissipation"].rhs, there)
        there[state.capacity] = at(d["heat_capacity"].rhs, there)
        assert near(there[state.capacity], -number(point[warm]) * slope(own, point, own.temperature, own.temperature, STEP / 10))
        rates[rate] = there[rate] = at(d["heat_equation"].rhs, there) / there[state.capacity]
        entropy = along(own, d, point, rates, lambda at: -slope(own, at, own.temperature, step=STEP))
        bodies = given(own, there)
        flowing = mpmath.fsum(q for _, q in bodies)
        assert near(number(point[warm]) * entropy, there[d.names.power] + flowing)
        assert near(number(point[warm]) * entropy, at(d["heat_balance"].rhs, there))
        energy = along(own, d, point, rates, lambda at: psi(own, at) - number(at[warm]) * slope(own, at, own.temperature))
        power = [there[table[own.variables[x].force]] * number(rates[state.rate[x]]) for x in names(own, "observable")]
        assert near(energy, mpmath.fsum(power) + flowing)
        produced = entropy - mpmath.fsum(q / body for body, q in bodies)
        thermal = at(d["thermal_dissipation"].rhs, there)
        assert near(number(point[warm]) * produced, there[d.names.power] + thermal)
        assert near(at(d["dissipation_split"].rhs, there | {state.thermal: thermal}), number(point[warm]) * produced)


@pytest.mark.slow
@pytest.mark.parametrize("own", [own for own in LAWS if own.temperature], ids=lambda own: own.name)
def test_both_principles_hold_with_the_heat_equation(own: Criterion) -> None:
    check_heat(own, derived(own))


@pytest.mark.slow
def test_the_heat_of_bodies_by_their_conductances() -> None:
    s, d = ADHESION.symbols(), derived(ADHESION)
    first, second = s["h1"] * (s["T1"] - s["T"]), s["h2"] * s["T1"] * (1 + s["q"] * s["T"]) * (s["T2"] - s["T"])
    thermal = first * (s["T1"] - s["T"]) / s["T1"] + second * (s["T2"] - s["T"]) / s["T2"]
    assert d["thermal_dissipation"].rhs == thermal and d["heat_balance"].rhs == d.names.power + first + second
    cold = duhem.derive(ADHESION, {"T1": 300})
    assert sp.expand(cold["heat_balance"].rhs - (d.names.power + first + second).subs(s["T1"], 300)) == 0
    assert not cold["thermal_dissipation"].rhs.has(s["T1"])


@pytest.mark.slow
def test_adiabatic_heating_at_a_constant_rate_of_slip() -> None:
    """c T = c T_0 + R lambda t without back stress, without bodies: the closed form."""
    own = law("heated", "abs(sigma) - R", f"{STORED} - {HEAT}", SLIP | WARM)
    d = duhem.derive(own)
    assert d["heat_capacity"].rhs == own.symbols()["c"] and "no thermoelastic term" in d["heat_equation"].note
    still = d["heat_equation"].rhs.subs({q: 0 for _, q in d.names.state.bodies})
    assert still.subs(d.names.power, d["dissipation"].rhs) == d.names.multiplier * own.symbols()["R"]


# -- mutants ----------------------------------------------------------------------------------------------------------


def changed(d: Derivation, name: str, change: Callable[[sp.Expr], sp.Expr]) -> Derivation:
    """The derivation with one right side changed."""

    def new(equation: Any) -> Any:
        return replace(equation, relation=sp.Eq(equation.lhs, change(equation.rhs), evaluate=False))

    return replace(d, equations=tuple(new(e) if e.name == name else e for e in d))


MUTANTS: list[tuple[str, Callable[[Criterion, Derivation], None], str, Callable[[Derivation, sp.Expr], sp.Expr]]] = [
    ("entropy turned", check_state_laws, "entropy", lambda d, rhs: -rhs),
    ("a force turned", check_state_laws, "thermodynamic_forces", lambda d, rhs: -rhs),
    ("the stress turned", check_state_laws, "state_law", lambda d, rhs: -rhs),
    ("the rate of the entropy lost", check_balance, "energy_rate", lambda d, rhs: rhs.subs(d.names.state.entropy, 0)),
    ("a force lost", check_balance, "reduced_dissipation", lambda d, rhs: rhs.subs(d.names.forces[1], 0)),
    ("entropy added", check_balance, "intrinsic_dissipation", lambda d, rhs: rhs.subs(d.names.state.entropy, -d.names.state.entropy)),
    ("no thermoelastic term", check_heat, "heat_equation", lambda d, rhs: d.names.power + sum(q for _, q in d.names.state.bodies)),
    ("dissipation counted twice", check_heat, "heat_equation", lambda d, rhs: rhs + d.names.power),
    ("heat of a body lost", check_heat, "heat_equation", lambda d, rhs: rhs.subs(d.names.state.bodies[0][1], 0)),
    ("capacity turned", check_heat, "heat_capacity", lambda d, rhs: -rhs),
    ("conduction turned", check_heat, "thermal_dissipation", lambda d, rhs: -rhs),
    ("recovery lost", check_evolution, "flow", lambda d, rhs: rhs.subs(d.names.law.symbols()["r"], 0)),
    ("recall lost", check_evolution, "dissipation_in_state", lambda d, rhs: rhs.subs(d.names.law.symbols()["gamma"], 0)),
]


@pytest.mark.slow
@pytest.mark.parametrize(("check", "name", "change"), [row[1:] for row in MUTANTS], ids=[row[0] for row in MUTANTS])
def test_a_wrong_equation_is_seen(check: Any, name: str, change: Any) -> None:
    d = derived(RECOVERING)
    with pytest.raises(AssertionError):
        check(RECOVERING, changed(d, name, lambda rhs: change(d, rhs)))


WRONG = [("C/2", "-C/2"), ("- c*(T", "+ c*(T"), ("(1 + b*T)", "(1 - b*T)"), ("k/2*(u - u_in)", "k*(u - u_in)")]
CHECKS = (check_state_laws, check_balance, check_heat)  # the last says nothing of k: the power is that of the forces


@pytest.mark.slow
@pytest.mark.parametrize(("one", "other", "check"), [(*wrong, check) for wrong in WRONG for check in CHECKS][:-1])
def test_a_sign_or_factor_in_the_energy_is_seen(one: str, other: str, check: Any) -> None:
    mutant = replace(RECOVERING, energy=str(RECOVERING.written_energy).replace(one, other), written_energy="")
    assert mutant.energy != RECOVERING.energy
    with pytest.raises(AssertionError):
        check(RECOVERING, duhem.derive(mutant))


def test_a_force_of_the_wrong_variable_is_refused() -> None:
    wrong = replace(KINEMATIC, energy="k/2*(u - alpha)**2 + C/2*u_in**2", written_energy="")
    with pytest.raises(InputError, match=r"energy of kinematic: d psi/d u and -d psi/d u_in differ, and both are said to be sigma"):
        duhem.derive(wrong)
    same = replace(KINEMATIC, energy="k/2*norm(u - u_in, 0)**2*(1 + exp(log(1 + (u - u_in)**2)))", written_energy="")
    assert {*in_state(same)} == {KINEMATIC.symbols()["sigma"], KINEMATIC.symbols()["X"]}


def test_what_random_states_compare_is_no_identity_and_says_so() -> None:
    """k log(2 cosh((u - u_in)/2)), of which no expansion sees that it depends on the difference alone."""
    only = "compared at random states only for sigma"
    own = law("compared", "abs(sigma) - R", "k*log(exp(u) + exp(u_in)) - k*(u + u_in)/2", SLIP)
    assert only in duhem.derive(own)["thermodynamic_forces"].note
    assert only not in duhem.derive(replace(own, energy=STORED, written_energy=""))["thermodynamic_forces"].note


# -- what is omitted, and how it is shown -----------------------------------------------------------------------------


@pytest.mark.slow
def test_a_law_without_an_energy_says_so() -> None:
    variables = {"p": Variable(domain=AT_LEAST_0)} | WARM
    own = Criterion("frozen", "norm(sigma_a, sigma_b) - (mu + h*p)*abs(sigma_n)", variables=variables, unforced={"p": "1"},
                    parameters={"mu": POSITIVE, "h": POSITIVE})  # fmt: skip
    d = duhem.derive(own)
    s, rate = own.symbols(), d.names.state.rate["p"]
    assert "free_energy" not in d and "entropy" not in d and "heat_equation" not in d
    assert {"entropy and heat equation", "free energy, state laws (25) and forces in the state (26)"} <= {part for part, _ in d.left_out}
    assert dict(zip(d["normality"].lhs, d["normality"].rhs, strict=True))[rate] == d.names.multiplier
    assert d["dissipation"].rhs == -d.names.multiplier * s["sigma_n"] * (s["mu"] + s["h"] * s["p"])
    assert "at frozen pressure, p" in d["admissible_set"].note and list(d["tip"].rhs) == [0, 0]
    assert "(24')     T > 0, p >= 0" in d.text()


def test_a_potential_without_a_state() -> None:
    own = Criterion("creep", "A/(n + 1)*norm(sigma_a, sigma_b)**(n + 1)", dict.fromkeys("An", POSITIVE), pressure=None, viscous=True)
    d = duhem.derive(own)
    assert d.titles == ("clausius_duhem", "reduced_dissipation", "dual_potential", "evolution", "dissipation")
    assert {*d["evolution"].lhs} == {*d.names.rates} and {x.name for x in d.names.rates} == {"d_a", "d_b"}
    s = own.symbols()
    size = duhem.expression.Norm(s["sigma_a"], s["sigma_b"])
    assert list(d["evolution"].rhs) == [s["A"] * s[x] * size ** (s["n"] - 1) for x in ("sigma_a", "sigma_b")]
    perzyna = duhem.derive("perzyna")
    table, (rate, _) = perzyna.names.law.symbols(), perzyna["evolution"].rhs
    where_it_begins = {table[x]: sp.Rational(value) for x, value in {"sigma_a": 3, "sigma_b": 4, "R": 5, "eta": 2, "n": "5/2"}.items()}
    assert all(at(value, where_it_begins) == 0 for value, _ in rate.args)
    beside = replace(own, variables={"w": Variable(), "v": Variable()}, unforced={"w": "1"}, rates={"v": "2"})
    assert "rate of w" in {part for part, _ in duhem.derive(beside).left_out} and len(duhem.derive(beside)["evolution"].lhs) == 3


def test_the_stiffness_is_that_of_the_energy() -> None:
    with pytest.raises(InputError, match="the stiffness 'full' is given for a law with a state; remove it"):
        duhem.derive(KINEMATIC, stiffness="full")


@pytest.mark.slow
def test_names_of_the_law_are_left_to_it() -> None:
    variables = {"psi_C": Variable("sigma", observable=True), "s_C": Variable("sigma"), "D": Variable("D_th"), "chi": WARM["T"]}
    own = Criterion(
        "clash", "abs(sigma + D_th) - T_1", {"T_1": POSITIVE, "c_C": POSITIVE}, ("sigma", "D_th"), None,
        energy="(psi_C - s_C)**2 + chi*D**2 - c_C*chi*log(chi)", variables=variables,
    )  # fmt: skip
    d = duhem.derive(own)
    table = own.symbols()
    assert not {*table} & {x.name for e in d for x in e.relation.free_symbols if x not in table.values() and x not in sp.symbols("g K")}
    assert r"\tilde{s_C} = " in d.latex() and r"s_C = " not in d.latex()
    check_state_laws(own, d)
    check_heat(own, d)


@pytest.mark.slow
def test_fixed_parameters_and_ranges_are_put_in() -> None:
    d = duhem.derive(KINEMATIC, {"C": 3, "k": "0.5"})
    at_300 = replace(KINEMATIC, variables=dict(KINEMATIC.variables) | {"T": Variable(temperature=True, domain=Domain.fixed(300))})
    alpha, warm, b = (KINEMATIC.symbols()[x] for x in ("alpha", "T", "b"))
    assert sp.expand(d["thermodynamic_forces"].rhs[1] + 3 * alpha * (1 + b * warm)) == 0 and "C" not in str(d["free_energy"].rhs)
    assert d["entropy"].rhs.has(warm)
    assert duhem.derive(at_300)["entropy"].rhs.has(at_300.symbols()["T"])  # the derivative is taken, and then T = 300


@pytest.mark.slow
@pytest.mark.parametrize("own", long_but([1, 5, 6], LAWS), ids=lambda own: own.name)
def test_every_form_shows_every_equation(own: Criterion) -> None:
    d = derived(own)
    said, source = d.text(), d.latex()
    assert all(f"[{e.name}] {e.note}" in said and f"({e.number})" in said for e in d)
    assert source.count(r"\tag{") == len(d) and source.count(r"\left") == source.count(r"\right")
    braces = re.sub(r"\\[{}]", "", source)
    assert braces.count("{") == braces.count("}") and r"\dot{u_{\mathrm{in}}}" in source
    assert d.markdown().count("$$") == 2 * len(d)
    assert [e["number"] for e in d.to_dict()["equations"]] == [e.number for e in d]
    assert d.to_html() and all(part.reason for part in d.left_out)
    for back in (pickle.loads(pickle.dumps(d)), copy.deepcopy(d)):
        assert back == d and back.text() == said and back.latex() == source


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("pdflatex") is None, reason="pdflatex is not installed")
@pytest.mark.parametrize("own", [RECOVERING, BINGHAM], ids=lambda own: own.name)
def test_latex_compiles_and_fits_the_page(own: Criterion, tmp_path: Path) -> None:
    (tmp_path / "derivation.tex").write_text(derived(own).latex(), encoding="utf-8")
    done = subprocess.run(["pdflatex", "-halt-on-error", "-interaction=nonstopmode", "derivation.tex"], cwd=tmp_path, capture_output=True)
    assert done.returncode == 0, done.stdout[-800:]
    log = (tmp_path / "derivation.log").read_text("utf-8", errors="replace")
    assert [float(pt) for pt in re.findall(r"Overfull \\[hv]box \(([\d.]+)pt", log) if float(pt) > 5] == []


@pytest.mark.slow
def test_a_file_is_derived_as_its_law() -> None:
    assert "D = lambda_dot*(C*alpha**2*gamma + R)" in duhem.derive("armstrong-frederick-recall").text()
