"""A criterion as a frozen value: names, one formula or several surfaces, parameter domains, and optionally a flow of its own.

Local names stand for formulas, each in terms of the ones above it.

Sign convention: the pressure name stands for the normal stress, sigma_n <= 0 in compression.  Forces and pressure
share one unit; what else carries a unit is the law's affair.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import repeat
from keyword import iskeyword
from typing import Any, ClassVar, Self, overload

import sympy as sp
from sympy.core.relational import Relational

from duhem.errors import InputError, faults_at
from duhem.expression import WORDS, symbol
from duhem.expression.abbreviations import NONE, Abbreviations, Stress
from duhem.expression.branches import gradient
from duhem.expression.build import greatest
from duhem.expression.fold import Graph, Shared, graph_of
from duhem.expression.number import inert_exponent
from duhem.expression.parse import check_formula, check_size, own_text, parse_expression, parse_graph, too_long, written_out
from duhem.expression.syntax import PlacedText, respelled, spelled
from duhem.expression.unevaluated import HASH, Verbatim
from duhem.law.domain import POSITIVE, Domain, Domains, by_name, range_fault
from duhem.law.frozen_mapping import FrozenMapping
from duhem.law.given import Known, Swap, argument_names, called, given_formula, listed, moved, moved_relations, relations, text_of
from duhem.law.registry import register
from duhem.law.shapes import Shape, converted
from duhem.law.state import NO_STATE, Variable, Variables, check_state, variables_of
from duhem.show.printing import Shown, latex

__all__ = [
    "FORCES", "PRESSURE", "Criterion", "DeclaredLaw", "Definitions", "YieldSurface", "as_expression", "criterion", "declared_symbols",
    "definitions", "name_fault", "swapped",
]  # fmt: skip


@dataclass(frozen=True)
class YieldSurface(Verbatim):
    """K lies in {g <= 0}; where g = 0 the slip is a non-negative multiple of ``flow``, one expression per force.

    ``potential`` is a formula whose gradient is the flow, instead of ``flow``; neither means associated: the slip is in the normal
    cone of {g <= 0}.  Text and SymPy expressions as for :class:`duhem.law.formula_law.Criterion`, which reads them; ``written``
    and ``written_flow`` are g and flow as they were given, where that was text.
    """

    g: sp.Expr
    flow: tuple[sp.Expr, ...] | None = None
    potential: str | None = None
    written: str = field(default="", repr=False, compare=False)
    written_flow: tuple[str, ...] = field(default=(), repr=False, compare=False)

    def read(
        self, known: Mapping[str, sp.Symbol], forces: Sequence[sp.Symbol], short: Abbreviations, owner: str, whole: bool = False
    ) -> YieldSurface:
        """The same with its texts read over the symbols ``known``; InputError names the ``owner`` of what cannot be.

        The g of a ``whole`` law is kept as a graph where it is too long to be written out.
        """
        where, g = f"g of {owner}", self.g
        if isinstance(g, str) and whole and too_long(g, short):
            g = parse_graph(g, known, short, where)
        elif not (g is sp.nan or isinstance(g, Shared)):
            g = as_expression(g, known, where, short)
        written = "" if isinstance(g, Shared) else text_of(self.g, g, self.written, known, short)
        flow, written_flow = self.flow, self.written_flow
        if flow is not None:
            given = listed(flow, "flow", owner)
            flow = tuple(as_expression(c, known, f"flow of {owner}", short) for c in given)
            texts = zip(given, flow, self.written_flow or repeat(""), strict=False)
            written_flow = tuple(text_of(c, component, text, known, short) for c, component, text in texts)
        if self.potential is None:
            return YieldSurface(g, flow, None, written, written_flow)
        if not isinstance(self.potential, str):
            raise InputError("the potential is no text", where=owner, remedy="write its formula as text")
        where = f"potential of {owner}"
        with faults_at(_name_at(self.potential, where), unless_placed=True):
            slip = gradient(parse_expression(self.potential, known, where=where, short=short), forces)
            if not any(slip):
                raise InputError("the potential does not depend on any force", remedy=f"use at least one of {', '.join(map(str, forces))}")
        if flow not in (None, slip):
            raise InputError("a flow and a potential are both given", where=owner, remedy="remove one of them")
        return YieldSurface(g, slip, written_out(self.potential, short), written, written_flow)

    def map(self, change: Callable[[sp.Expr], sp.Expr]) -> YieldSurface:
        """The same with every expression changed, and no longer the texts it came from."""
        return YieldSurface(change(self.g), None if self.flow is None else tuple(map(change, self.flow)))

    def moved(self, change: Callable[[sp.Expr, str], sp.Expr]) -> YieldSurface:
        """The same with every expression, and its text, in other symbols of the same names; a potential's flow is to be found again."""
        flow = None if self.flow is None or self.potential is not None else tuple(map(change, self.flow, self.written_flow or repeat("")))
        return replace(self, g=change(self.g, self.written), flow=flow)


