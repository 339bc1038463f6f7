"""The boundary of K as the surface g = 0: whether it rises outward and curves inward, and which sums in a formula are convex.

If g < 0 at the origin and sigma . grad g > 0 wherever g = 0, each ray leaves K once, and K is convex if it is so near every
point of its boundary (Tietze 1928, Nakajima 1928): the second derivative of g along every tangent is >= 0 there.

That polynomial conditions exclude each other is shown by an identity (Stengle 1974, Math. Ann. 207, 87): a product of conditions h > 0,
plus sums of squares times products of conditions h >= 0, plus multiples of what is 0, cannot be 0 where all of them hold.  A sum of
squares is z' G z, G symmetric, positive semidefinite and of fractions.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from functools import reduce
from itertools import combinations
from math import lcm
from typing import Any

from duhem.proof.kernel.curvature import over, within_ranges
from duhem.proof.kernel.domain import ANY, NEGATIVE, POSITIVE, ZERO, Sign, StatedDomain, exact
from duhem.proof.kernel.forms import determinant, quadratic
from duhem.proof.kernel.pieces import CHOICES, below, chooses, pieces
from duhem.proof.kernel.polynomial import ONE, Polynomial, negated, slope, times, total, written
from duhem.proof.kernel.stated_law import StatedFace, StatedLaw
from duhem.proof.kernel.term import NotWritten, Term, minus, number, parse, product_of, sum_of

__all__ = [
    "curves_inward", "flows_along_normals", "flows_outward", "is_not_zero_at_its_centre", "is_steep", "rises_outward", "with_convex_sums",
]  # fmt: skip

Condition = tuple[Polynomial, str]  # and how it stands to 0: ">", ">=" or "=="
Identities = Sequence[Mapping[str, Any]]
_MOST_PRODUCTS = 4_000_000  # of terms, in a product of an identity
_GOAL, _BOUNDARY, _TANGENT = "the goal", "the boundary", "the tangent"  # no formulas: they name what is refuted, and given
_ENOUGH = {">": ((">",), POSITIVE), ">=": ((">", ">="), POSITIVE | ZERO), "==": (("==",), ZERO)}  # conditions, or signs


def rises_outward(law: StatedLaw, identities: Identities) -> bool:
    """Whether sigma . grad g > 0 wherever g = 0, on every piece of g."""
    return _dissipates(StatedFace(law.g, None), law.forces, identities, over(law))


def is_steep(law: StatedLaw, identities: Identities) -> bool:
    """Whether grad g != 0 wherever g = 0, on every piece of g: its square is > 0 there."""
    domain = over(law)

    def square(g: Term) -> Polynomial:
        return total(*(times(d, d) for d in (_along_axis(x, g, domain) for x in law.forces)))

    return all(shown(square(g), ">", _on_boundary(g, sides, domain), identities, domain) for g, sides in pieces(law.g, domain))


def is_not_zero_at_its_centre(law: StatedLaw) -> bool:
    """Whether a quadratic g has one centre, the only place where grad g = 0, and another value than 0 there.

    With g = x . A x + b . x + c that is the determinant of [[A, b/2], [b/2, c]] divided by that of A.
    """
    domain = over(law)
    matrix, row, rest = quadratic(law.g, law.forces, domain)
    half = [product_of(number(Fraction(1, 2)), b) for b in row]
    whole = [[*entries, b] for entries, b in zip(matrix, half, strict=True)] + [[*half, rest]]
    return all(domain.sign(written(determinant(own, domain))) in (NEGATIVE, POSITIVE) for own in (matrix, whole))


def flows_outward(law: StatedLaw, identities: Identities) -> bool:
    """Whether sigma . d >= 0 on every face, d being its own flow or, being associated, a gradient of its g, which then is not 0."""
    domain = within_ranges(law)
    return all(_dissipates(face, law.forces, identities, domain) for face in law.faces())


def flows_along_normals(law: StatedLaw, along: Identities, across: Identities) -> bool:
    """Whether each flow d is a positive multiple of every gradient of its g, on its face: d . grad g > 0, no component across.

    Then d . (tau - sigma) > 0 would make g rise from sigma towards tau; but g <= 0 on the way, K being convex.
    """
    domain = over(law)
    return all(_parallel(face, law.forces, along, across, domain) for face in law.faces() if face.flow is not None)


def _dissipates(face: StatedFace, forces: tuple[str, ...], identities: Identities, domain: StatedDomain) -> bool:
    if face.flow is None and face.power is None:
        return all(shown(_along(forces, g, domain), ">", given, identities, domain) for (g,), _, given in _on_face(face, (), domain))
    power = face.power or sum_of(*map(product_of, (Term("name", name=x) for x in forces), face.flow or ()))
    return domain.never_negative(power) or all(
        domain.where(dict.fromkeys(sides, False)).never_negative(smooth)
        or shown(domain.polynomial(smooth), ">=", given, identities, domain)
        for (_, smooth), sides, given in _on_face(face, (power,), domain)
    )


def _parallel(face: StatedFace, forces: tuple[str, ...], along: Identities, across: Identities, domain: StatedDomain) -> bool:
    for (g, *components), _, given in _on_face(face, face.flow or (), domain):
        gradient, d = [_along_axis(x, g, domain) for x in forces], list(map(domain.polynomial, components))
        if not shown(total(*map(times, d, gradient)), ">", given, along, domain):
            return False
        for i, j in combinations(range(len(forces)), 2):
            minor = total(times(d[i], gradient[j]), negated(times(d[j], gradient[i])))
            if minor and not all(shown(way, ">=", given, across, domain) for way in (minor, negated(minor))):
                return False
    return True


def _on_face(
    face: StatedFace, beside: Sequence[Term], domain: StatedDomain
) -> Iterator[tuple[tuple[Term, ...], tuple[Term, ...], dict[str, Condition]]]:
    """Smooth pieces of the face's g and of the formulas ``beside`` it, with what is >= 0 there, and what holds where it is the boundary."""
    inside = [minus(smaller) for other in face.others for smaller in below(other)]
    if any(chooses(g, domain) for g in (face.g, *face.others)):
        raise NotWritten("g may jump, and then K ends where no g is 0")
    for piece, sides in pieces(Term(",", (face.g, *beside)), domain, CHOICES):
        there = (*sides, *inside)
        yield piece.args, there, _on_boundary(piece.args[0], there, domain)


