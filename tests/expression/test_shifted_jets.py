"""Second derivatives where eigenvalues are equal or a norm is 0: those of a polynomial that is the same function, or none."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import comb

import numpy as np
import pytest
import sympy as sp

from duhem.expression import jets, symbol
from duhem.expression.parse import parse_expression

NAMES = [symbol(n) for n in ("xx", "yy", "zz", "yz", "xz", "xy")]
SCOPE = {n.name: n for n in NAMES}
GREATEST = "eigmax(xx, yy, zz, yz, xz, xy)"
LEAST = "(-eigmax(-xx, -yy, -zz, -yz, -xz, -xy))"
MIDDLE = f"(xx + yy + zz - {GREATEST} - {LEAST})"


def _matrix() -> sp.Matrix:
    xx, yy, zz, yz, xz, xy = NAMES
    return sp.Matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _power_sum(k: int) -> sp.Expr:
    return sp.expand((_matrix() ** k).trace())


def _differences(m: int) -> sp.Expr:
    """The sum over pairs of (s_i - s_j)^m, m even."""
    return sp.expand(sum((-1) ** k * comb(m, k) * _power_sum(m - k) * _power_sum(k) for k in range(m + 1)) / 2)


# what is written of eigenvalues, and what makes the polynomial of the entries that it is
SAME: dict[str, Callable[[], sp.Expr]] = {
    f"{GREATEST}**3 + {MIDDLE}**3 + {LEAST}**3": lambda: _power_sum(3),
    f"{GREATEST}*{MIDDLE}*{LEAST}": lambda: _matrix().det(),
    f"abs({GREATEST} - {MIDDLE})**4 + abs({MIDDLE} - {LEAST})**4 + abs({LEAST} - {GREATEST})**4": lambda: _differences(4),
    f"({GREATEST} - {MIDDLE})**6 + ({MIDDLE} - {LEAST})**6 + ({LEAST} - {GREATEST})**6": lambda: _differences(6),
    f"sqrt(1 + {GREATEST}**2 + {MIDDLE}**2 + {LEAST}**2)": lambda: sp.sqrt(1 + _power_sum(2)),
}
EQUAL = [(2, 2, -1), (3, -1, -1), (1.5, 1.5, 1.5), (-2, -2, -2), (0, 0, 3), (7, 7, 0), (101, 101, 100)]
NEARLY = [(2 + gap, 2, -1) for gap in (1e-3, 1e-5, 1e-7, 1e-9, 1e-12, 1e-15)] + [(1.5 + 2e-8, 1.5, 1.5 - 3e-8), (-1, 2 - 1e-14, 2 + 1e-14)]


def _turned(values: Sequence[float], turn: bool) -> np.ndarray:
    q = np.linalg.qr(np.random.default_rng(3).standard_normal((3, 3)))[0] if turn else np.eye(3)
    a = (q * np.array(values)) @ q.T
    a = (a + a.T) / 2
    return np.array([a[0, 0], a[1, 1], a[2, 2], a[1, 2], a[0, 2], a[0, 1]])


@pytest.mark.slow
@pytest.mark.parametrize("text", SAME)
@pytest.mark.parametrize("turn", [False, True])
def test_smooth_functions_of_eigenvalues_have_the_hessian_of_their_polynomial(text: str, turn: bool) -> None:
    points = np.array([_turned(values, turn) for values in (*EQUAL, *NEARLY)])
    jet, _ = jets.formula(parse_expression(f"{text} + 10*xx", SCOPE), NAMES, [], strict=True)(points, [])  # no slope, no boundary
    exact, _ = jets.formula(SAME[text](), NAMES, [])(points, [])
    assert jet.hessian is not None and exact.hessian is not None and jet.gradient is not None
    np.testing.assert_allclose(jet.hessian, np.swapaxes(jet.hessian, 1, 2))
    size = np.maximum(np.abs(exact.hessian).max(axis=(1, 2)), 1e-3)
    off = np.abs(jet.hessian - exact.hessian).max(axis=(1, 2)) / size
    assert off.max() < 1e-6, off
    assert np.median(off) < 1e-10, off


@pytest.mark.parametrize(
    "text",
    [
        GREATEST,
        f"{GREATEST} - {LEAST}",
        f"{GREATEST}**2 + 2*{MIDDLE}**2",
        f"abs({GREATEST} - {MIDDLE})**(3/2) + {LEAST}",
        f"exp({GREATEST})",
    ],
)
def test_at_a_kink_there_is_none(text: str) -> None:
    points = np.array([_turned((2, 2, -1), turn) for turn in (False, True)] + [_turned((1, 1, 1), False)])
    jet, _ = jets.formula(parse_expression(text, SCOPE), NAMES, [], strict=True)(points, [])
    assert jet.hessian is not None
    assert not np.isfinite(jet.hessian).all(axis=(1, 2)).any()


def test_a_matrix_that_is_zero_has_no_axes() -> None:
    (*_, text) = SAME
    jet, _ = jets.formula(parse_expression(f"{text} + 10*xx", SCOPE), NAMES, [], strict=True)(np.zeros((1, 6)), [])
    assert jet.hessian is not None and np.isnan(jet.hessian).any()


def test_beside_a_kink_the_curvature_of_an_eigenvalue_is_two_over_the_gap() -> None:
    for gap in (1e-2, 1e-6, 1e-8):
        jet, _ = jets.formula(parse_expression(GREATEST, SCOPE), NAMES, [], strict=True)(np.array([[2 + gap, 2, -1, 0, 0, 0]]), [])
        assert jet.hessian is not None
        assert jet.hessian[0, 5, 5] == pytest.approx(2 / gap, rel=1e-6)
        assert jet.hessian[0, 4, 4] == pytest.approx(2 / (3 + gap), rel=1e-12)


NORMS = {
    "norm(xx - yy, 2*xy)**2 + xx": (sp.sympify("(xx - yy)**2 + 4*xy**2 + xx", locals=SCOPE), True),
    "(zz + norm(xx - yy, 2*xy))**4 + (zz - norm(xx - yy, 2*xy))**4": (
        sp.expand(sp.sympify("2*zz**4 + 12*zz**2*((xx - yy)**2 + 4*xy**2) + 2*((xx - yy)**2 + 4*xy**2)**2", locals=SCOPE)),
        True,
    ),
    "cosh(norm(xx, xy)) + yy": (None, True),
    "norm(xx - yy, 2*xy) + xx": (None, False),
    "norm(xx - yy, 2*xy)**(3/2) + xx": (None, False),
    "(abs(xx)**4 + abs(xy)**4)**(1/4)": (None, False),
    "(abs(xx)**4 + abs(xy)**4)**(1/2)": (None, False),
}


@pytest.mark.parametrize("text", NORMS)
def test_at_a_zero_of_a_norm(text: str) -> None:
    exact, smooth = NORMS[text]
    points = np.array([[0.0, 0.0, 1.5, 0, 0, 0], [0.0, 0.0, -0.3, 0, 0, 0], [0.0, 2.0, 0.7, 1.0, -1.0, 0.0]])
    if "cosh" not in text and "abs" not in text:
        points[:, 0] = points[:, 1]  # zeros of xx - yy off the origin
    jet, _ = jets.formula(parse_expression(text, SCOPE), NAMES, [], strict=True)(points, [])
    assert jet.hessian is not None
    assert np.isfinite(jet.hessian).all() == smooth
    if exact is not None:
        want, _ = jets.formula(exact, NAMES, [])(points, [])
        np.testing.assert_allclose(jet.hessian, want.hessian, rtol=1e-9, atol=1e-12)
    elif smooth:
        expected = np.zeros((6, 6))
        expected[0, 0] = expected[5, 5] = 1.0
        np.testing.assert_allclose(jet.hessian, np.tile(expected, (3, 1, 1)), atol=1e-12)


def test_what_holds_is_not_disturbed_by_a_piece_without_a_value() -> None:
    text = "max(norm(xx, yy) - 1, eigmax(log(zz), yy, xx, xy, xz, yz) - 9)"
    jet, _ = jets.formula(parse_expression(text, SCOPE), NAMES, [], strict=True)(np.array([[3.0, 4.0, 1.0, 0, 0, 0]]), [])
    assert jet.hessian is not None
    np.testing.assert_allclose(jet.hessian[0, :2, :2], np.array([[16, -12], [-12, 9]]) / 125, rtol=1e-12)