def as_expression(given: Any, known: Mapping[str, sp.Symbol], where: str, short: Abbreviations) -> sp.Expr:
    """Text, read over the symbols ``known``, or what :func:`duhem.law.given.given_formula` makes of anything else."""
    if isinstance(given, str):
        return parse_expression(given, known, where=where, short=short)
    return given_formula(given, known.values(), where)


def swapped(old: Mapping[str, sp.Symbol], domains: Mapping[str, Domain]) -> tuple[Swap, Known]:
    """What takes the place of symbols over other domains of parameters, and every declared name with its symbol there."""
    swap = {old[name]: new for name, domain in domains.items() if (new := domain.symbol(name)) != old[name]}
    return swap, tuple((name, swap.get(x, x)) for name, x in old.items())


def _name_at(given: Any, otherwise: str) -> str:
    """Where the name of a text stands that knows it."""
    return given.name_at if isinstance(given, PlacedText) else otherwise


class Definitions(FrozenMapping[str, str]):
    """Name to formula as it was given, in order; ``short`` has them, and the invariants of the law's stress, written out."""

    __slots__ = ("short",)

    def __init__(self, content: Mapping[str, str] | None = None, short: Abbreviations = NONE) -> None:
        super().__init__(content)
        self.short = short

    def __reduce__(self) -> tuple[Any, ...]:
        return Definitions, (dict(self), self.short)

    @classmethod
    def of(cls, given: Mapping[str, str], known: Mapping[str, sp.Symbol], stress: Stress | None, law: str) -> Definitions:
        """Those that a program gives ``law``; InputError as :func:`definitions`."""
        for name, text in by_name(given, "a formula").items():
            if not isinstance(text, str):
                raise InputError(f"the definition of {name} is no text", where=law, remedy="write its formula as text")
        return definitions({name: PlacedText(text, f"{name} of {law}", name_at=law) for name, text in given.items()}, known, stress)


def definitions(given: Mapping[str, PlacedText], known: Mapping[str, sp.Symbol], stress: Stress | None) -> Definitions:
    """Those of a law over the symbols ``known``; InputError, with its place, for a name or a formula that cannot be one.

    A definition is replaced by its formula, in brackets, wherever its name stands: the law is what it is with all written out.  One that
    is too long for that may stand in g alone, which is kept as a graph then.
    """
    formulas: dict[str, str] = {}
    own: dict[str, str] = {}
    left = [spelled(name) for name in given]
    taken = [*map(spelled, known), *left]
    for name, formula in given.items():
        if fault := name_fault(name, taken, "force, parameter and definition", Abbreviations(stress=stress).words()):
            raise InputError(fault[0], where=formula.name_at, remedy=fault[1])
    for formula in given.values():
        short = Abbreviations(formulas, stress, frozenset(left), own, frozenset(known))
        long = too_long(formula, short)
        if formula.alike:
            check_size(formula)
        elif long:
            check_formula(formula, [*known, *own], formula.where, short.alone())
        else:
            parse_expression(formula, known, short=short)
        text, name = own_text(formula, short), left.pop(0)
        formulas |= {} if long else {name: written_out(formula, short)}
        own[name] = text
    short = Abbreviations(formulas, stress, frozenset(), own, frozenset(known))
    return Definitions({spelled(name): str(formula) for name, formula in given.items()}, short)


def name_fault(name: Any, taken: Sequence[Any], whose: str, invariants: frozenset[str] = frozenset()) -> tuple[str, str] | None:
    """What is wrong with a name among those that are ``taken``, and the remedy, with ``whose`` the names are; None if nothing is."""
    if not isinstance(name, str) or not name.isidentifier():
        return f"{name!r} is not a name", "use letters, digits and underscores"
    if (name := spelled(name)) in WORDS or name in invariants or name == "pi" or iskeyword(name):
        return f"the name {name!r} already means something", "choose another"
    return (f"{name!r} is declared twice", f"give each {whose} a name of its own") if taken.count(name) > 1 else None


