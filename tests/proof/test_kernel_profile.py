"""The parts by which the kernel knows a profile: what sides leave of a line, where the root of a polynomial is concave."""

from __future__ import annotations

from fractions import Fraction

import pytest

from duhem.proof.kernel.polynomial import Polynomial
from duhem.proof.kernel.region import _bend, _between, _concave_root, _leading, _measured, _profile, _rounded, _solved
from duhem.proof.kernel.signs import RAY, Line, line, on_the_line, sign_at
from duhem.proof.kernel.term import NotWritten, parse
from tests.proof.small_laws import domain, poly

F = Fraction


def in_t(*coefficients: int | F) -> Polynomial:
    return {((RAY, n),) if n else (): F(c) for n, c in enumerate(coefficients) if c}


def test_what_sides_leave_of_a_line() -> None:
    sides: list[tuple[list[Line], tuple[F | int | None, F | int | None]]] = [
        ([], (None, None)), ([(-1, 2)], (F(1, 2), None)), ([(3, -1)], (None, 3)), ([(-1, 2), (3, -1)], (F(1, 2), 3)),
        ([(3, -1), (1, -1)], (None, 1)), ([(1, -1), (3, -1)], (None, 1)), ([(-1, 1), (-2, 1)], (2, None)), ([(1,)], (None, None)),
        ([(0, 0, 1)], (None, None)), ([(2, 1), (-1, -1)], (-2, -1)),
    ]  # fmt: skip
    for given, left in sides:
        assert _between(given) == left


def test_the_sign_at_a_place() -> None:
    p = (-2, 1)
    assert [sign_at(p, F(x)) for x in (1, 2, 3)] == [-1, 0, 1] and sign_at((0, 0, -1), F(1)) == -1


@pytest.mark.parametrize(
    ("coefficients", "sides", "concave"),
    [
        ((0, 1, -1), [], True),  # t (1 - t)
        ((1,), [], True), ((0, 1), [], True), ((0, 0, 1), [], False), ((0, 0, 1), [(0, 1)], True), ((0, 0, 1), [(1, 1)], False),
        ((0, 0, -1), [], True), ((0, 0, 1, -2, 1), [(0, 1), (1, -1)], True),  # t^2 (1 - t)^2
        ((0, 0, 1, -2, 1), [(1, 1), (1, -1)], False), ((0, 0, 1, -2, 1), [(0, 1), (2, -1)], False), ((0, 0, -1, 2, -1), [], False),
        ((0, 0, -1, 2, -1), [(1, -2)], True), ((-1,), [], True), ((-1, 0, 1), [], False), ((-1, 0, 1), [(0, 1)], True),
        ((1, 0, -1), [], True), ((1, 0, 1), [], False), ((0, 1, 0, -1), [], False), ((0, 1, 0, -1), [(0, 1)], True),
        ((0, 0, 0, 1, -1), [], False), ((0, 0, 1, -1), [(0, 1)], True), ((0, 0, 1, -1), [], False), ((0, 0, 1, -1), [(1, 2)], False),
        ((0, 1, -3, 3, -1), [(1, -1)], False), ((0, 0, 1), [(-1, 1), (1, -1)], True),  # a point
        ((0, 0, 1), [(-2, 1), (1, -1)], True),  # nothing
        ((-1, 0, 1), [(1, 1), (1, -1)], False),  # two points, the ends
        ((1, 2), [], True), ((4, 0, -5, 0, 1), [(1, 1), (1, -1)], True), ((4, 0, -5, 0, 1), [], False),
    ],
)  # fmt: skip
def test_where_the_root_of_a_polynomial_is_concave(coefficients: tuple[int, ...], sides: list[Line], concave: bool) -> None:
    h, bend = (on_the_line(p) for p in (in_t(*coefficients), _bend(in_t(*coefficients))))
    assert h and bend is not None and _concave_root(h, bend, sides) is concave


def test_the_profile_along_a_load() -> None:
    here = domain(g="a")
    t = {((RAY, 1),): F(1)}
    assert _solved(poly("2*b + a*m - 1"), here)[0] == parse("a")
    x, place = _solved(poly("2*b - 4"), here)
    assert x == parse("b") and place == {**{m: F(1, 2) for m in t}, (): F(2)}
    for load in ("e*a", "k*b", "(m + p)*a", "q*a + 1", "3"):  # a factor > 0 is a power of constants > 0
        with pytest.raises(NotWritten):
            _solved(poly(load), here)
    assert [*_leading(poly("a**2 + b"), here)] == [] and [*_leading(poly("a**2*b"), here)] == []
    assert [*_leading(poly("(a + 2*b)**3 + a*b"), here)] == [poly("a + 2*b")]
    assert [*_leading(poly("m*(2*a - b)**4 + a"), here)] == [poly("a - b/2")]
    with pytest.raises(NotWritten):
        list(_leading(poly("q*a**3"), here))
    for text, profile in (("a**2 + 3*a + q", "9 - 4*q"), ("2*a**2 + m - 1", "8 - 8*m"), ("a**2 + a*b + b**2 - 1", "48")):
        assert _profile(poly(text), here) == poly(profile)
    for text in ("a**2*b", "a**3", "-a**2", "q*a**2", "e*a**2", "a + b", "a**2 + a*b**2", "a**2 - b**2"):
        with pytest.raises(NotWritten):
            _profile(poly(text), here)


def test_a_profile_in_numbers_measures_in_one_constant() -> None:
    here = domain(g="a")
    m_t = {tuple(sorted([(RAY, 1), (parse("m"), 1)])): F(3)}
    ((found, sides),) = _measured(in_t(0, 2, 1), [in_t(1, 1), {}], here)
    assert on_the_line(found) == (0, 2, 1) and on_the_line(_bend(found)) == (1,) and sides == [line([F(1), F(1)])]
    cubic = {((RAY, 2), (parse("m"), 1)): F(1), ((RAY, 3),): F(-1)}  # m t^2 - t^3 is m^3 (u^2 - u^3) at t = m u
    assert [on_the_line(h) for h, _ in _measured({tuple(sorted(m)): c for m, c in cubic.items()}, [], here)] == [None, (0, 0, 1, -1)]
    assert [*_measured({}, [], here)] == [] and [on_the_line(h) for h, _ in _measured(m_t, [], here)] == [(0, 1), (0, 1)]
    assert [on_the_line(h) for h, _ in _measured({((parse("q"), 1),): F(1), (): F(1)}, [], here)] == [None]


@pytest.mark.parametrize(
    ("profile", "sides", "rounded"),
    [
        ("m + t", [(0, 1), (1, -1)], True), ("m + t", [(0, 1)], False), ("q + t", [(0, 1), (1, -1)], False),
        ("m + t**2", [(0, 1), (1, -1)], False),
        ("m*t - m*t**2", [(0, 1), (1, -1)], True), ("t - t**2", [], True), ("t**2", [(0, 1)], True), ("m + t", [(1, 1), (-2, -1)], False),
    ],
)  # fmt: skip
def test_a_profile_with_constants_needs_two_sides(profile: str, sides: list[Line], rounded: bool) -> None:
    here = domain(g="a")
    h = {tuple(sorted((RAY if x == parse("t") else x, n) for x, n in m)): c for m, c in poly(profile).items()}
    assert _rounded(h, sides, here) is rounded
