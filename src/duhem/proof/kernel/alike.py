"""Whether two formulas are one: multiplied out, what stands under |.|, a norm or an even power with one of its two signs, in order."""

from __future__ import annotations

from contextlib import suppress

from duhem.proof.kernel.domain import StatedDomain
from duhem.proof.kernel.polynomial import Polynomial, number_in, written
from duhem.proof.kernel.term import NotWritten, Term, minus, number

__all__ = ["alike"]

_SORTED = ("norm", "max", "min")


def alike(one: Term, two: Term, domain: StatedDomain) -> bool:
    """Whether they have one form, even powers multiplied out or kept as powers of a size; False where neither is seen."""
    for powers in (False, True):
        with suppress(NotWritten):
            if _form(one, domain, powers) == _form(two, domain, powers):
                return True
    return False


def _form(term: Term, domain: StatedDomain, powers: bool) -> Polynomial:
    return domain.polynomial(_ordered(term, domain, powers))


def _ordered(term: Term, domain: StatedDomain, powers: bool) -> Term:
    if not term.args:
        return term
    args = [_sorted(domain.polynomial(_ordered(a, domain, powers))) for a in term.args]
    even = term.op == "**" and args[1].op == "number" and args[1].value % 2 == 0
    if term.op in ("abs", "norm") or even:
        sized = 1 if even else len(args)
        args[:sized] = [min(a, _sorted(domain.polynomial(minus(a)))) for a in args[:sized]]
    if even and powers:
        args[0] = Term("abs", (args[0],))
    return Term(term.op, tuple(sorted(args) if term.op in _SORTED else args))


def _sorted(poly: Polynomial) -> Term:
    if number_in(poly) is not None:
        return number(poly.get((), 0))
    return written(dict(sorted(poly.items())))
