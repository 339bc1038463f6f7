"""Increments of contact with friction, against every set of faces tried and against closed forms."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations
from typing import Any

import numpy as np
import pytest

import duhem
from duhem import Criterion, InputError, Status
from duhem.api.contact import Contact, contact
from tests.long import mostly_long

MU = 0.4
FACES: dict[str, list[tuple[float, float]]] = {
    "polygon": [(s * x / MU, t * y / MU) for x, y in ((1, 0), (0, 1), (0.8, 0.6), (0.6, 0.8)) for s in (1, -1) for t in (1, -1)],
    "box": [(1 / MU, 0), (-1 / MU, 0), (0, 5), (0, -5)],
}
GIVEN: dict[str, dict[str, float]] = {"polygon": {"mu": MU}, "box": {"mu_a": MU, "mu_b": 0.2}}
PLAIN = np.diag([1.0, 2.0, 3.0])
WEAK = np.array([[1.0, 0.2, 0.5], [0.2, 2.0, -0.6], [0.5, -0.6, 3.0]])
STRONG = np.array([[1.0, 0.0, -3.0], [0.0, 1.0, 0.0], [-3.0, 0.0, 10.0]])  # |k_nt| M = 3 * 0.4 > 1 along a


def drawn(n: int, d: int = 2) -> Any:
    chance = np.random.default_rng(8)
    return chance.standard_normal((n, d + 1)) * 10.0 ** chance.uniform(-1.0, 1.0, (n, 1))


def every_answer(faces: list[tuple[float, float]], k: Any, trial: Any) -> Iterator[Any]:
    """(sigma_a, sigma_b, sigma_n) for each set of faces that slips, the empty one too, or with no contact: all linear equations."""
    normals, close = np.unique(np.array(faces), axis=0), 1e-9 * np.linalg.norm(trial)
    apart = np.linalg.solve(k, trial)
    if apart[2] >= 0.0:
        yield np.zeros(3)
    for size in range(3):
        for chosen in combinations(range(len(normals)), size):
            slips = np.column_stack([normals[list(chosen)], np.zeros(size)])  # (size, 3): no opening
            loads = np.column_stack([normals[list(chosen)], np.ones(size)])  # a . sigma + sigma_n = 0
            system = loads @ k @ slips.T
            if size and abs(np.linalg.det(system)) < 1e-9:
                continue
            share = np.linalg.solve(system, loads @ trial) if size else np.zeros(0)
            stress = trial - k @ (slips.T @ share)
            inside = normals @ stress[:2] + stress[2] <= close
            if stress[2] <= 0.0 and (share >= 0.0).all() and inside.all():
                yield stress


def apart(answers: list[Any]) -> list[Any]:
    """Those that are not the same."""
    found: list[Any] = []
    for answer in answers:
        if all(np.linalg.norm(answer - other) > 1e-8 for other in found):
            found.append(answer)
    return found


@pytest.mark.slow
@pytest.mark.parametrize("law", FACES)
@pytest.mark.parametrize("k", [PLAIN, WEAK], ids=["plain", "weak"])
def test_polygons_answer_as_every_set_of_faces_does(law: str, k: Any) -> None:
    trials = drawn(30)
    found = contact(law, trials, k, GIVEN[law])
    assert found.unique.all() and {*found.status.tolist()} <= {Status.STICK, Status.SLIP}
    assert np.nanmax(np.abs(found.gap)) < 1e-12 and found.balance.max() < 1e-12
    kinds = set()
    for row, stress in zip(trials, found.stress, strict=True):
        (expected,) = apart([*every_answer(FACES[law], k, row)])
        assert np.linalg.norm(stress - expected) <= 1e-10 * np.linalg.norm(row)
        kinds.add(bool(expected[2] < 0.0))
    assert kinds == {True, False}


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
@pytest.mark.parametrize("across", [(0.0, 0.0), (0.8, -0.6), (1.4, 0.9)])
def test_coulombs_law_has_a_closed_form(across: tuple[float, float], scale: float) -> None:
    c, trials = np.array(across), drawn(200) * scale
    k = np.array([[1.0, 0.0, c[0]], [0.0, 1.0, c[1]], [c[0], c[1], 9.0]])
    size = np.linalg.norm(trials[:, :2], axis=1)
    along = trials[:, :2] / size[:, None]
    sticks = size <= -MU * trials[:, 2]
    pressure = np.where(sticks, -trials[:, 2], (size * (along @ c) - trials[:, 2]) / (1.0 + MU * (along @ c)))
    pressure = np.where(trials[:, 2] - trials[:, :2] @ c >= 0.0, 0.0, pressure)  # apart
    tangential = np.where(sticks[:, None], trials[:, :2], MU * pressure[:, None] * along)
    found = contact("coulomb", trials, k, {"mu": MU})
    assert found.unique.all() and 0 < np.count_nonzero(pressure) < 200
    assert np.abs(found.stress - np.column_stack([tangential, -pressure])).max() <= 1e-10 * np.abs(trials).max()
    assert np.abs(found.gap).max() < 1e-12 and (found.opening[pressure > 0.0] == 0.0).all() and (found.opening >= 0.0).all()


SEVERAL = [
    ("antoni2007", {"mu_a_plus": 0.2, "mu_a_minus": 0.08, "mu_b_plus": 0.12, "mu_b_minus": 0.15}),
    ("shifted-ellipse", {"mu_a": 0.3, "mu_b": 0.1, "shift": 0.125}),
    ("superellipse", {"mu_a": 0.3, "mu_b": 0.1, "p": 4.0}),
]


@pytest.mark.parametrize(("law", "given"), mostly_long(SEVERAL, SEVERAL[0]))
@pytest.mark.parametrize("k", [PLAIN, WEAK], ids=["plain", "weak"])
def test_other_gauges_are_held_against_the_bipotential(law: str, given: dict[str, float], k: Any) -> None:
    found = contact(law, drawn(40), k, given)
    assert found.unique.all() and {*found.status.tolist()} <= {Status.STICK, Status.SLIP}
    assert np.abs(found.gap).max() < 1e-12 and found.balance.max() < 1e-12


def test_one_direction_of_slip_and_one_increment() -> None:
    found = contact("antoni2007-1d", [3.0, -2.0], [2.0, 5.0], {"mu_plus": 0.5, "mu_minus": 0.25})
    assert found.stress.tolist() == [[1.0, -2.0]] and found.slip.tolist() == [[1.0]] and found.opening.tolist() == [0.0]
    found = contact("antoni2007-1d", [3.0, 2.0], [2.0, 5.0], {"mu_plus": 0.5, "mu_minus": 0.25})
    assert found.stress.tolist() == [[0.0, 0.0]] and found.slip.tolist() == [[1.5]] and found.opening.tolist() == [0.4]


def test_of_a_strong_coupling_uniqueness_is_not_said_and_there_are_two_answers() -> None:
    trials = drawn(80)
    several = [row for row in trials if len(apart([*every_answer(FACES["box"], STRONG, row)])) > 1]
    assert several
    found = contact("box", np.array(several), STRONG, GIVEN["box"])
    assert not found.unique.any() and np.abs(found.gap).max() < 1e-12 and found.balance.max() < 1e-12
    for row, stress in zip(several, found.stress, strict=True):
        assert min(np.linalg.norm(stress - one) for one in every_answer(FACES["box"], STRONG, row)) <= 1e-10 * np.linalg.norm(row)


def judged(monkeypatch: pytest.MonkeyPatch, change: Any) -> Contact:
    """The answers where the normal part is another one."""
    import duhem.api.contact as module

    right = module._normal_part
    with monkeypatch.context() as context:
        context.setattr(module, "_normal_part", lambda *given: change(*right(*given)))
        return contact("coulomb", drawn(40), WEAK, {"mu": MU})


@pytest.mark.parametrize(
    "change",
    [
        pytest.param(lambda p, v: (1.01 * p, v), id="another pressure"),
        pytest.param(lambda p, v: (p, v + 0.01 * (v == 0.0)), id="open under pressure"),
        pytest.param(lambda p, v: (p, 0.5 * v), id="half of the opening"),
        pytest.param(lambda p, v: (p + 0.01 * (p == 0.0), v), id="pressed while apart"),
    ],
)
def test_a_wrong_answer_is_called_inaccurate(monkeypatch: pytest.MonkeyPatch, change: Any) -> None:
    right, wrong = contact("coulomb", drawn(40), WEAK, {"mu": MU}), judged(monkeypatch, change)
    changed = np.abs(right.stress - wrong.stress).max(axis=1) + np.abs(right.opening - wrong.opening) > 1e-6
    assert changed.any() and (wrong.status[changed] == Status.INACCURATE).all()


def test_the_gap_alone_tells_an_opening_under_pressure_and_a_slip_that_is_not_normal() -> None:
    from duhem.api.contact import _against_the_bipotential, _polar

    polar, right = _polar(duhem.load("coulomb"), (("mu", MU),)), contact("coulomb", [3.0, 4.0, -2.0], 1.0, {"mu": MU})
    stress, pressure = right.stress[:, :2], -right.stress[:, 2]

    def judge(slip: Any, opening: float) -> float:
        return float(_against_the_bipotential(polar, np.eye(3), stress, pressure, slip, np.array([opening]))[0][0])

    assert abs(judge(right.slip, 0.0)) < 1e-15
    assert judge(right.slip, 0.1) > 0.01 and judge(right.slip[:, ::-1], 0.0) > 0.01 and judge(-right.slip, 0.0) == 1.0


def test_without_a_closed_form_there_is_no_gap_to_tell() -> None:
    found = contact("limacon", drawn(5), PLAIN, {"mu": 0.3, "e": 0.25})
    assert np.isnan(found.gap).all() and found.balance.max() < 1e-12 and found.unique.all()


@pytest.mark.parametrize(
    ("law", "trial", "given", "said"),
    [
        ("cohesive", [1.0, 0.0, -1.0], {"mu": 0.5, "cohesion": 1.0}, "not seen to be proportional to sigma_n"),
        ("von-mises", [1.0, 0.0], {"yield_stress": 1.0}, "has no pressure"),
        ("coulomb", [1.0, 0.0], {"mu": 0.5}, "the shape"),
        ("coulomb", [1.0, 0.0, float("nan")], {"mu": 0.5}, "is nan"),
        ("radial-flow", [1.0, 0.0, -1.0], {"mu_a": 0.5, "mu_b": 0.5}, "its own flow direction"),
    ],
)
def test_what_cannot_be_asked_is_refused(law: str, trial: Any, given: dict[str, float], said: str) -> None:
    with pytest.raises(InputError, match=said):
        contact(law, trial, 1.0, given)


def test_a_stiffness_of_another_order_is_refused() -> None:
    with pytest.raises(InputError, match="stiffness"):
        contact("coulomb", [1.0, 0.0, -1.0], [1.0, 2.0], {"mu": 0.5})
    with pytest.raises(InputError, match="positive definite"):
        contact("coulomb", [1.0, 0.0, -1.0], [[1.0, 0.0, 2.0], [0.0, 1.0, 0.0], [2.0, 0.0, 1.0]], {"mu": 0.5})


def test_it_is_offered_by_name() -> None:
    assert duhem.contact is contact and isinstance(duhem.load("coulomb"), Criterion)


ODD = (
    "norm(sigma_a, sigma_b)*abs(sigma_n) - 2/5*sigma_n**2",
    "norm(sigma_a, sigma_b)**2*abs(sigma_n) - 4/25*abs(sigma_n)**3",
    "(norm(sigma_a, sigma_b) + 2/5*sigma_n)*abs(sigma_n)",
    "sqrt(abs(sigma_n))*norm(sigma_a, sigma_b) - 2/5*abs(sigma_n)**(3/2)",
    "norm(sigma_a, sigma_b)/abs(sigma_n) - 2/5",
    "norm(sigma_a/sigma_n, sigma_b/sigma_n) - 2/5",
)


@pytest.mark.slow
@pytest.mark.parametrize("g", mostly_long(ODD, ODD[0], ODD[4]))
def test_an_open_contact_has_no_stress_however_the_law_is_written(g: str) -> None:
    """At sigma_n = 0 these formulas are another set than 0 K(-1) = {0}, or none."""
    trials = np.array([[3.0, 4.0, 2.0], [3.0, 4.0, 0.0], [3.0, 4.0, -2.0], [0.1, 0.0, -2.0], [0.0, 0.0, 1.0]])
    for k in (PLAIN, WEAK):
        found, known = contact(Criterion("odd", g, {}), trials, k), contact("coulomb", trials, k, {"mu": MU})
        for one, other in ((found.stress, known.stress), (found.slip, known.slip), (found.opening, known.opening)):
            assert np.abs(one - other).max() < 1e-9
        assert (found.status == known.status).all() and np.isin(found.status, (Status.STICK, Status.SLIP)).all()


def test_no_answer_is_given_where_an_open_contact_may_keep_a_stress() -> None:
    """K(-1) = {sigma_a^2 + sigma_b/2 <= 0} has no end along -sigma_b alone: (0, 4) is no stress without pressure."""
    found = contact(Criterion("parabola", "sigma_a**2 - 1/2*sigma_b*sigma_n", {}), [[3.0, 4.0, 2.0], [0.0, -4.0, 2.0]])
    assert found.status[0] == Status.FAILED and found.status[1] == Status.STICK
    assert found.stress[1].tolist() == [0.0, -4.0, 0.0]
