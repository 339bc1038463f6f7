"""Where rays leave a set, held against sets whose gauge is known: ellipses, a ring, what has no end."""

import mpmath
import numpy as np
import pytest
from numpy.typing import NDArray

from duhem.expression.mpmath_ import reach
from duhem.expression.rays import Rays, crossing, evenly_between, first_exit

Array = NDArray[np.float64]
RADII = np.ldexp(1.0, np.arange(-400, 401))
AXES = np.array([3.0, 0.2])
WAYS = np.random.default_rng(0).standard_normal((200, 2)) * 10.0 ** np.random.default_rng(1).uniform(-9, 9, (200, 1))


def ellipse(points: Array) -> Array:
    """(x/3)^2 + (y/0.2)^2 - 1."""
    return np.asarray(np.square(points / AXES).sum(axis=-1)) - 1.0


def ends(way: Array) -> Array:
    """Where rays from 0 leave it."""
    return np.asarray(1.0 / np.hypot(*(way / AXES).T))


@pytest.mark.parametrize("at_once", [1, 2, 6, 7])
def test_rays_end_between_neighbouring_numbers(at_once: int) -> None:
    rays = Rays(ellipse, np.zeros(2), WAYS)
    last, first = rays.left(RADII, at_once=at_once)
    assert np.array_equal(first, np.nextafter(last, np.inf))
    assert (ellipse(rays.at(last)) <= 0.0).all() and (ellipse(rays.at(first)) > 0.0).all()
    assert last == pytest.approx(ends(WAYS), rel=1e-15)


@pytest.mark.parametrize("at_once", [1, 3, 4, 6])
def test_decades_apart_rays_end_between_the_same_neighbours(at_once: int) -> None:
    low, high = np.zeros(len(WAYS)), np.full(len(WAYS), 2.0**500)
    rays = Rays(ellipse, np.zeros(2), WAYS)
    last, first = rays.ended(low, high, at_once)
    assert np.array_equal([last, first], rays.left(RADII))


@pytest.mark.parametrize("parts", [2, 3, 16])
def test_numbers_are_counted_by_their_bits(parts: int) -> None:
    low, high = np.array([0.0, 0.0, 5e-324, 1.0]), np.array([1e300, 5e-324, 5e-324 * parts, 1.0 + parts * 2.0**-52])
    cuts = evenly_between(low, high, parts)
    assert (np.diff(np.column_stack([low, cuts, high])) >= 0.0).all()
    assert (cuts[1] == 0.0).all() and 1e-300 < cuts[0, -1] < 1e300
    assert cuts[3].tolist() == [1.0 + i * 2.0**-52 for i in range(1, parts)]


@pytest.mark.parametrize("start", [np.array([0.5, 0.05]), WAYS[:, ::-1] / np.hypot(*WAYS.T)[:, None] * [1.0, 0.1]])
def test_rays_start_anywhere_inside(start: Array) -> None:
    rays = Rays(ellipse, start, WAYS)
    assert ellipse(rays.at(rays.left(RADII)[0])) == pytest.approx(0.0, abs=1e-13)


def test_a_set_is_left_where_it_is_left_first() -> None:
    def ring(points: Array) -> Array:
        far = np.hypot(*np.moveaxis(points, -1, 0))
        return np.asarray(np.minimum(far - 1.0, np.maximum(2.0 - far, far - 3.0)))

    rays = Rays(ring, np.zeros(2), np.array([[0.6, 0.8], [1.0, 0.0]]))
    radii = np.linspace(0.3, 4.0, 30)
    assert rays.left(radii)[0] == pytest.approx([1.0, 1.0])
    gap = radii[~rays.inside(radii)[0]]
    assert gap[0] > 1.0 and (gap[gap < 3.0] < 2.0).all() and gap[-1] == 4.0
    back, out = rays.narrowed(np.array([2.5, 2.5]), np.array([1.5, 1.5]))  # from the far side
    assert back == pytest.approx([2.0, 2.0]) and (out < back).all()


