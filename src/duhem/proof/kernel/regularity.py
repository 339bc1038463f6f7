"""Smoothness by composition: where a formula may fail to be C^1 in the forces, and which of its kinks cancel.

A function that vanishes where it has a kink, and is Lipschitz, loses the kink under a power > 1, cos and cosh, and inside a Euclidean
norm: only the tip is left where the norm is 0.

Let G(x, z) be C^1 and even in every z_i, and r_i(x) >= 0 convex, and C^1 where it is > 0.  Then G(x, r(x)) is C^1, where r_i = 0 too:
dG/dz_i is 0 for z_i = 0, and r_i is Lipschitz, so that the share dG/dz_i grad r_i of the gradient tends to 0 there.

Let f be rho^k h, rho = sqrt(J2), k > 1, h of the direction of the deviator alone, and C^1 where rho > 0.  Its slopes are rho^(k - 1) times
what is bounded, being continuous in the direction: f and they tend to 0 where J2 = 0, so that f, with 0 for its value there, is C^1.

Let G(x, z) be C^1 and not change with the order of z, the eigenvalues of a symmetric matrix A = U' diag(z) U that is affine in x, or of
each of several: then it is C^1 in x.  Its gradient in A is U' diag(dG/dz) U (Lewis 1996, Math. Oper. Res. 21, 576, theorem 1.1), for every
such U the same; so it is continuous: where A and x tend to a limit, so do z, and U for a subsequence.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, replace

from duhem.proof.kernel.definedness import flat_on_axis, sign_on_axis
from duhem.proof.kernel.domain import ANY, NEGATIVE, POSITIVE, ZERO, Sign, StatedDomain
from duhem.proof.kernel.identity import multiplied_through
from duhem.proof.kernel.normal_form import normal
from duhem.proof.kernel.polynomial import Polynomial, written
from duhem.proof.kernel.semidefinite import zero_with
from duhem.proof.kernel.spectrum import freed_of_eigenvalues, freed_of_roots
from duhem.proof.kernel.term import NotWritten, Term, minus, number

__all__ = ["Kinks", "regularity", "smooth_but_where_zero", "smooth_everywhere", "smooth_near_the_boundary", "tips"]

Switch = frozenset[tuple[object, object]]
_FLAT = ("cos", "cosh")  # their slope is 0 where their argument is 0
_ODD = ("sin", "sinh", "tanh", "atan")  # 0 where their argument is


@dataclass(frozen=True)
class Kinks:
    """``kinks``: arguments on whose zeros it may not be C^1; ``zeros``: arguments where it vanishes; ``tips``: where it may be singular."""

    kinks: frozenset[Switch] = frozenset()
    zeros: frozenset[Switch] = frozenset()
    tips: frozenset[Term] = frozenset()


def smooth_near_the_boundary(law_g: Term, domain: StatedDomain) -> bool:
    """Whether g is C^1 wherever g = 0: where a kink is left, or a tip is 0, g is not."""
    found = regularity(law_g, domain)
    if found is None or not found.kinks <= set(_kinks_off_the_boundary(law_g, domain)):
        return False
    return all(any(sign in (NEGATIVE, POSITIVE) for sign in _signs_at(tip, law_g, domain)) for tip in found.tips)


def _kinks_off_the_boundary(g: Term, domain: StatedDomain) -> Iterator[Switch]:
    """Those of |x|, pos x and neg x with x = 0 where g is not 0."""
    for part in dict.fromkeys(() if g.large else (part for part in g.parts() if part.op in ("abs", "pos", "neg"))):
        if _sign(g.put({part: number(0)}), domain) in (NEGATIVE, POSITIVE):
            yield _switch(part.args[0], domain)


def smooth_everywhere(term: Term, domain: StatedDomain) -> bool:
    """Whether a term, which has a value everywhere, is C^1."""
    found = regularity(term, domain)
    return found is not None and not (found.kinks or found.tips)


def smooth_but_where_zero(term: Term, domain: StatedDomain) -> bool:
    """Whether a term is C^1 wherever it is not 0."""
    found = regularity(term, domain)
    return found is not None and found.kinks <= found.zeros and all(ZERO in _signs_at(tip, term, domain) for tip in found.tips)


def tips(term: Term, domain: StatedDomain) -> frozenset[Term]:
    """What is 0 where a term, which has a value everywhere, may be singular; nothing where more than that is open."""
    for spelled in (lambda x, _: x, normal):
        with suppress(NotWritten):
            if (found := regularity(spelled(term, domain), domain)) is not None and not found.kinks:
                return found.tips
    return frozenset()


def _signs_at(tip: Term, term: Term, domain: StatedDomain) -> tuple[Sign, Sign]:
    """The sign of a term where a tip is 0, read in two ways."""
    return _sign_without(term, tip, domain), sign_on_axis(term, tip, domain)


def _sign_without(term: Term, tip: Term, domain: StatedDomain) -> Sign:
    """That of the term with the tip put to 0, and what is 0 with it: so it is wherever the tip is 0."""
    put = term.put({tip: number(0)})
    return _sign(put if domain.constant(put) else put.put(dict.fromkeys(zero_with(tip, domain), number(0))), domain)


def _sign(term: Term, domain: StatedDomain) -> Sign:
    """That of a term; where forces have ranges also by that of the term times what it divides by, which is > 0."""
    known = domain.facts(term)
    with suppress(NotWritten):
        if domain.sides and known.defined and known.sign not in (NEGATIVE, POSITIVE):
            return domain.sign(written(multiplied_through(domain.polynomial(term), domain, signed=True)))
    return known.sign if known.defined else ANY


def _switch(term: Term, domain: StatedDomain) -> Switch:
    """The zeros of a term, the same for all multiples of it by a number."""
    poly: Polynomial = domain.polynomial(term)
    first = poly[min(poly)] if poly else 1
    return frozenset((m, c / first) for m, c in poly.items())


def regularity(term: Term, domain: StatedDomain) -> Kinks | None:
    """Where a term may fail to be C^1; None where that is not known."""
    known: dict[Term, Kinks | None] = domain.kept.setdefault("regularity", {})
    if term not in known:
        found = _of_parts(term, domain)
        if found is not None and found.tips and not found.kinks and flat_on_axis(term, found.tips, domain):
            found = replace(found, tips=frozenset())
        if term.op == "+" and (found is None or found.kinks or found.tips) and not term.large:
            with suppress(NotWritten):
                found = _freed_of_parts(term, domain) or found
        known[term] = found
    return known[term]


def _freed_of_parts(term: Term, domain: StatedDomain) -> Kinks | None:
    """Of a sum that is C^1 and even in its roots, or does not change with the order of eigenvalues; what is singular but for these
    themselves stays a tip.
    """
    for freed in (*freed_of_roots(term, domain), *freed_of_eigenvalues(term, domain)):
        found = regularity(freed.term, freed.domain)
        if found is None or found.kinks or not freed.domain.facts(freed.term).defined or not freed.unchanged():
            continue
        roots = [root for root in freed.parts.values() if root.op in ("norm", "**")]
        inner = [regularity(y, domain) for root in roots for y in (root.args if root.op == "norm" else root.args[:1])]
        known = [y for y in inner if y is not None and y.kinks <= y.zeros]
        if len(known) == len(inner):
            tips = frozenset(tip.put(freed.parts) for tip in found.tips).union(*(y.tips for y in known))
            return Kinks(zeros=frozenset({_switch(term, domain)}), tips=tips)
    return None


def _of_parts(term: Term, domain: StatedDomain) -> Kinks | None:
    if domain.constant(term):
        return Kinks()
    if term.op == "name":
        return Kinks(zeros=frozenset({_switch(term, domain)}))
    parts = [regularity(a, domain) for a in term.args]
    known = [p for p in parts if p is not None]
    if len(known) < len(parts):
        return None
    kinks, tips = (frozenset().union(*(getattr(p, part) for p in known)) for part in ("kinks", "tips"))
    every, some = frozenset.intersection(*(p.zeros for p in known)), frozenset().union(*(p.zeros for p in known))
    if term.op == "+":
        return Kinks(kinks, every | {_switch(term, domain)}, tips)
    if term.op == "*":
        left = {k for i, p in enumerate(known) for k in p.kinks if not any(k in q.zeros for j, q in enumerate(known) if j != i)}
        return Kinks(frozenset(left), some, tips)
    if term.op in ("abs", "pos", "neg"):
        here, dead = frozenset({_switch(term.args[0], domain)}), {"pos": NEGATIVE, "neg": POSITIVE}.get(term.op)
        if (
            not (sign := domain.facts(term.args[0]).sign) & NEGATIVE or not sign & POSITIVE
        ):  # it is its argument, or that turned round, or 0
            return known[0] if term.op == "abs" or (term.op == "pos") == (not sign & NEGATIVE) else Kinks()
        tips = frozenset(tip for tip in tips if dead is None or dead not in _signs_at(tip, term.args[0], domain))  # it is 0 around others
        return Kinks(kinks | here, known[0].zeros | here, tips)
    if term.op in ("exp", "log", "cos", "cosh", "sin", "sinh", "tanh", "atan"):
        flat = term.op in _FLAT and kinks <= known[0].zeros
        return Kinks(frozenset() if flat else kinks, known[0].zeros if term.op in _ODD else frozenset(), tips)
    if term.op in ("asin", "acos"):  # of x, for x^2 < 1
        return Kinks(kinks, tips=tips | _zeros_of(Term("+", (number(1), minus(Term("*", term.args * 2)))), domain))
    if term.op == "norm" and all(p.kinks <= p.zeros for p in known):
        return Kinks(frozenset(), every, tips | _zeros_of(term, domain))
    if term.op == "**" and domain.constant(term.args[1]):
        base, exponent = known[0], term.args[1].value if term.args[1].op == "number" else None
        whole = exponent is not None and exponent.denominator == 1 and exponent >= 0
        steep = exponent > 1 if whole and exponent is not None else domain.facts(Term("+", (term.args[1], number(-1)))).sign == POSITIVE
        zeros = base.zeros if domain.facts(term.args[1]).sign == POSITIVE else frozenset()
        bent = frozenset() if steep and base.kinks <= base.zeros else base.kinks
        return Kinks(bent, zeros, tips if whole or steep else tips | _zeros_of(term.args[0], domain))
    return None


def _zeros_of(tip: Term, domain: StatedDomain) -> frozenset[Term]:
    """A tip; none where it is never 0."""
    return frozenset({tip} if domain.facts(tip).sign & ZERO else ())
