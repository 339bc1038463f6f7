"""State, free energy, state laws and the Clausius-Duhem inequality (Antoni et al. 2007, Eqs. 21-31), by differentiation."""

from __future__ import annotations

from collections.abc import Iterator

import sympy as sp

from duhem.derivation.equation import Equation
from duhem.derivation.notation import Names

__all__ = ["column", "energy", "equal", "free_energy", "state_equations"]

STATE, DISSIPATION = "State and state laws", "Clausius-Duhem inequality"


def column(entries: object) -> sp.ImmutableMatrix:
    """A column vector."""
    return sp.ImmutableMatrix(sp.Matrix(list(entries)))  # type: ignore[call-overload]


def equal(left: object, right: object) -> sp.Basic:
    """left = right, kept as written."""
    return sp.Eq(left, right, evaluate=False)


def energy(names: Names, strain: tuple[sp.Expr, ...]) -> sp.Expr:
    """1/2 strain . k strain."""
    vector = sp.Matrix(list(strain))
    return (vector.T * names.stiffness * vector)[0] / 2


def free_energy(names: Names) -> sp.Expr:
    """psi_C(u, u_in) = 1/2 (u - u_in) . k (u - u_in) (Antoni et al. 2007, Eq. 30)."""
    return energy(names, tuple(u - p for u, p in zip(names.total, names.inelastic, strict=True)))


def state_equations(names: Names) -> Iterator[Equation]:
    """Equations 21 to 31, isothermal; what has to agree is checked here, symbolically."""
    u, p, v, d = names.total, names.inelastic, names.speed, names.rates
    psi = free_energy(names)
    stress = [sp.factor_terms(psi.diff(x)) for x in u]
    forces = [sp.factor_terms(-psi.diff(x)) for x in p]
    if any(sp.expand(a - b) != 0 for a, b in zip(stress, forces, strict=True)):
        raise ArithmeticError("dpsi/du and -dpsi/du_in differ")
    potential = sp.Symbol("psi_C", real=True)
    yield Equation(
        "21",
        "decomposition",
        equal(column(u), column(e + q for e, q in zip(names.elastic, p, strict=True))),
        "displacement = elastic (reversible) part + inelastic part (slip)",
        STATE,
    )
    yield Equation(
        "24",
        "state_variables",
        equal(sp.Symbol("chi"), sp.Tuple(*u, *p)),
        "observable and internal state variables; no temperature and no further internal variable",
        STATE,
    )
    yield Equation("30", "free_energy", equal(potential, psi), "stored energy, quadratic in the elastic part u - u_in", STATE)
    minors = [sp.StrictGreaterThan(names.stiffness[:i, :i].det(), 0, evaluate=False) for i in range(1, len(u) + 1)]
    yield Equation(
        "D1",
        "free_energy_convex",
        sp.And(*minors, evaluate=False),
        "psi_C is strictly convex in u - u_in: leading minors of its Hessian, the stiffness (Sylvester)",
        STATE,
    )
    yield Equation("25", "state_law", equal(column(names.forces), column(stress)), "sigma = d psi_C/d u", STATE)
    elastic = [sp.factor_terms(energy(names, names.elastic).diff(e)) for e in names.elastic]
    yield Equation(
        "31", "state_law_elastic", equal(column(names.forces), column(elastic)), "the same in the elastic part: sigma = k u_e", STATE
    )
    yield Equation(
        "26",
        "thermodynamic_forces",
        equal(column(names.forces), column(forces)),
        "the force Y = -d psi_C/d u_in that drives the slip is the stress itself (difference expanded to 0)",
        STATE,
    )
    change = sp.Add(*[sp.factor_terms(psi.diff(x)) * w for x, w in zip((*u, *p), (*v, *d), strict=True)])
    power = sp.Add(*[s * w for s, w in zip(names.forces, v, strict=True)])
    dissipation = sp.Symbol("D", real=True)
    yield Equation(
        "22",
        "clausius_duhem",
        sp.GreaterThan(dissipation, 0, evaluate=False),
        "second principle at the interface; isothermal, so the whole dissipation is the intrinsic one",
        DISSIPATION,
    )
    yield Equation(
        "23",
        "intrinsic_dissipation",
        equal(dissipation, power - change),
        "D = sigma . du/dt - dpsi_C/dt by the chain rule; the entropy term dT_C/dt s_C is zero",
        DISSIPATION,
    )
    at_law = dict(zip(names.forces, stress, strict=True))
    reduced = sp.Add(*[s * w for s, w in zip(names.forces, d, strict=True)])
    if sp.expand((power - change - reduced).xreplace(at_law)) != 0:
        raise ArithmeticError("the Clausius-Duhem inequality does not reduce to the power of the stress on the slip rate")
    yield Equation(
        "D2",
        "reduced_dissipation",
        equal(dissipation, reduced),
        "what is left of (23) once the state law (25) holds: the power of the stress on the slip rate",
        DISSIPATION,
    )
