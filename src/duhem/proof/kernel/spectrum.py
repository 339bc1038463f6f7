"""Functions of further arguments that do not change with their signs or their order: of roots r, and of principal values of matrices.

Let G(x, z) be quasiconvex in both together and even in every z_i.  Then it does not fall where z_i >= 0 grows, since z_i lies
between -z_i' and z_i' for every z_i' above it; so G(x, r(x)) is quasiconvex where all r_i are convex and >= 0, and convex where
G is: f(u - r) + f(u + r) with f convex, u affine.  The symmetric functions of the eigenvalues u - r, u + r of a tensor in the plane are
such (Davis 1957, Arch. Math. 8, 276; Lewis 1996, SIAM J. Optim. 6, 164).

The eigenvalues, in order, of a mean t A + (1 - t) B of symmetric matrices are a mean of permutations of t a + (1 - t) b (Fan 1949,
Proc. Natl. Acad. Sci. 35, 652; Birkhoff 1946).  So f(eigenvalues of A, of B, ..., forces), the entries being affine, is convex, or
quasiconvex, where f is so in all of its arguments together and does not change with the order of the eigenvalues of any one matrix
(Davis 1957).  The arguments are the greatest and the least value, for the middle one is the trace less both, and the forces: f is asked
for all numbers.  Two swaps of neighbours make every order.  Of a diagonal matrix they are the greatest and the least of three loads.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from typing import NamedTuple

from duhem.proof.kernel.bounds import Facts
from duhem.proof.kernel.domain import StatedDomain
from duhem.proof.kernel.identity import alike
from duhem.proof.kernel.polynomial import Polynomial, negated, total, written
from duhem.proof.kernel.term import NotWritten, Term, factors, minus, number, product_of, sum_of

__all__ = ["Freed", "entries_of", "extremes", "freed_of_eigenvalues", "freed_of_roots", "quasiconvex_with_parts_freed"]

_MOST_ROOTS, _MOST_MATRICES = 8, 4


class Freed(NamedTuple):
    """A ``term`` of a wider ``domain``: forces that may be any numbers in the place of ``parts``, for which ``swaps`` put others."""

    term: Term
    domain: StatedDomain
    parts: Mapping[Term, Term]
    swaps: Sequence[Mapping[Term, Term]]

    def unchanged(self) -> bool:
        """Whether no swap changes it."""
        return all(alike(self.term.put(swap), self.term, self.domain) for swap in self.swaps)


def quasiconvex_with_parts_freed(term: Term, domain: StatedDomain) -> Facts | None:
    """What is shown of the term with further forces in the place of roots, or of eigenvalues; None where that is not quasiconvex, or
    changes with their signs or order.
    """
    for freed_of in (freed_of_roots, freed_of_eigenvalues):
        with suppress(NotWritten):
            for freed in freed_of(term, domain):
                known = freed.domain.facts(freed.term)
                if known.defined and known.quasiconvex and freed.unchanged():
                    return known
    return None


# -- roots -------------------------------------------------------------------------------------------------------------


def freed_of_roots(term: Term, domain: StatedDomain) -> Iterator[Freed]:
    """The term with a force z for each of its outermost roots; then with |z| where no affine part is added."""
    roots = list(dict.fromkeys(root for part in term.args for root in _roots(part, domain)))
    if not 0 < len(roots) <= _MOST_ROOTS:
        return
    names = [f"root {i}" for i in range(len(roots))]  # no name of a law has blanks
    while {*names} & {*domain.law.forces}:
        names = [f"{name} inside" for name in names]
    wider = domain.wider(*names)
    free = {root: Term("name", name=name) for root, name in zip(roots, names, strict=True)}
    for sized in (False, True):
        swaps = [{z: minus(z)} for z in free.values()]
        yield Freed(_freed(term, free, sized, domain), wider, {z: root for root, z in free.items()}, swaps)


def _roots(term: Term, domain: StatedDomain) -> Iterator[Term]:
    """The outermost roots and norms that are convex, and >= 0."""
    rooted = term.op == "**" and term.args[1].op == "number" and 0 < term.args[1].value < 1
    if (rooted or term.op == "norm") and not domain.constant(term):
        known = domain.facts(term)
        if known.defined and known.convex and known.nonnegative and not known.affine:
            yield term
            return
    for a in term.args:
        yield from _roots(a, domain)


def _freed(term: Term, names: dict[Term, Term], sized: bool, domain: StatedDomain) -> Term:
    """The term with z for its roots r = y^e, ``sized`` |z| where no affine part is added; for other powers y^k, y >= 0, |z|^(k/e)."""
    if term in names:
        return Term("abs", (names[term],)) if sized else names[term]
    if term.op == "**":
        for root, name in names.items():
            if root.op == "**" and root.args[0] == term.args[0]:
                power, own = term.args[1], 1 / root.args[1].value
                power = number(own * power.value) if power.op == "number" else product_of(number(own), power)
                return Term("**", (Term("abs", (name,)), power))
    if sized and (sizes := _sizes(term, names, domain)) is not None:
        return sizes
    if sized and term.op == "+" and any(domain.facts(a).affine and not domain.constant(a) for a in term.args):
        return Term("+", tuple(_multiple(a, names, domain) or _freed(a, names, sized, domain) for a in term.args))
    return term._replace(args=tuple(_freed(a, names, sized, domain) for a in term.args))


def _sizes(term: Term, names: dict[Term, Term], domain: StatedDomain) -> Term | None:
    """The sum of c |z| for one of c r, which has nothing else left in it that depends on the forces."""
    if term.op != "+":
        return None
    found = list[Term]()
    for m, c in domain.polynomial(term).items():
        moving = [(x, n) for x, n in m if not domain.constant(x)]
        if moving and not (len(moving) == 1 and moving[0][1] == 1 and moving[0][0] in names):
            return None
        found.append(written({m: c}).put({root: Term("abs", (name,)) for root, name in names.items()}))
    return sum_of(*found)


def _multiple(term: Term, names: dict[Term, Term], domain: StatedDomain) -> Term | None:
    """c z where the term is c r."""
    parts = factors(term)
    if len([f for f in parts if not domain.constant(f)]) > 1 or not any(f in names for f in parts):
        return None
    return product_of(*(names.get(f, f) for f in parts))


# -- eigenvalues ---------------------------------------------------------------------------------------------------------


class _Matrix(NamedTuple):
    """By its entries, those of a diagonal matrix in order, and the names of its greatest and its least eigenvalue."""

    entries: tuple[Polynomial, ...]
    greatest: Term
    least: Term

    @property
    def middle(self) -> Term:
        return sum_of(written(total(*self.entries[:3])), minus(self.greatest), minus(self.least))


def freed_of_eigenvalues(term: Term, domain: StatedDomain) -> Iterator[Freed]:
    """The term with forces for the greatest and the least eigenvalue of each matrix in it."""
    matrices, free = _read(term, domain)
    names = [x.name for matrix in matrices for x in (matrix.greatest, matrix.least)]
    if 0 < len(matrices) <= _MOST_MATRICES and not {*names} & {*domain.law.forces}:
        swaps = [swap for m in matrices for swap in ({m.greatest: m.least, m.least: m.greatest}, {m.greatest: m.middle})]
        wider = domain.wider(*names)
        parts = dict((z, part) if z.op == "name" else (z.args[1], minus(part)) for part, z in free.items())
        for form in dict.fromkeys((term, _of_sizes(term, domain))):
            yield Freed(form.put(free), wider, parts, swaps)


def _of_sizes(term: Term, domain: StatedDomain) -> Term:
    """The term with powers of |y| for those of y >= 0: y may be < 0 where forces stand for eigenvalues."""
    if term.op in ("eigmax", "max", "min") or domain.constant(term):
        return term
    args = tuple(_of_sizes(a, domain) for a in term.args)
    if term.op == "**" and term.args[0].op != "abs" and domain.facts(term.args[0]).nonnegative:
        args = (Term("abs", args[:1]), args[1])
    return term if args == term.args else term._replace(args=args)


def _read(term: Term, domain: StatedDomain) -> tuple[list[_Matrix], dict[Term, Term]]:
    """The matrices of which the term has the greatest or the least eigenvalue, and the name that takes the place of each."""
    matrices, free = list[_Matrix](), dict[Term, Term]()
    for part in dict.fromkeys(extremes(term)):
        if domain.constant(part) or not all(domain.facts(a).affine and domain.facts(a).defined for a in part.args):
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
