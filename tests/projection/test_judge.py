"""No wrong answer of a method is passed on as right, and no right one as wrong."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
import pytest

import duhem
from duhem.errors import InputError
from duhem.law.formula_law import Criterion
from duhem.projection import closed_form, newton
from duhem.projection.increment import Increment, factors
from duhem.projection.increment import increment as checked
from duhem.projection.method import Options
from duhem.projection.methods import METHODS
from duhem.projection.residuals import residuals
from duhem.projection.result import ACCURACY, Solution, Status
from tests.long import long_at, long_but, mostly_long

MU = {"mu_a_plus": 0.2, "mu_a_minus": 0.08, "mu_b_plus": 0.12, "mu_b_minus": 0.15}
nan, inf = float("nan"), float("inf")
Spoil = Callable[[Solution], Solution]


def put(monkeypatch: pytest.MonkeyPatch, **parts: Any) -> None:
    """The closed form with parts of another, for the time of a test."""
    monkeypatch.setattr(closed_form, "CLOSED_FORM", replace(closed_form.CLOSED_FORM, **parts))


def _turned(by: float) -> Spoil:
    """The stress moved along the boundary, with the slip that balances it."""

    def spoil(s: Solution) -> Solution:
        stress = s.stress.copy()
        angle = np.arctan2(stress[:, 1] / 0.2, stress[:, 0] / 0.3) + by
        stress = np.stack([0.3 * np.cos(angle), 0.2 * np.sin(angle)], axis=1)
        return replace(s, stress=stress, slip=s.slip + s.stress - stress)

    return spoil


def test_a_multiplier_that_is_slightly_wrong_is_put_right(monkeypatch: pytest.MonkeyPatch) -> None:
    trial, parameters = [[2.0, 1.0], [-1.0, 3.0]], {"mu_a": 0.3, "mu_b": 0.2}
    right = duhem.project("orthotropic", trial, -1.0, parameters=parameters)
    put(monkeypatch, solve=lambda question, _: replace(s := closed_form.solve(question), multiplier=s.multiplier * 1.001))
    done = duhem.project("orthotropic", trial, -1.0, parameters=parameters)
    assert (done.status == Status.SLIP).all() and np.allclose(done.multiplier, right.multiplier, rtol=1e-12, atol=0.0)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("spoil", "residual"),
    long_but(
        [0, 2, 3, 7],
        [
            (lambda s: replace(s, stress=s.stress * (1 + 1e-6)), "feasibility"),
            (lambda s: replace(s, multiplier=-s.multiplier), "multiplier_sign"),
            (lambda s: replace(s, stress=s.stress * 0.9), "complementarity"),
            (lambda s: replace(s, slip=s.slip * (1 + 1e-6)), "stationarity"),
            (lambda s: replace(s, multiplier=s.multiplier * 1.1), "stationarity"),
            (_turned(1e-5), "stationarity"),
            (_turned(0.7), "variational"),
            (lambda s: replace(s, slip=0 * s.slip, multiplier=0 * s.multiplier), "stationarity"),
        ],
    ),
    ids=["outside", "negative", "inside", "slip", "multiplier", "turned", "far", "no-slip"],
)
def test_a_wrong_answer_is_inaccurate(monkeypatch: pytest.MonkeyPatch, spoil: Spoil, residual: str) -> None:
    put(monkeypatch, solve=lambda question, _: spoil(closed_form.solve(question)))
    angle = np.linspace(0.05, 1.5, 8)
    trial = 2 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    done = duhem.project("orthotropic", trial, -1.0, parameters={"mu_a": 0.3, "mu_b": 0.2})
    assert (getattr(done.residuals, residual) > 1e-7).any()
    assert (done.status[getattr(done.residuals, residual) > 1e-7] == Status.INACCURATE).all()
    if residual != "variational":
        assert (done.status == Status.INACCURATE).all()


@pytest.mark.slow
@pytest.mark.parametrize("field", ["stress", "slip", "multiplier"])
@pytest.mark.parametrize("value", [nan, inf])
def test_what_is_not_finite_has_failed(monkeypatch: pytest.MonkeyPatch, field: str, value: float) -> None:
    def broken(question: Increment, _: Options) -> Solution:
        solution = closed_form.solve(question)
        getattr(solution, field)[1] = value
        return solution

    put(monkeypatch, solve=broken)
    done = duhem.project("coulomb", [[1.0, 2.0], [1.0, 3.0], [0.01, 0.0]], -1.0, parameters={"mu": 0.3})
    assert done.status.tolist() == [Status.SLIP, Status.FAILED, Status.STICK]


def test_a_stick_outside_is_inaccurate(monkeypatch: pytest.MonkeyPatch) -> None:
    def lazy(q: Increment, _: Options) -> Solution:
        n = len(q.trial)
        return Solution(q.trial.copy(), np.zeros_like(q.trial), np.zeros(n), np.zeros(n, dtype=bool))

    put(monkeypatch, solve=lazy)
    done = duhem.project("coulomb", [[0.30001, 0.0], [0.29, 0.0]], -1.0, parameters={"mu": 0.3})
    assert done.status.tolist() == [Status.INACCURATE, Status.STICK]


@pytest.mark.slow
@pytest.mark.parametrize(
    "g", ["cosh(sigma_a) + sigma_b**2 - 3", "exp(sigma_a) + exp(-2*sigma_a) + exp(sigma_b**2) - 4", "abs(sigma_a)**900 - 2"]
)
@pytest.mark.parametrize("far", [2.0, 20.0, 360.0, 700.0, 1e3, 1e5, 1e9, 1e30, 1e200])
def test_a_stick_where_g_is_beyond_doubles_is_inaccurate(g: str, far: float) -> None:
    """A ball around such a number is no wider than it, and in doubles both are infinite: that is a sign, not a zero."""
    law = Criterion("steep", g, pressure=None)
    trial = far * np.array([[1.0, 0.25], [-1.0, 0.5]])
    asked, none = checked(law, trial, None, 1.0, None), np.zeros(2)
    for stress in (trial.copy(), np.nextafter(trial, 0.0)):  # the second has moved, by rounding
        found = residuals(asked, Solution(stress, 0.0 * trial, none, none.astype(bool)), convex=True)
        assert not (found.worst() <= 1e-7).any()


@pytest.mark.slow
def test_corners_are_judged_by_their_cone(monkeypatch: pytest.MonkeyPatch) -> None:
    """At a corner of the box any slip between the two normals is right, and no other."""
    law = Criterion("corner", "max(abs(sigma_a), abs(sigma_b)) - abs(sigma_n)", {})
    for trial, right in (((3.0, 2.0), True), ((3.0, 0.5), False)):

        def at_corner(q: Increment, _: Options, t: tuple[float, float] = trial) -> Solution:
            slip = np.array([[t[0] - 1.0, t[1] - 1.0]])
            return Solution(np.array([[1.0, 1.0]]), slip, np.abs(slip).sum(axis=1), np.zeros(1, dtype=bool))

        put(monkeypatch, applies=lambda q: None, solve=at_corner)
        status = duhem.project(law, trial, -1.0).status[0]
        assert status == (Status.SLIP if right else Status.INACCURATE)


@pytest.mark.parametrize("trial", [[1.05, 1.05, 1.05], [4.2, 10.0, 4.0], [2.0, 3.0, 4.0]])
def test_a_vertex_met_to_the_last_digit_has_the_normals_of_all_its_faces(trial: list[float]) -> None:
    """At (1, 1, 1) the faces of max(a, b, c) <= 1 are equal along the axes, and the first of them stands for all."""
    done = duhem.project("rankine", trial, parameters={"ft": 1}, stiffness=1.0)
    np.testing.assert_array_equal(done.stress[0], 1.0)
    assert done.status[0] == Status.SLIP


@pytest.mark.slow
def test_a_slip_beside_the_cone_of_such_a_vertex_is_inaccurate(monkeypatch: pytest.MonkeyPatch) -> None:
    slip = np.array([[1.0, 1.0, -0.01]])
    found = Solution(np.ones((1, 3)), slip, np.array([1.99]), np.zeros(1, dtype=bool))
    put(monkeypatch, applies=lambda q: None, solve=lambda q, _: found)
    done = duhem.project("rankine", 1.0 + slip, stiffness=1.0, parameters={"ft": 1})
    assert done.status[0] == Status.INACCURATE
    assert done.remark() is not None


def test_residuals_are_pure_numbers() -> None:
    trial = np.random.default_rng(4).normal(size=(200, 2))
    for unit in (1e-9, 1.0, 1e9):
        done = duhem.project("antoni2007", trial * unit, -unit, [1e11, 3e11], MU)
        assert done.residuals.worst().max() <= 2e-15


@pytest.mark.slow
@pytest.mark.parametrize("seed", long_but([0, 6], range(12)))
def test_no_right_answer_is_called_inaccurate(seed: int) -> None:
    """mu ratio 1e8, |sigma_n| 1e-200 ... 1e200, trials to 1e16 radii, stiffness of condition 1e12 in any unit."""
    rng = np.random.default_rng(seed)
    mu = dict(zip(MU, (10 ** rng.uniform(-4, 4, 4)).tolist(), strict=True))
    angle, soft = rng.uniform(0, np.pi), 10 ** rng.uniform(-12, -8)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    k = turn @ np.diag([1.0, soft]) @ turn.T * 10 ** rng.uniform(-9, 12)
    load, way = 10 ** rng.uniform(-200, 200, 200), rng.normal(size=(200, 2))
    radius = 1 / np.hypot(*(np.where(way < 0, way / -mu[f"mu_{i}_minus"], way / mu[f"mu_{i}_plus"])[:, j] for j, i in enumerate("ab")))
    far = np.where(rng.random(200) < 0.5, 10 ** rng.uniform(-1, 16, 200), 1 + 10 ** rng.uniform(-16, 0, 200))
    done = duhem.project("antoni2007", way * (radius * load * far)[:, None], -load, (k + k.T) / 2, mu)
    assert set(done.status) == {Status.STICK, Status.SLIP}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("mu", "k", "trial", "pressure"),
    [
        (
            (1e-6, 12.0, 1e-6, 12.0),
            (2.0163991891162093e-04, 4.1648283358679095e04),
            (30519.064159532085, -34611.77821855558),
            -0.1955379819,
        ),
        ((12.0, 12.0, 1e-6, 1e-6), (1.0, 1.0), (1e7, 3e6), -1.0),
        ((12.0, 12.0, 1e-6, 1e-6), (1.0, 1.0), (4.0, 2e-6), -1.0),
    ],
)
@pytest.mark.parametrize("shift", long_at([1], [1e-2, 1e-4, 1e-5]))
def test_a_stress_shifted_along_a_flat_side_is_inaccurate(
    mu: tuple[float, ...], k: tuple[float, float], trial: tuple[float, float], pressure: float, shift: float
) -> None:
    """On a flat side the normal hardly turns: a slip along it and balanced to 1e-8 of the trial says little of the place."""
    question = checked(duhem.load("antoni2007"), trial, pressure, k, dict(zip(MU, mu, strict=True)))
    right = closed_form.solve(question)
    assert residuals(question, right).worst()[0] <= 1e-14
    i = int(np.argmax(np.abs(right.stress[0]) / np.sqrt(k)))  # the long way, in the metric of k
    stress = right.stress.copy()
    stress[0, i] *= 1 - shift
    axes = np.array([mu[2 * j + (stress[0, j] < 0)] for j in (0, 1)]) * -pressure
    stress[0, 1 - i] = np.copysign(axes[1 - i] * np.sqrt(1 - (stress[0, i] / axes[i]) ** 2), stress[0, 1 - i])
    normal = stress / axes**2
    amount = (normal / k * (question.trial - stress)).sum() / (normal**2 / k * k).sum()
    for slip in (amount * normal, (question.trial - stress) / k):  # along the normal, or in balance
        length = np.linalg.norm(slip * np.sqrt(k)) / np.linalg.norm(normal * np.sqrt(k))
        gradient = np.linalg.norm(normal * np.sqrt(k)) * length / np.linalg.norm(stress / axes**2 / -pressure * np.sqrt(k) * pressure**2)
        wrong = Solution(stress, slip, np.array([gradient]), np.zeros(1, dtype=bool))
        assert residuals(question, wrong).worst()[0] > min(shift / 100, 1e-6)


PERTURBED: list[tuple[str, dict[str, Any], float | None]] = [
    ("antoni2007", MU, -1.0),
    ("antoni2007", dict(zip(MU, (12.0, 12.0, 1e-6, 2e-6), strict=True)), -1.0),
    ("superellipse", {"mu_a": 0.2, "mu_b": 0.1, "p": "1.01"}, -1.0),
    ("superellipse", {"mu_a": 0.2, "mu_b": 0.1, "p": 50}, -1.0),
    ("box", {"mu_a": 0.2, "mu_b": 0.3}, -1.0),
    ("hosford", {"yield_stress": 0.1, "m": "1.1"}, None),
    ("tresca", {"yield_stress": 0.1}, None),
]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("law", "parameters", "pressure", "condition"),
    mostly_long(
        [(*case, condition) for case in PERTURBED for condition in (1.0, 1e6)],
        (*PERTURBED[3], 1.0),
    ),
    ids=lambda x: x if isinstance(x, str) else "",
)
def test_no_stress_that_is_off_by_more_than_a_millionth_passes(
    law: str, parameters: dict[str, Any], pressure: float | None, condition: float
) -> None:
    """Right answers pass; pushed aside on the boundary they do not, however sharp or flat it is there."""
    rng = np.random.default_rng(3)
    d = len(duhem.load(law).forces)
    turn, _ = np.linalg.qr(rng.standard_normal((d, d)))
    k = (turn * np.geomspace(1.0, condition, d)) @ turn.T
    lower, inverse = factors((k + k.T) / 2)
    size = 0.1 if pressure is None else 1.0
    trial = size * rng.standard_normal((80, d)) * 10 ** rng.uniform(-1, 4, 80)[:, None]
    question = checked(duhem.load(law), trial, pressure, (k + k.T) / 2, parameters)
    right = newton.solve(question)
    slips = np.flatnonzero((right.multiplier > 0) & ~right.failed & (residuals(question, right).worst() <= 1e-7))
    assert len(slips) > 30
    question = replace(question, trial=question.trial[slips], pressure=question.pressure[slips])
    stress, multiplier = right.stress[slips], right.multiplier[slips]
    reach = np.linalg.norm(stress @ inverse.T, axis=1)
    seen = 0
    for shift in (1e-3, 1e-5, 1e-6):
        way = rng.standard_normal((len(slips), d))
        moved = stress + shift * reach[:, None] * (way / np.linalg.norm(way, axis=1)[:, None]) @ lower.T
        aside = newton.solve(replace(question, trial=moved)).stress
        slip = np.linalg.solve(question.stiffness, (question.trial - aside).T).T
        wrong = residuals(question, Solution(aside, slip, multiplier, np.zeros(len(slips), dtype=bool))).worst()
        off = np.linalg.norm((aside - stress) @ inverse.T, axis=1) / reach > 1e-6
        seen += int(off.sum())
        assert not (wrong[off] <= 1e-7).any()
    assert seen > 20


POINTS: list[tuple[str | Criterion, dict[str, Any], tuple[float, float]]] = [
    ("antoni2007", MU, (0, 0)),
    ("polygon", {"mu": 0.2}, (0, 0)),
    ("regularised", {"mu": 0.2, "c": 0.1}, (0, 0)),
    ("quartic", {"mu": 0.2, "c": 1}, (0, 0)),
    ("limacon", {"mu": 0.2, "e": 0.5}, (0, 0)),
    ("matchstick", {"mu_a": 0.2, "mu_b": 0.15}, (0, 0)),
    ("superellipse", {"mu_a": 0.2, "mu_b": 0.1, "p": "1.01"}, (0, 0)),
    (Criterion("cone", "norm(sigma_a - 1/10, sigma_b) - abs(sigma_n)"), {}, (0.1, 0)),
    (Criterion("bowl", "(sigma_a - 1/10)**2 + sigma_b**2 - sigma_n**2"), {}, (0.1, 0)),
    (Criterion("pyramid", "max(abs(sigma_a - 1/7), abs(sigma_b + 1/3)) - abs(sigma_n)"), {}, (1 / 7, -1 / 3)),
]
DRAWN = ("polygon", "quartic", "limacon", "matchstick", "superellipse", "cone", "bowl", "pyramid")  # declare no closed form


@pytest.mark.slow
@pytest.mark.parametrize(
    ("law", "parameters", "point", "method"),
    mostly_long(
        [(*case, method) for method in METHODS for case in POINTS],
        *((*case, "closed-form") for case in POINTS),
        *((*case, "newton") for case in (*POINTS[:3], *POINTS[7::2])),
        *((*case, "cvxpy") for case in (POINTS[1], POINTS[7])),
    ),
    ids=lambda x: x if isinstance(x, str) else getattr(x, "name", ""),
)
def test_where_k_is_one_point_every_slip_goes(
    law: str | Criterion, parameters: dict[str, Any], point: tuple[float, float], method: str
) -> None:
    trial, k = np.array([[0.3, -0.4], [-2.0, 1e5], [2.0, 0.7]]), np.array([3.0, 1.0])
    if getattr(law, "name", law) in {"closed-form": DRAWN, "cvxpy": ("quartic",), "newton": ()}[method]:
        with pytest.raises(InputError):
            duhem.project(law, trial, 0.0, k, parameters, method=method)
        return
    done = duhem.project(law, trial, 0.0, k, parameters, method=method)
    assert (done.status == Status.SLIP).all()
    assert np.abs(done.stress - point).max(axis=1) == pytest.approx(0.0, abs=1e-15 + 1e-14 * np.abs(trial * np.any(point)).max())
    assert np.abs(done.slip - (trial - point) / k).max() <= 1e-13 * np.abs(trial).max()
    assert (done.multiplier > 0).all() and np.isfinite(done.multiplier).all()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("ratio", "coupling"), mostly_long(product((1.0, 7.0, 30.0, 300.0), (0.5, -0.9)), (1.0, -0.9), (7.0, 0.5), (300.0, -0.9))
)
def test_where_a_box_is_one_point_every_slip_goes_though_its_long_sides_are_seen_seldom(ratio: float, coupling: float) -> None:
    k = np.array([[0.15, coupling * np.sqrt(0.15)], [coupling * np.sqrt(0.15), 1.0]])
    angle = np.linspace(0.0, 2.0 * np.pi, 16, endpoint=False) + 0.1
    trial = np.column_stack([np.cos(angle), np.sin(angle)])
    done = duhem.project("box", trial, 0.0, k, {"mu_a": 51.0 * ratio, "mu_b": 51.0}, method="newton")
    assert (done.status == Status.SLIP).all() and not done.stress.any()
    assert done.slip == pytest.approx(np.linalg.solve(k, trial.T).T, rel=1e-13)


@pytest.mark.slow
@pytest.mark.parametrize("g", ["max(300*abs(b), pos(a)) + sigma_n", "max(90000*b**2, pos(a)**2) - sigma_n**2"])
def test_at_the_end_of_a_half_line_a_slip_goes_no_way_back_on_it(g: str) -> None:
    """At no pressure its sides are opposed, and the one at its end is seen from an angle of 1/300: with g flat there or not."""
    law, k = Criterion("half line", g, forces=("a", "b")), np.array([[2.0, 1.0], [1.0, 3.0]])
    slip = np.array([[1.0, 1.0], [1e-3, -1.0], [1.0, 300.0], [-1.0, 1.0], [-1e-3, 1.0], [-3e-6, 1.0]])
    question = checked(law, slip @ k, 0.0, k, {})

    def passes(share: float) -> list[bool]:
        moved = share * slip
        given = Solution(np.zeros_like(slip), moved, np.linalg.norm(moved, axis=1), np.zeros(len(slip), dtype=bool))
        return (residuals(question, given, convex=True).worst() <= ACCURACY).tolist()

    assert passes(1.0) == [True] * 3 + [False] * 3
    for off in (2e-6, 1e-5, 1e-3):
        assert not any(passes(1.0 + off))


@pytest.mark.slow
def test_multipliers_where_k_is_one_point() -> None:
    """At the tip of a cone the dissipation potential at unit pressure; where g has no slope, the length of the slip."""
    trial = np.array([[0.3, -0.4], [-2.0, 30.0]])
    exact = [np.hypot(0.2 * 0.3, 0.15 * 0.4), np.hypot(0.08 * 2.0, 0.12 * 30.0)]
    for method, digits in (("closed-form", 1e-15), ("newton", 1e-8), ("cvxpy", 1e-6)):
        assert duhem.project("antoni2007", trial, 0.0, 1.0, MU, method=method).multiplier == pytest.approx(exact, rel=digits)
        smooth = duhem.project("regularised", trial, 0.0, 2.0, {"mu": 0.2, "c": 0.1}, method=method)
        assert smooth.multiplier == pytest.approx(np.hypot(*trial.T) / 2, rel=1e-14)


@pytest.mark.slow
def test_a_wrong_point_at_no_pressure_is_inaccurate(monkeypatch: pytest.MonkeyPatch) -> None:
    """A line is no point: the origin is right for one slip only."""
    law = Criterion("line", "abs(sigma_a - 2*sigma_b) - abs(sigma_n)")
    trial = np.array([[1.0, -2.0], [1.0, -1.0], [1.0, 2.0]])
    assert duhem.project(law, trial, 0.0, method="newton").stress == pytest.approx(trial - (trial @ [0.2, -0.4])[:, None] * [1, -2])

    def origin(q: Increment, _: Options) -> Solution:
        return Solution(np.zeros_like(q.trial), q.trial.copy(), np.linalg.norm(q.trial, axis=1), np.zeros(len(q.trial), dtype=bool))

    monkeypatch.setattr(newton, "NEWTON", replace(newton.NEWTON, solve=origin, again=None))
    assert duhem.project(law, trial, 0.0, method="newton").status.tolist() == [Status.SLIP, Status.INACCURATE, Status.INACCURATE]


THIN_TIPS = {
    "lens": (2, "max((a - 1)**2 + b**2, (a + 1)**2 + b**2) - 1 - {0}"),
    "wedge": (2, "max(abs(a) - {1}*(b + {1}), b/1000)"),
    "two balls": (3, "max((a - 1)**2 + b**2 + c**2, (a + 1)**2 + b**2 + c**2) - 1 - {0}"),
}


@pytest.mark.parametrize("name", THIN_TIPS)
def test_no_stress_inside_a_thin_tip_passes_for_the_tip(name: str) -> None:
    """Both sides of K are as near as rounding there, and the tip is as far along the axis as that over its angle."""
    chance, (d, g) = np.random.default_rng(5), THIN_TIPS[name]
    for power in (2, 5, 8, 10, 13)[:: d - 1]:
        thin = 10.0**-power
        tip = float(np.sqrt(thin))
        law = Criterion("thin", g.format(repr(thin), repr(tip)), forces=("a", "b", "c")[:d], pressure=None)
        weights = 10.0 ** chance.uniform(-2, 9) * chance.uniform(0.1, 1.0, 2)
        k = np.append(10.0 ** chance.uniform(-3, 3), np.ones(d - 1))
        end, slip = np.zeros(d), np.zeros(d)
        end[1], slip[:2] = -tip, (weights[1] - weights[0], -tip * weights.sum())
        short = 10.0 ** chance.uniform(-5, -0.5, 3)
        stress = np.zeros((len(short), d))
        stress[:, 0], stress[:, 1] = thin * short * chance.choice([0.0, 1e-8, 1e-3], len(short)), -tip * (1.0 - short)
        trial = np.tile(end + k * slip, (len(short), 1))
        multiplier = weights.sum() * (1.0 if name == "wedge" else 0.5) * (1.0 + short * chance.integers(0, 2, len(short)))
        given = Solution(stress, (trial - stress) / k, multiplier, np.zeros(len(short), dtype=np.bool_))
        foreign = replace(newton.NEWTON, name="foreign", again=None, solve=lambda _, __, given=given: given)
        done = duhem.project(law, trial, stiffness=k, method=foreign, convex="assume")
        wrong = np.abs(done.stress - end).max(axis=1) > 1e-6 * tip  # the judge may put one right
        assert (done.status[wrong] >= Status.INACCURATE).all() and (done.status[wrong] <= Status.FAILED).all()
