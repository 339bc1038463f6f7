"""Roots of which a formula is an even function: f(u - r) + f(u + r) with f convex, u affine and r >= 0 convex.

Let G(x, z) be quasiconvex in both together and even in every z_i.  Then it does not fall where z_i >= 0 grows, since z_i lies
between -z_i' and z_i' for every z_i' above it; so G(x, r(x)) is quasiconvex where all r_i are convex and >= 0, and convex where
G is.  The symmetric functions of the eigenvalues u - r, u + r of a tensor in the plane are such (Davis 1957, Arch. Math. 8, 276;
Lewis 1996, SIAM J. Optim. 6, 164).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from typing import NamedTuple

from duhem.proof.kernel.alike import alike
from duhem.proof.kernel.domain import StatedDomain, StatedLaw
from duhem.proof.kernel.polynomial import written
from duhem.proof.kernel.shape import Facts, Shown
from duhem.proof.kernel.term import NotWritten, Term, factors, minus, number, product_of, sum_of

__all__ = ["FreedOfRoots", "freed_of_roots", "quasiconvex_in_even_parts"]

_MOST_ROOTS = 8


def quasiconvex_in_even_parts(term: Term, domain: StatedDomain, shown: Shown, over: Callable[[StatedLaw], StatedDomain]) -> Facts | None:
    """What is shown of the term with further forces in the place of its roots; None if that is not even in them, or not quasiconvex."""
    with suppress(NotWritten):
        for freed in freed_of_roots(term, domain, shown, over):
            known = shown(freed.term, freed.domain)
            if known.defined and known.quasiconvex and freed.even():
                return known
    return None


class FreedOfRoots(NamedTuple):
    """A ``term`` of a wider ``domain``: with forces that may be any numbers in the place of ``roots``, which are convex and >= 0."""

    term: Term
    domain: StatedDomain
    roots: Mapping[Term, Term]

    def even(self) -> bool:
        """Whether it is even in each of these forces."""
        return all(alike(self.term.put({z: minus(z)}), self.term, self.domain) for z in self.roots)


def freed_of_roots(term: Term, domain: StatedDomain, shown: Shown, over: Callable[[StatedLaw], StatedDomain]) -> Iterator[FreedOfRoots]:
    """The term with a force z for each of its outermost roots; then with |z| where no affine part is added."""
    roots = list(dict.fromkeys(root for part in term.args for root in _roots(part, domain, shown)))
    if not 0 < len(roots) <= _MOST_ROOTS:
        return
    names = [f"root {i}" for i in range(len(roots))]  # no name of a law has blanks
    while {*names} & {*domain.law.forces}:
        names = [f"{name} inside" for name in names]
    wider = over(domain.law._replace(forces=(*domain.law.forces, *names)))
    free = {root: Term("name", name=name) for root, name in zip(roots, names, strict=True)}
    for sized in (False, True):
        yield FreedOfRoots(_freed(term, free, sized, domain, shown), wider, {z: root for root, z in free.items()})


def _roots(term: Term, domain: StatedDomain, shown: Shown) -> Iterator[Term]:
    """The outermost roots and norms that are convex, and >= 0."""
    rooted = term.op == "**" and term.args[1].op == "number" and 0 < term.args[1].value < 1
    if (rooted or term.op == "norm") and not domain.constant(term):
        known = shown(term, domain)
        if known.defined and known.convex and known.nonnegative and not known.affine:
            yield term
            return
    for a in term.args:
        yield from _roots(a, domain, shown)


def _freed(term: Term, names: dict[Term, Term], sized: bool, domain: StatedDomain, shown: Shown) -> Term:
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
    if sized and term.op == "+" and any(shown(a, domain).affine and not domain.constant(a) for a in term.args):
        return Term("+", tuple(_multiple(a, names, domain) or _freed(a, names, sized, domain, shown) for a in term.args))
    return term._replace(args=tuple(_freed(a, names, sized, domain, shown) for a in term.args))


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
