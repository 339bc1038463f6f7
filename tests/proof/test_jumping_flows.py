"""Dissipation of a slip that jumps: each side of a choice is asked about, and the seam itself with the side that owns it."""

import pytest

from duhem import Criterion, Domain, verify
from duhem.proof.verdict import Trust, Verdict
from tests.long import long_at

POSITIVE = Domain(positive=True)


def dissipation(flow, g="abs(s - x) - r - k", forces=("s", "x", "r")):
    law = Criterion("law", g, {"k": POSITIVE, "c": POSITIVE}, forces=forces, pressure=None, flow=flow)
    return verify(law, claims=["dissipation"])["dissipation"]


@pytest.mark.slow
def test_a_slip_that_jumps_across_the_axis_dissipates():
    found = dissipation(("where(s - x > 0, 1, -1)", "x/c - where(s - x > 0, 1, -1)", "-1"))
    assert (found.verdict, found.trust) == (Verdict.PROVED, Trust.CHECKED)


@pytest.mark.parametrize(
    "flow, g, forces",
    long_at(
        [4],
        [
            (("where(s - x > 0, 1, -1)", "-x/c - where(s - x > 0, 1, -1)", "-1"), "abs(s - x) - r - k", ("s", "x", "r")),
            (("where(s - x > 0, -1, 1)", "x/c + where(s - x > 0, 1, -1)", "-1"), "abs(s - x) - r - k", ("s", "x", "r")),
            # on a = 0 alone it turns back
            pytest.param(("a", "where(a > 0, b, where(a < 0, b, -b))"), "a**2 + b**2 - k", ("a", "b"), marks=pytest.mark.slow),
            (("a", "where(a >= 0, where(a <= 0, -b, b), b)"), "a**2 + b**2 - k", ("a", "b")),
            # g jumps, and the boundary is not where it is 0
            pytest.param(("1", "0"), "where(a > -1, norm(a, b) - 2 - k, 1)", ("a", "b"), marks=pytest.mark.slow),
        ],
    ),
)
def test_one_that_turns_back_is_not_proved_to(flow, g, forces):
    assert dissipation(flow, g, forces).verdict is not Verdict.PROVED
