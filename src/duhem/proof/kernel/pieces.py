"""A formula with kinks as smooth pieces."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from duhem.proof.kernel.domain import StatedDomain, gap
from duhem.proof.kernel.term import COMPARISONS, NotWritten, Term, minus, number, sum_of

__all__ = ["CHOICES", "below", "choice", "chooses", "pieces"]

_KINKS = ("abs", "pos", "neg", "max", "min")
CHOICES = (*_KINKS, "where")
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


def choice(term: Term, domain: StatedDomain) -> Term | None:
    """A part by which a force decides what the formula is, or an angle, which may jump where its first part is 0 and its second < 0."""
    return _innermost(term, domain, ("where", "atan2"))


def chooses(term: Term, domain: StatedDomain) -> bool:
    """Whether there is such a part."""
    return choice(term, domain) is not None


def below(term: Term, depth: int = 0) -> Iterator[Term]:
    """What is <= 0 wherever ``term`` is: a kink in a sum is no less than any of its values."""
    parts = term.args if term.op == "+" else (term,)
    i = next((i for i, a in enumerate(parts) if a.op in ("abs", "pos", "neg", "max")), None)
    if i is None or depth == _DEEPEST:
        yield term
        return
    for value, _ in _sides(parts[i]):
        yield from below(sum_of(*parts[:i], *parts[i + 1 :], value), depth + 1)


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
