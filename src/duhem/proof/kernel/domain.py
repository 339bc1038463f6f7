"""A law as its text says it, and the signs of its constants over the whole domain and every pressure sigma_n < 0.

The sign of a sum of products is shown by three sound rules: every term has it; so it is once each variable is measured
from an end of its range; so it is once a multiple of a constraint that has it is taken away.

Waves of an angle are read as algebra: cos(k atan2(q, p)) is Re (p + i q)^k / |(p, q)|^k for whole k, sin its Im (de Moivre 1722).
Both sides are undefined at p = q = 0, and there alone, so that the formula stays what it is.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import suppress
from fractions import Fraction
from itertools import islice, product
from math import comb, prod
from typing import Any, NamedTuple, TypeVar
from unicodedata import normalize

from duhem.proof.kernel.bounds import ANY, NEGATIVE, POSITIVE, ZERO, Bounds, Facts, Sign, exact, sharpened, signs_of_product
from duhem.proof.kernel.constant_value import holds
from duhem.proof.kernel.gradient import gradient
from duhem.proof.kernel.polynomial import (
    ONE,
    Monomial,
    Polynomial,
    divided,
    joined,
    number_in,
    replaced,
    root_of_square,
    shared,
    times,
    total,
    written,
)
from duhem.proof.kernel.spans import ordered, span
from duhem.proof.kernel.steps import pay
from duhem.proof.kernel.term import (
    COMPARISONS,
    WORDS,
    NotWritten,
    Term,
    bounded,
    definitions,
    factors,
    minus,
    number,
    parse,
    product_of,
    sum_of,
)

__all__ = [
    "ANY", "NEGATIVE", "POSITIVE", "ZERO", "Bounds", "Sign", "StatedDomain", "StatedFace", "StatedLaw", "as_list", "as_object",
    "declared", "exact", "gap", "inhabited", "without_angles", "without_more",
]  # fmt: skip

_MOST_POWER, _MOST_POWER_OF_ONE, _MOST_STEPS, _MOST_CHOICES = 12, 64, 400_000, 64  # of a sum; of a single term
_MOST_PAIRS = 40  # of a term of a formula and one of a constraint, for two constraints to be tried together
_FEW, _SHORT = 4, 12  # words that are no names, and terms, of which ends of spans are tried
_MOST_TURNS = 24  # of an angle
_HALF = number(Fraction(1, 2))
_AT_ZERO = dict.fromkeys(("exp", "cos", "cosh"), 1) | dict.fromkeys(("sin", "tan", "asin", "atan", "sinh", "tanh"), 0)


Answer = TypeVar("Answer")
_Gaps = Sequence[tuple[Polynomial, bool]]  # each is >= 0, or > 0
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


def declared(given: Mapping[str, Any], others: tuple[str, ...], formulas: Collection[str]) -> Declared:
    """Forces, parameters, constraints and what fixed parameters stand for; ``others`` are further names.  NotWritten where they clash.

    ``formulas`` are the words of a law of its kind.
    """
    without_more(given, _LAW | set(formulas))
    forces = tuple(as_list(given["forces"]))
    parameters = {name: Bounds.read(entry) for name, entry in given["parameters"].items()}
    names = [*forces, *others, *parameters]
    if not forces or any(not n.isidentifier() or n != normalize("NFKC", n) or n in (*WORDS, "pi") for n in names):
        raise NotWritten("a name is none")
    if len(set(names)) < len(names):
        raise NotWritten("a name is declared twice")
    constraints = tuple(parse(text) for text in as_list(given["constraints"]))
    if any(c.op not in COMPARISONS or not c.names() <= set(parameters) for c in constraints):
        raise NotWritten("a constraint does not compare parameters")
    fixed = {Term("name", name=n): number(x.low) for n, x in parameters.items() if x.low is not None and x.low == x.high}
    return forces, parameters, tuple(c.put(fixed) for c in constraints), fixed


def without_angles(term: Term) -> Term:
    """The formula with the waves of whole multiples of an angle as quotients; NotWritten where that is too large."""
    waves = [part for part in term.parts() if part.op in ("cos", "sin")]
    swap = dict[Term, Term]()
    for wave in waves:  # the inner ones first
        swap[wave] = _without_angle(wave._replace(args=tuple(a.put(swap) for a in wave.args)))
    return term.put(swap) if swap else term


def _without_angle(here: Term) -> Term:
    (angle,) = here.args
    turns = prod((x.value for x in factors(angle) if x.op == "number"), start=Fraction(1))
    moving = [x for x in factors(angle) if x.op != "number"]
    if [x.op for x in moving] != ["atan2"] or turns.denominator > 1 or not 0 < abs(turns) <= _MOST_TURNS:
        return here
    ((q, p),), k, odd = (x.args for x in moving), abs(int(turns)), here.op == "sin"
    sense = -1 if odd and turns < 0 else 1
    parts = (
        product_of(number(sense * (-1) ** (j // 2) * comb(k, j)), Term("**", (p, number(k - j))), Term("**", (q, number(j))))
        for j in range(odd, k + 1, 2)
    )
    return bounded(product_of(sum_of(*parts), Term("**", (Term("norm", (p, q)), number(-k)))))


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

    _found: dict[Any, Any]

    def once(self, question: Callable[[StatedLaw], Answer]) -> Answer:
        """The answer to a question about this law, found when it is first asked."""
        try:
            found = self._found
        except AttributeError:
            found = self._found = {}
        if question not in found:
            found[question] = question(self)
        answer: Answer = found[question]
        return answer

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
        beside = () if pressure is None else (pressure,)
        forces, parameters, constraints, fixed = declared(given, beside, {"domain", *bounds, *own})
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
            read = (parse(entry["g"], defined), *map(parse, texts))
            g, *flow = (without_angles(term).put(fixed) for term in read)
            if any(f.op in COMPARISONS or not f.names() <= names for f in (g, *flow)):
                raise NotWritten("a name is not declared")
            slips = gradient(flow[0], forces) if by_potential else tuple(flow)
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
    beside = () if pressure is None else (pressure,)
    forces, parameters, constraints, fixed = declared(given, beside, {"variables", "forces_of_rates"})
    variables = _state(given, forces, parameters, fixed)["variables"]
    driven = {own.force: f"{name}_rate" for name, own in variables if own.kind == "internal"}
    rates = tuple(driven[f] for f in forces if f in driven)
    if not len(rates) == len(functions) == len(forces) or {*functions} != {*forces}:
        raise NotWritten("a force is no function of the rate of a variable")
    if {*rates} & {*forces, *parameters, pressure} or len({*rates}) < len(rates):
        raise NotWritten("a name is declared twice")
    flow = tuple(without_angles(parse(functions[f])).put(fixed) for f in forces)
    if any(d.op in COMPARISONS or not d.names() <= {*rates, *beside, *parameters, "pi"} for d in flow):
        raise NotWritten("a name is not declared")
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
            rates[key, name] = rate = without_angles(parse(text)).put(fixed)
            if kinds.get(name) != "internal" or rate.op in COMPARISONS or not rate.names() <= known:
                raise NotWritten("a rate is of no internal variable, or of names that are not declared")
            if key == "unforced" and dict(variables)[name].force is not None:
                raise NotWritten("a variable with a force has its rate in the flow")
    state: dict[str, Any] = {"variables": variables, "rates": tuple((name, rate) for (key, name), rate in rates.items() if key == "rates")}
    state["heat"] = _heat(given, parameters, fixed, kinds)
    if "energy" not in given:
        return state
    ours = {Term("name", name=name) for name, _ in variables}  # a fixed variable stays one: forces are derivatives by it
    energy = without_angles(parse(given["energy"])).put({x: value for x, value in fixed.items() if x not in ours})
    without_force = {name for name, own in variables if own.kind == "internal" and own.force is None}
    if energy.op in COMPARISONS or not energy.names() <= {*parameters, "pi"} - without_force:
        raise NotWritten("the energy is of other names than parameters and variables with a force")
    return state | {"energy": energy}


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
    found = tuple((name, without_angles(parse(text)).put(fixed)) for name, text in bodies.items())
    if any(h.op in COMPARISONS or not h.names() <= {*parameters, given["pressure"], "pi"} for _, h in found):
        raise NotWritten("a conductance is of names that are not declared")
    return found


def _variable(entry: Any) -> StatedVariable:
    given = without_more(as_object(entry), {"observable", "temperature", "force"})
    kinds = [kind for kind in ("observable", "temperature") if kind in given]
    force = given.get("force")
    if len(kinds) > 1 or any(given[kind] is not True for kind in kinds) or not isinstance(force, str | None):
        raise NotWritten("a variable is none")
    if (force is None and "observable" in kinds) or (force is not None and "temperature" in kinds):
        raise NotWritten("a variable is none")
    return StatedVariable(kinds[0] if kinds else "internal", force)


def _ranges(given: Mapping[str, Any], forces: Sequence[str], pressure: str | None) -> tuple[tuple[str, Bounds], ...]:
    """Where the pressure and forces lie; NotWritten where that leaves no pressure < 0, or a force no 0."""
    found = {name: Bounds.read(entry) for name, entry in given.items()}
    for name, own in found.items():
        if name == pressure:
            found[name] = own = own.below(Fraction(0), True)
            if own.low is not None and own.high is not None and not (own.low < own.high or own.holds(own.high)):
                raise NotWritten("no pressure is left")
        elif name not in forces or not own.holds(Fraction(0)):
            raise NotWritten("a range is of no force, or without 0")
    return tuple(found.items())


class StatedDomain:
    """Signs over a law's domain.  What it says holds wherever the term is defined; what it does not say is not known.

    A range of the pressure bounds it; forces are any numbers, for what holds of all holds within a range too.
    """

    def __init__(self, law: StatedLaw, rules: Callable[[Term, StatedDomain], Facts]) -> None:
        """``rules`` say what is shown of a term over a domain."""
        self.law, self._rules, self._steps = law, rules, 0
        self._named: dict[Term, str] = {}
        self.known: dict[Term, Facts] = {}  # what was shown of terms
        self._polynomials: dict[Term, Polynomial] = {}  # as they were multiplied out once; nobody changes one
        self.kept: dict[str, Any] = {}  # what a rule looks up once a law
        self.sides: dict[Term, bool] = {}  # loads that are >= 0 where it is asked, or > 0
        self.bounds = {**law.parameters, **{name: own for name, own in law.ranges if name == law.pressure}}
        self._gaps, self._tied = list[tuple[Polynomial, bool]](), frozenset[Term]()
        self._gaps = [(self.polynomial(gap(c)), len(c.op) == 1) for c in law.constraints]  # each >= 0, or > 0
        self._tied = frozenset(x for known, _ in self._gaps for m in known for x, _ in m)
        self._compared: dict[Term, Sign] = {}
        self.bounds = sharpened(self.bounds, self._gaps)
        self.known.clear()
        self.kept.clear()
        self._polynomials.clear()

    def over(self, law: StatedLaw) -> StatedDomain:
        """The domain of another law, by the same rules."""
        return StatedDomain(law, self._rules)

    def where(self, sides: Mapping[Term, bool]) -> StatedDomain:
        """The domain of this law where these loads too are >= 0, or > 0."""
        inside = self.over(self.law)
        inside.sides = self.sides | dict(sides)
        return inside

    def facts(self, term: Term) -> Facts:
        """What is shown of a term, once."""
        if term not in self.known:
            self.known[term] = self._rules(term, self)
        return self.known[term]

    def sign(self, term: Term) -> Sign:
        """The signs that a term may have, where it has a value: those of its facts, where a kind of domain knows no more."""
        return self.facts(term).sign

    def constant(self, term: Term) -> bool:
        """Whether no force enters."""
        return not term.names() & set(self.law.forces)

    def of(self, atom: Term) -> Sign:
        """The sign of what polynomials are written in."""
        if atom.op != "name":
            return self._of_compared(atom) if atom in self._tied else self.sign(atom)
        if atom.name in ("pi", self.law.pressure):
            return POSITIVE if atom.name == "pi" else NEGATIVE
        return ANY if atom.name in self.law.forces else self.bounds[atom.name].sign()

    def _of_compared(self, atom: Term) -> Sign:
        """The sign of what constraints are written in, as the other constraints show it: else each would be asked before itself."""
        if atom not in self._compared:
            others = (
                c for c, (known, _) in zip(self.law.constraints, self._gaps, strict=True) if all(x != atom for m in known for x, _ in m)
            )
            self._compared[atom] = self.over(self.law._replace(constraints=tuple(others))).sign(atom)
        return self._compared[atom]

    def never_negative(self, term: Term) -> bool:
        """Whether a term is >= 0: by the ranges and constraints of what stands in it, or by what it is put together from."""
        return self.nonnegative(term) or self.facts(term).nonnegative

    def nonnegative(self, term: Term, strict: bool = False) -> bool:
        """Whether a constant is >= 0, or > 0, over the domain."""
        poly = self.polynomial(term)
        words = frozenset(x for m in poly for x, _ in m if x.op not in ("name", "abs", "norm") and self.constant(x))
        gaps = [*self._gaps, *(ordered(words, self.sign) if len(words) > 1 else ())]
        most = 2 if len(poly) * sum(len(known) for known, _ in gaps) <= _MOST_PAIRS else 1
        forms = enumerate(self._in_ranges(poly, words, gaps))
        return any(self._nonnegative(form, strict, 1 if i else most, known) for i, (form, known) in forms)

    def _in_ranges(self, poly: Polynomial, words: frozenset[Term], gaps: _Gaps) -> Iterator[tuple[Polynomial, _Gaps]]:
        """The polynomial, and what is >= 0, with names for exponentials; then for all words of which more is known than a sign."""
        exponentials = frozenset(x for x in words if x.op == "exp")
        yield self._with_names(poly, gaps, exponentials)
        few = len(poly) <= _SHORT and len(words) <= _FEW
        told = frozenset(x for x in words if few and not _is_root(x) and {*self.span(x)[:2]} - {None, Fraction(0)})
        if told - exponentials:
            yield self._with_names(poly, gaps, told)

    def _with_names(self, poly: Polynomial, gaps: _Gaps, words: Collection[Term]) -> tuple[Polynomial, _Gaps]:
        swap = {x: Term("name", name=self._named.setdefault(x, f"constant {len(self._named)}")) for x in sorted(words)}  # no name of a law
        self.bounds |= {swap[x].name: self.span(x) for x in words}

        def put(form: Polynomial) -> Polynomial:
            return {tuple(sorted((swap.get(x, x), n) for x, n in m)): c for m, c in form.items()} if swap else form

        return put(poly), [(put(known), sharp) for known, sharp in gaps] if swap else gaps

    def span(self, constant: Term) -> Bounds:
        """Where a constant lies."""
        if constant.op == "name" and constant.name in self.bounds:
            return self.bounds[constant.name]
        kept: dict[Term, Bounds] = self.kept.setdefault("spans", {})
        if constant not in kept:
            kept[constant] = span(constant, self.of, self.bounds)
        return kept[constant]

    def _nonnegative(self, poly: Polynomial, strict: bool, constraints: int, gaps: _Gaps) -> bool:
        if any(self._by_terms(moved, strict) for moved in self._measured(poly)):
            return True
        for m, c in poly.items() if constraints else ():
            for known, sharp in gaps:
                for n, d in known.items():
                    share = joined(m, tuple((x, -k) for x, k in n))
                    if (sign := self._of_term(share, c / d)) & NEGATIVE or not sign:
                        continue
                    rest = total(poly, times({share: -c / d}, known))
                    if self._nonnegative(rest, strict and not (sharp and sign == POSITIVE), constraints - 1, gaps):
                        return True
        return False

    def _by_terms(self, poly: Polynomial, strict: bool) -> bool:
        pay(20 * len(poly))
        signs = {m: self._of_term(m, c) for m, c in poly.items()}
        above = {m: c for m, c in poly.items() if not signs[m] & NEGATIVE}
        others = {m: c for m, c in poly.items() if m not in above}
        if 2 * len(others) > len(above) or not all(_outweighed(m, c, above) for m, c in others.items()):
            return False
        return not strict or any(signs[m] == POSITIVE for m in above)

    def _of_term(self, monomial: Monomial, factor: Fraction) -> Sign:
        sign = POSITIVE if factor > 0 else NEGATIVE
        for x, n in monomial:
            own = self.of(x)
            if n < 0 and own & ZERO:
                return ANY
            sign = signs_of_product(sign, own if n % 2 else signs_of_product(own, own) if own != ANY else ZERO | POSITIVE)
        return sign

    def _measured(self, poly: Polynomial) -> Iterator[Polynomial]:
        """The polynomial, and with its variables measured from ends of their ranges, by distances that are >= 0."""
        powers = {(x, n > 0) for m in poly for x, n in m}
        turned = sorted(x for x, above in powers if above and x.name in self.bounds and (x, False) not in powers)
        if turned:
            yield poly
        for choice in islice(product(*(self._ends(x) for x in turned)), _MOST_CHOICES):
            moved = poly
            for x, (end, i) in zip(turned, choice, strict=True):
                if end != 0 or i:
                    step = Term("name", name=f"{x.name} from end {i}")  # no name of a law has blanks
                    self.bounds[step.name] = Bounds(Fraction(0), None, (self.bounds[x.name].open, self.bounds[x.name].open_high)[i])
                    moved = replaced(moved, x, total({(): end}, {((step, 1),): Fraction(1 - 2 * i)}))
            yield moved

    def _ends(self, x: Term) -> list[tuple[Fraction, int]]:
        """The ends of a variable's range, 0 for lower and 1 for upper; measuring from a lower end 0 changes nothing."""
        return [(end, i) for i, end in enumerate(self.bounds[x.name][:2]) if end is not None] or [(Fraction(0), 0)]

    def decided(self, comparison: Term) -> bool | None:
        """Whether a comparison of constants holds, where their signs tell."""
        if not self.constant(comparison):
            return None
        sign, holds = self.sign(gap(comparison)), POSITIVE | (ZERO if len(comparison.op) == 2 else 0)
        return True if not sign & ~holds else False if not sign & holds else None

    def polynomial(self, term: Term) -> Polynomial:
        """Sums, products and whole powers multiplied out, sizes of known sign undone; anything else is a variable of its own."""
        if not term.args:
            return self._multiplied_out(term)
        if term not in self._polynomials:
            self._polynomials[term] = self._multiplied_out(term)
        return self._polynomials[term]

    def _multiplied_out(self, term: Term) -> Polynomial:
        term = self.plain(term)
        if term.op == "number":
            return {(): term.value} if term.value else {}
        if term.op == "+":
            return total(*(self.polynomial(a) for a in term.args))
        if term.op == "*":
            found = ONE
            for a in term.args:
                found = self._times(found, self.polynomial(a))
            return found
        if term.op == "**" and term.args[1].op == "number" and term.args[1].value.denominator == 1:
            n, inner = int(term.args[1].value), term.args[0]
            if n == 2 and inner.op in ("norm", "abs"):
                return self.polynomial(sum_of(*(product_of(a, a) for a in inner.args)))
            base = self.polynomial(inner)
            if len(base) == 1 and 0 < abs(n) <= _MOST_POWER_OF_ONE:
                ((monomial, c),) = base.items()
                return {tuple((x, k * n) for x, k in monomial): c**n}
            if 0 <= n <= _MOST_POWER:
                found = ONE
                for _ in range(n):
                    found = self._times(found, base)
                return found
            if base == ONE:
                return ONE
            if base and n < 0 and self.constant(term) and term.names() - {"pi"}:
                return _inverse(base, -n)
        if term.op == "**" and self.constant(term) and self.polynomial(term.args[0]) == ONE:
            return ONE  # whatever the power
        return {((self._in_order(term) if self.constant(term) else term, 1),): Fraction(1)}

    def _in_order(self, constant: Term) -> Term:
        """The same with its sums, products and numbers in one order, so that it is one variable however it is written."""
        kept: dict[Term, Term] = self.kept.setdefault("in order", {})
        if not constant.args or constant.large:
            return constant
        if constant not in kept:
            args = tuple(map(self._in_order, constant.args))
            if constant.op in ("+", "*"):
                args = tuple(sorted(b for a in args for b in (a.args if a.op == constant.op else (a,))))
            found = constant._replace(args=args)
            value = number_in(self.polynomial(found)) if not found.names() and found.op in ("+", "*") else None
            kept[constant] = found if value is None else number(value)
            if constant in self.known and self.known[constant].defined:  # else what is shown of it may be of nothing
                self.known.setdefault(kept[constant], self.known[constant])
        return kept[constant]

    def _root_of_square(self, base: Term, exponent: Term) -> Term | None:
        """The size of x, times the root of a number, where a constant is a number times x^2."""
        known = base.names() <= {*self.bounds, "pi", self.law.pressure}
        with suppress(NotWritten):
            if known and exponent == _HALF and (found := root_of_square(self.polynomial(base))) is not None and number_in(found[1]) is None:
                size = self.plain(Term("abs", (written(found[1]),)))
                return size if found[0] == 1 else product_of(Term("**", (number(found[0]), _HALF)), size)
        return None

    def _times(self, one: Polynomial, two: Polynomial) -> Polynomial:
        self.spend(len(one) * len(two))
        return times(one, two)

    def spend(self, steps: int) -> None:
        """Counts products of terms; NotWritten where all of them together have become too many to go on."""
        self._steps += steps
        if self._steps > _MOST_STEPS:
            raise NotWritten("there is too much to multiply out")

    def plain(self, term: Term) -> Term:
        """A ramp or size of a constant of known sign is it, its negative or 0; a norm of one that need not be 0, or the root of a square,
        is a size.

        A choice that is decided is what is chosen; what a word is at 0 is a number.
        """
        if term.op == "where" and (holds := self.decided(term.args[0])) is not None:
            return self.plain(term.args[1 if holds else 2])
        if term.op not in ("norm", "abs", "pos", "neg", "**", *_AT_ZERO) or not self.constant(term):
            return term
        if term.op == "**":
            return self._root_of_square(*term.args) or term
        if term.op in _AT_ZERO:
            return number(_AT_ZERO[term.op]) if self.sign(term.args[0]) == ZERO else term
        left = [a for a in term.args if self.sign(a) != ZERO] or [number(0)]
        if len(left) > 1:
            return term
        (x,), sign = left, self.sign(left[0])
        if not sign & NEGATIVE:
            return number(0) if term.op == "neg" else x
        if not sign & POSITIVE:
            return number(0) if term.op == "pos" else minus(x)
        return Term("abs", (x,)) if term.op == "norm" else term