def curves_inward(law: StatedLaw, directions: Sequence[str], identities: Identities) -> bool:
    """Whether v . Hess g v >= 0 for every v with v . grad g = 0 wherever g = 0; ``directions`` are names for the components of v."""
    domain = _wider(law, directions)
    given = {**_on_boundary(law.g, (), domain), _TANGENT: (_along(directions, law.g, domain), "==")}
    return shown(_bend(directions, law.g, domain), ">=", given, identities, domain)


def with_convex_sums(law: StatedLaw, directions: Sequence[str], identities: Identities) -> StatedDomain:
    """The domain of the law, knowing which sums f in g are >= 0, and which are convex: v . Hess f v >= 0 for all v."""
    domain, wider = StatedDomain(law, over(law).rules), _wider(law, directions)  # its own: nobody else takes these as such
    for f in (part for part in law.g.parts() if part.op == "+"):
        known = domain.facts(f)
        with suppress(NotWritten):  # a sum with a kink, a root or a word
            if known.defined and not known.nonnegative and shown(wider.polynomial(f), ">=", {}, identities, wider):
                known = replace(known, sign=known.sign & ~NEGATIVE)
            if known.defined and not known.convex and shown(_bend(directions, f, wider), ">=", {}, identities, wider):
                known = replace(known, convex=True, quasiconvex=True)
        domain.known[f] = known
    return domain


def _along(v: Sequence[str], f: Term, domain: StatedDomain) -> Polynomial:
    """v . grad f; NotWritten where f is no polynomial in the forces."""
    return _derived(v, domain.polynomial(f), domain)


def _bend(v: Sequence[str], f: Term, domain: StatedDomain) -> Polynomial:
    """v . Hess f v."""
    return _derived(v, _along(v, f, domain), domain)


def _along_axis(x: str, f: Term, domain: StatedDomain) -> Polynomial:
    """The derivative of f by one force."""
    return slope(_differentiable(domain.polynomial(f), domain), Term("name", name=x))


def _differentiable(f: Polynomial, domain: StatedDomain) -> Polynomial:
    if any(x.op != "name" and not domain.constant(x) for m in f for x, _ in m):
        raise NotWritten("a kink, a root or a word of the forces has no slope here")
    return f


def _derived(v: Sequence[str], f: Polynomial, domain: StatedDomain) -> Polynomial:
    _differentiable(f, domain)
    forces = domain.law.forces[: len(v)]  # the components of v may follow them
    pairs = ((Term("name", name=x), Term("name", name=d)) for x, d in zip(forces, v, strict=True))
    return total(*(times({((d, 1),): Fraction(1)}, slope(f, x)) for x, d in pairs))


