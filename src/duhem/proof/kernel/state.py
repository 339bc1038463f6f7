"""Laws with a state: what is claimed of the energy and of the dissipation in it, as laws in other forces.

psi(chi) is jointly convex in the variables but the temperature where {psi <= z} is convex in (chi, z): the claim is that of convexity, of
its epigraph.  The forces are Y = -d psi/d alpha, and sigma = d psi/d u where an observable u has the force of an internal variable too.

The dissipation sum Y . rate has these derivatives in the place of the forces that are functions of internal variables alone.  A force that
depends on an observable stays free: what holds for all values of it holds for those that a state gives.

With heat between bodies and the interface D_th = sum of (q_k . n_k/T_k) (T_k - T) (Antoni et al. 2007, Eq. 22), which with
q_k . n_k = h_k (T_k - T) is the sum of h_k (T_k - T)^2/T_k.  What the interface takes up, T ds/dt = D_intr + sum of q_k . n_k, gives the
rate of its temperature, so that there is nothing to show of it.
"""

from __future__ import annotations

from fractions import Fraction

from duhem.proof.kernel.bounds import Bounds
from duhem.proof.kernel.curvature import over, within_ranges
from duhem.proof.kernel.definedness import Reader
from duhem.proof.kernel.domain import ZERO
from duhem.proof.kernel.forms import place_of
from duhem.proof.kernel.gradient import gradient
from duhem.proof.kernel.identity import in_order, vanishes
from duhem.proof.kernel.polynomial import written
from duhem.proof.kernel.rates import never_negative_on_each_side
from duhem.proof.kernel.regularity import regularity, smooth_everywhere
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import Term, minus, product_of, sum_of

__all__ = [
    "convex_in_each_variable", "energy_differentiable", "epigraph", "has_default_energy", "heat_flows_downhill",
    "in_state", "least_at_zero", "potential_least_at_zero", "rate_epigraph", "state_laws_agree", "stored_and_rates",
]  # fmt: skip


def has_default_energy(law: StatedLaw) -> bool:
    """Whether psi is |L^T (u - u_in)|^2/2: the law states no other, and no variable but the u_in of a declared u has a force."""
    observed = {own.force for _, own in law.variables if own.kind == "observable"}
    return law.energy is None and all(own.force in observed for _, own in law.variables if own.force is not None)


def epigraph(law: StatedLaw) -> StatedLaw | None:
    """{psi(chi) <= z} in chi, without the temperature, and z; None for a law without an energy."""
    if law.energy is None or any(c.names() & {name for name, _ in law.variables} for c in law.constraints):
        return None  # the states that are left need not be a convex set
    moving = tuple(name for name, own in law.variables if own.kind != "temperature")
    height = _unused(law)
    return _in_variables(law, moving, sum_of(law.energy, minus(Term("name", name=height))), height)


def convex_in_each_variable(law: StatedLaw) -> bool:
    """Whether psi is convex in each variable but the temperature, at every value of the others."""
    if law.energy is None or law.once(energy_differentiable):
        return False
    moving = [name for name, own in law.variables if own.kind != "temperature"]
    return all(over(_in_variables(law, (name,), law.energy)).facts(law.energy).convex for name in moving)


def rate_epigraph(law: StatedLaw, power: bool) -> StatedLaw:
    """{Phi*(Y) <= z} in the forces and z, of a potential of rates; with the power Y . d Phi*/d Y, if that is asked for."""
    height = _unused(law)
    names = [Term("name", name=f) for f in law.forces]
    spent = sum_of(*map(product_of, names, gradient(law.g, law.forces))) if power else None
    g = sum_of(law.g, minus(Term("name", name=height)))
    return law._replace(forces=(*law.forces, height), g=g, viscous=False, power=spent, energy=None, variables=(), rates=())


def potential_least_at_zero(law: StatedLaw) -> str:
    """Whether a potential of rates is 0 at 0 and no less elsewhere: it is >= 0, or convex and even, or convex with no slope at 0."""
    if not law.viscous:
        return ""
    there = over(law).facts(law.g.put(place_of({}, over(law))))
    if not (there.defined and there.sign == ZERO):
        return "the potential is not shown to be 0 at zero force"
    return "" if least_at_zero(law.g, law) else "the potential is not shown to be least at zero force"


def least_at_zero(potential: Term, law: StatedLaw) -> bool:
    """Whether a potential is no less than at zero force: by its sign, or as it is convex, and even or without a slope there."""
    domain, zero = over(law), place_of({}, over(law))
    there = domain.facts(start := potential.put(zero))
    above = potential if there.sign == ZERO else sum_of(potential, minus(start))
    if there.defined and (domain.never_negative(above) or never_negative_on_each_side(above, law)):
        return True
    opposite = potential.put({x: minus(x) for x in zero})
    even = vanishes(in_order(sum_of(potential, minus(opposite)), domain), domain)
    slopes = (domain.facts(slope.put(zero)) for slope in gradient(potential, law.forces))
    flat = smooth_everywhere(potential, domain) and all(slope.defined and slope.sign == ZERO for slope in slopes)
    return domain.facts(potential).convex and (even or flat)


def _unused(law: StatedLaw) -> str:
    """A name that the law has no use for."""
    taken = {*law.forces, *law.parameters, law.pressure}
    return next(name for name in ("z", *(f"z{i}" for i in range(len(taken) + 1))) if name not in taken)


