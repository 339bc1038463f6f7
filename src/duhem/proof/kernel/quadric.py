"""Whether a formula is the support function of K, for a quadratic K = {x . A x + b . x + c <= 0}.

About its centre m, K = {y . A y <= R} with R > 0, A positive semidefinite.  By Cauchy-Schwarz the greatest of y . d, d = A z, is
sqrt(R z . A z); it is infinite for other d.  So it is sqrt(d . B d) with any B for which A B A = R A (Rockafellar 1970,
section 12), and A B/R projects on the range of A: the trace of A B is R times the rank of A.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from duhem.proof.kernel.curvature import facts
from duhem.proof.kernel.domain import NEGATIVE, POSITIVE, StatedDomain
from duhem.proof.kernel.forms import Matrix, affine, at, determinant, quadratic
from duhem.proof.kernel.identity import multiplied_out, value, vanishes
from duhem.proof.kernel.term import NotWritten, Term, factors, minus, number, product_of, sum_of

__all__ = ["supports_quadric"]

_TWO = number(2)


def supports_quadric(
    g: Term, potential: Term, forces: Sequence[str], slips: Sequence[str], flat: Sequence[Term], domain: StatedDomain
) -> bool:
    """Whether ``potential`` = sup {sigma . d : g <= 0} where the forms ``flat`` in the slips vanish, and it is infinite elsewhere."""
    q = _polynomial(g, domain)
    a, b, _ = quadratic(q, forces, domain)
    terms = potential.args if potential.op == "+" else (potential,)
    squares = [(t, _square(t, domain)) for t in terms]
    roots = [square for _, square in squares if square is not None]
    straight = sum_of(*(t for t, square in squares if square is None))
    centre, offset = affine(straight, slips, domain)
    if len(roots) != 1 or not facts(straight, domain).defined:
        return False
    inverse, slant, level = quadratic(roots[0], slips, domain)
    size = multiplied_out(minus(at(q, forces, centre)), domain)
    n, rank = range(len(forces)), len(forces) - len(flat)
    zeros = [offset, level, *slant]
    zeros += [sum_of(b[i], *(product_of(_TWO, a[i][j], centre[j]) for j in n)) for i in n]
    projected = [[multiplied_out(sum_of(*(product_of(a[i][k], inverse[k][j]) for k in n)), domain) for j in n] for i in n]
    zeros += [sum_of(*(product_of(projected[i][k], a[k][j]) for k in n), minus(product_of(size, a[i][j]))) for i in n for j in n]
    zeros.append(sum_of(*(projected[i][i] for i in n), product_of(number(-rank), size)))
    rows = [affine(form, slips, domain) for form in flat]
    zeros += [constant for _, constant in rows]
    zeros += [sum_of(*map(product_of, a[i], row)) for row, _ in rows for i in n]
    gram = determinant([[sum_of(*map(product_of, one, two)) for two, _ in rows] for one, _ in rows])
    return (
        all(vanishes(zero, domain) for zero in zeros)
        and _positive(size, domain)
        and _positive(gram, domain)
        and (facts(q, domain).convex or _definite(a, rank, domain))
    )


def _polynomial(g: Term, domain: StatedDomain) -> Term:
    """A formula that is <= 0 where g is, without the root of g = root - radius."""
    if not facts(g, domain).defined:
        raise NotWritten("g is not defined everywhere")
    moving, still = ([t for t in (g.args if g.op == "+" else (g,)) if domain.constant(t) is c] for c in (False, True))
    square, radius = _square(moving[0], domain) if len(moving) == 1 else None, minus(sum_of(*still))
    if square is None or facts(radius, domain).sign & NEGATIVE:
        return g
    return sum_of(square, minus(Term("**", (radius, _TWO))))


def _square(term: Term, domain: StatedDomain) -> Term | None:
    """The square of a norm or root times constants, where that is >= 0."""
    moving, still = ([f for f in factors(term) if domain.constant(f) is c] for c in (False, True))
    scale = product_of(*still)
    known = facts(scale, domain)
    if len(moving) != 1 or not known.defined or known.sign & NEGATIVE:
        return None
    (x,) = moving
    if x.op in ("norm", "abs"):
        inner = [Term("**", (a, _TWO)) for a in x.args]
    elif x.op == "**" and value(x.args[1], domain) == Fraction(1, 2):
        inner = [x.args[0]]
    else:
        return None
    if not all(facts(part, domain).defined for part in inner):
        return None
    return sum_of(*(product_of(Term("**", (scale, _TWO)), part) for part in inner))


def _positive(term: Term, domain: StatedDomain) -> bool:
    return facts(term, domain).defined and facts(term, domain).sign == POSITIVE


def _definite(matrix: Matrix, rank: int, domain: StatedDomain) -> bool:
    """Whether a matrix of this rank is positive semidefinite: its leading minors up to the rank are positive (Sylvester)."""
    return all(_positive(determinant([row[:k] for row in matrix[:k]]), domain) for k in range(1, rank + 1))