def _wider(law: StatedLaw, directions: Sequence[str]) -> StatedDomain:
    """The law's domain where the components of v may be any numbers too."""
    if not len({*directions}) == len(directions) == len(law.forces) or {*directions} & {*law.forces, *law.parameters, law.pressure, "pi"}:
        raise NotWritten("the directions have no names of their own")
    return over(law).wider(*directions)


def _on_boundary(g: Term, sides: Sequence[Term], domain: StatedDomain) -> dict[str, Condition]:
    """What holds where the piece g, whose ``sides`` are >= 0, is 0."""
    conditions = {f"side {i}": (domain.polynomial(side), ">=") for i, side in enumerate(sides)}
    return {_BOUNDARY: (domain.polynomial(g), "=="), **conditions}


# -- identities ----------------------------------------------------------------------------------------------------------


def shown(poly: Polynomial, sense: str, given: Mapping[str, Condition], identities: Identities, domain: StatedDomain) -> bool:
    """Whether some identity refutes that ``poly`` is not ``sense`` 0 (">" or ">=") somewhere in the domain where ``given`` holds."""
    against = (negated(poly), ">=" if sense == ">" else ">")
    for identity in identities:
        with suppress(NotWritten):  # it is about the conditions of another place
            if _refuted({**given, _GOAL: against}, identity, domain):
                return True
    return False


def _refuted(conditions: Mapping[str, Condition], identity: Mapping[str, Any], domain: StatedDomain) -> bool:
    """Whether the conditions cannot hold together anywhere in the domain, the identity being checked.

    It speaks of a condition by its name in ``conditions`` or by its formula; formulas whose sign the domain shows are
    conditions too.  ``strict`` lists those of the first product; each of ``sums`` those it is multiplied by (``times``), the
    formulas ``of`` its squares and their ``gram`` matrix; each of ``multiples`` what is 0 (``of``) and the formula ``by``
    which it is multiplied.
    """

    def condition(text: str, op: str) -> Polynomial:
        poly, sign = (conditions[text][0], ANY) if text in conditions else _read(text, domain)
        ops, signs = _ENOUGH[op]
        if not any(own == poly and stands in ops for own, stands in conditions.values()) and (not sign or sign & ~signs):
            raise NotWritten(f"{text} {op} 0 is no condition")
        return poly

    grams = list[list[list[Fraction]]]()
    parts = [_product(condition(text, ">") for text in identity["strict"])]
    for entry in identity["sums"]:
        grams.append([[exact(x) for x in row] for row in entry["gram"]])
        if {len(entry["of"])} != {len(grams[-1]), *map(len, grams[-1])}:
            return False
        form = _quadratic_form([_read(text, domain)[0] for text in entry["of"]], grams[-1])
        parts.append(_product((form, *(condition(text, ">=") for text in entry["times"]))))
    parts += [_product((condition(entry["of"], "=="), _read(entry["by"], domain)[0])) for entry in identity["multiples"]]
    return not total(*parts) and all(map(_positive_semidefinite, grams))


def _product(factors: Iterable[Polynomial]) -> Polynomial:
    return reduce(lambda one, two: times(one, two, _MOST_PRODUCTS), factors, ONE)


def _quadratic_form(squares: Sequence[Polynomial], gram: Sequence[Sequence[Fraction]]) -> Polynomial:
    """z' G z for the polynomials z."""
    rows = [total(*(times({(): g}, z) for g, z in zip(row, squares, strict=True) if g)) for row in gram]
    return total(*(_product(pair) for pair in zip(squares, rows, strict=True)))


def _read(text: str, domain: StatedDomain) -> tuple[Polynomial, Sign]:
    """A formula that is defined everywhere, and the signs it may have."""
    known = domain.facts(term := parse(text))
    if not known.defined:
        raise NotWritten(f"{text} is not defined everywhere")
    return domain.polynomial(term), known.sign


def _positive_semidefinite(gram: list[list[Fraction]]) -> bool:
    """By elimination, the greatest entry of the diagonal first: what is left in the end must be 0.

    In whole numbers: each step divides by the pivot before (Bareiss 1968, Math. Comp. 22, 565), which is > 0.
    """
    if gram != [list(column) for column in zip(*gram, strict=True)]:
        return False
    below, before = lcm(*(x.denominator for row in gram for x in row)), 1
    rows = [[x.numerator * (below // x.denominator) for x in row] for row in gram]
    while rows:
        k = max(range(len(rows)), key=lambda i: rows[i][i])
        if (pivot := rows[k][k]) <= 0:
            return not any(map(any, rows))
        left = [i for i in range(len(rows)) if i != k]
        rows = [[(pivot * rows[i][j] - rows[i][k] * rows[k][j]) // before for j in left] for i in left]
        before = pivot
    return True
