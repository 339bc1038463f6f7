"""A law as its text says it.

Waves of an angle are read as algebra: cos(k atan2(q, p)) is Re (p + i q)^k / |(p, q)|^k for whole k, sin its Im (de Moivre 1722).
Both sides are undefined at p = q = 0, and there alone, so that the formula stays what it is.  What is added to the angle is parted from
it by the theorem on the cosine, or the sine, of a sum.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from fractions import Fraction
from math import comb, prod
from typing import Any, NamedTuple, TypeVar
from unicodedata import normalize

from duhem.proof.kernel.bounds import POSITIVE, Bounds
from duhem.proof.kernel.constant_value import holds
from duhem.proof.kernel.gradient import gradient
from duhem.proof.kernel.term import COMPARISONS, WORDS, NotWritten, Term, bounded, definitions, factors, number, parse, product_of, sum_of

__all__ = ["StatedFace", "StatedLaw", "as_list", "as_object", "declared", "formula_over", "inhabited", "without_angles", "without_more"]

_MOST_TURNS = 24  # of an angle

Answer = TypeVar("Answer")
Declared = tuple[tuple[str, ...], dict[str, Bounds], tuple[Term, ...], dict[Term, Term]]


_OF_STATE = ("energy", "heat", "rates", "unforced", "variables", "viscous")
_LAW = frozenset({"name", "forces", "pressure", "parameters", "constraints"})


def without_more(given: Mapping[str, Any], known: Collection[str]) -> Mapping[str, Any]:
    """What is given; NotWritten where a reader would find a word that means nothing here."""
    if more := sorted(set(given) - set(known)):
        raise NotWritten(f"{more[0]!r} means nothing here")
    return given


def as_list(given: Any) -> Sequence[Any]:
    """A list; NotWritten for a text or an object, of which one could go through the letters or keys."""
    if not isinstance(given, list | tuple):
        raise NotWritten("something else stands where a list should")
    return given


def as_object(given: Any) -> Mapping[str, Any]:
    """An object; NotWritten for anything else."""
    if not isinstance(given, Mapping) or not all(isinstance(key, str) for key in given):
        raise NotWritten("something else stands where an object should")
    return given


def declared(given: Mapping[str, Any], others: tuple[str | None, ...], formulas: Collection[str]) -> Declared:
    """Forces, parameters, constraints and what fixed parameters stand for; ``others`` may be further names.  NotWritten where they clash.

    ``formulas`` are the words of a law of its kind.
    """
    without_more(given, _LAW | set(formulas))
    forces = tuple(as_list(given["forces"]))
    parameters = {name: Bounds.read(entry) for name, entry in given["parameters"].items()}
    names = [*forces, *(name for name in others if name is not None), *parameters]
    if not forces or any(not n.isidentifier() or n != normalize("NFKC", n) or n in (*WORDS, "pi") for n in names):
        raise NotWritten("a name is none")
    if len(set(names)) < len(names):
        raise NotWritten("a name is declared twice")
    constraints = tuple(parse(text) for text in as_list(given["constraints"]))
    if any(c.op not in COMPARISONS or not c.names() <= {*parameters, "pi"} for c in constraints):
        raise NotWritten("a constraint does not compare parameters")
    fixed = {Term("name", name=n): number(x.low) for n, x in parameters.items() if x.low is not None and x.low == x.high}
    return forces, parameters, tuple(c.put(fixed) for c in constraints), fixed


def formula_over(names: Collection[str | None], term: Term, fixed: Mapping[Term, Term], wrong: str = "a name is not declared") -> Term:
    """The formula with what is ``fixed`` put in; NotWritten, with what is ``wrong``, for a comparison, or where other names are in it."""
    found = without_angles(term).put(fixed)
    if found.op in COMPARISONS or not found.names() <= {*names}:
        raise NotWritten(wrong)
    return found


def without_angles(term: Term) -> Term:
    """The formula with the waves of whole multiples of an angle as quotients; NotWritten where that is too large."""
    waves = [part for part in term.parts() if part.op in ("cos", "sin")]
    swap = dict[Term, Term]()
    for wave in waves:  # the inner ones first
        swap[wave] = _without_angle(wave._replace(args=tuple(a.put(swap) for a in wave.args)))
    return term.put(swap) if swap else term


def _without_angle(here: Term) -> Term:
    """cos(k A + b) = cos(k A) cos b - sin(k A) sin b, and so sin, for an angle A; any other wave as it is."""
    parts = _summed(here.args[0], Fraction(1))
    angles, odd = {x for x, _ in parts if x.op == "atan2"}, here.op == "sin"
    turns = sum((k for x, k in parts if x in angles), Fraction(0))
    if len(angles) != 1 or turns.denominator > 1 or not 0 < abs(turns) <= _MOST_TURNS:
        return here
    (q, p), rest = angles.pop().args, [product_of(number(k), x) for x, k in parts if x.op != "atan2"]
    own, other = (_of_turns(q, p, int(turns), way) for way in (odd, not odd))
    if not rest:
        return bounded(own)
    cosine, sine = (Term(word, (sum_of(*rest),)) for word in ("cos", "sin"))
    return bounded(sum_of(product_of(own, cosine), product_of(number(1 if odd else -1), other, sine)))


def _summed(term: Term, scale: Fraction) -> list[tuple[Term, Fraction]]:
    """What a sum, perhaps times a number, adds up, and how often."""
    others = [x for x in factors(term) if x.op != "number"]
    scale = prod((x.value for x in factors(term) if x.op == "number"), start=scale)
    if len(others) == 1 and others[0].op == "+":
        return [part for a in others[0].args for part in _summed(a, scale)]
    return [(others[0] if len(others) == 1 else product_of(*others), scale)]


def _of_turns(q: Term, p: Term, k: int, odd: bool) -> Term:
    """cos(k atan2(q, p)), or the sine if ``odd``."""
    sense, n = -1 if odd and k < 0 else 1, abs(k)
    parts = (
        product_of(number(sense * (-1) ** (j // 2) * comb(n, j)), Term("**", (p, number(n - j))), Term("**", (q, number(j))))
        for j in range(odd, n + 1, 2)
    )
    return product_of(sum_of(*parts), Term("**", (Term("norm", (p, q)), number(-n))))


class StatedFace(NamedTuple):
    """Where ``g`` = 0 and the others are <= 0 the slip is a non-negative multiple of ``flow``, or for None normal to {g <= 0}.

    ``power`` is what dissipates there, where that is more than force . flow.
    """

    g: Term
    flow: tuple[Term, ...] | None
    others: tuple[Term, ...] = ()
    power: Term | None = None


class StatedVariable(NamedTuple):
    """A variable of the state: ``observable``, ``internal`` or ``temperature``; it lies where the parameter of its name does."""

    kind: str
    force: str | None


class _Stated(NamedTuple):
    forces: tuple[str, ...]
    pressure: str | None
    g: Term
    flow: tuple[Term, ...] | None
    parameters: Mapping[str, Bounds]
    constraints: tuple[Term, ...]
    ranges: tuple[tuple[str, Bounds], ...] = ()  # of forces and the pressure, where they are bounded
    surfaces: tuple[tuple[Term, tuple[Term, ...] | None], ...] = ()
    potential: Term | None = None  # of which the flow is the gradient
    energy: Term | None = None  # in variables and parameters
    variables: tuple[tuple[str, StatedVariable], ...] = ()
    rates: tuple[tuple[str, Term], ...] = ()  # of variables, without a multiplier
    heat: tuple[tuple[str, Term], ...] = ()  # temperatures of bodies, with the conductance to each
    viscous: bool = False  # g is a potential of which the rates are the gradient
    power: Term | None = None  # what dissipates, where that is more than force . flow
    of_rates: bool = False  # "forces" are the names of rates, "flow" are the forces as functions of them, and g is the power


class StatedLaw(_Stated):
    """The law of a certificate; every formula is kept as written.

    Of several surfaces g is the greatest, and ``surfaces`` has them with the flow of each; then ``flow`` is None.
    """

    def once(self, question: Callable[..., Answer], *beside: object) -> Answer:
        """The answer to a question about this law, and what is asked ``beside`` it, found when it is first asked."""
        found = vars(self).setdefault("_found", {})
        if (question, beside) not in found:
            found[question, beside] = question(self, *beside)
        answer: Answer = found[question, beside]
        return answer

    def with_forces(self, *names: str) -> StatedLaw:
        """The law with further names among its forces."""
        return self._replace(forces=(*self.forces, *names))

    def __getstate__(self) -> None:
        """The law is all of it: another process asks anew."""

    @classmethod
    def read(cls, given: Mapping[str, Any]) -> StatedLaw:
        """From the ``law`` of a certificate; NotWritten for what is no law or has no parameter values."""
        if "forces_of_rates" in given:
            return _of_rates(given)
        pressure = given["pressure"]
        bounds = {"surfaces"} if "surfaces" in given else {"g", "flow"}
        own = {"define"} if "define" in given and not {*given} & {"surfaces", *_OF_STATE} else {*_OF_STATE}
        forces, parameters, constraints, fixed = declared(given, (pressure,), {"domain", *bounds, *own})
        if given.get("viscous", True) is not True or ("viscous" in given and ("surfaces" in given or given["flow"] is not None)):
            raise NotWritten("a potential of rates stands beside a flow")
        state = _state(given, forces, parameters, fixed) | {"viscous": "viscous" in given}
        names = {*forces, pressure, *parameters, "pi"}
        ranges = _ranges(given.get("domain", {}), forces, pressure)
        defined = _defined(given, names)

        def bound(entry: Mapping[str, Any]) -> tuple[Term, tuple[Term, ...] | None]:
            given_flow = entry["flow"]
            by_potential = isinstance(given_flow, Mapping)  # {"potential": "..."}, the flow being its gradient
            texts = [without_more(given_flow, {"potential"})["potential"]] if by_potential else as_list(given_flow or [])
            g = formula_over(names, parse(entry["g"], defined), fixed)
            flow = tuple(formula_over(names, parse(text), fixed) for text in texts)
            slips = gradient(flow[0], forces) if by_potential else flow
            if given_flow is not None and len(slips) != len(forces):
                raise NotWritten("the flow has another number of components than there are forces")
            if not g.names() & set(forces):
                raise NotWritten("g depends on no force")
            return g, None if given_flow is None else slips

        if "surfaces" not in given:
            law = cls(forces, pressure, *bound(given), parameters, constraints, ranges, **state)
            if isinstance(given["flow"], Mapping):
                law = law._replace(potential=without_angles(parse(given["flow"]["potential"])).put(fixed))
            return law
        if not given["surfaces"]:
            raise NotWritten("there is no surface")
        surfaces = tuple(bound(without_more(entry, {"g", "flow"})) for entry in as_list(given["surfaces"]))
        g = Term("max", tuple(g for g, _ in surfaces)) if len(surfaces) > 1 else surfaces[0][0]
        return cls(forces, pressure, g, None, parameters, constraints, ranges, surfaces, **state)

    @property
    def associated(self) -> bool:
        """Whether the slip is normal to K by definition."""
        return self.flow is None and self.power is None and all(flow is None for _, flow in self.surfaces)

    @property
    def around_zero(self) -> bool:
        """Whether zero force lies in the ranges."""
        return all(own.holds(Fraction(0)) for name, own in self.ranges if name != self.pressure)

    def everywhere(self) -> StatedLaw:
        """The law for all forces: what is shown of its K, and of each point, is so of the part in the ranges, which are convex."""
        return self._replace(ranges=tuple((name, own) for name, own in self.ranges if name == self.pressure))

    def faces(self) -> Iterator[StatedFace]:
        """What covers the boundary: all of it, or the share of each surface where one of them has a flow of its own."""
        if self.associated or not self.surfaces:
            yield StatedFace(self.g, self.flow, power=self.power)
            return
        for i, (g, flow) in enumerate(self.surfaces):
            yield StatedFace(g, flow, tuple(other for j, (other, _) in enumerate(self.surfaces) if j != i))


def _defined(given: Mapping[str, Any], taken: Collection[str | None]) -> dict[str, Term]:
    """What the names stand for that g may use; NotWritten where they are no list of names with formulas."""
    pairs = [tuple(as_list(pair)) for pair in as_list(given.get("define", []))]
    if not all(len(pair) == 2 and all(isinstance(text, str) for text in pair) for pair in pairs):
        raise NotWritten("a definition is no name with a formula")
    return definitions(pairs, [name for name in taken if name is not None])


def _of_rates(given: Mapping[str, Any]) -> StatedLaw:
    """The law of a certificate that has its forces as functions of the rates; NotWritten where not each of them is one."""
    pressure, functions = given["pressure"], as_object(given["forces_of_rates"])
    forces, parameters, constraints, fixed = declared(given, (pressure,), {"variables", "forces_of_rates"})
    variables = _state(given, forces, parameters, fixed)["variables"]
    driven = {own.force: f"{name}_rate" for name, own in variables if own.kind == "internal"}
    rates = tuple(driven[f] for f in forces if f in driven)
    if not len(rates) == len(functions) == len(forces) or {*functions} != {*forces}:
        raise NotWritten("a force is no function of the rate of a variable")
    if {*rates} & {*forces, *parameters, pressure} or len({*rates}) < len(rates):
        raise NotWritten("a name is declared twice")
    flow = tuple(formula_over((*rates, pressure, *parameters, "pi"), parse(functions[f]), fixed) for f in forces)
    power = sum_of(*(product_of(Term("name", name=v), d) for v, d in zip(rates, flow, strict=True)))
    return StatedLaw(rates, pressure, power, flow, parameters, constraints, variables=variables, power=power, of_rates=True)


def _state(given: Mapping[str, Any], forces: Sequence[str], parameters: Mapping[str, Bounds], fixed: Mapping[Term, Term]) -> dict[str, Any]:
    """The energy, variables and rates; NotWritten where forces and variables do not fit each other."""
    variables = tuple((name, _variable(entry)) for name, entry in as_object(given.get("variables", {})).items())
    kinds = {name: own.kind for name, own in variables}
    if any(name not in parameters or (own.kind == "internal" and own.force not in (None, *forces)) for name, own in variables):
        raise NotWritten("a variable is not declared, or its force is none")
    if list(kinds.values()).count("temperature") > 1:
        raise NotWritten("there are two temperatures")
    for kind in ("observable", "internal"):
        taken = [own.force for _, own in variables if own.kind == kind and own.force is not None]
        if len({*taken}) < len(taken) or (kind == "internal" and "energy" in given and {*taken} != {*forces}):
            raise NotWritten("a force belongs to no internal variable, or to two")
    known, rates = {*forces, *parameters, "pi", given["pressure"]}, {}
    for key in ("rates", "unforced"):
        for name, text in as_object(given.get(key, {})).items():
            rates[key, name] = formula_over(known, parse(text), fixed, "a rate is of names that are not declared")
            if kinds.get(name) != "internal":
                raise NotWritten("a rate is of no internal variable")
            if key == "unforced" and dict(variables)[name].force is not None:
                raise NotWritten("a variable with a force has its rate in the flow")
    state: dict[str, Any] = {"variables": variables, "rates": tuple((name, rate) for (key, name), rate in rates.items() if key == "rates")}
    state["heat"] = _heat(given, parameters, fixed, kinds)
    if "energy" not in given:
        return state
    ours = {Term("name", name=name) for name, _ in variables}  # a fixed variable stays one: forces are derivatives by it
    names = {*parameters, "pi"} - {name for name, own in variables if own.kind == "internal" and own.force is None}
    left, wrong = {x: v for x, v in fixed.items() if x not in ours}, "the energy is of names that are no parameters, or of no force"
    return state | {"energy": formula_over(names, parse(given["energy"]), left, wrong)}


def _heat(
    given: Mapping[str, Any], parameters: Mapping[str, Bounds], fixed: Mapping[Term, Term], kinds: Mapping[str, str]
) -> tuple[tuple[str, Term], ...]:
    """The conductance to each body; NotWritten where a temperature may be <= 0 only, or one of a body <= 0, or there is none."""
    bodies = as_object(given.get("heat", {}))
    own = [parameters[name] for name, kind in kinds.items() if kind == "temperature"]
    if bodies and not (own and own[0].sign() & POSITIVE):
        raise NotWritten("there is heat and no temperature")
    if any(name in kinds or name not in parameters or parameters[name].sign() != POSITIVE for name in bodies):
        raise NotWritten("a body has no temperature > 0")
    known, wrong = (*parameters, given["pressure"], "pi"), "a conductance is of names that are not declared"
    return tuple((name, formula_over(known, parse(text), fixed, wrong)) for name, text in bodies.items())


def _variable(entry: Any) -> StatedVariable:
    given = without_more(as_object(entry), {"observable", "temperature", "force"})
    kinds = [kind for kind in ("observable", "temperature") if kind in given]
    force = given.get("force")
    wrong = len(kinds) > 1 or any(given[kind] is not True for kind in kinds) or not isinstance(force, str | None)
    if wrong or (force is None and "observable" in kinds) or (force is not None and "temperature" in kinds):
        raise NotWritten("a variable is none")
    return StatedVariable(kinds[0] if kinds else "internal", force)


def _ranges(given: Mapping[str, Any], forces: Sequence[str], pressure: str | None) -> tuple[tuple[str, Bounds], ...]:
    """Where the pressure and forces lie; NotWritten where that leaves no pressure < 0, or a force one value."""
    found = {name: Bounds.read(entry) for name, entry in given.items()}
    for name, own in found.items():
        if name == pressure:
            found[name] = own = own.below(Fraction(0), True)
            if own.low is not None and own.high is not None and not (own.low < own.high or own.holds(own.high)):
                raise NotWritten("no pressure is left")
        elif name not in forces or own.open or own.open_high or (own.low is not None and own.high is not None and own.low >= own.high):
            raise NotWritten("a range is of no force, or lacks an end, or does not begin below its end")
    return tuple(found.items())


def inhabited(parameters: Mapping[str, Bounds], constraints: tuple[Term, ...], point: Mapping[str, Fraction]) -> bool:
    """Whether ``point`` satisfies the domain and every constraint, worked out exactly, so that a claim over the domain is not empty."""
    here = {Term("name", name=n): number(x) for n, x in point.items()}
    inside = set(point) == set(parameters) and all(parameters[n].holds(x) for n, x in point.items())
    try:
        return inside and all(holds(c.put(here)) for c in constraints)
    except NotWritten:  # something in a constraint has no value there, or is no fraction
        return False