def declared_symbols(names: Iterable[str], pressure: str | None, parameters: Mapping[str, Domain]) -> dict[str, sp.Symbol]:
    """Every declared name with its symbol: the ``names`` of forces, of the ``pressure`` and of what is no parameter, and parameters."""
    table = {name: symbol(name, nonpositive=True) if name == pressure else symbol(name) for name in names}
    return table | {name: domain.symbol(name) for name, domain in parameters.items()}


_MOST = 4  # parameters in one line


class DeclaredLaw(Verbatim, Shown):
    """What a law declares, whether a formula or a curve bounds its K: names with their symbols, and the law it is a part of.

    ``law_sheet`` shows a law of either kind, and is imported when one is first shown.
    """

    printed_by: ClassVar[str] = "duhem.law.law_sheet"

    name: str
    forces: tuple[str, ...]
    pressure: str | None
    parameters: Mapping[str, Domain]
    whole: Any  # what this law is a part of

    def __repr__(self) -> str:
        said = [domain.stated(name) for name, domain in self.parameters.items()]
        more = [f"and {len(said) - _MOST} more"] if len(said) > _MOST else []
        return f"<{type(self).__name__} {self.name}: {', '.join(self.forces)}; {', '.join(said[:_MOST] + more) or 'no parameter'}>"

    def _repr_latex_(self) -> str:
        return rf"$\displaystyle {latex(self)}$"

    @property
    def coordinates(self) -> tuple[str, ...]:
        """The names of stress space: the forces, then the pressure where there is one."""
        return (*self.forces, *([self.pressure] if self.pressure else []))

    def force_symbols(self) -> tuple[sp.Symbol, ...]:
        """The symbols of the forces, in order."""
        return tuple(symbol(name) for name in self.forces)

    def free(self) -> dict[sp.Symbol, Domain]:
        """The free parameters, that is those without a value, in order, with their domains."""
        return {domain.symbol(name): domain for name, domain in self.parameters.items() if domain.value is None}

    def fixed_values(self) -> dict[sp.Symbol, sp.Rational]:
        """The fixed parameters, in order, with their values."""
        return {domain.symbol(name): domain.value for name, domain in self.parameters.items() if domain.value is not None}

    def _set(self, **values: Any) -> None:
        """Give fields of the frozen value what was made of what was given for them."""
        for name, value in values.items():
            object.__setattr__(self, name, value)

    def _with_part(self, part: Self) -> Self:
        """The ``part``, which knows what it is a part of."""
        whole, own = self.whole or self, part.parameters
        narrower = own != whole.parameters and all(domain.covers(own[name]) for name, domain in whole.parameters.items())
        part._set(whole=whole if narrower else None)
        return part


_NAMED = {"unforced": "rate of", "rates": "rate of", "heat": "conductance to", "forces_of_rates": "force"}  # formulas by name, in words
FORCES = ("sigma_a", "sigma_b")
PRESSURE = "sigma_n"


