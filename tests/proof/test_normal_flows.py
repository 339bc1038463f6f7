"""Flows of a law's own that are normal: of one force, where they have its sign, and multiples of grad g; they are held to floats."""

from __future__ import annotations

from random import Random

import numpy as np
import pytest

from duhem import Criterion, Domain, recheck, verify
from duhem.expression import numpy_, symbol
from duhem.expression.parse import parse_as_written
from duhem.proof.kernel.claims import objection
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.verdict import Verdict

PARAMETERS = {"m": {"positive": True}, "k": {"min": "0"}}


def is_proved(g: str, flow: str, **more: object) -> bool:
    own = {"name": "law", "forces": ["x"], "pressure": None, "parameters": PARAMETERS, "constraints": [], "domain": {}}
    return not objection("normality", "one-force", frozenset(), StatedLaw.read({**own, "g": g, "flow": [flow], **more}), {})


SIGN = "where(x > 0, 1, where(x < 0, -1, 0))"
NORMAL = [
    ("abs(x) - m", SIGN), ("abs(x) - k", SIGN), ("max(x/m, -2*x) - 1", "x"), ("x**2 - k", "x/9"), ("sqrt(x**2) - m", "x"),
    ("exp(abs(x)) - m", "x*abs(x)"), ("2*pos(x) + neg(x)/m - k", "m*pos(x) - neg(x)"),
    ("atan(abs(x)) + x**2 - m", SIGN),
]  # fmt: skip
OTHERS = [  # the flow is 0 or against the force; K is wider than where g < 0, or on one side of 0 alone; g falls, jumps or is flat
    ("abs(x) - m", "0"), ("abs(x) - m", "x*abs(x - 1)"), ("pos(abs(x) - 1)", "x"), ("x - m", "1"), ("abs(x) - m", "1"),
    ("abs(x) - m", "-x"), ("x**3 - m", "x"), ("-abs(x) + m", "x"), ("where(x > 2, x - 9, abs(x)) - 1", "x"), ("abs(x)**k - m", "x"),
    ("abs(abs(x) - 2) - m", "x"), ("abs(x) - m", "x - k"),
    ("abs(x) - m", f"{SIGN} - 2*pos(x - 9)"), ("min(abs(x), 1) - 1", "x"),
]  # fmt: skip


@pytest.mark.parametrize(("g", "flow"), NORMAL)
def test_a_flow_with_the_sign_of_the_force_is_normal(g: str, flow: str) -> None:
    assert is_proved(g, flow)


@pytest.mark.parametrize(("g", "flow"), OTHERS)
def test_where_g_does_not_rise_or_the_flow_turns_back_nothing_is_shown(g: str, flow: str) -> None:
    assert not is_proved(g, flow)


def drawn(rng: Random, depth: int) -> str:
    if depth == 0:
        return rng.choice(["x", "x", "abs(x)", "pos(x)", "neg(x)", "1/2", "2", SIGN])
    a, b = drawn(rng, depth - 1), drawn(rng, depth - 1)
    return rng.choice(
        [f"({a} + {b})", f"({a} - {b})", f"{a}*({b})", f"max({a}, {b})", f"min({a}, {b})", f"exp({a}/2)", f"({a})**2", f"abs({a})"]
    )


def test_no_drawn_flow_that_is_proved_leaves_the_normal_cone() -> None:
    """Wherever g changes its sign or is about 0 on a grid, flow . (tau - sigma) <= 0 for all tau of the grid with g <= 0."""
    x, proved = np.concatenate([np.linspace(-4, 4, 1601), np.zeros(1)]), 0
    for seed in range(200):
        rng = Random(seed)
        g, flow = f"{drawn(rng, 2)} + 0*x - {rng.choice(['1/2', '1', '3'])}", drawn(rng, rng.choice((0, 1)))
        if not is_proved(g, flow):
            continue
        level, slip = (
            np.broadcast_to(numpy_.compiled(parse_as_written(text, {"x": symbol("x")}), (symbol("x"),))(x), x.shape) for text in (g, flow)
        )
        inside, edge = x[level <= 0], np.abs(level) < 1e-9
        edge[:-2] |= level[:-2] * level[1:-1] < 0
        proved += bool(edge.any())
        if inside.size:
            assert all(
                d * ((inside.max() if d > 0 else inside.min()) - s) <= 0.01 * abs(d) for s, d in zip(x[edge], slip[edge], strict=True)
            ), g
    assert proved >= 8


def test_coulombs_law_with_the_sign_of_the_force_is_decided() -> None:
    law = Criterion(
        name="coulomb", forces=("tau",), g="abs(tau) - mu*abs(sigma_n)", parameters={"mu": Domain(positive=True)}, flow=("sign(tau)",)
    )
    found = verify(law)
    assert found["normality"].verdict is Verdict.PROVED and found["normality"].method == "one-force"
    assert recheck(found.certificate()).ok


IN_A_PLANE = {  # and multiples of its gradient
    "norm(x, y) - m": ("x", "y"), "norm(x, 2*y) + abs(k)/9 - m - k": ("x", "4*y"), "x**2/m + 3*y**2 - 1": ("2*x", "6*m*y"),
    "norm(x, y) + x/2 - m": ("x/norm(x, y) + 1/2", "y/norm(x, y)"), "exp(x) + x**2 + y**2 - 2": ("exp(x) + 2*x", "2*y"),
}  # fmt: skip
SHARES = ["{d}", "3*({d})", "m*({d})", "({d})*exp(y)", "where(norm(x, y) > 0, ({d})/norm(x, y), 0)"]
NO_SHARES = [
    "({d})*abs(x)",
    "0*({d})",
    "({d})*pos(x - y)",
    "-({d})",
    "({d})*x",
    "({d})*(abs(x) - 1/9)",
    "({d}) + y/9",
    "({d})/x",
    "where(norm(x, y) > 1/9, -({d}), ({d}))",
]


def multiple_is_proved(g: str, flow: list[str]) -> bool:
    own = {"name": "law", "forces": ["x", "y"], "pressure": None, "parameters": PARAMETERS, "constraints": [], "domain": {}}
    return not objection("normality", "gradient", frozenset({"convexity"}), StatedLaw.read({**own, "g": g, "flow": flow}), {})


@pytest.mark.parametrize("g", IN_A_PLANE)
@pytest.mark.parametrize("share", [*SHARES, *NO_SHARES])
def test_multiples_of_the_gradient_are_normal(g: str, share: str) -> None:
    """Every share of the gradient is normal, and what is none is not shown to be; floats know each slip by points of K."""
    flow, names = [share.format(d=d) for d in IN_A_PLANE[g]], ("x", "y", "m", "k")
    proved = multiple_is_proved(g, flow)
    assert proved if share in SHARES[:3] else not (proved and share in NO_SHARES)
    if not proved:
        return
    level, *slips = (
        numpy_.compiled(parse_as_written(text, {n: symbol(n) for n in names}), [symbol(n) for n in names]) for text in (g, *flow)
    )
    angles = np.linspace(0.0, 2 * np.pi, 200, endpoint=False)
    low, high = np.zeros(200), np.full(200, 9.0)
    for _ in range(60):
        middle = (low + high) / 2
        inside = level(middle * np.cos(angles), middle * np.sin(angles), 0.8, 0.1) <= 0
        low, high = np.where(inside, middle, low), np.where(inside, high, middle)
    points = np.array([low * np.cos(angles), low * np.sin(angles)])
    slip = np.array([np.broadcast_to(d(*points, 0.8, 0.1), 200) for d in slips])
    assert (slip.T @ points - (slip * points).sum(axis=0)[:, None]).max() < 1e-9
