"""Positive definite matrices in a thin slice of their cone: found where there are any, however thin, and none where there is none."""

from __future__ import annotations

from fractions import Fraction
from itertools import islice

import flint
import pytest

from duhem import Criterion
from duhem.proof.search.identities import Blocks, inner_point
from tests.campaigns.polynomials import forms
from tests.oracles.prover import convex_sums
from tests.oracles.prover.decide import AskedSubject

F = Fraction


def matrices(*rows: list[list[int | Fraction]]) -> Blocks:
    return [[[F(x) for x in row] for row in block] for block in rows]


def hankel(c: Fraction, y: Fraction) -> list[list[Fraction]]:
    """x^4 + c x^2 + 1 = z' G z with z = (1, x, x^2)."""
    return [[F(1), F(0), y], [F(0), c - 2 * y, F(0)], [y, F(0), F(1)]]


def positive(gram: list[list[Fraction]]) -> bool:
    """By Sylvester's minors."""
    one, two, three = (
        gram[0][0],
        gram[0][0] * gram[1][1] - gram[0][1] ** 2,
        flint.fmpq_mat(3, 3, [flint.fmpq(x.numerator, x.denominator) for row in gram for x in row]).det(),
    )
    return one > 0 and two > 0 and three > 0


@pytest.mark.parametrize("margin", [F(1), F(1, 10**6), F(1, 10**12)])
@pytest.mark.parametrize("start", [F(0), F(1), F(-7, 2)])
def test_however_thin_the_slice(margin: Fraction, start: Fraction) -> None:
    """x^4 - 2 x^2 + 1 + margin x^2: y lies between -1 and -1 + margin/2."""
    c = margin - 2
    base = matrices(hankel(c, F(0)))
    way = matrices([[0, 0, 1], [0, -2, 0], [1, 0, 0]])
    tried = [y for (y,) in inner_point(base, [way], [start])]
    assert any(positive(hankel(c, y)) and -1 < y < -1 + margin / 2 for y in tried)
    before = flint.ctx.prec
    assert before == 53  # the digits are given back


@pytest.mark.parametrize("margin", [F(0), F(-1, 10**9), F(-1)])
def test_no_inside(margin: Fraction) -> None:
    base = matrices(hankel(margin - 2, F(0)))
    way = matrices([[0, 0, 1], [0, -2, 0], [1, 0, 0]])
    assert not any(positive(hankel(margin - 2, y)) for (y,) in inner_point(base, [way], [F(0)]))


def test_several_blocks_and_ways() -> None:
    """[[1, y], [y, 1]] and [[y - z]] and [[z - 1/2]]: 1/2 < z < y < 1."""
    base = matrices([[1, 0], [0, 1]], [[0]], [[F(-1, 2)]])
    ways = [matrices([[0, 1], [1, 0]], [[1]], [[0]]), matrices([[0, 0], [0, 0]], [[-1]], [[1]])]
    assert all(F(1, 2) < z < y < 1 for y, z in inner_point(base, ways, [F(-5), F(9)]))
    assert len(list(inner_point(base, ways, [F(-5), F(9)]))) > 3


NEAR = (  # a share of 1e-9 of the way out of the convex ones is left; the depth of the least second derivative is some 1e-9
    "6489359558603672417777*sx**4/137438953472000000000 + 38858879604764104176373*sx**3*sy/274877906944000000000"
    " + 1464114999601357940117*sx**2*sy**2/6871947673600000000 + 45108579315748537544329*sx*sy**3/274877906944000000000"
    " + 564550660848051316117*sy**4/10995116277760000000 + (2020405574099835787883*sx**2/10995116277760000000"
    " + 21063056746751887381053*sx*sy/137438953472000000000 + 7100445094528265141989*sy**2/137438953472000000000)*t**2"
    " + 9096936493210900543159*t**4/274877906944000000000 - 1"
)


def test_a_law_in_whose_margin_a_solver_drowns() -> None:
    law = Criterion(name="near", g=NEAR, forces=("sx", "sy", "t"), pressure=None)
    assert convex_sums.convexity(AskedSubject(law)) is not None


@pytest.mark.long
def test_the_same_in_four_forces() -> None:
    """In skew coordinates, where no change of units helps."""
    trial = next(islice(forms(20, 1), 19, None))
    assert (trial.family, trial.margin) == ("degree 4, 4 forces", "below 1e-9")
    assert convex_sums.convexity(AskedSubject(trial.law)) is not None
