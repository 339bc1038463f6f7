"""The loop and the judge of laws with eigenvalues: in the text that a compiler is given, on faces and where two eigenvalues are equal.

Of an isotropic law and stiffness the stress has the axes of the trial, so that the law in principal stresses, with forces of which none
is an eigenvalue, says the same.  For other stiffnesses it is asked whether points of K lie beyond the plane across the slip.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import mpmath
import numpy as np
import pytest

import duhem
from duhem import Criterion, InputError
from duhem.expression import mpmath_, numpy_
from duhem.expression.scalar_jets import scalar_jets
from duhem.projection import compiled_newton, newton
from duhem.projection.in_blocks import FEW_SEARCHED
from duhem.projection.increment import Increment, Metric, posed, setting
from duhem.projection.newton_kernel import LEFT, SLIP
from duhem.projection.normal_cones import Suspect, off_edge
from duhem.projection.projector import Projector
from duhem.projection.result import Solution, Status
from duhem.projection.scaled_formula import level, scaled
from duhem.projection.whitened_body import whitening
from tests.expression.text_as_functions import named
from tests.projection.loop_as_text import as_text

LAWS = {
    "tresca": "principal(1) - principal(3) - 1",
    "mohr-coulomb": "(1 + 1/3)*principal(1) - (1 - 1/3)*principal(3) - 1",
    "rankine": "principal(1) - 1/2",
    "hosford": "(principal(1) - principal(2))**8 + (principal(2) - principal(3))**8 + (principal(1) - principal(3))**8 - 2",
    "hoek-brown": "principal(1) - principal(3) - sqrt(pos(1 - 2*principal(1)))",
    "cut off": "max(principal(1) - principal(3) - 1, principal(1) - 1/3)",
}
SHEARS = np.array([1.0, 1.0, 1.0, 0.5, 0.5, 0.5])
ALIKE = np.diag(1.4 * SHEARS) + np.pad(np.full((3, 3), 0.6), (0, 3))
Edit = Callable[[str], str]


def _law(name: str, kind: str = "3d") -> Criterion:
    return Criterion(name=name, g=LAWS[name], stress={"name": "s", "kind": kind}, pressure=None)


def _trials(n: int, seed: int = 0, size: float = 1.0) -> np.ndarray:
    return np.asarray(size * np.random.default_rng(seed).standard_normal((n, 6)))


def _question(name: str, trial: np.ndarray, stiffness: Any = ALIKE) -> Increment:
    return posed(setting(_law(name), stiffness, {}), trial, None)


def _any_stiffness(seed: int = 1) -> np.ndarray:
    drawn = np.random.default_rng(seed).standard_normal((6, 6))
    return np.asarray(drawn @ drawn.T / 6.0 + np.eye(6))


def _by_text(question: Increment, edit: Edit = str) -> tuple[Solution, np.ndarray]:
    """The loop, not compiled, from its text after an ``edit``."""
    (n, d), forces = question.trial.shape, question.law.force_symbols()
    formula = scaled(question.g, forces, None)
    jets = scalar_jets(formula.expr, forces, tuple(formula.data))
    space: dict[str, Any] = {}
    exec(edit(compiled_newton.kernel_text(formula, jets, d)), space)
    values = formula.values(question.pressure, np.ones(n))
    data = np.stack(list(values.values()), axis=1) if values else np.zeros((n, 0))
    mean, root = whitening(question)
    out, state = Solution(np.empty((n, d)), np.empty((n, d)), np.empty(n), np.zeros(n, dtype=bool)), np.empty(n, dtype=np.int8)
    with np.errstate(all="ignore"):
        given = question.trial, data, np.array(jets.constants), root, np.linalg.inv(root), formula.degree
        space["solve"](*given, out.stress, out.slip, out.multiplier, state)
    return Solution(out.stress, out.slip / mean, out.multiplier / mean, out.failed), state


def _matrices(stress: np.ndarray) -> np.ndarray:
    x, y, z, yz, xz, xy = stress.T
    return np.stack([np.stack([x, xy, xz]), np.stack([xy, y, yz]), np.stack([xz, yz, z])]).transpose(2, 0, 1)


def _double(stress: np.ndarray) -> np.ndarray:
    """Points with two equal eigenvalues."""
    return np.asarray(np.diff(np.linalg.eigvalsh(_matrices(stress)), axis=1).min(axis=1) < 1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("name", LAWS)
def test_the_loop_is_the_law_in_principal_stresses(name: str) -> None:
    trial = _trials(24)
    found, state = _by_text(_question(name, trial))
    values, axes = np.linalg.eigh(_matrices(trial))
    plain = duhem.project(_law(name, "principal"), values, stiffness=ALIKE[:3, :3], method="newton")
    assert set(np.unique(plain.status)) <= {Status.STICK, Status.SLIP, Status.STATIONARY}
    done = state != LEFT
    assert done.mean() >= 0.7 and (state == SLIP).sum() >= 12  # an edge in which two surfaces meet is the search's
    whole = np.einsum("nij,nj,nkj->nik", axes, plain.stress, axes)
    assert _matrices(found.stress)[done] == pytest.approx(whole[done], abs=1e-12)
    assert found.multiplier[done] == pytest.approx(plain.multiplier[done], rel=1e-11, abs=1e-12)
    moved = np.einsum("nij,nj,nkj->nik", axes, plain.slip, axes)
    assert _matrices(found.slip * SHEARS)[done] == pytest.approx(moved[done], abs=1e-12)
    if name in ("tresca", "mohr-coulomb"):
        assert done.all() and _double(found.stress).sum() >= 4


@pytest.mark.slow
@pytest.mark.parametrize("name", ["tresca", "mohr-coulomb", "hosford"])
def test_for_any_stiffness_no_point_of_k_is_beyond_the_slip(name: str) -> None:
    trial, k = _trials(20, 3, 1.5), _any_stiffness()
    found, state = _by_text(_question(name, trial, k))
    done = state != LEFT
    assert done.mean() >= 0.9 and (name == "hosford" or _double(found.stress[done]).sum() >= 5)
    assert (trial - found.slip @ k)[done] == pytest.approx(found.stress[done], abs=1e-12)
    inside = _trials(4000, 9, 0.5)
    g = numpy_.evaluate(_law(name).g, dict(zip(_law(name).force_symbols(), inside.T, strict=True)))
    inside = inside[g <= 0.0]
    assert len(inside) >= 20
    beyond = (inside @ found.slip[done].T - np.einsum("nd,nd->n", found.stress, found.slip)[done]).max()
    assert beyond <= 1e-11
    judged = duhem.project(_law(name), trial, stiffness=k, method="newton")
    assert judged.stress[done] == pytest.approx(found.stress[done], abs=1e-12) and set(judged.status[done]) <= {0, 1}


def _flatter(text: str) -> str:
    changed, count = re.subn(
        r"(t\d+) = \(2\.0\)(?= \* t\d+\n(?:.*\n)*?.* = \1 / )|2\.0(?=\) / )", lambda m: m[0].replace("2.0", "1.0"), text
    )
    assert count
    return changed


GAPS = (0.7, 1e-2, 1e-4, 1e-6)  # at smaller ones Tresca and Hoek-Brown have no second derivative, or one of 1e9
BENDS = [*((name, gap) for name in ("tresca", "hoek-brown") for gap in GAPS), *(("hosford", gap) for gap in (*GAPS, 1e-9, 0.0))]


@pytest.mark.parametrize(("name", "gap"), BENDS)
def test_second_derivatives_are_those_of_differences_in_many_digits(name: str, gap: float) -> None:
    """Those of a smooth function are known at equal eigenvalues too; half of what axes add by turning is noticed."""
    g = _law(name).g
    forces = _law(name).force_symbols()
    turn, _ = np.linalg.qr(np.random.default_rng(2).standard_normal((3, 3)))
    whole = turn @ np.diag([0.31, 0.31 - gap, -0.8]) @ turn.T
    at, way = whole[[0, 1, 2, 1, 0, 0], [0, 1, 2, 2, 2, 1]], np.array([0.3, -0.5, 0.2, 0.7, -0.4, 0.6])

    def along(t: Any) -> Any:
        return mpmath.mpf(mpmath_.evaluate(g, {s: a + w * mpmath.mpf(t) for s, a, w in zip(forces, at, way, strict=True)}, 400))

    with mpmath.workdps(100):
        expected = float(mpmath.diff(along, 0, 2, h=mpmath.mpf(10) ** -30))

    def second(edit: Edit) -> float:
        text = scalar_jets(g, forces, ())
        space = named("sqrt", "nan", "inf")
        exec(edit(text.piece), space)
        v, m = np.array([at, np.zeros(6)]), np.zeros((1, 6, 6))
        space["piece"](v, 0, np.array(text.constants), 1, np.zeros((1, text.kinks), dtype=np.int8), 0, 1, m, 0)
        return float(way @ m[0] @ way)

    assert second(str) == pytest.approx(expected, rel=1e-8 if gap < 1e-2 else 1e-11)
    if gap >= 1e-2:
        assert abs(second(_flatter) / expected - 1.0) > 1e-3


@pytest.mark.slow
def test_pieces_of_a_pair_that_are_turned_wrongly_answer_nothing() -> None:
    question = _question("tresca", _trials(24))
    found, state = _by_text(question)
    double = _double(found.stress)
    _, spoilt = _by_text(question, lambda text: text.replace("sqrt(0.75) if i == 1", "sqrt(0.5) if i == 1"))
    assert double.sum() >= 5 and (spoilt[double] == LEFT).all() and (spoilt[~double] == state[~double]).all()


@pytest.mark.slow
def test_of_many_points_the_loop_solves_what_arrays_lose(monkeypatch: pytest.MonkeyPatch) -> None:
    trial, k = _trials(FEW_SEARCHED + 1, 3, 1.5), _any_stiffness()
    question = _question("tresca", trial, k)
    shape, lost = trial.shape, np.ones(len(trial), dtype=bool)
    monkeypatch.setattr(
        newton, "search", lambda _: Solution(np.full(shape, np.nan), np.full(shape, np.nan), np.full(shape[0], np.nan), lost)
    )
    done = Projector.of(question.law, k, method="newton").at(question)
    assert (done.status == SLIP).all() and done.stress == pytest.approx(trial - done.slip @ k, abs=1e-12)


# -- the judge ---------------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("full", [False, True], ids=["isotropic", "any"])
def test_the_judge_passes_slips_at_edges_and_no_others(full: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    question = _question("tresca", _trials(24, 5), _any_stiffness() if full else ALIKE)
    found, _ = _by_text(question)
    double = _double(found.stress)
    told = as_text(monkeypatch, question, found, True)
    assert double.sum() >= 5 and told.left is not None and not set(np.flatnonzero(double)) & set(told.left)
    assert (told.status[double] == SLIP).all()
    spoilt = Solution(found.stress.copy(), found.slip.copy(), found.multiplier.copy(), found.failed)
    spoilt.slip[:, 0] += 1e-6
    told = as_text(monkeypatch, question, spoilt, True)
    assert told.left is not None and set(np.flatnonzero(double)) <= set(told.left)
    spoilt = Solution(found.stress.copy(), found.slip.copy(), found.multiplier * (1.0 + 1e-6), found.failed)
    told = as_text(monkeypatch, question, spoilt, True)
    assert told.left is not None and set(np.flatnonzero(double)) <= set(told.left)


@pytest.mark.parametrize(("pair", "within"), [((0.7, 0.3), True), ((1.0, 0.0), True), ((0.5, 0.5), True), ((1.2, -0.2), False)])
def test_normals_of_an_edge_are_sums_with_a_positive_semidefinite_matrix(pair: tuple[float, float], within: bool) -> None:
    """At diag(1, 1, 0) Tresca's normals are M - e_z e_z^T with M in the plane of x and y, its trace 1: here turned by an angle."""
    c, s = np.cos(0.4), np.sin(0.4)
    plane = np.array([[c, -s], [s, c]]) @ np.diag(pair) @ np.array([[c, s], [-s, c]])
    slip = np.array([plane[0, 0], plane[1, 1], -1.0, 0.0, 0.0, 2.0 * plane[0, 1]])
    law = _law("tresca")
    known = level(law.g, law.force_symbols(), None)
    stress, metric = np.array([[1.0, 1.0, 0.0, 0.0, 0.0, 0.0]]), Metric.of(np.diag(SHEARS))
    room = float(np.linalg.norm(stress[0] @ metric.of_stress))
    one, far = np.ones(1), np.full(1, room)
    suspect = Suspect(stress, np.zeros(1), one, (slip @ metric.of_slip)[None] / room, one / room, far, np.zeros(1), np.zeros(1, dtype=bool))
    off = off_edge(known, metric, suspect)
    assert (off[0] <= 1e-14) == within


