"""What an identity is made of: products, quadratic forms, semidefinite matrices; each exactly so."""

from __future__ import annotations

from fractions import Fraction
from random import Random

import pytest

from duhem.proof.kernel.boundary import _positive_semidefinite, _product, _quadratic_form
from duhem.proof.kernel.polynomial import Polynomial, times, total
from duhem.proof.kernel.term import NotWritten, Term
from duhem.proof.search.identities import _positive_semidefinite as found_semidefinite

NAMES = [Term("name", name=n) for n in "xyz"]


def drawn(random: Random) -> Polynomial:
    """A few terms, negative powers among them."""
    parts = []
    for _ in range(random.randint(1, 4)):
        powers = [(x, random.randint(-3, 3)) for x in NAMES]
        parts.append({tuple((x, n) for x, n in powers if n): Fraction(random.randint(-9, 9), random.randint(1, 9))})
    return total(*parts)


def test_products() -> None:
    random = Random(3)
    for _ in range(50):
        p, q, r = (drawn(random) for _ in range(3))
        assert _product((p, q, r)) == times(times(p, q), r) and _product(()) == {(): Fraction(1)}


def test_what_is_too_long_is_refused() -> None:
    long = {((NAMES[0], i),): Fraction(1) for i in range(1, 2100)}
    for factors in ((long, long), ({(): Fraction(2**5000)}, {(): Fraction(2**5000)})):
        with pytest.raises(NotWritten):
            _product(factors)


def test_quadratic_forms() -> None:
    random = Random(4)
    for _ in range(50):
        z = [drawn(random) for _ in range(3)]
        gram = [[Fraction(random.randint(-9, 9), random.randint(1, 9)) for _ in z] for _ in z]
        wanted = total(*(times(times({(): g}, a), b) for a, row in zip(z, gram, strict=True) for b, g in zip(z, row, strict=True)))
        assert _quadratic_form(z, gram) == wanted
    for ragged in ([[Fraction(1)]], [[Fraction(1)], [Fraction(1)]], [[Fraction(1)] * 2, [Fraction(1)] * 3], [[Fraction(1)] * 2] * 3):
        with pytest.raises(ValueError, match="zip"):
            _quadratic_form(z[:2], ragged)


def test_semidefinite_matrices() -> None:
    """Squares of matrices are, of any rank; a little less than that is not; nor is what is not symmetric."""
    random = Random(5)
    for _ in range(60):
        n, rank = random.randint(1, 5), random.randint(0, 4)
        factor = [[Fraction(random.randint(-5, 5), random.randint(1, 4)) for _ in range(rank)] for _ in range(n)]
        gram = [[sum((a * b for a, b in zip(r, s, strict=True)), Fraction(0)) for s in factor] for r in factor]
        assert _positive_semidefinite(gram) and found_semidefinite(gram, lambda _: True)
        if rank < n:
            less = [[x - (i == j) * Fraction(1, 10**12) for j, x in enumerate(row)] for i, row in enumerate(gram)]
            assert not _positive_semidefinite(less) and not found_semidefinite(less, lambda _: True)
        if n > 1:
            gram[0][1] += Fraction(1, 10**12)
            assert not _positive_semidefinite(gram)