@dataclass(frozen=True, repr=False)
class Criterion(DeclaredLaw):
    """K(sigma_n) = {g <= 0} in the space of the forces, for every pressure and every parameter of the domain.

    ``g``, ``constraints`` and ``flow`` may be given as text in the vocabulary or as SymPy expressions over
    :meth:`symbols`; text is parsed safely, nothing in it is executed.  ``flow`` is the slip direction field, one
    expression per force; None means associated (normality rule, Antoni et al. 2007, Eq. 36); at an apex, where it may have no value, it is
    any mean of its limits (Koiter 1953).  ``closed_form`` states the shape of K where the slip increment onto it has one.  ``written``,
    ``written_flow`` and ``written_constraints`` are g, the flow and the constraints as they were given, where that was text: an expression
    is simplified as it is built, and who checks a proof wants what was stated.

    ``stress`` declares a stress instead of ``forces``: its components are the forces, and its invariants are words.  ``define``
    maps local names to formulas, each in terms of those above it, for everything that is given as text.  ``potential`` is a formula
    whose gradient by the forces is the flow, instead of ``flow``; at a kink of it the flow is any mean of the gradients that meet there.
    ``domain`` maps the pressure or forces to the ranges in which the claims are asked; where zero force is outside, nothing is claimed
    of it.  Increments and paths refuse a pressure outside, and say so of a stress.

    Instead of g and flow a law may have several ``surfaces``: K is where all of them are <= 0, g the greatest of them.  At a
    boundary point the slip is a non-negative combination of the flows of the surfaces that are 0 there (Koiter 1953).

    ``variables`` declares a state, by name: observables, internal variables and a temperature, each with its force; their domains are
    the admissible states.  ``energy`` is psi in variables and parameters; without it psi is quadratic in u - u_in, which nobody declares.
    Everything else may name variables, as parameters that the normality rule does not act on.  ``unforced`` has the rates, for a unit
    of the multiplier, of internal variables without a force, which normality says nothing of.  ``rates`` has those of internal
    variables without a multiplier, such as a static recovery, which act beside the flow.

    ``heat`` maps the temperature T_k > 0 of each body, which is declared by that, to the conductance h_k: q_k . n_k = h_k (T_k - T) flows
    from it into the interface, whose temperature T is > 0 there.

    With ``viscous`` g is no criterion but a potential Phi* of rates: the rate of each variable is d Phi*/d Y by its force (Antoni et al.
    2007, Eqs. 27, 28), as of Norton, Perzyna and Bingham.  The claims then speak of Phi*, which is to be convex, and least and 0 at 0.

    ``forces_of_rates`` has each force as a function of the rates, instead of g, as Stribeck's friction has: the rate of the variable u_in
    is u_in_rate there, and g is made the sum of force . rate.  Such a law has no K; normality says that these forces are the gradient of
    a convex potential of the rates.

    ``expect`` maps claims to the verdicts that the author knows of, such as ``{"smoothness": "refuted"}`` of a law with corners: the
    exit code of ``duhem verify`` counts them as no failure, and any other verdict on these claims as one.

    ``whole`` is the law of which this one is a part over narrower domains: what holds of it holds here; None where it is none.
    """

    name: str
    g: sp.Expr = sp.nan
    parameters: Mapping[str, Domain] = Domains()
    forces: tuple[str, ...] = FORCES
    pressure: str | None = PRESSURE
    constraints: tuple[Relational, ...] = ()
    flow: tuple[sp.Expr, ...] | None = None
    summary: str = ""
    source: str = ""
    closed_form: Shape | None = None
    written: str = field(default="", repr=False, compare=False)
    written_flow: tuple[str, ...] = field(default=(), repr=False, compare=False)
    written_constraints: tuple[str, ...] = field(default=(), repr=False, compare=False)
    stress: Stress | None = None
    define: Mapping[str, str] = Definitions()
    potential: str | None = None
    domain: Mapping[str, Domain] = Domains()
    surfaces: tuple[YieldSurface, ...] = ()
    energy: sp.Expr | None = None
    variables: Mapping[str, Variable] = NO_STATE
    unforced: Mapping[str, sp.Expr] = FrozenMapping()
    rates: Mapping[str, sp.Expr] = FrozenMapping()
    heat: Mapping[str, sp.Expr] = FrozenMapping()
    viscous: bool = False
    forces_of_rates: Mapping[str, sp.Expr] = FrozenMapping()
    written_energy: str = field(default="", repr=False, compare=False)
    written_unforced: Mapping[str, str] = field(default=FrozenMapping(), repr=False, compare=False)
    written_rates: Mapping[str, str] = field(default=FrozenMapping(), repr=False, compare=False)
    written_heat: Mapping[str, str] = field(default=FrozenMapping(), repr=False, compare=False)
    written_forces_of_rates: Mapping[str, str] = field(default=FrozenMapping(), repr=False, compare=False)
    expect: Mapping[str, str] = field(default=FrozenMapping(), repr=False, compare=False)
    _symbols: Mapping[str, sp.Symbol] = field(init=False, repr=False, compare=False)
    whole: Criterion | None = field(init=False, default=None, repr=False, compare=False)

    def __post_init__(self) -> None:
        self._set(stress=_stress(self.stress, self.name))
        forces = listed(self.forces, "forces", self.name) if self.stress is None else self._components(self.stress)
        variables = Variables(respelled(self.variables, f"variables of {self.name}"))
        more = {n: v.domain for n, v in variables.items()} | dict.fromkeys(self.heat, POSITIVE)
        self._set(forces=tuple(map(spelled, forces)), pressure=spelled(self.pressure), variables=variables)
        self._set(parameters=Domains(more | Domains(self.parameters)), expect=FrozenMapping(self.expect))
        self._check_names()
        self._set(_symbols=declared_symbols((*self.coordinates, *self.velocities.values()), self.pressure, self.parameters))
        known = self.symbols()
        define = self.define
        if not isinstance(define, Definitions) or (define.short.stress, define.short.known) != (self.stress, frozenset(known)):
            define = Definitions.of(define, known, self.stress, self.name)
        self._set(define=define)
        short = define.short
        self._read_bounds(known, short)
        if self.energy is not None:
            energy = as_expression(self.energy, known, f"energy of {self.name}", short)
            self._set(written_energy=text_of(self.energy, energy, self.written_energy, known, short), energy=energy)
        for key, what in _NAMED.items():
            given, texts = getattr(self, key), getattr(self, f"written_{key}")
            found = {name: as_expression(rate, known, f"{what} {name} of {self.name}", short) for name, rate in given.items()}
            written = {name: text_of(given[name], rate, texts.get(name, ""), known, short) for name, rate in found.items()}
            self._set(**{key: FrozenMapping(found), f"written_{key}": FrozenMapping(written)})
        if self.forces_of_rates:
            power = sp.Add(*(known[rate] * self.forces_of_rates.get(force, 0) for force, rate in self.velocities.items()))
            if self.g not in (sp.nan, power):
                raise InputError("a law with forces of rates has no g", where=self.name, remedy="remove one of them")
            self._set(g=power)
        constraints, texts = relations(self.constraints, self.written_constraints, known, self.name, short)
        self._set(constraints=constraints, written_constraints=texts, domain=Domains(self.domain))
        for name, own in self.domain.items():
            if fault := range_fault(name, own, self.forces, self.pressure):
                raise InputError(fault[0], where=f"domain of {self.name}", remedy=fault[1])
        if self.closed_form is not None:
            if not isinstance(self.closed_form, Shape):
                what = f"the closed form {self.closed_form!r} is no shape"
                raise InputError(what, where=self.name, remedy="write Interval(...), Disk(...) or Quadrants(...)")
            self._set(closed_form=converted(self.closed_form, lambda x: as_expression(x, known, f"closed form of {self.name}", short)))
        self._check_content()
        check_state(self)
        if self.viscous and (self.surfaces or self.flow is not None):
            what = "a law whose rates are the gradient of a potential has no flow and no surfaces"
            raise InputError(what, where=self.name, remedy="remove them, or viscous")

    def __hash__(self) -> int:
        """Found once: what is kept by law is looked up some times in each increment."""
        if (known := vars(self).get(HASH)) is None:
            known = hash((self.name, self.g, self.forces, self.pressure, self.parameters, self.constraints, self.flow, self.surfaces))
            self._set(**{HASH: known})
        return int(known)

    def _read_bounds(self, known: Mapping[str, sp.Symbol], short: Abbreviations) -> None:
        """g and what else is said of K's boundary; from the surfaces, where there are several."""
        surfaces = []
        for i, given in enumerate(self.surfaces, 1):
            owner = f"surface {i} of {self.name}"
            if not isinstance(given, YieldSurface):
                raise InputError(f"{given!r} is no surface", where=owner, remedy="write YieldSurface(g=..., flow=...)")
            if given.g is sp.nan:
                raise InputError("there is no g", where=owner, remedy="give the surface a formula g")
            surfaces.append(given.read(known, self.force_symbols(), short, owner))
            self._check_load(given.g, surfaces[-1].g)
        whole = YieldSurface(self.g, self.flow, self.potential, self.written, self.written_flow)
        whole = whole.read(known, self.force_symbols(), short, self.name, not (surfaces or self.viscous or self.variables))
        if surfaces:
            most, texts = greatest(*(s.g for s in surfaces)), [s.written for s in surfaces]
            if whole.g not in (sp.nan, most) or whole.flow is not None:
                what = "a law with several surfaces takes g and flow from its surfaces"
                raise InputError(what, where=self.name, remedy="remove g, flow and potential")
            whole = YieldSurface(most, written=f"max({', '.join(texts)})" if all(texts) else "")
        elif not (whole.g is sp.nan or self.forces_of_rates):
            self._check_load(self.g, whole.g)
        self._set(surfaces=tuple(surfaces), **vars(whole))

    def _check_load(self, given: Any, g: sp.Expr) -> None:
        """InputError where g, which was ``given``, depends on no force."""
        if not g.free_symbols & set(self.force_symbols()):
            what = "the potential" if self.viscous and isinstance(given, PlacedText) else "g"
            remedy = f"use at least one of {', '.join(self.forces)}"
            raise InputError(f"{what} does not depend on any force", where=_name_at(given, self.name), remedy=remedy)

    @property
    def graph(self) -> Graph | None:
        """What g is kept as where it is too large to be written out."""
        return graph_of(self.g)

    @property
    def temperature(self) -> str | None:
        """The name of the temperature among the variables, if there is one."""
        return variables_of(self).temperature()

    @property
    def velocities(self) -> dict[str, str]:
        """Each force with the name of its rate, where the forces are functions of the rates."""
        return variables_of(self).rates(self.forces) if self.forces_of_rates else {}

    @property
    def associated(self) -> bool:
        """Whether the slip is normal to the boundary by definition: neither the law nor a surface states a flow."""
        return self.flow is None and not self.forces_of_rates and all(s.flow is None for s in self.surfaces)

    def _components(self, stress: Stress) -> tuple[str, ...]:
        if tuple(self.forces) not in (FORCES, stress.components):
            what = f"forces and a stress {stress.name!r} are both declared"
            raise InputError(what, where=self.name, remedy="remove them: they are its components")
        return stress.components

    def _check_names(self) -> None:
        if not self.forces:
            raise InputError(f"{self.name} declares no force", remedy="name at least one in forces")
        names = [*self.coordinates, *self.parameters, *self.velocities.values()]
        for name in names:
            if fault := name_fault(name, names, "force and parameter"):
                raise InputError(fault[0], where=self.name, remedy=fault[1])

    def _check_content(self) -> None:
        if self.g is sp.nan:
            raise InputError("there is no g", where=self.name, remedy="give g, or surfaces")
        for flow in (self.flow, *(s.flow for s in self.surfaces)):
            if flow is not None and len(flow) != len(self.forces):
                what = f"the flow has {len(flow)} components for {len(self.forces)} forces"
                raise InputError(what, where=self.name, remedy="give one expression per force")
        allowed = {self.symbols()[p] for p in self.parameters}
        for relation in self.constraints:
            if stray := relation.free_symbols - allowed:
                what = f"the constraint {relation} uses {sorted(map(str, stray))}"
                raise InputError(what, where=self.name, remedy="constraints relate parameters only")

    @property
    def around_zero(self) -> bool:
        """Whether zero force lies in the ranges of the forces."""
        return all(0 in own for name, own in self.domain.items() if name != self.pressure)

    def symbols(self) -> dict[str, sp.Symbol]:
        """Every declared name with its symbol: forces, pressure, parameters, in this order."""
        return dict(self._symbols)

    def defined(self) -> dict[str, sp.Expr]:
        """What each definition stands for, over :meth:`symbols`."""
        assert isinstance(self.define, Definitions)  # since __post_init__
        return {name: parse_expression(name, self.symbols(), short=self.define.short) for name in self.define}

    def settled(self) -> dict[sp.Symbol, sp.Expr]:
        """The fixed parameters with the numbers to put in their places; exponents as numbers that SymPy leaves alone."""
        exponents = {x for power in self.g.atoms(sp.Pow) for x in power.exp.free_symbols}
        return {x: inert_exponent(value) if x in exponents else value for x, value in self.fixed_values().items()}

    def fix(self, values: Mapping[str, Any] | None) -> Criterion:
        """The same law with some parameters fixed; a value outside its domain is an error."""
        return self._with_part(_over(self, Domains(self.parameters).fixed(values, self.name)))

    def within(self, ranges: Mapping[str, Domain]) -> Criterion:
        """The same law over other domains of some of its parameters."""
        return self._with_part(_over(self, Domains({**self.parameters, **ranges})))


