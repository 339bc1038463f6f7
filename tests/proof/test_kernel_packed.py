"""Packed polynomials: sums and products as with fractions, and no two monomials in one number."""

from __future__ import annotations

from fractions import Fraction
from random import Random

import pytest

from duhem.proof.kernel.packed import Packing, is_zero_sum, product, quadratic_form
from duhem.proof.kernel.polynomial import Polynomial, times, total
from duhem.proof.kernel.refutation import _positive_semidefinite
from duhem.proof.kernel.term import NotWritten, Term

NAMES = [Term("name", name=n) for n in "xyz"]


def drawn(random: Random) -> Polynomial:
    """A few terms, negative powers among them."""
    parts = []
    for _ in range(random.randint(1, 4)):
        powers = [(x, random.randint(-3, 3)) for x in NAMES]
        parts.append({tuple((x, n) for x, n in powers if n): Fraction(random.randint(-9, 9), random.randint(1, 9))})
    return total(*parts)


def test_sums_and_products() -> None:
    random = Random(3)
    for _ in range(200):
        p, q, r = (drawn(random) for _ in range(3))
        packing = Packing()
        whole = total(times(times(p, q), r), times({(): Fraction(-1)}, p))
        parts = [product([packing.of(x) for x in (p, q, r)]), product([packing.of({(): Fraction(-1)}), packing.of(p)])]
        assert is_zero_sum([*parts, packing.of(times({(): Fraction(-1)}, whole))])
        assert is_zero_sum(parts) == (not whole)
        off = total(whole, {((NAMES[0], 1),): Fraction(1, 10**30)})
        assert not is_zero_sum([*parts, packing.of(times({(): Fraction(-1)}, off))])


def test_quadratic_forms() -> None:
    random = Random(4)
    for _ in range(50):
        z = [drawn(random) for _ in range(3)]
        gram = [[Fraction(random.randint(-9, 9), random.randint(1, 9)) for _ in z] for _ in z]
        wanted = total(*(times(times({(): g}, a), b) for a, row in zip(z, gram, strict=True) for b, g in zip(z, row, strict=True)))
        packing = Packing()
        form = quadratic_form([packing.of(p) for p in z], gram)
        assert is_zero_sum([form, packing.of(times({(): Fraction(-1)}, wanted))])


def test_what_would_not_fit_is_refused() -> None:
    """A power so high that two monomials could have one number."""
    with pytest.raises(NotWritten):
        Packing().of({((NAMES[0], 2**12 + 1),): Fraction(1)})
    with pytest.raises(NotWritten):
        product([Packing().of({((NAMES[0], 1),): Fraction(1)})] * 65)
    with pytest.raises(NotWritten):
        Packing().of({(): Fraction(1, 2 ** (2**16))})


def test_semidefinite_matrices() -> None:
    """Squares of matrices are, of any rank; a little less than that is not; nor is what is not symmetric."""
    random = Random(5)
    for _ in range(60):
        n, rank = random.randint(1, 5), random.randint(0, 4)
        factor = [[Fraction(random.randint(-5, 5), random.randint(1, 4)) for _ in range(rank)] for _ in range(n)]
        gram = [[sum((a * b for a, b in zip(r, s, strict=True)), Fraction(0)) for s in factor] for r in factor]
        assert _positive_semidefinite(gram)
        if rank < n:
            less = [[x - (i == j) * Fraction(1, 10**12) for j, x in enumerate(row)] for i, row in enumerate(gram)]
            assert not _positive_semidefinite(less)
        if n > 1:
            gram[0][1] += Fraction(1, 10**12)
            assert not _positive_semidefinite(gram)
