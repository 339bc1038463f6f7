"""A criterion as a frozen value: names, one formula, parameter domains, and optionally a flow of its own.

Sign convention: the pressure name stands for the normal stress, sigma_n <= 0 in compression.  Forces and pressure
share one unit; what else carries a unit is the law's affair.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import repeat
from keyword import iskeyword
from typing import Any, overload

import sympy as sp
from sympy.core.relational import Relational

from duhem.errors import InputError
from duhem.expression import WORDS, symbol
from duhem.expression.abbreviations import Abbreviations
from duhem.expression.extremes import greatest
from duhem.expression.inert_number import inert_exponent
from duhem.expression.invariants import Stress
from duhem.expression.parse import parse_expression
from duhem.expression.spelling import spelled
from duhem.expression.verbatim import HASH, Verbatim
from duhem.law.definitions import Definitions
from duhem.law.domain import POSITIVE, Domain, Domains, cover, range_fault
from duhem.law.frozen_mapping import FrozenMapping
from duhem.law.given_text import moved, moved_relations, relations
from duhem.law.registry import register
from duhem.law.shapes import Shape, check_shape, converted
from duhem.law.shown_law import ShownLaw
from duhem.law.signature import argument_names, called, listed
from duhem.law.yield_surface import YieldSurface, as_expression

__all__ = ["FORCES", "PRESSURE", "Criterion", "criterion"]

FORCES = ("sigma_a", "sigma_b")
PRESSURE = "sigma_n"


@dataclass(frozen=True, repr=False)
class Criterion(Verbatim, ShownLaw):
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
    ``domain`` maps the pressure or forces to the ranges in which the claims are asked; zero force is in them.  Increments and
    paths refuse a pressure outside, and say so of a stress.

    Instead of g and flow a law may have several ``surfaces``: K is where all of them are <= 0, g the greatest of them.  At a
    boundary point the slip is a non-negative combination of the flows of the surfaces that are 0 there (Koiter 1953).

    ``expect`` maps claims to the verdicts that the author knows of, such as ``{"smoothness": "refuted"}`` of a law with corners: the
    exit code of ``duhem verify`` counts them as no failure, and any other verdict on these claims as one.
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
    expect: Mapping[str, str] = field(default=FrozenMapping(), repr=False, compare=False)
    _symbols: Mapping[str, sp.Symbol] = field(init=False, repr=False, compare=False)
    _whole: Criterion | None = field(init=False, default=None, repr=False, compare=False)

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "stress", _stress(self.stress, self.name))
        put(self, "forces", self._named_forces() if self.stress is None else self._components(self.stress))
        put(self, "pressure", spelled(self.pressure))
        put(self, "parameters", Domains(self.parameters))
        put(self, "expect", FrozenMapping(self.expect))
        self._check_names()
        put(self, "_symbols", self._declared())
        known = self.symbols()
        define = self.define
        if not isinstance(define, Definitions) or define.short.stress != self.stress:
            define = Definitions.of(define, known, self.stress, self.name)
        put(self, "define", define)
        short = define.short
        self._read_bounds(known, short)
        constraints, texts = relations(self.constraints, self.written_constraints, known, self.name, short)
        put(self, "constraints", constraints)
        put(self, "written_constraints", texts)
        put(self, "domain", Domains(self.domain))
        for name, own in self.domain.items():
            if fault := range_fault(name, own, self.forces, self.pressure):
                raise InputError(fault[0], where=f"domain of {self.name}", remedy=fault[1])
        if self.closed_form is not None:
            check_shape(self.closed_form, self.name)
            put(self, "closed_form", converted(self.closed_form, lambda x: as_expression(x, known, f"closed form of {self.name}", short)))
        self._check_content()

    def __hash__(self) -> int:
        """Found once: what is kept by law is looked up some times in each increment."""
        if (known := vars(self).get(HASH)) is None:
            known = hash((self.name, self.g, self.forces, self.pressure, self.parameters, self.constraints, self.flow, self.surfaces))
            object.__setattr__(self, HASH, known)
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
        whole = YieldSurface(self.g, self.flow, self.potential, self.written, self.written_flow)
        whole = whole.read(known, self.force_symbols(), short, self.name)
        if surfaces:
            most, texts = greatest(*(s.g for s in surfaces)), [s.written for s in surfaces]
            if whole.g not in (sp.nan, most) or whole.flow is not None:
                what = "a law of several surfaces has its g and its flow from them"
                raise InputError(what, where=self.name, remedy="leave g, flow and potential out")
            whole = YieldSurface(most, written=f"max({', '.join(texts)})" if all(texts) else "")
        put = object.__setattr__
        put(self, "surfaces", tuple(surfaces))
        for name in ("g", "flow", "potential", "written", "written_flow"):
            put(self, name, getattr(whole, name))

    @property
    def associated(self) -> bool:
        """Whether the slip is normal to the boundary by definition: neither the law nor a surface states a flow."""
        return self.flow is None and all(s.flow is None for s in self.surfaces)

    def _named_forces(self) -> tuple[str, ...]:
        return tuple(spelled(name) for name in listed(self.forces, "forces", self.name))

    def _components(self, stress: Stress) -> tuple[str, ...]:
        if tuple(self.forces) not in (FORCES, stress.components):
            raise InputError(
                f"forces and a stress {stress.name!r} are both declared",
                where=self.name,
                remedy="leave them out: they are its components",
            )
        return stress.components

    def _check_names(self) -> None:
        names = [*self.forces, *([self.pressure] if self.pressure else []), *self.parameters]
        if not self.forces:
            raise InputError(f"{self.name} declares no force", remedy="name at least one in forces")
        _check_are_names(names, self.name)
        for name in names:
            if name in WORDS or name == "pi" or iskeyword(name):
                raise InputError(f"the name {name!r} already means something", where=self.name, remedy="choose another")
            if names.count(name) > 1:
                raise InputError(f"{name!r} is declared twice", where=self.name, remedy="give each force and parameter a name of its own")

    def _check_content(self) -> None:
        forces = {self.symbols()[f] for f in self.forces}
        flows = [flow for flow in (self.flow, *(s.flow for s in self.surfaces)) if flow is not None]
        if self.g is sp.nan:
            raise InputError("there is no g", where=self.name, remedy="give g, or surfaces")
        if not all(g.free_symbols & forces for g in (self.g, *(s.g for s in self.surfaces))):
            raise InputError("g does not depend on any force", where=self.name, remedy=f"use at least one of {', '.join(self.forces)}")
        for flow in flows:
            if len(flow) != len(self.forces):
                raise InputError(
                    f"the flow has {len(flow)} components for {len(self.forces)} forces",
                    where=self.name,
                    remedy="give one expression per force",
                )
        allowed = {self.symbols()[p] for p in self.parameters}
        for relation in self.constraints:
            if stray := relation.free_symbols - allowed:
                raise InputError(
                    f"the constraint {relation} uses {sorted(map(str, stray))}",
                    where=self.name,
                    remedy="constraints relate parameters only",
                )

    def symbols(self) -> dict[str, sp.Symbol]:
        """Every declared name with its symbol: forces, pressure, parameters, in this order."""
        return dict(self._symbols)

    def _declared(self) -> dict[str, sp.Symbol]:
        table = {name: symbol(name) for name in self.forces}
        if self.pressure is not None:
            table[self.pressure] = symbol(self.pressure, nonpositive=True)
        return table | {name: domain.symbol(name) for name, domain in self.parameters.items()}

    def force_symbols(self) -> tuple[sp.Symbol, ...]:
        """The symbols of the forces, in order."""
        return tuple(symbol(name) for name in self.forces)

    def defined(self) -> dict[str, sp.Expr]:
        """What each definition stands for, over :meth:`symbols`."""
        assert isinstance(self.define, Definitions)  # since __post_init__
        return {name: parse_expression(name, self.symbols(), short=self.define.short) for name in self.define}

    def settled(self) -> dict[sp.Symbol, sp.Expr]:
        """The fixed parameters with the numbers to put in their places; exponents as numbers that SymPy leaves alone."""
        exponents = {x for power in self.g.atoms(sp.Pow) for x in power.exp.free_symbols}
        fixed = {self.symbols()[name]: domain.value for name, domain in self.parameters.items() if domain.value is not None}
        return {x: inert_exponent(value) if x in exponents else value for x, value in fixed.items()}

    def fix(self, values: Mapping[str, Any] | None) -> Criterion:
        """The same law with some parameters fixed; a value outside its domain is an error."""
        return self._over(Domains(self.parameters).fixed(values, self.name))

    def within(self, ranges: Mapping[str, Domain]) -> Criterion:
        """The same law over other domains of some of its parameters."""
        return self._over(Domains({**self.parameters, **ranges}))

    def _over(self, domains: Domains) -> Criterion:
        part, whole = _over(self, domains), self._whole or self
        object.__setattr__(part, "_whole", whole if domains != whole.parameters and cover(whole.parameters, domains) else None)
        return part

    @property
    def whole(self) -> Criterion | None:
        """The law of which this one is a part, by :meth:`fix` or :meth:`within`: what holds of it holds here; None where it is none."""
        return self._whole


def _over(law: Criterion, domains: Mapping[str, Domain]) -> Criterion:
    """The law over other domains, its expressions rewritten in the symbols that know the new signs."""
    old = law.symbols()
    new = {name: domain.symbol(name) for name, domain in domains.items()}
    swap = {old[name]: new[name] for name in new if old[name] != new[name]}

    known = tuple((name, swap.get(x, x)) for name, x in old.items())

    def here(expr: sp.Basic, text: str = "") -> sp.Basic:
        return moved(expr, text, swap, known)

    constraints, texts = moved_relations(law.constraints, law.written_constraints, swap, known)
    return replace(
        law,
        g=sp.nan if law.surfaces else here(law.g, law.written),
        parameters=domains,
        constraints=constraints,
        written_constraints=texts,
        flow=None if law.flow is None or law.potential else tuple(map(here, law.flow, law.written_flow or repeat(""))),
        surfaces=tuple(s.moved(here) for s in law.surfaces),
        closed_form=None if law.closed_form is None else converted(law.closed_form, here),
    )


def _check_are_names(names: Sequence[Any], law: str) -> None:
    for name in names:
        if not isinstance(name, str) or not name.isidentifier():
            raise InputError(f"{name!r} is not a name", where=law, remedy="use letters, digits and underscores")


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
        _check_are_names([*axes, *([pressure] if pressure else [])], named)
        load = spelled(pressure)
        fixed_names = {*axes, load, *map(spelled, define or ())}
        declared = Domains(parameters)
        domains = {a: declared.get(a, POSITIVE) for a in arguments if a not in fixed_names}
        domains |= {n: d for n, d in declared.items() if define and n not in domains}  # for what is defined
        shell = {n: symbol(n) for n in axes} | ({load: symbol(load, nonpositive=True)} if load else {})
        shell |= {n: d.symbol(n) for n, d in domains.items()}
        local = Definitions.of(define or {}, shell, of, named)
        values = shell | {n: parse_expression(n, shell, short=local.short) for n in local}
        made = called(f, values)
        surfaces = _surfaces(made)
        law = Criterion(
            name=named,
            g=sp.nan if surfaces else made,
            parameters=domains,
            forces=axes,
            pressure=load,
            constraints=constraints,  # type: ignore[arg-type]  # read on construction
            flow=flow,  # type: ignore[arg-type]
            summary=(inspect.getdoc(f) or "").split("\n", 1)[0],
            source=source,
            closed_form=closed_form,
            stress=of,
            define=local,
            potential=potential,
            domain=Domains(domain),
            surfaces=surfaces,
        )
        register(law.name, law)
        return law

    return build if function is None else build(function)


def _surfaces(made: Any) -> tuple[YieldSurface, ...]:
    """What a function returned, if it is a surface or a list with one in it."""
    parts = tuple(made) if isinstance(made, list | tuple) else (made,)
    return parts if any(isinstance(part, YieldSurface) for part in parts) else ()
