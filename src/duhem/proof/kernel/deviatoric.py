"""Formulas read as homogeneous functions of the deviator of a tensor, of which what is shown depends on the choice of a variable.

The functions of one degree that a sum adds up are taken together.  With F > 0 of degree k > 0 it is asked of F^(1/k) whether it is convex.
"""

from __future__ import annotations

from abc import abstractmethod
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from typing import ClassVar

from duhem.proof.kernel.algebraic import plain
from duhem.proof.kernel.domain import ANY, NEGATIVE, POSITIVE, ZERO, Sign, StatedDomain
from duhem.proof.kernel.forms import degree_at_most
from duhem.proof.kernel.plane_function import PlaneFunction, PlaneVariable, added, multiplied
from duhem.proof.kernel.polynomial import Polynomial, negated
from duhem.proof.kernel.shape import Facts, Shown, of_sum
from duhem.proof.kernel.term import COMPARISONS, NotWritten, Term, factors, number, product_of

__all__ = ["DeviatoricReader"]


class DeviatoricReader(PlaneVariable):
    """Reads formulas over a ``domain``; ``within`` is that domain, its forces joined by names that stand for parts of the tensor."""

    by_continuity: ClassVar[bool] = False  # whether what has a degree above 0 counts as 0 where the deviator is 0, whatever its formula

    def __init__(self, domain: StatedDomain, shown: Shown, within: StatedDomain | None = None) -> None:
        self.domain, self.shown, self.within = domain, shown, within or domain
        self.known: dict[Term, PlaneFunction | None] = {}  # what was read

    @property
    @abstractmethod
    def second(self) -> Polynomial:
        """J2 of the tensor, in the forces."""

    # -- what is shown -------------------------------------------------------------------------------------------------

    def facts(self, term: Term) -> Facts | None:
        """What is shown of a term; None for a product, power or choice that is no such function."""
        groups, whole, moving, constants = dict[Fraction, list[PlaneFunction]](), True, list[Facts](), list[Facts]()
        for part in term.args if term.op == "+" else (term,):
            if self.domain.constant(part):
                constants.append(self.shown(part, self.domain))
            elif (wave := self.of_wave(part)) is not None:
                moving.append(wave)
            elif (value := self.value(part)) is not None and value.degree > 0:
                groups.setdefault(value.degree, []).append(value)
                whole &= self.vanishes(value)
            elif term.op != "+":
                return None
            else:
                moving.append(self.shown(part, self.domain))
        known = of_sum([*moving, *map(self.together, groups.values())], constants)
        return replace(known, defined=known.defined and whole)

    def sign(self, term: Term) -> Sign:
        """The signs that a term may have where the deviator is not 0."""
        with suppress(NotWritten):
            poly = self.read(term).poly
            for turned, sign in ((poly, POSITIVE), (negated(poly), NEGATIVE)):
                if self.above(turned):
                    return sign if self.above(turned, strict=True) else sign | ZERO
        return ANY

    def of_wave(self, term: Term) -> Facts | None:
        """What is shown of a term by its form alone, if there is a theorem about it."""
        return None

    def together(self, values: list[PlaneFunction]) -> Facts:
        """What is shown of a sum of functions of one degree."""
        with suppress(NotWritten):
            return self.of_one(self.shortened(added(values)))
        return of_sum(list(map(self.of_one, values)))

    def of_one(self, value: PlaneFunction) -> Facts:
        """What is shown of one function, whose value where the deviator is 0 is 0."""
        sign: Sign = ANY
        with suppress(NotWritten):
            sign = ZERO | POSITIVE | (0 if self.above(value.poly) else NEGATIVE)
            if value.degree == 1 or self.above(value.poly, strict=True):
                convex = self.convex(value if value.degree == 1 else self.root(value))
                return Facts(True, sign, convex and value.degree >= 1, False, convex)
        return Facts(True, sign)

    def convex(self, value: PlaneFunction) -> bool:
        """Whether a function of degree 1 is convex."""
        return self.above(self.bend(value))

    def vanishes(self, value: PlaneFunction) -> bool:
        """Whether a function counts as 0 where the deviator is 0."""
        return value.degree > 0 and (value.whole or self.by_continuity)

    def emptied(self, term: Term) -> Term:
        """The term as it is where the deviator is 0; what is compared stays, for beside that place it may have another sign."""
        if self.domain.constant(term) or term.op == "name" or term.op in COMPARISONS:
            return term
        value = self.value(term)
        if self.of_wave(term) is not None or (value is not None and self.vanishes(value)):
            return number(0)
        return term._replace(args=tuple(map(self.emptied, term.args)))

    # -- reading -------------------------------------------------------------------------------------------------------

    def plain(self, poly: Polynomial) -> Polynomial:
        """The polynomial, its roots as short as they are seen to be."""
        return plain(poly, self.domain)

    def value(self, term: Term) -> PlaneFunction | None:
        """The function that a term is; None where it is not read as one."""
        if term not in self.known:
            self.known[term] = None
            with suppress(NotWritten):
                self.known[term] = self.shortened(self._read(self.replaced(term)))
        return self.known[term]

    def replaced(self, term: Term) -> Term:
        """The term with names for the parts of the tensor that stand in it."""
        return term

    def read(self, term: Term) -> PlaneFunction:
        """The function that a term is; NotWritten where it is not read as one."""
        if (known := self.value(term)) is None:
            raise NotWritten("it is no function of the deviator")
        return known

    def _read(self, term: Term) -> PlaneFunction:
        if self.within.constant(term):
            if not self.shown(term, self.domain).defined:
                raise NotWritten("a constant may be undefined")
            return PlaneFunction(Fraction(0), self.domain.polynomial(term), {})
        if self._is_polynomial(term):
            return self.of_polynomial(self.within.polynomial(term))
        match term.op:
            case "+":
                return added([self.read(a) for a in term.args])
            case "*":
                parts = factors(term)
                smooth = [f for f in parts if self._is_polynomial(f)]
                parts = [*(f for f in parts if f not in smooth), *([product_of(*smooth)] if smooth else [])]
                return multiplied(map(self.read, parts))
            case "**":
                exponent = term.args[1]
                if not (self.within.constant(exponent) and self.shown(exponent, self.domain).defined):
                    raise NotWritten("an exponent varies")
                return self.power(self.read(term.args[0]), self.domain.polynomial(exponent))
        return self.of_word(term)

    def _is_polynomial(self, term: Term) -> bool:
        return degree_at_most(term, self.within) is not None

    @abstractmethod
    def of_polynomial(self, poly: Polynomial) -> PlaneFunction:
        """The function that a polynomial of the forces is."""

    def of_word(self, term: Term) -> PlaneFunction:
        """The function that another formula is."""
        raise NotWritten(f"{term.op} is not read as a function of the deviator")
