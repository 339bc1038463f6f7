"""The reference projection against truths of other origin: printed values, closed forms in 60 digits, brute force."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import cvxpy as cp
import mpmath
import numpy as np
import pytest

import duhem
from duhem.errors import InputError
from duhem.expression.numpy_ import evaluate
from duhem.law.formula_law import Criterion
from duhem.projection.conic_solvers import rungs
from duhem.projection.cvxpy_method import applies, solve
from duhem.projection.increment import Increment
from duhem.projection.result import Array, Solution
from duhem.projection.scaled_formula import scaled

ANTONI = {"mu_a_plus": 0.2, "mu_a_minus": 0.08, "mu_b_plus": 0.12, "mu_b_minus": 0.15}
FULL = np.array([[1.0, 0.4], [0.4, 2.0]])


def increment(
    law: str | Criterion, trial: Any, pressure: Any, stiffness: Any = 1.0, parameters: Mapping[str, Any] | None = None
) -> Increment:
    """The question as the solver gets it, put together by hand."""
    law = duhem.load(law) if isinstance(law, str) else law
    fixed = law.fix({name: repr(value) for name, value in (parameters or {}).items()})
    known = {fixed.symbols()[name]: domain.value for name, domain in fixed.parameters.items()}
    points = np.atleast_2d(np.asarray(trial, dtype=float))
    k = np.asarray(stiffness, dtype=float) * np.eye(points.shape[1]) if np.ndim(stiffness) == 0 else np.asarray(stiffness, dtype=float)
    return Increment(
        law=law,
        g=fixed.g.xreplace(known),
        trial=points,
        pressure=np.broadcast_to(np.asarray(pressure, dtype=float), (len(points),)),
        stiffness=k,
        diagonal=bool(np.all(k == np.diag(np.diag(k)))),
        parameters=dict(parameters or {}),
    )


# -- the laws once more, by hand and in plain NumPy --------------------------------------------------------------------


def norm(*x: Any) -> Any:
    return np.sqrt(sum(np.square(y) for y in x))


def pnorm(p: float, *x: Any) -> Any:
    return sum(np.abs(y) ** p for y in x) ** (1 / p)


def quarters(a: Any, b: Any) -> Any:
    return norm(np.where(a > 0, a / 0.2, -a / 0.08), np.where(b > 0, b / 0.12, -b / 0.15))


def twelve_sides(a: Any, b: Any) -> Any:
    x, y = np.abs(a), np.abs(b)
    return np.max(np.stack([x, y, (4 * x + 3 * y) / 5, (3 * x + 4 * y) / 5]), axis=0)


@dataclass(frozen=True)
class Law:
    """A built-in law, its set {gauge(sigma - centre N) <= radius(N)}, and sigma . dg/dsigma there, for the multiplier."""

    name: str
    gauge: Callable[..., Any]
    parameters: dict[str, float]
    radius: Callable[[float], float] = lambda load: load
    euler: Callable[[float], float] | None = None  # (sigma - centre N) . dg/dsigma on the boundary; the radius if left out
    centre: tuple[float, float] = (0.0, 0.0)
    stresses: tuple[str, ...] = ()  # parameters in the unit of the stresses
    principal: bool = False
    degree: int = 1

    def label(self) -> str:
        return "-".join([self.name, *(f"{x}{self.parameters[x]}" for x in ("p", "m") if x in self.parameters)])


def principal(f: Callable[..., Any]) -> Callable[..., Any]:
    """A function of the differences of principal stresses, over the deviatoric plane with its orthonormal axes."""

    def on_plane(x: Any, y: Any) -> Any:
        s1, s2, s3 = (x * e + y * n for e, n in zip(*PLANE, strict=True))
        return f(s1 - s2, s2 - s3, s3 - s1)

    return on_plane


PLANE = np.array([[1, -1, 0], [1, 1, -2]]) / np.sqrt([[2], [6]])

LAWS = [
    Law("coulomb", norm, {"mu": 0.3}, lambda n: 0.3 * n),
    Law("orthotropic", lambda a, b: norm(a / 0.3, b / 0.1), {"mu_a": 0.3, "mu_b": 0.1}),
    Law("antoni2007", quarters, ANTONI),
    Law("box", lambda a, b: np.maximum(np.abs(a) / 0.3, np.abs(b) / 0.1), {"mu_a": 0.3, "mu_b": 0.1}),
    Law("polygon", twelve_sides, {"mu": 0.3}, lambda n: 0.3 * n),
    Law("capped", norm, {"mu": 0.3, "tau_max": 0.2}, lambda n: min(0.3 * n, 0.2), stresses=("tau_max",)),
    Law("shifted-ellipse", lambda a, b: norm(a / 0.3, b / 0.2), {"mu_a": 0.3, "mu_b": 0.2, "shift": 0.1}, centre=(0.1, 0.0)),
    Law("cohesive", norm, {"mu": 0.3, "cohesion": 0.1}, lambda n: 0.1 + 0.3 * n, stresses=("cohesion",)),
    Law(
        "regularised",
        norm,
        {"mu": 0.3, "c": 0.1},
        lambda n: math.sqrt((0.3 * n) ** 2 + 0.2 * 0.3 * n),
        lambda n: ((0.3 * n) ** 2 + 0.2 * 0.3 * n) / (0.3 * n + 0.1),
        stresses=("c",),
    ),
    Law("superellipse", lambda a, b: pnorm(1.5, a / 0.3, b / 0.2), {"mu_a": 0.3, "mu_b": 0.2, "p": 1.5}),
    Law("superellipse", lambda a, b: pnorm(4, a / 0.3, b / 0.2), {"mu_a": 0.3, "mu_b": 0.2, "p": 4}),
    Law("quartic", lambda a, b: pnorm(4, a, b), {"mu": 0.3, "c": 0}, lambda n: 0.3 * n, lambda n: 4 * (0.3 * n) ** 4, degree=4),
    Law(
        "hosford",
        principal(lambda *d: pnorm(4, *d) / 2**0.25),
        {"yield_stress": 0.7, "m": 4},
        lambda n: 0.7,
        stresses=("yield_stress",),
        principal=True,
    ),
    Law(
        "tresca",
        principal(lambda *d: np.max(np.abs(np.stack(d)), axis=0)),
        {"yield_stress": 0.7},
        lambda n: 0.7,
        stresses=("yield_stress",),
        principal=True,
    ),
    Law(
        "von-mises",
        principal(lambda *d: norm(*d) / 2**0.5),
        {"yield_stress": 0.7},
        lambda n: 0.7,
        stresses=("yield_stress",),
        principal=True,
    ),
]
EACH_LAW = pytest.mark.parametrize("law", LAWS, ids=Law.label)


@dataclass(frozen=True)
class Question:
    """Points around K, in the plane of two forces or of the deviator, and the same question to the solver."""

    law: Law
    load: float
    plane: Array
    stiffness: Array
    scale: float = 1.0
    asked: Increment = field(init=False)

    def __post_init__(self) -> None:
        law, s = self.law, self.scale
        parameters = {name: value * (s if name in law.stresses else 1.0) for name, value in law.parameters.items()}
        trial = (self.plane @ PLANE + 0.3 if law.principal else self.plane) * s
        k = 2.0 if law.principal else self.stiffness
        object.__setattr__(self, "asked", increment(law.name, trial, 0.0 if law.principal else -self.load * s, k, parameters))

    def metric(self) -> Array:
        return np.eye(2) / 2.0 if self.law.principal else np.linalg.inv(self.stiffness)

    def stresses(self, solution: Solution) -> Array:
        """The answer in the plane, in units of the scale; the mean of principal stresses must be that of the trial."""
        if not self.law.principal:
            return solution.stress / self.scale
        np.testing.assert_allclose(solution.stress.mean(axis=1), self.asked.trial.mean(axis=1), rtol=1e-7)
        return solution.stress @ PLANE.T / self.scale

    def boundary(self, angle: Array) -> Array:
        ray = np.stack([np.cos(angle), np.sin(angle)])
        unit = self.law.radius(self.load) / self.law.gauge(*ray)
        return (unit * ray).T + np.array(self.law.centre) * self.load

    def inside(self, point: Array) -> bool:
        return bool(self.law.gauge(*(point - np.array(self.law.centre) * self.load)) <= self.law.radius(self.load))

    def closest(self, point: Array) -> Array:
        """By brute force: the best of many boundary points, then a finer comb around the best, again and again."""
        if self.inside(point):
            return point
        middle, half = 0.0, math.pi
        for count in (4001, *[201] * 6):
            angles = middle + half * np.linspace(-1.0, 1.0, count)
            off = point - self.boundary(angles)
            middle, half = angles[np.argmin(np.einsum("ni,ij,nj->n", off, self.metric(), off))], 3 * half / count
        return self.boundary(np.array([middle]))[0]

    def violation(self, stress: Array) -> Array:
        """How far each answer is from optimal: (trial - sigma) . k^-1 (tau - sigma) <= 0 for all tau of K, and sigma in K."""
        comb = self.boundary(np.linspace(-math.pi, math.pi, 4001))
        push = (self.plane - stress) @ self.metric()
        unit = np.sqrt(np.einsum("ni,ij,nj->n", self.plane, self.metric(), self.plane))
        drift = np.max(push @ comb.T - np.sum(push * stress, axis=1)[:, None], axis=1) / unit**2
        shifted = stress - np.array(self.law.centre) * self.load
        return np.maximum(drift, self.law.gauge(*shifted.T) / self.law.radius(self.load) - 1.0)


def question(law: Law, scale: float = 1.0, count: int = 10) -> Question:
    points = np.random.default_rng(7).normal(size=(count, 2)) * 1.2
    return Question(law, 1.3, points, FULL, scale)


# -- truths ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "trial, k, sigma",
    [
        ((0.3, 0.2), (1, 1), (0.16948295870263982786, 0.063711769834024715701)),
        ((-0.3, 0.2), (1, 1), (-0.0626859952990218239, 0.074555673728327216011)),
        ((-0.3, -0.2), (1, 4), (-0.076140510365716901921, -0.046028201830649999767)),
        ((0.3, -0.01), (1, 1), (0.19987561244121522753, -0.0052894704439702478874)),
    ],
)
def test_reference_values(trial: Any, k: Any, sigma: Any) -> None:
    answer = solve(increment("antoni2007", trial, -1.0, np.diag(k), ANTONI))
    assert not answer.failed.any()
    np.testing.assert_allclose(answer.stress[0], sigma, rtol=0, atol=1e-9)
    np.testing.assert_allclose(answer.slip[0], (np.array(trial) - sigma) / k, rtol=0, atol=1e-9)
    gradient = [s / m**2 for s, m in zip(sigma, (0.2 if sigma[0] > 0 else 0.08, 0.12 if sigma[1] > 0 else 0.15), strict=True)]
    np.testing.assert_allclose(answer.multiplier * gradient, answer.slip[0], rtol=0, atol=1e-9)


def ellipse_point(trial: Array, k: Array, mu: tuple[float, float]) -> list[float]:
    """sigma_i = t_i/(1 + nu k_i/mu_i^2) on the ellipse of half-axes mu, nu by bisection in 60 digits."""
    with mpmath.workdps(60):
        t, stiff, half = ([mpmath.mpf(float(x)) for x in v] for v in (trial, k, mu))

        def point(nu: Any) -> list[Any]:
            return [a / (1 + nu * c / m**2) for a, c, m in zip(t, stiff, half, strict=True)]

        def outside(nu: Any) -> bool:
            return mpmath.fsum((s / m) ** 2 for s, m in zip(point(nu), half, strict=True)) > 1

        low, high = mpmath.mpf(0), mpmath.mpf(1)
        while outside(high):
            high *= 4
        for _ in range(200):
            middle = (low + high) / 2
            low, high = (middle, high) if outside(middle) else (low, middle)
        return [float(s) for s in point(low)]


@pytest.mark.parametrize("ratio", [1.0, 1e-4, 1e6])
def test_ellipse_in_sixty_digits(ratio: float) -> None:
    trial = np.random.default_rng(2).normal(size=(12, 2))
    trial = trial[norm(trial[:, 0] / 0.3, trial[:, 1] / 0.1) > 1]
    k = np.array([1.0, ratio])
    answer = solve(increment("orthotropic", trial, -1.0, np.diag(k), {"mu_a": 0.3, "mu_b": 0.1}))
    expected = [ellipse_point(t, k, (0.3, 0.1)) for t in trial]
    np.testing.assert_allclose(answer.stress, expected, rtol=0, atol=1e-8)


def test_disk_and_box_in_closed_form() -> None:
    trial = np.random.default_rng(3).normal(size=(9, 2))
    disk = solve(increment("coulomb", trial, -1.0, 5.0, {"mu": 0.1}))
    np.testing.assert_allclose(disk.stress, 0.1 * trial / norm(*trial.T)[:, None], atol=1e-9)
    np.testing.assert_allclose(disk.multiplier, (norm(*trial.T) - 0.1) / 5.0, rtol=1e-8)
    box = solve(increment("box", trial, -1.0, np.diag([5.0, 7.0]), {"mu_a": 0.1, "mu_b": 0.2}))
    np.testing.assert_allclose(box.stress, np.clip(trial, [-0.1, -0.2], [0.1, 0.2]), atol=1e-9)


def test_line() -> None:
    trial = np.array([[0.5], [-0.5], [0.1], [-0.15]])
    answer = solve(increment("antoni2007-1d", trial, -1.0, 4.0, {"mu_plus": 0.2, "mu_minus": 0.1}))
    np.testing.assert_allclose(answer.stress[:, 0], [0.2, -0.1, 0.1, -0.1], atol=1e-10)
    np.testing.assert_allclose(answer.multiplier, [0.3 / 4 * 0.2, 0.4 / 4 * 0.1, 0.0, 0.05 / 4 * 0.1], atol=1e-10)


@EACH_LAW
def test_every_law_against_brute_force(law: Law) -> None:
    asked = question(law)
    answer = solve(asked.asked)
    assert not answer.failed.any()
    stress = asked.stresses(answer)
    slipping = np.array([not asked.inside(t) for t in asked.plane])
    assert slipping.sum() > 5
    np.testing.assert_allclose(stress, [asked.closest(t) for t in asked.plane], rtol=0, atol=2e-6)
    assert np.max(asked.violation(stress)) < 1e-6
    np.testing.assert_array_equal(answer.multiplier[~slipping], 0.0)
    work = np.sum((answer.stress - (np.array(law.centre) * asked.load if not law.principal else 0)) * answer.slip, axis=1)
    euler = (law.euler or law.radius)(asked.load)
    np.testing.assert_allclose(answer.multiplier, work / euler, rtol=0, atol=1e-5 * np.max(work / euler))


@EACH_LAW
def test_the_unit_does_not_matter(law: Law) -> None:
    reference = solve(question(law).asked)
    for scale in (1e-9, 1e-6, 1e6, 1e9):
        answer = solve(question(law, scale).asked)
        assert not answer.failed.any()
        np.testing.assert_allclose(answer.stress / scale, reference.stress, rtol=0, atol=2e-6)
        np.testing.assert_allclose(answer.slip / scale, reference.slip, rtol=0, atol=2e-6)
        most = np.max(reference.multiplier)
        np.testing.assert_allclose(answer.multiplier / scale ** (2 - law.degree), reference.multiplier, rtol=0, atol=1e-5 * most)


@pytest.mark.parametrize("scale", [1e-290, 1e-100, 1e100, 1e290])
@pytest.mark.parametrize("k", [1e-12, 1e12])
def test_units_of_any_size(scale: float, k: float) -> None:
    plain = solve(increment("antoni2007", [[0.3, 0.2], [-0.3, -0.2]], -1.0, FULL, ANTONI))
    other = solve(increment("antoni2007", np.array([[0.3, 0.2], [-0.3, -0.2]]) * scale, -scale, FULL * k, ANTONI))
    np.testing.assert_allclose(other.stress / scale, plain.stress, rtol=1e-7)
    np.testing.assert_allclose(other.multiplier / scale * k, plain.multiplier, rtol=1e-7)


def test_a_far_trial_finds_the_exposed_point() -> None:
    """As the trial goes away, sigma tends to the point of K that maximises sigma . k^-1 sigma_tr."""
    far = np.array([[0.3, 0.2], [-0.3, -0.2], [0.1, -0.4]])
    push = far @ np.linalg.inv(FULL)
    square = np.where(push > 0, [0.2, 0.12], [0.08, 0.15]) ** 2
    expected = square * push / np.sqrt(np.sum(square * push**2, axis=1))[:, None]
    for distance in (1e12, 1e200):
        answer = solve(increment("antoni2007", far * distance, -1.0, FULL, ANTONI))
        np.testing.assert_allclose(answer.stress, expected, rtol=1e-6)


def test_without_pressure_nothing_is_carried() -> None:
    trial = [[0.3, 0.2], [-0.3, 0.1], [0.0, -0.2]]
    answer = solve(increment("antoni2007", trial, 0.0, FULL, ANTONI))
    assert np.max(np.abs(answer.stress)) < 1e-9
    np.testing.assert_allclose(answer.slip, np.array(trial) @ np.linalg.inv(FULL), rtol=1e-8)
    assert np.all(answer.multiplier >= 0)


def test_trial_inside_is_kept_to_the_last_bit() -> None:
    trial = np.array([[0.1, 0.05], [0.0, 0.0], [-0.05, 0.01]])
    answer = solve(increment("antoni2007", trial, -1.0, FULL, ANTONI))
    np.testing.assert_array_equal(answer.stress, trial)
    assert not answer.slip.any() and not answer.multiplier.any() and not answer.failed.any()


@pytest.mark.parametrize("law", [LAWS[2], LAWS[5], LAWS[10]], ids=Law.label)
def test_a_batch_is_its_points(law: Law) -> None:
    trial = np.random.default_rng(4).normal(size=(11, 2))
    pressure = -np.geomspace(1e-3, 1e3, 11)
    asked = increment(law.name, trial, pressure, FULL, law.parameters)
    single = solve(asked, batch=1)
    for batch in (4, 11, 100):
        stacked = solve(asked, batch=batch)
        np.testing.assert_allclose(stacked.stress, single.stress, rtol=0, atol=1e-6)
        np.testing.assert_allclose(stacked.multiplier, single.multiplier, rtol=1e-4, atol=1e-6)


# -- laws that are no norm ---------------------------------------------------------------------------------------------


def test_five_forces() -> None:
    names = tuple(f"s{i}" for i in range(5))
    law = Criterion("ball", "norm(s0, s1, s2, s3, s4) + sigma_n", forces=names)
    trial = np.array([[1.0, 2.0, 3.0, 4.0, 5.0]])
    np.testing.assert_allclose(solve(increment(law, trial, -1.0)).stress, trial / np.linalg.norm(trial), atol=1e-9)


def test_a_law_that_has_no_scale_of_its_own() -> None:
    law = Criterion("exponential", "exp(sigma_a/0.3) + abs(sigma_b) + sigma_n")
    answer = solve(increment(law, [[2.0, 0.0]], [-3.0], 4.0))
    np.testing.assert_allclose(answer.stress, [[0.3 * math.log(3.0), 0.0]], atol=1e-8)
    np.testing.assert_allclose(answer.multiplier, (2.0 - 0.3 * math.log(3.0)) / 4.0 * 0.1, rtol=1e-7)


def test_a_case_distinction_on_the_pressure_is_one_problem_a_pressure() -> None:
    law = Criterion("two-regimes", "norm(sigma_a, sigma_b) - where(sigma_n < -1, 0.5, 0.25)*abs(sigma_n)")
    answer = solve(increment(law, [[3.0, 4.0]] * 3, [-1.0, -2.0, -1.0]))
    np.testing.assert_allclose(answer.stress, [[0.15, 0.2], [0.6, 0.8], [0.15, 0.2]], atol=1e-9)


def test_a_set_without_the_origin() -> None:
    law = Criterion("far-disk", "norm(sigma_a - 5, sigma_b) - 1")
    answer = solve(increment(law, [[0.0, 0.0], [9.0, 0.0], [5.0, 0.5]], -1.0))
    np.testing.assert_allclose(answer.stress, [[4.0, 0.0], [6.0, 0.0], [5.0, 0.5]], atol=1e-8)


def test_an_empty_set_is_a_failure_of_its_point_alone() -> None:
    law = Criterion("needs-pressure", "norm(sigma_a, sigma_b) + 1 + sigma_n")
    answer = solve(increment(law, [[3.0, 4.0], [3.0, 4.0]], [-2.0, -0.5]))
    np.testing.assert_array_equal(answer.failed, [False, True])
    np.testing.assert_allclose(answer.stress[0], [0.6, 0.8], atol=1e-9)
    assert np.isnan(answer.stress[1]).all()


@pytest.mark.parametrize(
    "name, parameters, part",
    [
        ("limacon", {"mu": 0.3, "e": 0.4}, "norm(sigma_a, sigma_b)"),
        ("quartic", {"mu": 0.3, "c": 3}, "3*sigma_a**2*sigma_b**2"),
        ("matchstick", {"mu_a": 0.3, "mu_b": 0.25}, "norm(sigma_a, sigma_b)"),
    ],
)
def test_what_is_not_dcp_is_named_with_another_method(name: str, parameters: dict[str, float], part: str) -> None:
    asked = increment(name, [[1.0, 1.0]], -1.0, parameters=parameters)
    reason = applies(asked)
    assert reason is not None and part in reason and "method='newton'" in reason
    with pytest.raises(InputError, match="newton"):
        solve(asked)


def test_a_flow_of_its_own_is_not_the_closest_point() -> None:
    reason = applies(increment("radial-flow", [[1.0, 1.0]], -1.0, parameters={"mu_a": 0.3, "mu_b": 0.2}))
    assert reason is not None and "flow" in reason


# -- solvers and their options -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("solver", cp.installed_solvers())
@pytest.mark.parametrize("law", [LAWS[2], LAWS[3], LAWS[10]], ids=Law.label)
def test_every_installed_solver_answers_or_says_why_not(law: Law, solver: str) -> None:
    asked = question(law, count=4)
    try:
        answer = solve(asked.asked, solver=solver.lower())
    except InputError as error:
        assert solver != "CLARABEL" and solver in str(error)
        return
    assert np.max(asked.violation(asked.stresses(answer))) < 1e-5


def test_a_poor_answer_shows_in_its_residuals() -> None:
    asked = question(LAWS[2])
    fine, poor = (solve(asked.asked, tolerance=tolerance) for tolerance in (None, 1e-2))
    assert not poor.failed.any()
    assert np.max(asked.violation(asked.stresses(fine))) < 1e-7
    assert np.max(asked.violation(asked.stresses(poor))) > 1e-5


def test_a_tighter_tolerance_is_a_closer_answer() -> None:
    asked = question(LAWS[2]).asked
    best = solve(asked).stress
    errors = [np.max(np.abs(solve(asked, tolerance=tolerance).stress - best)) for tolerance in (1e-2, 1e-5, 1e-8, 1e-11)]
    assert errors == sorted(errors, reverse=True) and errors[-1] < 1e-2 * errors[0]


def test_a_warm_start_changes_no_more_than_the_tolerance() -> None:
    asked = question(LAWS[2])
    np.testing.assert_allclose(solve(asked.asked, warm_start=True, batch=2).stress, solve(asked.asked).stress, atol=1e-7)


@pytest.mark.parametrize(
    "options, message",
    [
        ({"solver": "NOSUCH"}, "solver: the solver 'NOSUCH' is not installed; installed are .*CLARABEL"),
        ({"tolerance": 0.0}, "tolerance: the tolerance 0.0 is not a positive number"),
        ({"tolerance": math.nan}, "tolerance: the tolerance nan is not a positive number"),
        ({"batch": 0}, "batch: batch 0 is not a count of points"),
        ({"batch": 2.5}, "batch: batch 2.5 is not a count of points"),
    ],
)
def test_bad_options_are_named(options: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        solve(increment("coulomb", [[1.0, 0.0]], -1.0, parameters={"mu": 0.3}), **options)


def test_a_tolerance_needs_a_solver_whose_word_for_it_is_known() -> None:
    with pytest.raises(InputError, match="spells its tolerance"):
        rungs("NOSUCH", 1e-6)


# -- the scaled formula ------------------------------------------------------------------------------------------------

SCALED = [(law.name, law.parameters) for law in LAWS] + [
    ("antoni2007-1d", {"mu_plus": 0.2, "mu_minus": 0.1}),
    ("limacon", {"mu": 0.3, "e": 0.4}),
    ("drucker1949", {"k": 0.7, "c": 1.5}),
    ("lobes", {"mu": 0.3, "e": 0.05}),
    ("matchstick", {"mu_a": 0.3, "mu_b": 0.25}),
]


@pytest.mark.parametrize("name, parameters", SCALED, ids=[name for name, _ in SCALED])
def test_scaling_keeps_the_formula(name: str, parameters: dict[str, float]) -> None:
    law = duhem.load(name)
    asked = increment(law, np.ones((1, len(law.forces))), 0.0, parameters=parameters)
    pressure = law.symbols()[law.pressure] if law.pressure else None
    formula = scaled(asked.g, law.force_symbols(), pressure)
    random = np.random.default_rng(6)
    load, size = -random.uniform(0.1, 2, 20), 2.0 ** random.integers(-20, 20, 20)
    s = dict(zip(law.force_symbols(), random.normal(size=(len(law.forces), 20)), strict=True))
    raw = evaluate(asked.g, {f: v * size for f, v in s.items()} | ({} if pressure is None else {pressure: load}))
    h = evaluate(formula.expr, s | formula.values(load, size))
    terms = 1.0 + sum(np.abs(q) for q in formula.values(load, size).values())
    np.testing.assert_allclose(raw / size**formula.degree, h, rtol=1e-12, atol=1e-12 * np.max(terms))
    assert formula.degree >= 1  # every one of these laws has a degree


def test_a_formula_without_degree_keeps_its_unit_as_a_datum() -> None:
    law = Criterion("exponential", "exp(sigma_a/0.3) + abs(sigma_b) + sigma_n")
    n = law.symbols()["sigma_n"]
    formula = scaled(law.g, law.force_symbols(), n)
    a, b = law.force_symbols()
    h = evaluate(formula.expr, {a: np.array([0.25]), b: np.array([-0.5])} | formula.values(np.array([-2.0]), np.array([4.0])))
    np.testing.assert_allclose(h, math.exp(1 / 0.3) + 2.0 - 2.0, rtol=1e-14)
    assert formula.degree == 0


# -- compiled once -----------------------------------------------------------------------------------------------------


def test_a_problem_is_compiled_once_for_a_law_and_a_stiffness(monkeypatch: pytest.MonkeyPatch) -> None:
    """Other points and pressures only change its parameters, and the numbers do not depend on what was solved before."""
    posed: list[Any] = []
    right = cp.Problem
    monkeypatch.setattr(cp, "Problem", lambda *a: posed.append(a) or right(*a))
    k = [1.0, 2.718281828]  # asked for by no other test
    first = duhem.project("antoni2007", [0.3, 0.2], -1.0, k, ANTONI, method="cvxpy")
    assert len(posed) == 1
    duhem.project("antoni2007", [9.0, 6.0], -2.0, k, ANTONI, method="cvxpy")
    again = duhem.project("antoni2007", [0.3, 0.2], -1.0, k, ANTONI, method="cvxpy")
    assert len(posed) == 1
    assert np.array_equal(first.stress, again.stress) and np.array_equal(first.multiplier, again.multiplier)
    duhem.project("antoni2007", [0.3, 0.2], -1.0, [1.0, 2.5], ANTONI, method="cvxpy")
    assert len(posed) == 2