def test_rays_that_never_end_and_rays_outside_from_the_start_are_told_apart() -> None:
    def strip(points: Array) -> Array:
        return np.asarray(np.abs(points[..., 1]) - 1.0)

    last, first = Rays(strip, np.zeros(2), np.array([[1.0, 0.0], [1.0, 1.0]])).left(RADII)
    assert last[0] == first[0] == RADII[-1] and last[1] < first[1]
    last, first = Rays(strip, np.array([0.0, 2.0]), np.array([[0.0, 1.0], [1.0, 0.0]])).left(RADII)
    assert (last == 0.0).all() and (first < RADII[0]).all()
    last, first = Rays(strip, np.zeros(2), np.array([[0.0, 1e105]])).left(RADII[RADII > 1e-100])
    assert last == pytest.approx(1e-105)  # before the first radius


def test_where_a_level_is_undefined_is_outside() -> None:
    def root(points: Array) -> Array:
        with np.errstate(invalid="ignore"):
            return np.asarray(np.sqrt(4.0 - np.square(points).sum(axis=-1)) - 3.0)

    assert Rays(root, np.zeros(2), np.eye(2)).left(RADII)[0] == pytest.approx([2.0, 2.0], rel=1e-15)


def test_first_exit_lies_between_two_radii() -> None:
    inside = np.array([[1, 1, 0, 1], [0, 1, 1, 1], [1, 1, 1, 1], [1, 1, 1, 0]], dtype=np.bool_)
    low, high = first_exit(inside, np.array([1.0, 2.0, 4.0, 8.0]))
    assert low.tolist() == [2.0, 0.0, 8.0, 4.0] and high.tolist() == [4.0, 1.0, 8.0, 8.0]


def test_crossing_and_halving_find_the_same_point() -> None:
    outside = WAYS / np.hypot(*WAYS.T)[:, None] * 10.0 ** np.random.default_rng(2).uniform(1, 12, (200, 1))
    start = np.broadcast_to(np.array([0.5, 0.05]), outside.shape)
    share, missed = crossing(lambda x, who: ellipse(x), start, outside)
    last, first = Rays(ellipse, start, outside - start).left(RADII)
    assert not missed.any()
    assert (np.abs(share - last) <= 1e-14 * last).all() and first == pytest.approx(last)
    assert (ellipse(start + share[:, None] * (outside - start)) <= 0.0).all()


def test_crossing_asks_far_less_often_than_halving() -> None:
    asked = 0

    def counted(points: Array, who: NDArray[np.intp]) -> Array:
        nonlocal asked
        asked += 1
        return ellipse(points)

    crossing(counted, np.zeros_like(WAYS), 2.0 * ends(WAYS)[:, None] * WAYS)
    assert asked < 25


def test_crossing_says_where_no_point_is_inside() -> None:
    _, missed = crossing(lambda x, who: np.where(who == 0, 1.0, ellipse(x)), np.zeros((2, 2)), np.full((2, 2), 5.0))
    assert missed.tolist() == [True, False]


@pytest.mark.parametrize("way", [(1, 0), (-3, 4), (1, 1000), (1e-9, 1e-10)])
@pytest.mark.parametrize("digits", [15, 60])
def test_one_ray_in_many_digits(way: tuple[float, float], digits: int) -> None:
    context = mpmath.MPContext()
    context.dps = digits
    ray = [context.mpf(w) for w in way]

    def level(x: list[mpmath.mpf]) -> mpmath.mpf:
        return (x[0] / 3) ** 2 + (5 * x[1]) ** 2 - 1

    bits = int(3.3 * digits) - 6
    end = 1 / context.sqrt((ray[0] / 3) ** 2 + (5 * ray[1]) ** 2)
    assert abs(reach(context, level, [0, 0], ray, bits) / end - 1) < context.mpf(2) ** -bits
    assert reach(context, lambda x: -1, [0, 0], ray, bits) is None
    assert reach(context, lambda x: 1, [0, 0], ray, bits) is None


@pytest.mark.parametrize("digits", [15, 40])
@pytest.mark.parametrize("power", [1, 2, 9])
def test_one_ray_ends_though_more_digits_are_asked_for_than_there_are(digits: int, power: int) -> None:
    """To neighbouring numbers but a few, also where the level is flat at the end and false position crawls."""
    context, asked = mpmath.MPContext(), []
    context.dps = digits

    def level(x: list[mpmath.mpf]) -> mpmath.mpf:
        asked.append(x)
        far = context.hypot(*x) - 1
        return far**power if far > 0 else context.mpf(-1)

    end = reach(context, level, [0, 0], [3, 4], 900)
    assert abs(5 * end - 1) < 8 * context.eps and len(asked) < 40 + 2 * context.prec