def energy_differentiable(law: StatedLaw) -> str:
    """Whether the energy and each force that it gives have a value in all states, and one; there is nothing to ask without an energy."""
    if law.energy is None:
        return ""
    names = tuple(name for name, _ in law.variables)
    terms = (law.energy, *gradient(law.energy, names))
    if any(Reader(over(law)).undecided(term) is not None for term in terms):
        return "the energy is not shown to have a value in every state"
    found = regularity(law.energy, within_ranges(_in_variables(law, names, law.energy)))
    if found is None or found.kinks or any(over(law).facts(tip).sign & ZERO for tip in found.tips):
        return "the energy is not shown to be differentiable"
    return ""


def _in_variables(law: StatedLaw, names: tuple[str, ...], g: Term, *more: str) -> StatedLaw:
    """A law whose forces are variables in their ranges, and ``more``."""
    ranges = tuple((name, law.parameters[name]) for name in names if law.parameters[name] != Bounds(None, None))
    rest = {name: own for name, own in law.parameters.items() if name not in names}
    return StatedLaw((*names, *more), None, g, None, rest, law.constraints, ranges)


def state_laws_agree(law: StatedLaw) -> bool:
    """Whether each force is one, and psi is concave in the temperature."""
    domain, slopes = over(law), law.once(_slopes)
    bends = [minus(*gradient(slopes[name], (name,))) for name, own in law.variables if own.kind == "temperature"]
    return _one_force_each(law) and all(map(domain.never_negative, bends))


def _one_force_each(law: StatedLaw) -> bool:
    """Whether d psi/d u = -d psi/d u_in where u and u_in have one force."""
    domain, slopes = over(law), law.once(_slopes)
    driven = {own.force: name for name, own in law.variables if own.kind == "internal" and own.force}
    shared = [(name, driven[own.force]) for name, own in law.variables if own.kind == "observable" and own.force in driven]
    return all(vanishes(in_order(sum_of(slopes[u], slopes[u_in]), domain), domain) for u, u_in in shared)


def in_state(law: StatedLaw) -> StatedLaw | None:
    """The law with Y = -d psi/d alpha put in, and its power; None where it has no energy or flow of its own.

    Where no force stays free, all of them are kept, of which nothing depends then.
    """
    if law.energy is None or law.flow is None or law.once(energy_differentiable):
        return None
    bound = _bound(law)
    free = tuple(f for f in law.forces if Term("name", name=f) not in bound) or law.forces
    flow = tuple(d.put(bound) for d in law.flow)
    names = [Term("name", name=f) for f in law.forces]
    power = sum_of(*(product_of(bound.get(x, x), d) for x, d in zip(names, flow, strict=True)))
    slips = tuple(d for f, d in zip(law.forces, flow, strict=True) if f in free)
    return law._replace(forces=free, g=law.g.put(bound), flow=slips, power=power, potential=None, energy=None, variables=(), rates=())


def stored_and_rates(law: StatedLaw) -> str:
    """What every proof of dissipation rests on: the energy gives one force to each variable, and rates without a multiplier dissipate."""
    if found := law.once(energy_differentiable):
        return found
    if law.energy is not None and not _one_force_each(law):
        return "an observable and an internal variable with one force are not shown to have the same from the energy"
    return _rates_dissipate(law)


def _rates_dissipate(law: StatedLaw) -> str:
    """Whether sum of Y . rate >= 0 in every state, of the rates without a multiplier; "" if so.  The energy is differentiable."""
    if not law.rates:
        return ""
    domain, bound = over(law), {} if law.energy is None else _bound(law)
    force = {name: own.force for name, own in law.variables}
    driven = [(Term("name", name=f), rate.put(bound)) for name, rate in law.rates if (f := force[name]) is not None]
    power = sum_of(*(product_of(bound.get(x, x), rate) for x, rate in driven))
    if any(Reader(domain).undecided(rate) is not None for _, rate in law.rates):
        return "the rates without a multiplier are not shown to have a value"
    return "" if domain.never_negative(power) else "the rates without a multiplier are not shown to dissipate"


def _bound(law: StatedLaw) -> dict[Term, Term]:
    """The forces that depend on no observable, each with what it is in the state."""
    domain, slopes = over(law), law.once(_slopes)
    observed = tuple(name for name, own in law.variables if own.kind == "observable")
    driven = [(own.force, name) for name, own in law.variables if own.kind == "internal" and own.force]
    given = {Term("name", name=force): written(domain.polynomial(minus(slopes[name]))) for force, name in driven}
    return {x: y for x, y in given.items() if all(vanishes(in_order(slope, domain), domain) for slope in gradient(y, observed))}


def _slopes(law: StatedLaw) -> dict[str, Term]:
    """d psi by each variable."""
    names = tuple(name for name, _ in law.variables)
    return dict(zip(names, gradient(law.energy or Term("number"), names), strict=True))


def heat_flows_downhill(law: StatedLaw) -> bool:
    """Whether each conductance has a value and is >= 0 in all states with T > 0; that each T_k > 0 is in its range."""
    warm = {name: law.parameters[name].above(Fraction(0), True) for name, own in law.variables if own.kind == "temperature"}
    domain = over(law._replace(parameters={**law.parameters, **warm}))
    reader = Reader(domain)
    shown = (reader.undecided(h) is None and domain.never_negative(h) for _, h in law.heat)
    return bool(law.heat) and all(shown)