def _inverse(poly: Polynomial, n: int) -> Polynomial:
    """1/P^n, factors of all terms of P and its first number on their own: P is not 0 where it has a value, and it has one spelling."""
    own, first = shared(poly), abs(poly[min(poly)])
    rest = Term("**", (written(divided(poly, own, first)), number(-1)))
    return divided({((rest, n),): Fraction(1)}, tuple((x, k * n) for x, k in own), first**n)


def _outweighed(m: Monomial, c: Fraction, above: Polynomial) -> bool:
    """Whether two terms that are >= 0 have a sum no less than |c m|, twice their geometric mean being so; they are used up."""
    for one, a in above.items():
        other = joined(joined(m, m), tuple((x, -n) for x, n in one))
        if other in above and other != one and c * c <= 4 * a * above[other]:
            del above[one], above[other]
            return True
    return False


def _is_root(term: Term) -> bool:
    """Whether it is a power with a number for exponent: what such ones say beside their sign, squares say (:mod:`signs`)."""
    return term.op == "**" and term.args[1].op == "number"


def inhabited(parameters: Mapping[str, Bounds], constraints: tuple[Term, ...], point: Mapping[str, Fraction]) -> bool:
    """Whether ``point`` satisfies the domain and every constraint, worked out exactly, so that a claim over the domain is not empty."""
    here = {Term("name", name=n): number(x) for n, x in point.items()}
    inside = set(point) == set(parameters) and all(parameters[n].holds(x) for n, x in point.items())
    try:
        return inside and all(holds(c.put(here)) for c in constraints)
    except NotWritten:  # something in a constraint has no value there, or is no fraction
        return False


def gap(comparison: Term) -> Term:
    """What a comparison says is >= 0."""
    left, right = comparison.args if comparison.op in (">", ">=") else comparison.args[::-1]
    return Term("+", (left, minus(right)))