def _over(law: Criterion, domains: Mapping[str, Domain]) -> Criterion:
    """The law over other domains, its expressions rewritten in the symbols that know the new signs."""
    swap, known = swapped(law.symbols(), domains)

    def here(expr: sp.Basic, text: str = "") -> sp.Basic:
        return moved(expr, text, swap, known)

    found: dict[str, Any] = {
        key: {name: here(x, getattr(law, f"written_{key}")[name]) for name, x in getattr(law, key).items()} for key in _NAMED
    }
    if law.energy is not None:
        found["energy"] = here(law.energy, law.written_energy)
    if law.closed_form is not None:
        found["closed_form"] = converted(law.closed_form, here)
    found["constraints"], found["written_constraints"] = moved_relations(law.constraints, law.written_constraints, swap, known)
    if law.surfaces or law.forces_of_rates:
        found |= {"g": sp.nan, "surfaces": tuple(s.moved(here) for s in law.surfaces)}
    else:
        whole = YieldSurface(law.g, law.flow, law.potential, law.written, law.written_flow).moved(here)
        found |= {"g": whole.g, "flow": whole.flow}
    return replace(law, parameters=domains, **found)


def _stress(given: Any, law: str) -> Stress | None:
    """A declared stress; a table of its name and kind will do."""
    if given is None or isinstance(given, Stress):
        return given
    try:
        return Stress(**given)
    except TypeError:
        raise InputError(f"{given!r} declares no stress", where=law, remedy='write {"name": "sigma", "kind": "3d"}') from None


