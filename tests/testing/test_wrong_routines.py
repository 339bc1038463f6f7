"""What the conformance suite must refuse, and which check refuses it."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product

import numpy as np
import pytest
import sympy as sp

import duhem
from duhem.testing import (
    Case,
    Step,
    checks_for,
    conformance,
    projection,
    violation,
)
from tests.long import long_at, long_but, mostly_long
from tests.oracles.routines import (
    ELLIPSE,
    MU,
    Array,
    antoni,
    built_in_stress,
    identity_metric,
    inverse_metric,
    not_a_number,
    nothing,
    over_projection,
    radial_return,
    raises,
    reflected,
    skewed,
    swapped_sign,
    to_the_origin,
    with_extras,
    wrong_shape,
)

# routine: (law, values), the checks that must refuse it, the checks that it satisfies by construction
MUTANTS: dict[str, tuple[Callable[..., object], str, dict[str, float], set[str], set[str]]] = {
    "radial return on an ellipse": (
        radial_return,
        "orthotropic",
        ELLIPSE,
        {"variational-inequality", "non-expansiveness", "firmness", "potential"},
        {"feasibility", "idempotence", "complementarity", "homogeneity", "stiffness-scale"},
    ),
    "a coefficient too large in one quadrant": (
        antoni({**MU, "mu_b_minus": 0.18}),
        "antoni2007",
        MU,
        {"feasibility"},
        {"idempotence", "non-expansiveness", "firmness", "potential", "ray", "homogeneity", "dissipation"},
    ),
    "a coefficient too small in one quadrant": (
        antoni({**MU, "mu_b_minus": 0.12}),
        "antoni2007",
        MU,
        {"complementarity", "variational-inequality"},
        {"feasibility", "non-expansiveness", "homogeneity", "dissipation"},
    ),
    "no projection": (
        nothing,
        "orthotropic",
        ELLIPSE,
        {"feasibility"},
        {
            "idempotence",
            "non-expansiveness",
            "firmness",
            "potential",
            "variational-inequality",
            "ray",
            "dissipation",
            "complementarity",
            "path",
        },
    ),
    "over-projection": (over_projection, "orthotropic", ELLIPSE, {"complementarity", "ray"}, {"feasibility", "dissipation", "path"}),
    "all stress gone": (
        to_the_origin,
        "orthotropic",
        ELLIPSE,
        {"complementarity", "variational-inequality", "non-expansiveness"},
        {"feasibility", "idempotence", "dissipation"},
    ),
    "a swapped sign": (
        swapped_sign,
        "orthotropic",
        ELLIPSE,
        {"dissipation", "variational-inequality", "firmness"},
        {"feasibility"},
    ),
    "reflection": (
        reflected,
        "orthotropic",
        ELLIPSE,
        {"idempotence", "variational-inequality", "firmness"},
        {"homogeneity", "non-expansiveness", "stiffness-scale"},
    ),
    "the metric of no stiffness": (
        identity_metric,
        "orthotropic",
        ELLIPSE,
        {"variational-inequality", "firmness"},
        {"feasibility", "idempotence", "homogeneity", "stiffness-scale", "complementarity"},
    ),
    "the metric of the inverse stiffness": (
        inverse_metric,
        "orthotropic",
        ELLIPSE,
        {"variational-inequality", "firmness"},
        {"feasibility", "idempotence", "homogeneity", "stiffness-scale"},
    ),
    "a stress built in": (
        built_in_stress,
        "orthotropic",
        ELLIPSE,
        {"homogeneity", "complementarity"},
        {"feasibility", "non-expansiveness", "dissipation"},
    ),
    "0/0 without stress": (not_a_number, "orthotropic", ELLIPSE, {"answers"}, {"convexity", "origin"}),
    "an exception": (raises, "orthotropic", ELLIPSE, {"answers"}, {"convexity", "origin"}),
    "an array of the wrong shape": (wrong_shape, "orthotropic", ELLIPSE, {"answers"}, {"convexity", "origin"}),
    "slip of the wrong sign": (with_extras(slip=np.negative), "orthotropic", ELLIPSE, {"slip", "energy"}, {"feasibility", "multiplier"}),
    "a negative multiplier": (with_extras(multiplier=np.negative), "orthotropic", ELLIPSE, {"multiplier"}, {"slip", "energy"}),
    "a multiplier without slip": (with_extras(multiplier=lambda x: x + 1.0), "orthotropic", ELLIPSE, {"multiplier"}, {"slip", "energy"}),
    "a tangent that is not symmetric": (with_extras(tangent=skewed), "orthotropic", ELLIPSE, {"tangent"}, {"slip", "multiplier"}),
    "the elastic tangent": (
        with_extras(tangent=lambda x: 0.0 * x + np.eye(2)),
        "orthotropic",
        ELLIPSE,
        {"slope"},
        {"slip", "multiplier"},
    ),
}


EVERY_RUN = (  # each check that one of them must fail is failed in every run, `slope` and `potential` by the tests below
    "no projection",
    "over-projection",
    "all stress gone",
    "reflection",
    "a stress built in",
    "an exception",
    "slip of the wrong sign",
    "a negative multiplier",
    "a tangent that is not symmetric",
)


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(MUTANTS, *EVERY_RUN))
def test_a_wrong_routine_is_refused_by_the_right_checks(name: str) -> None:
    update, law, values, must, cannot = MUTANTS[name]
    stiff = 1.0 if name == "the elastic tangent" else None
    asked = [c for c in checks_for(law) if c.name in must | cannot]
    report = conformance(law, update, values, checks=asked, stiffness=stiff, max_examples=6, rows=60, every=1, tries=5)
    assert must <= report.failed, f"not refused by {sorted(must - report.failed)}"
    assert not cannot & report.failed, str(report)
    for failure in report.failures:
        assert len(failure.case) == 1
        assert violation(failure.check, law, update, failure.case, open_parameters=())


NOT_CONVEX = [
    ("limacon", {"e": "0.6"}),
    ("limacon", {"e": "99/100"}),
    ("matchstick", {"mu_a": "1", "mu_b": "2"}),
    ("quartic", {"c": "30"}),
    ("quartic", {"c": "-1"}),
    ("lobes", {"e": "0.3"}),
    ("drucker1949", {"c": "4"}),
    ("drucker1949", {"c": "-10"}),
]


@pytest.mark.slow
@pytest.mark.parametrize(("law", "values"), long_but([4], NOT_CONVEX), ids=str)
def test_a_set_that_is_not_convex_is_refused(law: str, values: dict[str, str]) -> None:
    report = conformance(law, nothing, values, checks=["convexity", "origin"], max_examples=30, rows=60, tries=5)
    assert report.failed == {"convexity"}
    (failure,) = report.failures
    case, known = failure.case, duhem.load(law).fix(values)
    table = known.symbols()
    exact = {table[n]: sp.Rational(float(case.parameters[n])) for n in known.parameters} | (
        {table[known.pressure]: sp.Rational(float(case.pressure[0]))} if known.pressure else {}
    )
    level = [  # a shallow dent is less than what doubles round
        sp.N(known.g.subs(exact | dict(zip(known.force_symbols(), map(sp.Rational, point.tolist()), strict=True))), 60)
        for point in (case.inside[0], case.beside[0], (case.inside[0] + case.beside[0]) / 2)
    ]
    assert max(level[:2]) <= 1e-12 * abs(level[2]) and level[2] > 0


@pytest.mark.slow
@pytest.mark.parametrize("law", mostly_long(["radial-flow", "rotated-flow"], "rotated-flow"))
def test_a_flow_that_is_not_normal_is_refused(law: str) -> None:
    """The implicit step of each flow rule for k = 1, by hand: both stay in K and dissipate, and neither is a closest point."""
    values = {"radial-flow": {"mu_a": 0.5, "mu_b": 0.1}, "rotated-flow": {"mu": 0.3, "delta": 0.5}}[law]

    def rotated(trial: Array, pressure: Array, stiffness: Array) -> Array:
        size, e = np.hypot(*trial.T), -0.3 * pressure
        out = size > e
        # sigma + l R(delta) sigma = trial with |sigma| = e: 1 + 2 l cos(delta) + l^2 = (|trial|/e)^2
        q = np.where(out & (e > 0), (size / np.where(e > 0, e, 1.0)) ** 2 - 1.0, 0.0)
        slide = q / (np.cos(0.5) + np.sqrt(np.cos(0.5) ** 2 + q))
        z = (trial[:, 0] + 1j * trial[:, 1]) / (1.0 + slide * np.exp(0.5j))
        z = np.where(out & (e == 0), 0.0, z)
        return np.stack([z.real, z.imag], axis=1)

    update = {"radial-flow": radial_return, "rotated-flow": rotated}[law]
    report = conformance(law, update, values, stiffness=1.0, max_examples=6, rows=60, every=1, tries=5)
    assert {"variational-inequality", "firmness", "potential"} <= report.failed
    assert not {"feasibility", "idempotence", "dissipation", "path", "homogeneity", "complementarity", "convexity"} & report.failed, str(
        report
    )


THIN = {"mu_a": 700.0, "mu_b": 0.003}
FAR = np.array([[1400.0, 0.001], [1400.0, -0.001], [1400.0, 0.5], [1400.0, 0.0], [300.0, 0.003]])  # the last on an edge


def thin_case() -> Case:
    """Whose differences, at the step that the accuracy asks for, leave K both ways."""
    rows = len(FAR)
    nothing, ones = np.zeros((rows, 2)), np.ones(rows)
    return Case(
        THIN, np.eye(2), -ones, FAR, FAR, FAR, nothing, nothing, stretch=ones, factor=2.0, path=np.zeros((rows, 2, 2)),
        loads=np.stack([-ones, -ones], axis=1),
    )  # fmt: skip


def thin_box(change: Callable[[np.ndarray], np.ndarray]) -> Callable[..., Step]:
    """The exact answers, and a tangent that is changed."""

    def update(trial: np.ndarray, pressure: np.ndarray, _: np.ndarray) -> Step:
        ends = np.array([THIN["mu_a"], THIN["mu_b"]]) * np.abs(pressure)[:, None]
        inside = np.abs(trial) < ends
        return Step(np.clip(trial, -ends, ends), tangent=change(inside[:, :, None] * np.eye(2)))

    return update


@pytest.mark.parametrize(
    ("change", "right"),
    [
        (lambda c: c, True),
        (lambda c: 0.9 * c, False),
        (lambda c: 0.0 * c, False),
        (lambda c: 0.0 * c + np.eye(2), False),
        (lambda c: c[:, ::-1, ::-1], False),
        (lambda c: c + 1e-2 * np.eye(2), False),
    ],
)
def test_differences_resolve_a_set_that_is_thinner_than_their_step(change: Callable[[np.ndarray], np.ndarray], right: bool) -> None:
    found = violation("slope", "box", thin_box(change), thin_case(), open_parameters=())
    assert (found is None) == right


@pytest.mark.slow
@pytest.mark.parametrize(("share", "right"), mostly_long([(1.0, True), (4.0, False), (-1.0, False)], (4.0, False)))
def test_on_a_kink_of_the_answer_any_side_of_it_will_do(share: float, right: bool) -> None:
    """On an edge of a pyramid: the tangent of one face, which both differences along the third axis leave, sticking or to the edge."""
    law, k, slip = duhem.load("mujoco-pyramidal"), np.diag([123.0, 1.0, 1.0]), np.array([[-1.0, -1.0, 1.0 / 628.0]])
    trial, zero, one = np.array([[-1.0 / 1024.0, 0.0, 628.0 * (1.0 - 1.0 / 1024.0)]]), np.zeros((1, 3)), np.ones(1)
    face = k - (k @ slip.T) @ (slip @ k) / (slip @ k @ slip.T)
    exact = projection(law, "newton")

    def update(trial: np.ndarray, pressure: np.ndarray, stiffness: np.ndarray, **values: float) -> Step:
        return Step(exact(trial, pressure, stiffness, **values).stress, tangent=np.tile(share * face, (len(trial), 1, 1)))

    case = Case({"mu_1": 1.0, "mu_2": 628.0}, k, -one, trial, trial, trial, zero, zero, one, 2.0, np.zeros((1, 2, 3)), -np.ones((1, 2)))
    assert (violation("slope", law, update, case) is None) == right


@pytest.mark.slow
def test_a_tangent_is_accused_though_the_routine_gives_up_elsewhere() -> None:
    """It is wrong at a trial, and does not answer at the stress found there, which other checks ask for first."""

    def update(trial: np.ndarray, pressure: np.ndarray, stiffness: np.ndarray) -> Step:
        found = duhem.project("coulomb", trial, pressure, stiffness, {"mu": 0.3}, tangent=True)
        assert found.tangent is not None
        far = 0.3 * np.abs(pressure)
        beside = np.abs(np.linalg.norm(trial, axis=1) - far) <= 1e-9 * far
        return Step(found.stress, found.slip, found.multiplier, 2.0 * found.tangent, (found.status <= 1) & ~beside)

    report = conformance("coulomb", update, {"mu": 0.3}, stiffness=1.0, checks=["idempotence", "tangent"], max_examples=3, tries=20)
    assert [failure.check.name for failure in report.failures] == ["tangent"]


def at(parameters: dict[str, float], trial: list[float], pressure: float, k: list[float]) -> Case:
    """One increment of a law in a plane, and nothing else."""
    zero = np.zeros((1, 2))
    return Case(parameters, np.diag(k), [pressure], [trial], zero, zero, zero, zero, [2.0], 2.0, np.zeros((1, 2, 2)), [[pressure] * 2])


@pytest.mark.slow
@pytest.mark.parametrize("beyond", [0.0, -1e-15, 1e-15, 1e-12, 1e-10])
def test_a_tangent_is_not_accused_where_the_slope_jumps(beyond: float) -> None:
    """A trial at the end of an ellipse whose curvature differences cannot see: the slope is k inside and turns fast outside."""
    values = {"mu_a": 0.03, "mu_b": 510.0}
    case = at(values, [0.0, 510.0 * (1.0 + beyond)], -1.0, [1500.0, 0.15])
    assert violation("slope", "orthotropic", projection("orthotropic", tangent=True), case) is None


@pytest.mark.parametrize("beyond", [-1e-6, 1e-6])
def test_a_tangent_is_accused_next_to_where_the_slope_jumps(beyond: float) -> None:
    right = projection("orthotropic", tangent=True)

    def update(*given: np.ndarray, **values: float) -> Step:
        found = right(*given, **values)
        assert isinstance(found, Step) and found.tangent is not None
        return Step(found.stress, tangent=0.5 * np.asarray(found.tangent))

    case = at({"mu_a": 0.5, "mu_b": 0.1}, [0.0, 0.1 * (1.0 + beyond)], -1.0, [1.0, 1.0])
    assert violation("slope", "orthotropic", update, case) is not None
    assert violation("slope", "orthotropic", right, case) is None


@pytest.mark.parametrize(("width", "place"), [(0.1, 0.1 * (1.0 - 1e-5)), (1e-6, 5e-7), (1e-6, -4e-7), (1e-12, 0.0)])
@pytest.mark.parametrize("share", [1.0, 0.5])
def test_half_of_a_stiffness_is_no_tangent_just_inside(width: float, place: float, share: float) -> None:
    """As far from the boundary as a difference is long, its mean is half of k; thinner than what the accuracy lets see, nobody knows."""
    values = {"mu_a": 0.5, "mu_b": width}

    def update(trial: np.ndarray, pressure: np.ndarray, k: np.ndarray, **_: float) -> Step:
        ends = np.array([0.5, width]) * np.abs(pressure)[:, None]
        free = np.abs(trial) <= ends
        return Step(np.clip(trial, -ends, ends), tangent=(free * [1.0, share])[:, :, None] * np.eye(2))

    found = violation("slope", "box", update, at(values, [0.2, place], -1.0, [1.0, 1.0]))
    assert (found is None) == (share == 1.0 or width == 1e-12)


@pytest.mark.parametrize(("law", "values"), [("coulomb", {"mu": 0.3}), ("box", {"mu_a": 0.3, "mu_b": 0.2})])
def test_a_set_that_is_one_point_has_either_tangent_there(law: str, values: dict[str, float]) -> None:
    for share, trial, right in ((1.0, 0.0, True), (0.0, 0.0, True), (1.0, 1.0, False), (0.0, 1.0, True)):

        def update(trial: np.ndarray, pressure: np.ndarray, k: np.ndarray, share: float = share, **_: float) -> Step:
            return Step(0.0 * trial, tangent=np.tile(share * k, (len(trial), 1, 1)))

        case = at(values, [trial, trial], 0.0, [2.0, 3.0])
        assert (violation("slope", law, update, case) is None) == right


@pytest.mark.parametrize(("off", "accuracy", "right"), [(1e-6, 1e-9, True), (1e-6, 1e-15, False), (None, 1e-15, True)])
def test_beside_a_far_trial_the_accuracy_says_what_the_answer_may_be_off_by(off: float | None, accuracy: float, right: bool) -> None:
    """A trial 1e8 times as far out as K: the answer is off by a part of itself, or by what the trial less the slip is rounded to."""

    def update(trial: np.ndarray, *_: object) -> np.ndarray:
        answer = np.tile([0.3, 0.0], (len(trial), 1))
        return trial - (trial - answer) if off is None else (1.0 + off) * answer

    case = at({"mu": 0.3}, [3e7, 0.0], -1.0, [1.0, 1.0])
    assert (violation("feasibility", "coulomb", update, case, open_parameters=(), accuracy=accuracy) is None) == right


def test_a_complex_stress_is_no_answer() -> None:
    def update(trial: np.ndarray, *_: object) -> np.ndarray:
        return np.clip(trial, -0.3, 0.3) + 1e-3j

    found = violation("answers", "box", update, at({"mu_a": 0.3, "mu_b": 0.3}, [0.0, 1.0], -1.0, [1.0, 1.0]), open_parameters=())
    assert found is not None and "the stress is complex" in found


@pytest.mark.parametrize("spoilt", [None, 0, 1, 2])
def test_a_routine_leaves_what_it_is_given(spoilt: int | None) -> None:
    right = projection("coulomb")

    def update(*given: np.ndarray, **values: float) -> object:
        found = right(*(array.copy() for array in given), **values)
        if spoilt is not None:
            given[spoilt][...] = 0.0
        return found

    case = at({"mu": 0.3}, [0.0, 1.0], -1.0, [1.0, 1.0])
    assert (violation("inputs", "coulomb", update, case) is None) == (spoilt is None)
    assert violation("feasibility", "coulomb", update, case) is None


@pytest.mark.parametrize("seed", long_at([0], [1, 2, 3]))
def test_a_slip_that_leans_a_little_is_found_at_each_seed(seed: int) -> None:
    """Radial return to a disk under stiffnesses a fifth apart: two points drawn saw it at one seed in three."""

    def disk(trial: Array, pressure: Array, stiffness: Array) -> Array:
        size = np.hypot(*trial.T)
        return trial * np.divide(-0.3 * pressure, size, out=np.ones_like(size), where=size > -0.3 * pressure)[:, None]

    asked = {"stiffness": [1e9, 1.2e9], "checks": "variational-inequality", "max_examples": 3, "tries": 0, "seed": seed}
    assert conformance("coulomb", disk, {"mu": 0.3}, **asked).failed == {"variational-inequality"}
    assert conformance("coulomb", disk, {"mu": 0.3}, **asked | {"stiffness": 1e9}).ok


@pytest.mark.slow
@pytest.mark.parametrize("seed", long_but([1], [1, 2, 3]))
def test_an_open_contact_at_rest_is_asked(seed: int) -> None:
    """No stress under no pressure is 0/0 to many a radial return."""

    def open_(trial: Array, pressure: Array, stiffness: Array) -> Array:
        with np.errstate(all="ignore"):
            return trial / np.maximum(1.0, np.hypot(*trial.T) / (-0.3 * pressure))[:, None]

    assert "answers" in conformance("coulomb", open_, {"mu": 0.3}, stiffness=1e9, checks="answers", tries=0, seed=seed).failed


@pytest.mark.long
def test_slips_go_all_round() -> None:
    """Of 72 sectors of five degrees at most a few are empty in a run of the usual length."""
    asked: list[Array] = []

    def kept(trial: Array, pressure: Array, stiffness: Array) -> Array:
        asked.append(trial[np.hypot(*trial.T) > -0.3 * pressure])
        return trial

    conformance("coulomb", kept, {"mu": 0.3}, stiffness=1e9, checks="answers", seed=1)
    angles = np.degrees(np.arctan2(*np.concatenate(asked).T))
    assert (np.histogram(angles, np.arange(-180, 181, 5))[0] == 0).sum() < 8


@pytest.mark.slow
@pytest.mark.parametrize(("width", "from_the_end"), mostly_long(product((2, 3, 4, 8), (True, False)), (2, True), (4, False)))
def test_a_loop_over_several_rows_that_leaves_the_last_ones_alone_is_found(width: int, from_the_end: bool) -> None:
    """Vectorised loops take so many rows at a time; the rest of the division is asked too, whatever rows stand there."""

    def clipped(trial: Array, pressure: Array, stiffness: Array) -> Array:
        size, limit = np.linalg.norm(trial, axis=1), 0.3 * np.abs(pressure)
        stress = trial * np.divide(limit, size, out=np.ones_like(size), where=size > limit)[:, None]
        left = len(trial) % width if len(trial) > width else 0
        rows = slice(len(trial) - left, None) if from_the_end else slice(0, left)
        stress[rows] = trial[rows]
        return stress

    report = conformance("coulomb", clipped, {"mu": 0.3}, stiffness=1e9, seed=7)
    assert not report.ok
