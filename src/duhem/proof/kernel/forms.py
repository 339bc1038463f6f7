"""The coefficients of affine and quadratic formulas, sums of squares, and loads: multiples of one another, and where they are >= 0."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import combinations

from duhem.proof.kernel.bounds import Facts, signs_of_product
from duhem.proof.kernel.constant_value import BOUNDED, ordered, span
from duhem.proof.kernel.domain import ANY, NEGATIVE, POSITIVE, ZERO, Sign, StatedDomain
from duhem.proof.kernel.polynomial import (
    ONE,
    Monomial,
    Polynomial,
    divided,
    grouped,
    in_powers,
    negated,
    plainly,
    quotient,
    replaced,
    scaled,
    times,
    total,
    written,
)
from duhem.proof.kernel.stated_law import as_object
from duhem.proof.kernel.term import NotWritten, Term, factors, number, parse, product_of

__all__ = [
    "Matrix", "Row", "affine", "apart", "at", "at_end_of", "by_forces", "degree_at_most", "determinant", "inverse", "leading_minors",
    "multiple", "of_load", "place_of", "principal_minors", "quadratic", "share_and_rest", "sign_within", "sum_of_squares",
]  # fmt: skip

Row = Sequence[Term]
Matrix = Sequence[Row]
_UNIT = Term("name", name="the unit")  # no name of a law has blanks


def at(term: Term, names: Sequence[str], values: Sequence[Term]) -> Term:
    """A term with values in the place of names."""
    return term.put({Term("name", name=n): v for n, v in zip(names, values, strict=True)})


def place_of(given: object, domain: StatedDomain) -> dict[Term, Term]:
    """The forces at a place, given by constants; one that is not named is 0.  NotWritten where a constant has no value."""
    told = as_object(given)
    place = {Term("name", name=f): parse(told.get(f, "0")) for f in domain.law.forces}
    if not all(domain.constant(x) and domain.facts(x).defined for x in place.values()):
        raise NotWritten("a place is none")
    return place


def apart(term: Term, domain: StatedDomain) -> tuple[Term, list[Term]]:
    """The constants in a product, as their product, and its other factors."""
    parts = factors(term)
    return product_of(*(f for f in parts if domain.constant(f))), [f for f in parts if not domain.constant(f)]


def inverse(term: Term, domain: StatedDomain) -> Term | None:
    """y/c for c/y, c > 0, y not constant: both have a value > 0 where y > 0; None for anything else."""
    c, moving = apart(term, domain)
    below = all(f.op == "**" and f.args[1].op == "number" and f.args[1].value < 0 for f in moving)
    if not moving or not below or domain.facts(c).sign != POSITIVE:
        return None
    turned = (f.args[0] if f.args[1].value == -1 else Term("**", (f.args[0], number(-f.args[1].value))) for f in moving)
    return product_of(Term("**", (c, number(-1))), *turned)


def degree_at_most(term: Term, domain: StatedDomain) -> int | None:
    """A bound on the degree of a polynomial in the forces, as it is written; None for what is no polynomial as it is written."""
    if domain.constant(term):
        return 0
    if term.op == "name":
        return 1
    if term.op == "**":
        n, inner = term.args[1], term.args[0]
        if inner.op in ("abs", "norm") and n == number(2):
            inner = Term("+", inner.args)  # the sum of the squares is of no higher degree than that of this
        base = degree_at_most(inner, domain)
        whole = n.op == "number" and n.value.denominator == 1 and n.value > 0
        return base * int(n.value) if whole and base is not None else None
    degrees = [degree_at_most(a, domain) for a in term.args] if term.op in ("+", "*") else [None]
    known = [k for k in degrees if k is not None]
    if len(known) < len(degrees):
        return None
    return max(known) if term.op == "+" else sum(known)


def affine(term: Term, names: Sequence[str], domain: StatedDomain) -> tuple[Row, Term]:
    """(b, c) with b . x + c = term; NotWritten where it is not of that form."""
    matrix, row, constant = quadratic(term, names, domain)
    if any(domain.polynomial(entry) for line in matrix for entry in line):
        raise NotWritten("a formula is not affine")
    return row, constant


def quadratic(term: Term, names: Sequence[str], domain: StatedDomain) -> tuple[Matrix, Row, Term]:
    """(A, b, c) with x . A x + b . x + c = term, A symmetric; NotWritten where it is not of that form."""
    parts: dict[tuple[int, ...], Polynomial] = {}
    for moving, part in grouped(domain.polynomial(term), lambda x: bool(x.names() & {*names})).items():
        if any(x.op != "name" or n < 0 for x, n in moving) or sum(n for _, n in moving) > 2:
            raise NotWritten("a formula is not quadratic")
        parts[tuple(sorted(names.index(x.name) for x, n in moving for _ in range(n)))] = part
    half, n = Fraction(1, 2), range(len(names))
    entries = {(i, j): times({(): half if i < j else Fraction(1)}, parts.get((i, j), {})) for i in n for j in n if i <= j}
    matrix = [[written(entries[min(i, j), max(i, j)]) for j in n] for i in n]
    return matrix, [written(parts.get((i,), {})) for i in n], written(parts.get((), {}))


def determinant(matrix: Matrix, domain: StatedDomain) -> Polynomial:
    """The last leading minor; 1 of no rows."""
    return [ONE, *leading_minors(matrix, domain)][-1]


def principal_minors(matrix: Matrix, domain: StatedDomain, most: int | None = None) -> Iterator[tuple[tuple[int, ...], Polynomial]]:
    """The determinants of what the same rows and columns have in common, of so many rows at most, the smaller first."""
    for size in range(1, min(most or len(matrix), len(matrix)) + 1):
        for rows in combinations(range(len(matrix)), size):
            yield rows, determinant([[matrix[i][j] for j in rows] for i in rows], domain)


def leading_minors(matrix: Matrix, domain: StatedDomain) -> Iterator[Polynomial]:
    """The determinants of the first rows and columns, each by its last row from those of the rows before, for all sets of columns."""
    known: dict[tuple[int, ...], Polynomial] = {(): ONE}
    for k, row in enumerate(matrix):
        entries, before, known = [domain.polynomial(entry) for entry in row], known, {}
        for some in combinations(range(len(matrix)), k + 1):
            parts = ((Fraction((-1) ** (k + i)), entries[j], before[(*some[:i], *some[i + 1 :])]) for i, j in enumerate(some))
            known[some] = total(*(times(times({(): sign}, entry), minor) for sign, entry, minor in parts))
        yield known[tuple(range(k + 1))]


# -- loads ---------------------------------------------------------------------------------------------------------------


def multiple(rest: Polynomial, x: Polynomial, domain: StatedDomain) -> Polynomial | None:
    """The constant c where rest = c x; None where none is found.

    It is read off a part of x whose coefficient is a number or a product of constants that are not 0, or else found by division.
    """
    if not rest:
        return {}
    if by_forces(rest, domain).keys() != by_forces(x, domain).keys():
        return None
    split = share_and_rest(rest, x, domain)
    if split is not None:
        return None if split[1] else split[0]
    found = quotient(rest, x) if x else None
    return found if found is not None and all(domain.constant(y) for m in found for y, _ in m) else None


def _pivot(x: Polynomial, domain: StatedDomain) -> tuple[Monomial, Polynomial] | None:
    """A part of x that the forces enter, and the inverse of its coefficient, which is a number or a product of constants that are not 0."""
    for moving, c in by_forces(x, domain).items():
        if moving and len(c) == 1 and all(not domain.of(y) & ZERO for m in c for y, _ in m):
            ((m, factor),) = c.items()
            return moving, divided(ONE, m, factor)
    return None


def by_forces(poly: Polynomial, domain: StatedDomain) -> dict[Monomial, Polynomial]:
    """The coefficients of what depends on the forces."""
    return grouped(poly, lambda x: not domain.constant(x))


def sign_within(term: Term, known: Facts, domain: StatedDomain) -> Sign:
    """The signs that what is >= 0 in the domain leaves: of a multiple of that and a constant; of a concave term that depends on one load
    alone and is >= 0 at both of its ends, no sign < 0; those of a difference of two values of a word that rises, or falls; of a sum those
    of it times what it divides by and is > 0, and those that a word in it leaves which lies between two numbers.
    """
    try:
        found = _of_multiple(term, domain) & _of_one_word(term, domain)
        if term.op == "+" and found & known.sign not in (NEGATIVE, ZERO, POSITIVE):
            found &= _without_divisors(term, domain) & _of_bounded_words(term, domain)
        below = found & known.sign & NEGATIVE and known.concave
        ends = ((x, y) for x in domain.sides for y in domain.sides) if below else ()
        return found & ~NEGATIVE if any(_above_at_both_ends(term, *both, domain) for both in ends) else found
    except NotWritten:
        return ANY


def _of_multiple(term: Term, domain: StatedDomain) -> Sign:
    found, poly = ANY, domain.polynomial(term)
    for side, strict in domain.sides.items():
        if (split := share_and_rest(poly, domain.polynomial(side), domain)) is None:
            continue
        way, left = (domain.facts(written(part)).sign for part in split)
        for sign, opposite in ((POSITIVE, NEGATIVE), (NEGATIVE, POSITIVE)):
            if not (way | left) & opposite:
                found &= sign if left == sign or (strict and way == sign) else ZERO | sign
    return found


def _of_one_word(term: Term, domain: StatedDomain) -> Sign:
    """Of c f(x) - c f(y), with one word f: what the order of f(x) and f(y) leaves."""
    found = grouped(domain.polynomial(term), lambda x: len(x.args) == 1 and not domain.constant(x)) if term.op == "+" else {}
    if len(found) != 2 or total(*found.values()) or any([n for _, n in m] != [1] for m in found):
        return ANY
    for gap, strict in ordered([x for ((x, _),) in found], lambda x: domain.facts(written(domain.polynomial(x))).sign):
        greater = max(gap, key=lambda m: gap[m])
        return signs_of_product(POSITIVE if strict else POSITIVE | ZERO, domain.facts(written(found[greater])).sign)
    return ANY


def _without_divisors(term: Term, domain: StatedDomain) -> Sign:
    """Of a sum times what it divides by and is > 0."""
    poly = domain.polynomial(term)
    whole = domain.without_quotients(poly) if any(x.op == "**" and not domain.constant(x) for m in poly for x, _ in m) else poly
    return ANY if whole is poly else domain.facts(written(whole)).sign


def _of_bounded_words(term: Term, domain: StatedDomain) -> Sign:
    """Of c f(x) + d, where f(x) lies between two numbers: what it is at both leaves."""
    poly = domain.polynomial(term)
    for x in sorted({x for m in poly for x, _ in m if x.op in BOUNDED and not domain.constant(x)}):
        own = span(x, domain.sign, {})
        if own.low is not None and own.high is not None and {n for m in poly for y, n in m if y == x} == {1}:
            ends = [domain.facts(written(replaced(poly, x, {(): end} if end else {}))).sign for end in (own.low, own.high)]
            both = ends[0] | ends[1]
            return ANY if both & NEGATIVE and both & POSITIVE else both
    return ANY


def share_and_rest(poly: Polynomial, load: Polynomial, domain: StatedDomain) -> tuple[Polynomial, Polynomial] | None:
    """(c, d) with poly = c load + d, both constant and c not plainly 0."""
    if (pivot := _pivot(load, domain)) is None or not (share := times(by_forces(poly, domain).get(pivot[0], {}), pivot[1])):
        return None
    rest = total(poly, negated(times(share, load)))
    return None if any(not domain.constant(x) for m in rest for x, _ in m) else (share, rest)


def at_end_of(load: Term, term: Term, domain: StatedDomain) -> Term:
    """The constant that a term is where a load is 0; NotWritten where the forces enter it by more than that load."""
    known = domain.polynomial(load)
    if not of_load(term, known, domain):
        raise NotWritten("the forces enter by more than one load")
    return term.put(_zero(known, domain))


def _above_at_both_ends(term: Term, side: Term, other: Term, domain: StatedDomain) -> bool:
    """Whether a term that depends on the load ``side`` alone is >= 0 where that is 0, and at its other end, where ``other`` is.

    It is concave where all loads are >= 0 and perhaps nowhere else: so they are asked for at both ends, and hold between them.
    """
    if not all(_is_load(domain.polynomial(x), domain) for x in domain.sides):
        return False
    load, end = domain.polynomial(side), domain.polynomial(other)
    split = share_and_rest(end, load, domain)
    if split is None or domain.facts(written(split[0])).sign != NEGATIVE or not of_load(term, load, domain):
        return False
    ends = [_zero(x, domain) for x in (load, end)]
    values = [domain.facts(part.put(place)) for part in (*domain.sides, term) for place in ends]
    return all(here.defined and here.nonnegative for here in values)


def _is_load(poly: Polynomial, domain: StatedDomain) -> bool:
    """Whether each force enters by multiples of it."""
    moving = [[(x, n) for x, n in m if not domain.constant(x)] for m in poly]
    return all(not m or ([n for _, n in m] == [1] and m[0][0].op == "name") for m in moving)


def of_load(term: Term, load: Polynomial, domain: StatedDomain) -> bool:
    """Whether the forces enter a term through multiples of a load and constants alone."""
    if domain.constant(term):
        return True
    if term.op in ("+", "*", "name") and share_and_rest(domain.polynomial(term), load, domain) is not None:
        return True
    others = [a for a in term.args if not of_load(a, load, domain)]
    if term.op == "+" and 0 < len(others) < len(term.args):  # the load may stand in it force by force
        return of_load(Term("+", tuple(others)), load, domain)
    return term.op != "name" and not others


def _zero(load: Polynomial, domain: StatedDomain) -> dict[Term, Term]:
    """Forces at which a load is 0: all but one of them 0."""
    if not _is_load(load, domain) or (pivot := _pivot(load, domain)) is None:
        raise NotWritten("what is >= 0 is no load, or has no force with a coefficient that is not 0")
    place = negated(times(pivot[1], by_forces(load, domain).get((), {})))
    return {**{Term("name", name=f): number(0) for f in domain.law.forces}, pivot[0][0][0]: written(place)}


# -- sums of squares ------------------------------------------------------------------------------------------------------


def sum_of_squares(poly: Polynomial, domain: StatedDomain) -> list[tuple[Term, Polynomial]] | None:
    """Products of constants >= 0, each with a polynomial times whose square it is, added up; None where none are found.

    By Lagrange's reduction (1759): a x^2 + b x + c is a (x + b/(2 a))^2 + c - b^2/(4 a), and x is gone from the rest.
    """
    return _by_products(poly, domain) or _by_one_force_after_another(poly, domain)


def _by_one_force_after_another(poly: Polynomial, domain: StatedDomain) -> list[tuple[Term, Polynomial]] | None:
    """Where one product of constants stands with the square of each force, and divides what stands with twice that force."""
    found, left = list[tuple[Term, Polynomial]](), poly
    for x in sorted({x for m in poly for x, _ in m if not domain.constant(x)}):
        if not any(x in dict(m) for m in left):
            continue
        if x.op != "name" or any(dict(m).get(x, 0) < 0 for m in left) or len(powers := in_powers(left, x)) != 3 or len(powers[2]) != 1:
            return None
        scale, whole = plainly(powers[2]), _completed(x, powers)
        if not domain.constant(scale) or domain.facts(scale).sign & NEGATIVE:
            return None
        if any(n < 0 and domain.of(y) & ZERO for m in whole for y, n in m):
            return None
        found.append((scale, whole))
        left = total(left, negated(times(powers[2], times(whole, whole))))
    return None if left else found


def _by_products(poly: Polynomial, domain: StatedDomain) -> list[tuple[Term, Polynomial]] | None:
    """For each product of constants, of what it multiplies: a form of second degree with numbers as coefficients.

    Its variables are the forces, the constants that stand once beside a force, and 1.
    """
    beside = {x for m in poly if sum(n for y, n in m if not domain.constant(y)) == 1 for x, n in m if domain.constant(x) and n == 1}
    groups: dict[Monomial, Polynomial] = {}
    for m, a in sorted(poly.items()):
        own = tuple((x, n) for x, n in m if x in beside or not domain.constant(x))
        if any(n < 0 for _, n in own) or (degree := sum(n for _, n in own)) > 2:
            return None
        own = tuple(sorted([*own, (_UNIT, 2 - degree)])) if degree < 2 else own
        groups.setdefault(tuple((x, n) for x, n in m if (x, n) not in own), {})[own] = a
    found = list[tuple[Term, Polynomial]]()
    for scale, form in groups.items():
        if domain.facts(plainly({scale: Fraction(1)})).sign & NEGATIVE:
            return None
        while form:
            x = next((x for m, a in sorted(form.items()) for x, n in m if n == 2 and a > 0), None)
            if x is None:
                return None
            powers = in_powers(form, x)
            whole = _completed(x, powers)
            found.append((scaled(number(powers[2][()]), scale), {tuple(y for y in m if y[0] != _UNIT): b for m, b in whole.items()}))
            form = total(form, negated(times(powers[2], times(whole, whole))))
    return found


def _completed(x: Term, powers: list[Polynomial]) -> Polynomial:
    """y = x + b/(2 a), where a y^2 is all of a x^2 + b x + c that x enters; a is one term."""
    ((m, a),) = powers[2].items()
    return total({((x, 1),): Fraction(1)}, divided(powers[1], m, 2 * a))
