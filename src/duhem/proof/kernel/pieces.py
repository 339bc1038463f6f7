"""A formula with kinks as smooth pieces, and as the greatest of others."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product
from math import prod

from duhem.proof.kernel.domain import NEGATIVE, StatedDomain, gap
from duhem.proof.kernel.term import COMPARISONS, NotWritten, Term, factors, minus, number, product_of, sum_of

__all__ = ["CHOICES", "chooses", "greatest_of", "pieces"]

_KINKS = ("abs", "pos", "neg", "max", "min")
CHOICES = (*_KINKS, "where")
_MOST_ARMS = 100
_DEEPEST = 6  # kinks one after another: at most this many are opened


def pieces(term: Term, domain: StatedDomain, words: Sequence[str] = _KINKS, depth: int = 0) -> Iterator[tuple[Term, tuple[Term, ...]]]:
    """Smooth formulas, each with what is >= 0 where ``term`` is it; these places cover everything.

    Every abs, pos, neg, max and min of forces is opened, wherever it stands the same way; constants stay as they are.  So is a
    where if ``words`` says so; which side of it owns the equality is left open: there both of its pieces are asked about.
    """
    kink = _innermost(term, domain, words)
    if kink is None:
        yield term, ()
    elif depth == _DEEPEST:
        raise NotWritten("there are too many kinks")
    else:
        for value, sides in _sides(kink):
            for smooth, more in pieces(term.put({kink: value}), domain, words, depth + 1):
                yield smooth, (*sides, *more)


def chooses(term: Term, domain: StatedDomain) -> bool:
    """Whether a force decides what the formula is, or an angle may jump, which it does where its first part is 0 and its second < 0."""
    return _innermost(term, domain, ("where", "atan2")) is not None


def greatest_of(term: Term, domain: StatedDomain) -> list[Term]:
    """Terms whose greatest is ``term``: itself, where it is not seen to be the greatest of others, or of too many."""
    if domain.constant(term):
        return [term]
    match term.op:
        case "abs" | "pos" | "neg":
            return [value for value, _ in _sides(term)]
        case "max":
            return [arm for a in term.args for arm in greatest_of(a, domain)]
        case "*":
            moving, still = ([f for f in factors(term) if domain.constant(f) is c] for c in (False, True))
            if len(moving) == 1 and not domain.of(scale := product_of(*still)) & NEGATIVE:
                return [product_of(scale, arm) for arm in greatest_of(moving[0], domain)]
        case "+":
            parts = [greatest_of(a, domain) for a in term.args]
            if prod(map(len, parts)) <= _MOST_ARMS:
                return [sum_of(*arms) for arms in product(*parts)]
    return [term]


def _innermost(term: Term, domain: StatedDomain, words: Sequence[str]) -> Term | None:
    """A kink whose arguments have none; None if there is no kink."""
    if domain.constant(term):
        return None
    within = next((found for a in term.args if (found := _innermost(a, domain, words)) is not None), None)
    return within or (term if term.op in words else None)


def _sides(kink: Term) -> list[tuple[Term, tuple[Term, ...]]]:
    """The values a kink may have, each with what is >= 0 where it has it."""
    x = kink.args[0]
    if kink.op == "where":
        if x.op not in COMPARISONS:
            raise NotWritten("a choice is by no comparison")
        return [(kink.args[1], (gap(x),)), (kink.args[2], (minus(gap(x)),))]
    if kink.op in ("max", "min"):
        return [
            (u, tuple(sum_of(u, minus(v)) if kink.op == "max" else sum_of(v, minus(u)) for v in kink.args if v is not u)) for u in kink.args
        ]
    other = minus(x) if kink.op == "abs" else number(0)
    return [(x, (x,)), (other, (minus(x),))] if kink.op != "neg" else [(minus(x), (minus(x),)), (other, (x,))]