def test_a_law_without_eigenvalues_has_no_such_edge() -> None:
    law = Criterion(name="ball", g="norm(a, b) - 1", forces=("a", "b"), pressure=None)
    one = np.ones((1, 2))
    known = level(law.g, law.force_symbols(), None)
    suspect = Suspect(one, np.zeros(1), np.ones(1), one, np.ones(1), np.ones(1), np.zeros(1), np.zeros(1, dtype=bool))
    assert off_edge(known, Metric.of(np.eye(2)), suspect).tolist() == [np.inf]


# -- compiled ----------------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.long
def test_compiled_it_is_the_text() -> None:
    pytest.importorskip("numba")
    question = _question("tresca", _trials(40, 7))
    found, state = _by_text(question)
    made, left = compiled_newton.solved(question, 1)
    assert not left.size and (state != LEFT).all()
    for one, other in ((made.stress, found.stress), (made.slip, found.slip), (made.multiplier, found.multiplier)):
        assert one == pytest.approx(other, abs=1e-12)


def test_where_there_is_no_loop_compiled_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compiled_newton.Loop, "of", lambda *_, **__: None)
    with pytest.raises(InputError, match=r"tresca has no compiled loop.*leave compiled out"):
        newton.solve(_question("tresca", _trials(2)), newton.NewtonOptions(compiled=True))
