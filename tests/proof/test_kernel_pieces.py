"""The kernel's pieces of formulas with kinks, and polyhedra, exactly."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import pytest

from duhem.proof.kernel.pieces import CHOICES, below, chooses, pieces
from duhem.proof.kernel.regularity import smooth_near_the_boundary
from duhem.proof.kernel.support import Face, corners, is_bounded, least_of_greatest, measured, polyhedra, union_is_convex, within
from duhem.proof.kernel.term import NotWritten, parse
from tests.proof.small_laws import domain

F = Fraction


@pytest.mark.parametrize(
    ("text", "smooth"),
    [
        ("a**2 + b**2 - m", True), ("norm(a, b) - m", True), ("norm(a, b) - e", False), ("norm(a, b) + a - m", True),
        ("norm(a, b) + a", False), ("abs(a) - m", True),
        ("a*abs(a) + b - m", True), ("b*abs(a) - m", True), ("abs(a)**2 + b", True), ("abs(a)**(3/2) - m", True),
        ("abs(a)**p + b", False), ("abs(a)**(p + 1) + b", True),
        ("pos(a)**2 + neg(b)**3 - m", True), ("pos(a)*neg(b) - m", True), ("pos(a)*pos(a) - m", True), ("pos(a)*abs(a) + b", True),
        ("pos(a)*pos(a - b) - m", True),
        ("norm(pos(a), b) - m", True), ("norm(pos(a), b) + pos(a) - m", False), ("norm(abs(a), abs(b)) - m", True),
        ("norm(abs(a - b), a) - m", True), ("norm(abs(a) + 1, b) - m", False),
        ("sqrt(a**2 + 1) - m", True), ("sqrt(a**2 + b**2) - m", True), ("sqrt(a**2 + b**2) - q", False), ("exp(abs(a)) - m", False),
        ("exp(a*abs(a)) - m", True),
        ("sin(a) + cosh(b) - m", True), ("tanh(pos(a))**2 - m", True), ("tanh(pos(a)) - m", True), ("cos(abs(a))**2 - m", True),
        ("atan(abs(a))*a - m", True),
        ("max(a, b) - m", False), ("where(a > 0, a, b) - m", False), ("where(m > 0, a, b) - m", False), ("log(1 + a**2) - m", True),
        ("abs(m)*a - 1", True), ("abs(k) - a", True),
        ("abs(a - b)*(b - a) + b", True), ("abs(a - b)*(a + b) + b", False), ("abs(2*a)*a + b", True), ("(a**2 + b**2)**(3/2) - m", True),
        ("(a**2 + b**2)**(-1/2) - m", False),
        ("(abs(a) + abs(b))**2 - m", False), ("abs(a*b)*(a*b + 0) + b", True), ("sinh(abs(a))*tanh(a) - m", True),
        ("a**1 + b - m", True), ("abs(a)**0*b - m", False),
        ("abs(a)**1 - m", True),
    ],
)  # fmt: skip
def test_where_kinks_cancel(text: str, smooth: bool) -> None:
    assert smooth_near_the_boundary(parse(text), domain(g=text)) is smooth


def found(text: str, words: Sequence[str] | None = None) -> set[tuple[str, ...]]:
    """The pieces and their sides, multiplied out."""
    here = domain()
    made = pieces(parse(text), here) if words is None else pieces(parse(text), here, words)
    return {tuple(str(sorted(here.polynomial(x).items())) for x in (value, *sides)) for value, sides in made}


def expected(*made: Sequence[str]) -> set[tuple[str, ...]]:
    here = domain()
    return {tuple(str(sorted(here.polynomial(parse(x)).items())) for x in piece) for piece in made}


def test_pieces() -> None:
    assert found("a + b") == expected(["a + b"]) and found("abs(m)*a") == expected(["m*a"])
    assert found("abs(a) + b") == expected(["a + b", "a"], ["b - a", "-a"]) and found("pos(a)") == expected(["a", "a"], ["0", "-a"])
    assert found("neg(a)") == expected(["-a", "-a"], ["0", "a"]) and found("max(a, b)") == expected(["a", "a - b"], ["b", "b - a"])
    assert found("min(a, b)") == expected(["a", "b - a"], ["b", "a - b"]) and found("max(a, b, 1)") >= expected(["1", "1 - a", "1 - b"])
    assert found("abs(abs(a) - 1)") == expected(
        ["a - 1", "a", "a - 1"], ["1 - a", "a", "1 - a"], ["-a - 1", "-a", "-a - 1"], ["a + 1", "-a", "a + 1"]
    )
    chosen = "where(a > b, a**2, b)"
    assert (
        found(chosen, CHOICES) == expected(["a**2", "a - b"], ["b", "b - a"])
        and chooses(parse(chosen), domain())
        and not chooses(parse("abs(a)"), domain())
    )
    assert chooses(parse("where(m > 0, a, b)"), domain()) and not chooses(parse("where(m > 0, 1, 2)*a"), domain())
    with pytest.raises(NotWritten):
        found(" + ".join(f"abs(a - {i})" for i in range(7)))
    assert len(found(" + ".join(f"{2**i}*abs(a - {i})" for i in range(6)))) == 64
    here = domain()
    smaller = [
        ("abs(a) + b", {"a + b", "b - a"}), ("pos(a) + neg(b)", {"a - b", "a", "-b", "0"}), ("max(a, b) - 1", {"a - 1", "b - 1"}),
        ("min(a, b)", {"min(a, b)"}),
    ]  # fmt: skip
    for text, least in smaller:
        made = {str(sorted(here.polynomial(t).items())) for t in below(parse(text))}
        assert made == {str(sorted(here.polynomial(parse(t)).items())) for t in least}


def face(*numbers: int | F) -> Face:
    *row, limit = (F(x) for x in numbers)
    return tuple(row), limit


SQUARE = [face(1, 0, 1), face(-1, 0, 1), face(0, 1, 1), face(0, -1, 1)]


def test_corners_and_bounds() -> None:
    assert sorted(corners(SQUARE, 2)) == [(-1, -1), (-1, 1), (1, -1), (1, 1)] and is_bounded(SQUARE, 2) and not is_bounded(SQUARE[:3], 2)
    assert sorted(corners([*SQUARE, face(1, 1, 1)], 2)) == [(-1, -1), (-1, 1), (0, 1), (1, -1), (1, 0)] and corners(SQUARE[:2], 2) == []
    assert not is_bounded(SQUARE[:2], 2) and is_bounded([face(1, 0, -1), face(-1, 0, -1), face(0, 1, 1), face(0, -1, 1)], 2)
    assert is_bounded([face(1, 0, 0), face(-1, -1, 0), face(0, 1, 1)], 2) and not is_bounded(
        [face(1, 0, 0), face(-1, -1, 0), face(0, -1, 1)], 2
    )
    tetrahedron = [face(-1, 0, 0, 0), face(0, -1, 0, 0), face(0, 0, -1, 0), face(1, 1, 1, 1)]
    assert (
        len(corners(tetrahedron, 3)) == 4
        and is_bounded(tetrahedron, 3)
        and not is_bounded(tetrahedron[:3], 3)
        and within((F(0),) * 3, tetrahedron)
    )
    assert sorted(corners([face(2, 1), face(-3, 1)], 1)) == [(F(-1, 3),), (F(1, 2),)] and is_bounded([face(2, 1), face(-3, 1)], 1)
    assert not is_bounded([face(2, 1)], 1) and not within((F(2), F(0)), SQUARE) and within((F(1), F(-1)), SQUARE)


def test_unions_of_squares() -> None:
    def moved(x: F | int, y: F | int = 0) -> list[Face]:
        return [(row, limit + row[0] * F(x) + row[1] * F(y)) for row, limit in SQUARE]

    cases: list[tuple[list[list[Face]], bool]] = [
        ([], True), ([moved(1)], True), ([moved(2)], True), ([moved(F(2001, 1000))], False), ([moved(1, F(1, 1000))], False),
        ([moved(1, 1)], False), ([moved(2), moved(4)], True), ([moved(2), moved(0, 2)], False), ([SQUARE], True),
        ([moved(2), moved(0, 2), moved(2, 2)], True),
    ]  # fmt: skip
    for others, convex in cases:
        assert union_is_convex([SQUARE, *others], 2) is convex
    assert not union_is_convex([SQUARE[:3]], 2) and union_is_convex([[face(1, 0, -2), face(-1, 0, 1), *SQUARE[2:]], SQUARE], 2)


def test_piecewise_affine_formulas() -> None:
    here = domain()
    cases = [
        ("abs(a) + b", ["a + b", "b - a"]), ("pos(a)", ["a", "0"]), ("neg(a)", ["0", "-a"]), ("m*abs(a)", ["m*a", "-m*a"]),
        ("max(a, abs(b))", ["a", "b", "-b"]), ("q", ["q"]),
    ]  # fmt: skip
    for text, arms in cases:
        assert [[here.polynomial(arm) for arm in cell] for cell in least_of_greatest(parse(text), here)] == [
            [here.polynomial(parse(arm)) for arm in arms]
        ]
    assert [len(cell) for cell in least_of_greatest(parse("min(a, abs(b)) + abs(a)"), here)] == [2, 4]
    assert [len(cell) for cell in least_of_greatest(parse("max(min(a, b), min(a, 1), b)"), here)] == [3, 3, 3, 3] and len(
        least_of_greatest(parse("k*abs(a)"), here)[0]
    ) == 1
    assert len(least_of_greatest(parse("min(a, b)"), here)) == 2
    with pytest.raises(NotWritten):
        least_of_greatest(parse(" + ".join(["abs(a)"] * 7)), here)
    assert measured([parse("3*m"), parse("0"), parse("-m/2")], parse("2*m"), here) == (F(3, 2), 0, F(-1, 4))
    with pytest.raises(NotWritten):
        measured([parse("q")], parse("m"), here)
    cells, far, steep = polyhedra(parse("max(2*m*abs(a), m*b) - 3*p"), ("a", "b"), here)
    assert here.polynomial(far) == here.polynomial(parse("3*p")) and here.polynomial(steep) == here.polynomial(parse("2*m"))
    assert sorted(cells[0]) == sorted([((F(1), F(0)), F(1)), ((F(-1), F(0)), F(1)), ((F(0), F(1, 2)), F(1))])
    for text in ("max(abs(a), abs(b)) - q", "max(abs(a), abs(b))", "max(abs(a), q*abs(b)) - 1"):
        with pytest.raises(NotWritten):
            polyhedra(parse(text), ("a", "b"), here)
