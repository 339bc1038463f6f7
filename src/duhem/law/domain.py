"""Where the parameters of a law may lie: an interval with rational ends for each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf
from typing import Any

import sympy as sp
from sympy.core.relational import Relational

from duhem.errors import InputError
from duhem.expression import symbol
from duhem.expression.number import exact_number, nearest_double
from duhem.expression.syntax import respelled
from duhem.law.frozen_mapping import FrozenMapping

__all__ = ["POSITIVE", "REAL", "Domain", "Domains", "by_name", "range_fault"]


@dataclass(frozen=True)
class Domain:
    """Where a parameter may lie: an interval with rational ends, numbers or texts that are read exactly; ``None`` means no end.

    ``positive`` makes the lower end 0 an open one; every other end is closed.  Equal ends fix the value.
    """

    low: sp.Rational | None = None
    high: sp.Rational | None = None
    positive: bool = False

    def __post_init__(self) -> None:
        for side in ("low", "high"):
            if (end := getattr(self, side)) is not None:
                object.__setattr__(self, side, exact_number(end))
        if self.positive and self.low not in (None, 0):
            raise InputError(f"a positive parameter has the least value {self.low}", remedy="remove positive or the least value")
        if self.positive:
            object.__setattr__(self, "low", sp.S.Zero)
        if self.low is not None and self.high is not None and (self.low > self.high or (self.positive and self.high <= 0)):
            ends = f"({self.low}, {self.high}]" if self.positive else f"[{self.low}, {self.high}]"
            remedy = "give a greatest value above 0" if self.positive else "give a least value below the greatest"
            raise InputError(f"the domain {ends} is empty", remedy=remedy)

    @classmethod
    def between(cls, low: Any = None, high: Any = None) -> Domain:
        """Closed interval; you may omit either end.  Numbers are read exactly, decimals as rationals."""
        return cls(low, high)

    @classmethod
    def fixed(cls, value: Any) -> Domain:
        """One value."""
        return cls(value, value)

    @property
    def value(self) -> sp.Rational | None:
        """The fixed value, if there is only one."""
        return self.low if self.low is not None and self.low == self.high else None

    @property
    def ends(self) -> tuple[float, float]:
        """The doubles nearest to the ends; infinite where there is none."""
        return -inf if self.low is None else float(self.low), inf if self.high is None else float(self.high)

    def __contains__(self, value: object) -> bool:
        return self.covers(Domain.fixed(exact_number(value)))

    def covers(self, other: Domain) -> bool:
        """Whether every value in ``other`` lies in this domain."""
        if self.positive and not (other.positive or (other.low is not None and other.low > 0)):
            return False
        above = self.low is None or (other.low is not None and other.low >= self.low)
        return bool(above and (self.high is None or (other.high is not None and other.high <= self.high)))

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

    def plain(self) -> str:
        """As :meth:`describe`, one value by itself: ``3/20``."""
        return self.describe() if self.value is None else str(self.value)

    def numbers(self) -> dict[str, float | bool | None]:
        """``min``, ``max`` and the fixed ``value`` as the nearest doubles, None where there is none; whether it is ``positive``."""
        low, high, value = (None if x is None else nearest_double(x) for x in (self.low, self.high, self.value))
        return {"min": low, "max": high, "value": value, "positive": self.positive}

    def stated(self, name: str) -> str:
        """The domain of ``name`` in words: ``mu positive``, ``mu in [0, 1/2]``, ``mu = 3/20``."""
        words = self.describe()
        return f"{name} in {words}" if words[0] in "[(" else f"{name} {words}"


POSITIVE = Domain(low=sp.S.Zero, positive=True)
REAL = Domain()


def range_fault(name: str, own: Domain, forces: Sequence[str], pressure: str | None) -> tuple[str, str] | None:
    """What is wrong with a range of a force or the pressure of a law, and the remedy; None if nothing is."""
    if name == pressure:
        if own.low is not None and own.low >= 0:
            return f"the range contains no {name} < 0", "the pressure is <= 0 in compression"
    elif name not in forces:
        return f"{name!r} is neither a force nor the pressure", f"ranges are of: {', '.join([*forces, *([pressure] if pressure else [])])}"
    elif own.value is not None or own.positive:
        return f"the range of {name} must have its ends in it, and other values", "give it ends by min and max"
    return None


def by_name(given: Mapping[str, Any] | None, what: str = "a value") -> Mapping[str, Any]:
    """``given`` by names in one spelling, nothing for None; InputError where it does not map names to anything."""
    if given is not None and not isinstance(given, Mapping):
        shown = " ".join(repr(given).split())[:60]
        raise InputError(f"{shown} does not say which parameter has which value", where="parameters", remedy=f"map each name to {what}")
    return respelled(given or {}, "parameters")


class Domains(FrozenMapping[str, Domain]):
    """The domains of a law's parameters by name, in order."""

    __slots__ = ()

    def __init__(self, content: Mapping[str, Domain] | None = None) -> None:
        super().__init__(by_name(content, "a domain"))
        for name, domain in self.items():
            if not isinstance(domain, Domain):
                remedy = "write Domain.fixed(...) for one value, Domain.between(..., ...) or Domain() for more"
                raise InputError(f"the domain of {name} is {domain!r}", where=f"parameter {name}", remedy=remedy)

    def fixed(self, values: Mapping[str, Any] | None, law: str) -> Domains:
        """The same with some parameters of ``law`` fixed; InputError for an unknown one or a value outside its domain."""
        narrow = dict(self)
        for name, value in by_name(values).items():
            if name not in self:
                raise InputError(f"unknown parameter {name!r}", where=law, remedy=f"its parameters are: {', '.join(self) or 'none'}")
            number = exact_number(value)
            if number not in self[name]:
                what = f"{name} = {number} lies outside its domain {self[name].describe()}"
                raise InputError(what, where=law, remedy="choose a value inside")
            narrow[name] = Domain.fixed(number)
        return Domains(narrow)
