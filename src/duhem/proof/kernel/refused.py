"""What the parser refuses although it is well written: a text with a part that has no real value whatever its names stand for.

Like terms of a sum and like factors of a product are put together, as everybody does in the head: a/(b - b) divides by 0.  Nothing
else is cancelled or multiplied out; what goes undetected here is for the rules to find undefined.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any, Protocol

from duhem.proof.kernel.values import ANY, NEGATIVE, POSITIVE, ZERO, Known, NoValueError, constant, of_word

__all__ = ["NoValueError", "check_values"]

Atom = Any  # what a part is but for the order of its sums and products
Monomial = frozenset[tuple[Atom, Fraction]]
Form = dict[Monomial, Fraction]
COMPARED = ("<", "<=", ">", ">=")
_UNIT: Monomial = frozenset()
_MOST_TERMS = 200  # of a sum whose like terms are put together


class Part(Protocol):
    """A formula: its operation or word, its parts, and the number or name that it is."""

    @property
    def op(self) -> str: ...
    @property
    def args(self) -> Sequence[Any]: ...
    @property
    def value(self) -> Fraction: ...
    @property
    def name(self) -> str: ...


def check_values(term: Part, signs: Mapping[str, int]) -> None:
    """NoValueError where a part of the formula or comparison has no real value, for names of the ``signs`` given (any others: all)."""
    _Reading(signs).known(term)


class _Reading:
    """What is known of the parts of one text, and of the atoms in which its sums are written."""

    def __init__(self, signs: Mapping[str, int]) -> None:
        self._signs = signs
        self._known: dict[Any, tuple[Known, Form]] = {}
        self._atoms: dict[Atom, Known] = {}

    def known(self, term: Part) -> Known:
        return self._read(term)[0]

    def _read(self, term: Part) -> tuple[Known, Form]:
        if term not in self._known:
            self._known[term] = self._made(term)
        return self._known[term]

    def _made(self, term: Part) -> tuple[Known, Form]:
        if term.op == "number":
            return constant(term.value), {_UNIT: term.value} if term.value else {}
        if term.op == "name":
            found = constant(3.141592653589793, 2.5e-16) if term.name == "pi" else Known(self._signs.get(term.name, ANY))
            return found, self._atom(term.name, found)
        parts = [self._read(a) for a in term.args]
        found = of_word(term.op, [known for known, _ in parts])
        if term.op == "where" and parts[0][0].lone:  # decided: the choice is what is chosen
            return found, parts[1 if parts[0][0].number else 2][1]
        if term.op == "where" and parts[1][1] == parts[2][1]:
            return parts[1]
        if term.op in ("asin", "acos"):
            self._check_within_one(*parts[0])
        if term.op in COMPARED and not found.lone:
            found = self._compared(term.op, parts[0][1], parts[1][1])
        form = self._form(term, found, [form for _, form in parts])
        if not found.lone:
            if set(form) <= {_UNIT}:
                found = constant(form.get(_UNIT, Fraction(0)))
            elif term.op == "+" and len(form) <= _MOST_TERMS:
                found = self._sum(form, found)
        return found, form

    def _compared(self, op: str, one: Form, two: Form) -> Known:
        """A comparison, decided where the difference of its sides has the sign for it."""
        gap = {m: one.get(m, Fraction(0)) - two.get(m, Fraction(0)) for m in one | two}
        parts = [self._monomial(m, c) for m, c in gap.items() if c]
        known = of_word("+", parts) if parts else constant(Fraction(0))
        return of_word(op, (known, constant(Fraction(0)))) if known.real else Known()

    def _check_within_one(self, known: Known, form: Form) -> None:
        """NoValueError where 1 - |x| is negative by the signs of its terms."""
        if known.real and known.sign in (POSITIVE, NEGATIVE, POSITIVE | ZERO, NEGATIVE | ZERO):
            way = 1 if known.sign & NEGATIVE else -1
            rest = {m: way * c for m, c in form.items()}
            rest[_UNIT] = rest.get(_UNIT, Fraction(0)) + 1
            if self._sum({m: c for m, c in rest.items() if c}, known).sign == NEGATIVE:
                raise NoValueError("an arc of what lies beyond 1")

    def _sum(self, form: Form, found: Known) -> Known:
        """A sum by its terms, like ones put together."""
        return of_word("+", [self._monomial(m, c) for m, c in form.items()])._replace(turned=found.turned)

    def _monomial(self, monomial: Monomial, factor: Fraction) -> Known:
        powers = [of_word("**", (self._atoms[atom], constant(p))) if p != 1 else self._atoms[atom] for atom, p in monomial]
        return of_word("*", [constant(factor), *powers])

    def _form(self, term: Part, found: Known, parts: Sequence[Form]) -> Form:
        if found.lone and isinstance(found.number, Fraction):
            return {_UNIT: found.number} if found.number else {}
        match term.op:
            case "+":
                total = dict[Monomial, Fraction]()
                for form in parts:
                    for m, c in form.items():
                        total[m] = total.get(m, Fraction(0)) + c
                return {m: c for m, c in total.items() if c}
            case "*":
                return self._product(term, parts)
            case "**" if term.args[1].op == "number":
                return self._power(parts[0], term.args[1].value, term.args[0])
        return self._atom((term.op, *map(_frozen, parts)), found)

    def _product(self, term: Part, parts: Sequence[Form]) -> Form:
        sums = [form for form in parts if len(form) > 1]
        if len(sums) == 1 and all(set(form) == {_UNIT} for form in parts if form is not sums[0]):
            factor = Fraction(1)
            for form in parts:
                factor *= form[_UNIT] if form is not sums[0] else 1
            return {m: c * factor for m, c in sums[0].items()}
        powers, factor = dict[Atom, Fraction](), Fraction(1)
        for form, part in zip(parts, term.args, strict=True):
            if len(form) > 1:
                form = self._atom(_frozen(form), self.known(part))
            ((monomial, c),) = form.items()
            factor *= c
            for atom, p in monomial:
                powers[atom] = powers.get(atom, Fraction(0)) + p
        return {frozenset((atom, p) for atom, p in powers.items() if p): factor}

    def _power(self, base: Form, p: Fraction, part: Part) -> Form:
        if len(base) == 1:
            ((monomial, c),) = base.items()
            if p.denominator == 1 and c.numerator.bit_length() * abs(p) < 4096:
                return {frozenset((atom, q * p) for atom, q in monomial): c ** int(p)}
        atom = self._atom(_frozen(base), self.known(part))
        ((((key, _),), _),) = ((tuple(m), c) for m, c in atom.items())
        return {frozenset({(key, p)}): Fraction(1)}

    def _atom(self, key: Atom, known: Known) -> Form:
        self._atoms.setdefault(key, known)
        return {frozenset({(key, Fraction(1))}): Fraction(1)}


def _frozen(form: Form) -> Atom:
    return frozenset(form.items())