@overload
def criterion(function: Callable[..., Any]) -> Criterion: ...


@overload
def criterion(
    *,
    name: str | None = None,
    parameters: Mapping[str, Domain] | None = None,
    forces: Sequence[str] = FORCES,
    pressure: str | None = PRESSURE,
    constraints: Sequence[str] = (),
    flow: Sequence[Any] | None = None,
    source: str = "",
    closed_form: Shape | None = None,
    stress: Stress | Mapping[str, str] | None = None,
    define: Mapping[str, str] | None = None,
    potential: str | None = None,
    domain: Mapping[str, Domain] | None = None,
) -> Callable[[Callable[..., Any]], Criterion]: ...


def criterion(
    function: Callable[..., Any] | None = None,
    *,
    name: str | None = None,
    parameters: Mapping[str, Domain] | None = None,
    forces: Sequence[str] = FORCES,
    pressure: str | None = PRESSURE,
    constraints: Sequence[str] = (),
    flow: Sequence[Any] | None = None,
    source: str = "",
    closed_form: Shape | None = None,
    stress: Stress | Mapping[str, str] | None = None,
    define: Mapping[str, str] | None = None,
    potential: str | None = None,
    domain: Mapping[str, Domain] | None = None,
) -> Criterion | Callable[[Callable[..., Any]], Criterion]:
    """Turn a function of the declared names into a registered :class:`Criterion`.

    The function receives SymPy symbols by the names of its arguments and returns g, or a :class:`YieldSurface` or several of
    them, whose flows may use the arguments too; its docstring's first line becomes the summary.  The law's name is the
    function's, underscores as hyphens, unless given.  Parameters that are arguments but not declared are positive.  An argument
    that names a definition receives what it stands for.
    """

    def build(f: Callable[..., Any]) -> Criterion:
        arguments, named = argument_names(f), name or f.__name__.replace("_", "-")
        of = _stress(stress, named)
        axes = tuple(spelled(axis) for axis in listed(forces, "forces", named)) if of is None else of.components
        load = spelled(pressure)
        fixed_names = (*axes, load, *map(spelled, define or ()))
        declared = Domains(parameters)
        domains = {a: declared.get(a, POSITIVE) for a in arguments if a not in fixed_names}
        domains |= {n: d for n, d in declared.items() if define and n not in domains}  # for what is defined
        any_g = symbol(f"{axes[0]}") if axes else sp.nan  # what is no name is refused below
        shell = Criterion(named, any_g, domains, axes, load, stress=of, define=define or {})  # which knows what all names stand for
        made = called(f, shell.symbols() | shell.defined())
        parts = tuple(made) if isinstance(made, list | tuple) else (made,)
        surfaces = parts if any(isinstance(part, YieldSurface) for part in parts) else ()
        said: dict[str, Any] = {"summary": (inspect.getdoc(f) or "").split("\n", 1)[0], "source": source, "closed_form": closed_form}
        said |= {"constraints": constraints, "flow": flow, "potential": potential, "domain": Domains(domain)}
        law = replace(shell, g=sp.nan if surfaces else made, surfaces=surfaces, **said)
        register(law.name, law)
        return law

    return build if function is None else build(function)
