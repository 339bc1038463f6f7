"""Symmetric functions of principal values of linear transforms: convex where the function of three numbers is, and no further.

Hershey and Hosford's function is convex from the exponent 1 on (Davis 1957), Yld2004-18p too: sum |a_i - b_j|^m is a function of the
eigenvalues of A x 1 - 1 x B, which is linear in A and B.  Drawn sums are held against chords through numpy's eigenvalues.
"""

from __future__ import annotations

from itertools import product
from random import Random

import numpy as np
import pytest

from duhem import Criterion, verify
from duhem.law.domain import POSITIVE, Domain
from duhem.proof.verdict import Trust, Verdict
from tests.long import long_but, mostly_long, mostly_slow
from tests.proof.composed import by_kernel, by_prover

S1, S2, S3 = (f"principal(s, {i})" for i in (1, 2, 3))
PAIRS = ((S1, S2), (S2, S3), (S3, S1))
M, LESS, K = Domain.between("1", "30"), Domain.between("0.99", "30"), Domain.between("-1", "1")


def powers(pairs: tuple[tuple[str, str], ...], m: str = "m", weights: tuple[str, ...] = ("1", "1", "1")) -> str:
    return " + ".join(f"{w}*abs({x} - ({y}))**{m}" for w, (x, y) in zip(weights * 3, pairs, strict=False))


HOSFORD = powers(PAIRS)
TENSOR = {"a": "s_xx - s_yy/2, s_yy, s_zz, p*s_yz, q*s_xz, s_xy", "b": "s_yy, 2*s_zz, s_xx, s_yz, p*s_xz, s_xy"}


def values(entries: str) -> tuple[str, str, str]:
    """The principal values of a matrix, as one writes them."""
    first = f"eigmax({entries})"
    last = f"(-eigmax({', '.join(f'-({e})' for e in entries.split(', '))}))"
    return first, f"({' + '.join(entries.split(', ')[:3])} - {first} - {last})", last


A, B = map(values, TENSOR.values())
TWO = powers(tuple(product(A, B)))
SHEARED = values(TENSOR["a"].replace("p*s_yz", "2*p*s_yz"))
SHAPE = {"p": Domain.between("-2", "2"), "q": POSITIVE}

CASES = [
    ("3d", f"{HOSFORD} - 2", {"m": M}, True),
    ("principal", f"{HOSFORD} - 2", {"m": M}, True),
    ("3d", f"{HOSFORD} - 2", {"m": LESS}, False),
    ("3d", f"({HOSFORD})**(1/m) + k*I1(s) - 1", {"m": M, "k": K}, True),
    ("3d", f"{powers(PAIRS[:2])} - 2", {"m": M}, False),  # not for every order
    ("3d", f"{powers(PAIRS, weights=('1', '1', '2'))} - 2", {"m": M}, False),
    ("principal", f"{powers(PAIRS, '6').replace('abs', '')} - 2", {}, True),
    ("principal", f"abs({S1})**m + abs({S2})**m + abs({S3})**m + abs(s_1 - k*s_2) - 1", {"m": M, "k": K}, True),  # and of the forces
    ("principal", f"abs({S1})**m + abs(s_2)**m + abs({S3})**m - 1", {"m": M}, False),
    ("3d", f"exp({S1}) + exp({S2}) + exp({S3}) - 4", {}, True),
    ("3d", f"exp({S1}) + exp({S2}) - exp({S3}) - 4", {}, False),
    ("3d", f"abs({S2}) - 1", {}, False),
    ("3d", f"{TWO} - 4", {"m": M, **SHAPE}, True),
    ("3d", f"{TWO} - 4", {"m": LESS, **SHAPE}, False),
    ("3d", f"{powers(tuple(product(A, B[:2])))} - 4", {"m": M, **SHAPE}, False),
    ("3d", f"{powers(tuple(product((*A[:2], SHEARED[2]), B)))} - 4", {"m": M, **SHAPE}, False),  # of another matrix
    ("3d", f"{powers(tuple(product(values(TENSOR['a'].replace('s_yy/2', 's_yy**2')), B)))} - 4", {"m": M, **SHAPE}, False),
]


def law(g: str, kind: str, parameters: dict[str, Domain]) -> Criterion:
    return Criterion(name="law", g=g, stress={"name": "s", "kind": kind}, pressure=None, parameters=parameters)


@pytest.mark.parametrize(
    ("kind", "g", "parameters", "convex"),
    long_but([0, 2, 3, *range(8, 11)], [*mostly_slow(CASES[:12], CASES[1], CASES[4]), *mostly_long(CASES[12:])]),
)
def test_the_kernel_asks_for_every_order(kind: str, g: str, parameters: dict[str, Domain], convex: bool) -> None:
    shown = by_kernel(law(g, kind, parameters))
    assert (shown.defined and shown.quasiconvex) is convex


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "g", "parameters", "convex"), long_but([1, 4, 6, 8, 9, 11], CASES))
def test_so_does_the_prover(kind: str, g: str, parameters: dict[str, Domain], convex: bool) -> None:
    assert by_prover(law(g, kind, parameters)) is convex


@pytest.mark.slow
def test_laws_with_shear_are_proved_and_checked() -> None:
    found = verify(law(f"{HOSFORD} - 2*s0**m", "3d", {"m": M, "s0": POSITIVE}), claims=["origin", "convexity", "dissipation"])
    assert {(r.verdict, r.trust) for r in found.results} == {(Verdict.PROVED, Trust.CHECKED)}


@pytest.mark.long
def test_what_is_shown_of_drawn_sums_no_chord_denies() -> None:
    rng, both = Random(5), [0, 0]
    terms = [(S1, S2), (S2, S3), (S3, S1), (S1, "0"), (S2, "0"), (S3, "0")]
    for _ in range(9):
        m, each = rng.choice([1, 1.5, 3, 4]), rng.choice([1, 2])
        weights = [each, each, rng.choice([each, each + 1]), *(rng.choice([[0, 0, 0], [1, 1, 1], [1, 0, 1]]))]
        g = " + ".join(f"{w}*abs({x} - {y})**{m}" for w, (x, y) in zip(weights, terms, strict=True) if w) + " - 1"
        shown = by_kernel(law(g, "principal", {})).convex
        assert shown is by_prover(law(g, "principal", {}))
        assert not (shown and _leaves(weights, m, np.random.default_rng(7)))
        both[shown] += 1
    assert min(both) > 1


def _leaves(weights: list[int], m: float, rng: np.random.Generator) -> bool:
    """Whether some mean of matrices has more than the mean of their values."""
    one, two = (x + np.swapaxes(x, 1, 2) for x in rng.normal(size=(2, 400, 3, 3)))

    def g(matrices: np.ndarray) -> np.ndarray:
        c, b, a = np.linalg.eigvalsh(matrices).T
        return sum(w * abs(x) ** m for w, x in zip(weights, (a - b, b - c, c - a, a, b, c), strict=True))

    return bool(np.any(g((one + two) / 2) > (g(one) + g(two)) / 2 + 1e-9))
