"""Symmetric functions of the principal values of matrices whose entries are affine in the forces.

The eigenvalues, in order, of a mean t A + (1 - t) B of symmetric matrices are a mean of permutations of t a + (1 - t) b (Fan 1949,
Proc. Natl. Acad. Sci. 35, 652; Birkhoff 1946).  So f(eigenvalues of A, of B, ..., forces) is convex, or quasiconvex, where f is so in
all of its arguments together and does not change with the order of the eigenvalues of any one matrix (Davis 1957, Arch. Math. 8, 276).

The arguments are the greatest and the least value, for the middle one is the trace less both, and the forces: f is asked for all
numbers.  Two swaps of neighbours make every order.  Of a diagonal matrix they are the greatest and the least of three loads.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from typing import NamedTuple

from duhem.proof.kernel.alike import alike
from duhem.proof.kernel.domain import StatedDomain, StatedLaw
from duhem.proof.kernel.polynomial import Polynomial, negated, total, written
from duhem.proof.kernel.shape import Facts, Shown
from duhem.proof.kernel.term import NotWritten, Term, minus, sum_of

__all__ = ["entries_of", "extremes", "quasiconvex_in_eigenvalues"]

_MOST_MATRICES = 4


class _Matrix(NamedTuple):
    """By its entries, those of a diagonal matrix in order, and the names of its greatest and its least eigenvalue."""

    entries: tuple[Polynomial, ...]
    greatest: Term
    least: Term

    @property
    def middle(self) -> Term:
        return sum_of(written(total(*self.entries[:3])), minus(self.greatest), minus(self.least))


def quasiconvex_in_eigenvalues(term: Term, domain: StatedDomain, shown: Shown, over: Callable[[StatedLaw], StatedDomain]) -> Facts | None:
    """What is shown of the term as such a function; None if it is none, or not quasiconvex."""
    with suppress(NotWritten):
        matrices, free = _read(term, domain, shown)
        if not 0 < len(matrices) <= _MOST_MATRICES:
            return None
        names = [x.name for matrix in matrices for x in (matrix.greatest, matrix.least)]
        if {*names} & {*domain.law.forces}:
            return None
        wider, freed = over(domain.law._replace(forces=(*domain.law.forces, *names))), term.put(free)
        known = shown(freed, wider)
        if known.defined and known.quasiconvex and all(alike(freed.put(swap), freed, wider) for m in matrices for swap in _swaps(m)):
            return known
    return None


def _swaps(matrix: _Matrix) -> Iterator[dict[Term, Term]]:
    yield {matrix.greatest: matrix.least, matrix.least: matrix.greatest}
    yield {matrix.greatest: matrix.middle}


def _read(term: Term, domain: StatedDomain, shown: Shown) -> tuple[list[_Matrix], dict[Term, Term]]:
    """The matrices of which the term has the greatest or the least eigenvalue, and the name that takes the place of each."""
    matrices, free = list[_Matrix](), dict[Term, Term]()
    for part in dict.fromkeys(extremes(term)):
        if domain.constant(part) or not all(shown(a, domain).affine and shown(a, domain).defined for a in part.args):
            continue
        entries, opposite = (entries_of(part, domain, turned) for turned in (False, True))
        matrix = next((m for m in matrices if m.entries in (entries, opposite)), None)
        if matrix is None:
            own = f"of matrix {len(matrices)}"  # no name of a law has blanks
            matrix = _Matrix(entries, Term("name", name=f"greatest {own}"), Term("name", name=f"least {own}"))
            matrices.append(matrix)
        turned = matrix.entries != entries  # the greatest of -A is the least of A, turned
        value = matrix.least if turned is (part.op != "min") else matrix.greatest
        free[part] = minus(value) if turned else value
    return matrices, free


def extremes(term: Term) -> Iterator[Term]:
    """Its greatest eigenvalues, and what is the greatest or the least of three."""
    if term.op == "eigmax" or (term.op in ("max", "min") and len(term.args) == 3):
        yield term
    for a in term.args:
        yield from extremes(a)


def entries_of(part: Term, domain: StatedDomain, turned: bool = False) -> tuple[Polynomial, ...]:
    """Those of the matrix, or of its negative; a diagonal one has its entries in any order."""
    entries = [domain.polynomial(a) for a in part.args]
    entries = [negated(e) for e in entries] if turned else entries
    return tuple(entries) if part.op == "eigmax" else tuple(sorted(entries, key=lambda e: sorted(e.items())))
