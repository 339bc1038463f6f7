"""The same law said more simply: as two laws, without a map of its formula that keeps the sign, about another zero, in principal stresses.

Where no force enters a choice, the law at each value of parameters and pressure is one of two laws, each where its condition holds.  A
claim is made at every such value: so it holds of the law if it holds of either, the condition being one constraint more.

Where phi(f) has the sign of f, {phi(f) <= 0} is {f <= 0}, with the same boundary.

K moved by a constant X is convex, or has a C^1 boundary, if and only if K is.

Let g(R sigma R^T) = g(sigma) for every rotation R, so that g is a symmetric function f of the principal stresses.  Then K is convex
if and only if {f <= 0} is (Davis 1957, Arch. Math. 8, 276: the principal stresses of a mean of two tensors are a mean of permutations
of the means of theirs); g is C^1 where f is (Lewis 1996, Math. Oper. Res. 21, 576, theorem 1.1); and a normal n of {f <= 0} at the
principal stresses is, along the same axes, one of K, with the same power sigma . n.  That g is invariant shows in its formula: every
part that is a polynomial of the components is, for its rate along two rotations, which generate all others, is 0; what is made of
invariant parts is; and so is the greatest eigenvalue of a matrix that turns with sigma.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from fractions import Fraction
from functools import partial
from itertools import permutations
from typing import NamedTuple

from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.definedness import AGAINST, in_quotients
from duhem.proof.kernel.domain import NEGATIVE, POSITIVE, ZERO, Bounds, StatedDomain
from duhem.proof.kernel.forms import degree_at_most
from duhem.proof.kernel.normal_form import normal
from duhem.proof.kernel.polynomial import Polynomial, divided, negated, shared, slope, solved, times, total, written
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.steps import pay
from duhem.proof.kernel.term import NotWritten, Term, factors, minus, number, sum_of

__all__ = ["about_its_centre", "cases", "in_principal_stresses", "normal_forms", "without_outer_map"]

_SIZE = Term("name", name="size of the inner formula")  # no name of a law has blanks
_LONGEST = 1_500  # parts of g


def normal_forms(law: StatedLaw) -> tuple[StatedLaw, ...]:
    """The law in its normal forms, what has no value somewhere beside g as written; none of these is the law as it was written.

    There are none of a very long g: each rule would work through it twice more.
    """
    if law.g.size() > _LONGEST:
        return ()
    domain, found = over(law), list[StatedLaw]()

    def beside(term: Term, collects: bool) -> Term:
        if domain.facts(term).defined:
            return normal(term, domain, collects)
        with suppress(NotWritten):  # a slip that is too long stays as it is, and g has its normal form all the same
            return in_quotients(term, domain)
        return term

    for collects in (False, True):
        with suppress(NotWritten):
            new = _rewritten(law, partial(normal, domain=domain, collects=collects), partial(beside, collects=collects))
            if new not in (law, *found):
                found.append(new)
    return tuple(found)


def _rewritten(law: StatedLaw, bound: Callable[[Term], Term], beside: Callable[[Term], Term]) -> StatedLaw:
    """The law with its formulas rewritten: what bounds K in one way, the slips, their potential and power in another."""

    def each(terms: tuple[Term, ...] | None) -> tuple[Term, ...] | None:
        return None if terms is None else tuple(map(beside, terms))

    return law._replace(
        g=bound(law.g),
        flow=each(law.flow),
        surfaces=tuple((bound(g), each(flow)) for g, flow in law.surfaces),
        potential=None if law.potential is None else beside(law.potential),
        power=None if law.power is None else beside(law.power),
    )


def cases(law: StatedLaw) -> tuple[StatedLaw, ...]:
    """The two laws that a choice leaves, none where every choice is by the forces."""
    written = (law.g, *(law.flow or ()), *(part for g, flow in law.surfaces for part in (g, *(flow or ()))))
    domain = over(law)
    for term in (*written, *([] if law.potential is None else [law.potential])):
        choice = _choice(term, domain)
        if choice is not None and domain.facts(choice.args[0]).defined:
            condition, *values = choice.args
            against = Term(AGAINST[condition.op], condition.args)
            ways = zip((partial(Term.put, swap={choice: value}) for value in values), (condition, against), strict=True)
            return tuple(_rewritten(law, put, put)._replace(constraints=(*law.constraints, holds)) for put, holds in ways)
    return ()


def _choice(term: Term, domain: StatedDomain) -> Term | None:
    """A choice whose condition has no other choice in it and no force, and is open."""
    within = next((found for a in term.args if (found := _choice(a, domain)) is not None), None)
    is_open = term.op == "where" and domain.constant(term.args[0]) and domain.decided(term.args[0]) is None
    return within or (term if is_open else None)


def without_outer_map(law: StatedLaw) -> StatedLaw:
    """The law with the innermost formula that has the sign of g wherever it is defined; g is defined there too."""
    domain = over(law._replace(parameters={**law.parameters, _SIZE.name: Bounds(Fraction(0), None, True)}))
    g: Term | None = law.g
    while g is not None:
        law = law._replace(g=g)
        outer_first = dict.fromkeys(reversed([*g.parts()][:-1]))
        g = _without_positive_factors(g, domain) or next((f for f in outer_first if _keeps_sign(g, f, domain)), None)
    return law


def _without_positive_factors(g: Term, domain: StatedDomain) -> Term | None:
    known = [(f, domain.facts(f)) for f in factors(g)]
    left = [f for f, shown in known if not (shown.defined and shown.sign == POSITIVE)]
    return left[0] if len(left) == 1 < len(known) else None


def _keeps_sign(g: Term, f: Term, domain: StatedDomain) -> bool:
    """Whether g is a formula in f alone that is defined, and > 0, = 0, < 0 where f is."""
    ways = ((number(0), ZERO), (_SIZE, POSITIVE), (minus(_SIZE), NEGATIVE))
    if domain.constant(f) or not _alone(g, f, domain):
        return False
    return all(domain.facts(g.put({f: x})).defined and domain.facts(g.put({f: x})).sign == sign for x, sign in ways)


def _alone(g: Term, f: Term, domain: StatedDomain) -> bool:
    """Whether the forces enter g by f alone."""
    pay(1)
    return g == f or domain.constant(g) or (g.op != "name" and all(_alone(a, f, domain) for a in g.args))


# -- about another zero -----------------------------------------------------------------------------------------------


def about_its_centre(law: StatedLaw) -> StatedLaw:
    """The law of sigma - X where the sums of forces times numbers in g are all 0 at one X that is not 0; any other law as it is."""
    domain, rows = over(law), list[tuple[dict[Term, Fraction], Polynomial]]()
    if law.surfaces or any(name in law.forces for name, _ in law.ranges):
        return law
    for part in dict.fromkeys(law.g.parts()):
        if _is_affine(part, domain):
            poly = divided(own := domain.polynomial(part), shared(own, domain.constant))
            moving = {m: c for m, c in poly.items() if any(x.name in law.forces for x, _ in m)}
            if any(len(m) > 1 for m in moving):
                continue  # a parameter scales a force
            rows.append(({m[0][0]: c for m, c in moving.items()}, {m: -c for m, c in poly.items() if m not in moving}))
    centre = solved(rows) or {}
    swap = {x: sum_of(x, written(value)) for x, value in centre.items() if value}

    def moved(term: Term) -> Term:
        if _is_affine(term, domain):
            return written(domain.polynomial(term.put(swap)))
        return swap.get(term, term) if not term.args else term._replace(args=tuple(map(moved, term.args)))

    return law._replace(g=moved(law.g)) if swap else law


def _is_affine(part: Term, domain: StatedDomain) -> bool:
    """Whether it is a sum of multiples of the forces and constants, all of which have a value."""
    return part.op == "+" and degree_at_most(part, domain) == 1 and domain.facts(part).defined


# -- in principal stresses ---------------------------------------------------------------------------------------------


Matrix = Sequence[Polynomial]  # xx, yy, zz, yz, xz, xy
_AXES = ((0, 1), (1, 2))  # z and x, by the planes that turn
_AT = ((0, 5, 4), (5, 1, 3), (4, 3, 2))  # where an entry of the matrix stands in that list


def in_principal_stresses(law: StatedLaw) -> StatedLaw | None:
    """The law with its shear components 0, if the others are normal components of an isotropic law; None for any other law."""
    if len(law.forces) != 6 or not law.associated or any(name in law.forces for name, _ in law.ranges):
        return None
    domain, names = over(law), [Term("name", name=x) for x in law.forces]
    for shear in permutations(names[3:]):
        tensor = _Components(domain, (*names[:3], *shear))
        if tensor.invariant(law.g):
            swap = dict.fromkeys(shear, number(0))
            surfaces = tuple((_diagonal(g, swap, domain), None) for g, _ in law.surfaces)
            return law._replace(forces=law.forces[:3], g=_diagonal(law.g, swap, domain), surfaces=surfaces)
    return None


class _Components(NamedTuple):
    """The components xx, yy, zz, yz, xz, xy of a symmetric tensor."""

    domain: StatedDomain
    components: tuple[Term, ...]

    def invariant(self, term: Term) -> bool:
        """Whether the formula shows that turning the tensor changes neither its value nor whether it is defined."""
        if term.op == "eigmax":
            return self._turns(term.args)
        if term.op not in ("+", "*"):
            poly = self._polynomial(term)
            return not self._rates(poly) if poly is not None else all(map(self.invariant, term.args))
        known = [(a, self._polynomial(a)) for a in term.args]
        together = Term(term.op, tuple(a for a, poly in known if poly is not None))
        return not self._rates(self.domain.polynomial(together)) and all(self.invariant(a) for a, poly in known if poly is None)

    def _polynomial(self, term: Term) -> Polynomial | None:
        """Of the components, with constants for coefficients; None where it is none as it is written."""
        return None if degree_at_most(term, self.domain) is None else self.domain.polynomial(term)

    def _rates(self, poly: Polynomial) -> list[Polynomial]:
        """How fast it changes about the axes z and x, where it does."""
        return [rate for i, j in _AXES if (rate := self._rate(poly, i, j))]

    def _turns(self, entries: Sequence[Term]) -> bool:
        """Whether a matrix of polynomials turns with the tensor."""
        found = [self._polynomial(a) for a in entries]
        matrix = [poly for poly in found if poly is not None]
        if len(matrix) < len(found):
            return False
        return all([self._rate(poly, i, j) for poly in matrix] == _turned(matrix, i, j) for i, j in _AXES)

    def _rate(self, poly: Polynomial, i: int, j: int) -> Polynomial:
        """How fast it changes while the tensor turns in the plane of i and j."""
        rates = _turned([self.domain.polynomial(x) for x in self.components], i, j)
        return total(*(times(slope(poly, x), rate) for x, rate in zip(self.components, rates, strict=True)))


def _turned(matrix: Matrix, i: int, j: int) -> list[Polynomial]:
    """The rate W S - S W of a symmetric matrix S, with W_ji = 1 = -W_ij: i and j turn in their plane."""

    def entry(a: int, b: int) -> Polynomial:
        left = matrix[_AT[i][b]] if a == j else negated(matrix[_AT[j][b]]) if a == i else {}
        right = matrix[_AT[a][j]] if b == i else negated(matrix[_AT[a][i]]) if b == j else {}
        return total(left, negated(right))

    return [entry(a, b) for a, b in ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))]


def _diagonal(term: Term, swap: dict[Term, Term], domain: StatedDomain) -> Term:
    """The formula where the tensor is diagonal; a matrix that turns with it then has its entries for eigenvalues."""
    matrices = [part for part in term.parts() if part.op == "eigmax" and not domain.constant(part)]  # none stands within another
    return term.put({m: Term("max", m.args[:3]) for m in matrices}).put(swap)
