"""A criterion as a frozen value: names, one formula, parameter domains, and optionally a flow of its own.

Sign convention: the pressure name stands for the normal stress, sigma_n <= 0 in compression.  Forces and pressure
share one unit; what else carries a unit is the law's affair.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any, overload

import sympy as sp
from sympy.core.relational import Relational

from duhem.errors import InputError
from duhem.expression import symbol
from duhem.expression.inert_number import inert_exponent
from duhem.expression.parse import exact_number, parse_expression, parse_relation
from duhem.law.shapes import Shape, converted

__all__ = ["FORCES", "POSITIVE", "PRESSURE", "REAL", "Criterion", "Domain", "criterion", "narrowed", "register", "registered"]

FORCES = ("sigma_a", "sigma_b")
PRESSURE = "sigma_n"


@dataclass(frozen=True)
class Domain:
    """Where a parameter may lie: an interval with rational ends; ``None`` means no end.

    ``positive`` makes the lower end 0 an open one; every other end is closed.  Equal ends fix the value.
    """

    low: sp.Rational | None = None
    high: sp.Rational | None = None
    positive: bool = False

    def __post_init__(self) -> None:
        if self.low is not None and self.high is not None and (self.low > self.high or (self.positive and self.high <= 0)):
            raise InputError(f"the domain {self.describe()} is empty", remedy="give a least value below the greatest")

    @classmethod
    def between(cls, low: Any = None, high: Any = None) -> Domain:
        """Closed interval; either end may be left out.  Numbers are read exactly, decimals as rationals."""
        low, high = (None if end is None else exact_number(end) for end in (low, high))
        return cls(low, high)

    @classmethod
    def fixed(cls, value: Any) -> Domain:
        """One value."""
        exact = exact_number(value)
        return cls(exact, exact)

    @property
    def value(self) -> sp.Rational | None:
        """The fixed value, if there is only one."""
        return self.low if self.low is not None and self.low == self.high else None

    def __contains__(self, value: object) -> bool:
        number = exact_number(value)
        above = self.low is None or (number > 0 if self.positive else number >= self.low)
        return bool(above and (self.high is None or number <= self.high))

    def symbol(self, name: str) -> sp.Symbol:
        """The parameter as a symbol that knows its sign."""
        if self.positive or (self.low is not None and self.low > 0):
            return symbol(name, positive=True)
        if self.low is not None and self.low >= 0:
            return symbol(name, nonnegative=True)
        return symbol(name)

    def relations(self, x: sp.Expr) -> tuple[Relational, ...]:
        """The domain as relations on ``x`` (those SymPy does not already see as true)."""
        raw = []
        if self.low is not None:
            raw.append(sp.StrictGreaterThan(x, 0, evaluate=False) if self.positive else sp.GreaterThan(x, self.low, evaluate=False))
        if self.high is not None:
            raw.append(sp.LessThan(x, self.high, evaluate=False))
        return tuple(raw)

    def describe(self) -> str:
        """The domain in words: ``positive``, ``real``, ``[0, 1/2]``, ``= 3/20``."""
        if self.value is not None:
            return f"= {self.value}"
        if self.positive:
            return "positive" if self.high is None else f"(0, {self.high}]"
        if self.low is None:
            return "real" if self.high is None else f"(-oo, {self.high}]"
        return f"[{self.low}, oo)" if self.high is None else f"[{self.low}, {self.high}]"


POSITIVE = Domain(low=sp.S.Zero, positive=True)
REAL = Domain()


@dataclass(frozen=True)
class Criterion:
    """K(sigma_n) = {g <= 0} in the space of the forces, for every pressure and every parameter of the domain.

    ``g``, ``constraints`` and ``flow`` may be given as text in the vocabulary or as SymPy expressions over
    :meth:`symbols`; text is parsed safely, nothing in it is executed.  ``flow`` is the slip direction field, one
    expression per force; None means associated (normality rule, Antoni et al. 2007, Eq. 36).  ``closed_form`` states the
    shape of K where the slip increment onto it has one.
    """

    name: str
    g: sp.Expr
    parameters: Mapping[str, Domain] = field(default_factory=dict)
    forces: tuple[str, ...] = FORCES
    pressure: str | None = PRESSURE
    constraints: tuple[Relational, ...] = ()
    flow: tuple[sp.Expr, ...] | None = None
    summary: str = ""
    source: str = ""
    closed_form: Shape | None = None
    _symbols: Mapping[str, sp.Symbol] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        put = object.__setattr__
        put(self, "forces", tuple(self.forces))
        put(self, "parameters", MappingProxyType(dict(self.parameters)))
        self._check_names()
        put(self, "_symbols", MappingProxyType(self._declared()))
        known = self.symbols()
        put(self, "g", _expression(self.g, known, f"g of {self.name}"))
        put(self, "constraints", tuple(_relation(c, known, f"constraint of {self.name}") for c in self.constraints))
        if self.flow is not None:
            put(self, "flow", tuple(_expression(c, known, f"flow of {self.name}") for c in self.flow))
        if self.closed_form is not None:
            put(self, "closed_form", converted(self.closed_form, lambda x: _expression(x, known, f"closed form of {self.name}")))
        self._check_content()

    def __hash__(self) -> int:
        return hash((self.name, self.g, self.forces, self.pressure, tuple(self.parameters.items()), self.constraints, self.flow))

    def _check_names(self) -> None:
        names = [*self.forces, *([self.pressure] if self.pressure else []), *self.parameters]
        if not self.forces:
            raise InputError(f"{self.name} declares no force", remedy="name at least one in forces")
        for name in names:
            if not name.isidentifier():
                raise InputError(f"{name!r} is not a name", where=self.name, remedy="use letters, digits and underscores")
            if names.count(name) > 1:
                raise InputError(f"{name!r} is declared twice", where=self.name, remedy="give each force and parameter a name of its own")

    def _check_content(self) -> None:
        known = set(self.symbols().values())
        forces = {self.symbols()[f] for f in self.forces}
        for what, expr in [("g", self.g), *(("flow", c) for c in self.flow or ())]:
            if stray := expr.free_symbols - known:
                raise InputError(
                    f"{what} uses the undeclared {sorted(map(str, stray))}", where=self.name, remedy="declare it as a parameter"
                )
        if not self.g.free_symbols & forces:
            raise InputError("g does not depend on any force", where=self.name, remedy=f"use at least one of {', '.join(self.forces)}")
        if self.flow is not None and len(self.flow) != len(self.forces):
            raise InputError(
                f"the flow has {len(self.flow)} components for {len(self.forces)} forces",
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

    def settled(self) -> dict[sp.Symbol, sp.Expr]:
        """The fixed parameters with the numbers to put in their places; exponents as numbers that SymPy leaves alone."""
        exponents = {x for power in self.g.atoms(sp.Pow) for x in power.exp.free_symbols}
        fixed = {self.symbols()[name]: domain.value for name, domain in self.parameters.items() if domain.value is not None}
        return {x: inert_exponent(value) if x in exponents else value for x, value in fixed.items()}

    def fix(self, values: Mapping[str, Any] | None) -> Criterion:
        """The same law with some parameters fixed; a value outside its domain is an error."""
        return _over(self, narrowed(self.name, self.parameters, values or {}))


def narrowed(law: str, domains: Mapping[str, Domain], values: Mapping[str, Any]) -> dict[str, Domain]:
    """The domains with some parameters fixed; InputError for an unknown one or a value outside its domain."""
    narrow = dict(domains)
    for name, value in values.items():
        if name not in domains:
            raise InputError(f"unknown parameter {name!r}", where=law, remedy=f"its parameters are: {', '.join(domains) or 'none'}")
        number = exact_number(value)
        if number not in domains[name]:
            raise InputError(
                f"{name} = {number} lies outside its domain {domains[name].describe()}", where=law, remedy="choose a value inside"
            )
        narrow[name] = Domain.fixed(number)
    return narrow


def _over(law: Criterion, domains: Mapping[str, Domain]) -> Criterion:
    """The law over other domains, its expressions rewritten in the symbols that know the new signs."""
    old = law.symbols()
    new = {name: domain.symbol(name) for name, domain in domains.items()}
    swap = {old[name]: new[name] for name in new if old[name] != new[name]}

    def moved(expr: sp.Basic) -> sp.Basic:
        return expr.xreplace(swap)

    return replace(
        law,
        g=moved(law.g),
        parameters=domains,
        constraints=tuple(c for c in map(moved, law.constraints) if c != sp.true),
        flow=None if law.flow is None else tuple(moved(c) for c in law.flow),
        closed_form=None if law.closed_form is None else converted(law.closed_form, moved),
    )


def _expression(given: Any, known: Mapping[str, sp.Symbol], where: str) -> sp.Expr:
    return parse_expression(given, known, where=where) if isinstance(given, str) else sp.sympify(given, strict=True)


def _relation(given: Any, known: Mapping[str, sp.Symbol], where: str) -> Relational:
    return parse_relation(given, known, where=where) if isinstance(given, str) else given


_registered: dict[str, Any] = {}


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
) -> Criterion | Callable[[Callable[..., Any]], Criterion]:
    """Turn a function of the declared names into a registered :class:`Criterion`.

    The function receives SymPy symbols by the names of its arguments and returns g; its docstring's first line
    becomes the summary.  The law's name is the function's, underscores as hyphens, unless given.  Parameters that are
    arguments but not declared are positive.
    """

    def build(f: Callable[..., Any]) -> Criterion:
        arguments = list(inspect.signature(f).parameters)
        fixed_names = {*forces, pressure}
        domains = {a: (parameters or {}).get(a, POSITIVE) for a in arguments if a not in fixed_names}
        shell = {n: symbol(n) for n in forces} | ({pressure: symbol(pressure, nonpositive=True)} if pressure else {})
        shell |= {n: d.symbol(n) for n, d in domains.items()}
        law = Criterion(
            name=name or f.__name__.replace("_", "-"),
            g=f(*(shell[a] for a in arguments)),
            parameters=domains,
            forces=tuple(forces),
            pressure=pressure,
            constraints=tuple(constraints),
            flow=None if flow is None else tuple(flow),
            summary=(inspect.getdoc(f) or "").split("\n", 1)[0],
            source=source,
            closed_form=closed_form,
        )
        register(law.name, law)
        return law

    return build if function is None else build(function)


def register(name: str, law: Any) -> None:
    """Make a law, of whatever kind, known by a name in this process."""
    _registered[name] = law


def registered() -> Mapping[str, Any]:
    """The laws registered so far in this process, by name."""
    return MappingProxyType(_registered)
