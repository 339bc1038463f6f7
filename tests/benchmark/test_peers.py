"""Other programs beside duhem's methods: what they are given is the law, and what is said of them is measured."""

from __future__ import annotations

from dataclasses import replace
from importlib.util import find_spec
from typing import Any

import numpy as np
import pytest

import duhem
from duhem.benchmark import throughput
from duhem.benchmark.contenders import JAXMAT, PEERS, SLSQP, Contender, Peer, PeerOptions, Specimen, _moduli, _said, _surface, applicable
from duhem.benchmark.extreme_cases import stress
from duhem.benchmark.measurement import Measurement, Spread
from duhem.benchmark.throughput import beside_peers
from duhem.benchmark.work_precision import bench
from duhem.errors import InputError
from duhem.expression.numpy_ import compiled
from duhem.law.formula_law import Criterion
from duhem.projection import conic_solvers
from duhem.projection.half_spaces import planes
from duhem.projection.increment import Increment
from duhem.projection.projector import Projector
from duhem.projection.result import ACCURACY, Status
from duhem.show.printing import text

SLSQP_ALONE = Contender("scipy SLSQP", SLSQP, PeerOptions())


def specimen(name: str, stiffness: tuple[float, ...] | None = None, **values: Any) -> Specimen:
    law = duhem.load(name)
    assert isinstance(law, Criterion)
    return Specimen.of(law.fix(values), stiffness)


def asked(found: Specimen, points: int = 50) -> Increment:
    trial = np.random.default_rng(3).normal(size=(points, len(found.law.forces)))
    return found.question(trial, None if found.pressure is None else -np.linspace(0.2, 3.0, points))


def written(g: str) -> Increment:
    return asked(Specimen.of(Criterion("written", g)))


# -- planes ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("question", "count"),
    [
        (asked(specimen("box", mu_a="0.5", mu_b="0.25")), 4),
        (asked(specimen("polygon", mu="0.25")), 12),
        (asked(specimen("tresca", yield_stress="1")), 6),
        (written("2*pos(sigma_a) + 3*neg(sigma_a - 1) + norm(sigma_b)/4 + sigma_n - 3"), 8),
        (written("max(sigma_a + 2*sigma_b, -sigma_b/3) - abs(sigma_n)"), 2),
    ],
)
def test_the_planes_are_the_boundary(question: Increment, count: int) -> None:
    found = planes(question)
    assert found is not None
    normals, offsets = found
    assert normals.shape == (count, question.trial.shape[1])
    beyond = (question.trial @ normals.T - offsets).max(axis=1)
    law = question.law
    symbols = (*law.force_symbols(), *([law.symbols()[law.pressure]] if law.pressure else []))
    g = compiled(question.g, symbols)(*question.trial.T, *([question.pressure] if law.pressure else []))
    assert beyond == pytest.approx(g, rel=1e-12, abs=1e-12)


@pytest.mark.parametrize(
    "g",
    [
        "norm(sigma_a, sigma_b) + sigma_n",
        "min(abs(sigma_a), abs(sigma_b)) + sigma_n",
        "1 - abs(sigma_a)",
        "sigma_a*sigma_b + sigma_n",
        "abs(sigma_a)*abs(sigma_n) - 1",
        "abs(abs(sigma_a) - 1) + abs(sigma_b) + sigma_n",
        "sigma_a**2 + abs(sigma_b) - 1",
        "exp(abs(sigma_a)) - 2",
        "where(sigma_a > 0, sigma_a, -2*sigma_a) + abs(sigma_b) - 1",
    ],
)
def test_what_is_not_seen_to_be_a_greatest_of_planes_is_left_out(g: str) -> None:
    assert planes(written(g)) is None


# -- surfaces --------------------------------------------------------------------------------------------------------

ALIKE = (2.0, 2.0, 2.0)


@pytest.mark.parametrize(
    ("found", "surface"),
    [
        (specimen("von-mises", ALIKE, yield_stress="2"), ("vonMises", 0.0, 2.0)),
        (specimen("tresca", ALIKE, yield_stress="2"), ("Tresca", 0.0, 2.0)),
        (specimen("hosford", ALIKE, yield_stress="2", m="6"), ("Hosford", 6.0, 2.0)),
        (specimen("hosford", ALIKE, yield_stress="1", m="4"), ("vonMises", 0.0, 1.0)),  # the same set
        (specimen("drucker1949", ALIKE, k="1", c="2"), None),
        (specimen("coulomb", mu="0.3"), None),
    ],
)
def test_a_surface_is_known_by_its_values(found: Specimen, surface: tuple[str, float, float] | None) -> None:
    got = _surface(asked(found))
    assert (got is None) == (surface is None)
    if got is not None and surface is not None:
        assert got[0] == surface[0] and got[1:] == pytest.approx(surface[1:], rel=1e-14)


@pytest.mark.parametrize("g", ["2*(norm(s1 - s2, s2 - s3, s3 - s1)/sqrt(2) - 1)", "norm(s1 - s2, s2 - s3, s3 - s1)/sqrt(2) - 1 + s1/1e6"])
def test_a_neighbour_of_a_surface_is_none(g: str) -> None:
    law = Criterion("near", g, {}, forces=("s1", "s2", "s3"), pressure=None)
    assert _surface(asked(Specimen.of(law, ALIKE))) is None


def test_elasticity_of_a_material_is_isotropic() -> None:
    assert _moduli(2.0 * np.eye(3)) == (2.0, 0.0)
    steel = _moduli(2.0 * np.eye(3) + 1.0)  # mu = lambda = 1
    assert steel == pytest.approx((2.5, 0.25))
    assert _moduli(np.diag([1.0, 2.0, 3.0])) is None
    why = JAXMAT.applies(asked(specimen("von-mises", yield_stress="1")))
    assert why is not None and '--stiffness "1 1 1"' in why


def test_an_error_among_stacks_is_one_sentence() -> None:
    fault = RuntimeError("Above is the stack\n  File x\nequinox.EquinoxRuntimeError: The maximum number of steps was reached. Or so.\n---")
    assert _said(fault) == "The maximum number of steps was reached"
    assert _said(RuntimeError("another. And more")) == "another"


# -- what is measured ------------------------------------------------------------------------------------------------


def test_what_is_not_installed_is_said_with_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    missing = Peer(replace(SLSQP, name="nowhere"), "no-such-package")
    monkeypatch.setattr("duhem.benchmark.contenders.PEERS", (missing,))
    question = specimen("coulomb", mu="0.3").question(np.zeros((1, 2)), -1.0)
    found, left_out = applicable(question, peers=True)
    assert not any(contender.peer for contender in found)
    assert [part.reason for part in left_out if part.part == "nowhere"] == ["not installed, pip install no-such-package"]
    assert not any(part.part == "nowhere" for part in applicable(question)[1])


def test_every_peer_is_measured_or_said_to_be_left_out() -> None:
    question = specimen("box", mu_a="0.5", mu_b="0.25").question(np.zeros((1, 2)), -1.0)
    found, left_out = applicable(question, peers=True)
    named = {contender.name for contender in found if contender.peer} | {part.part for part in left_out}
    assert {peer.method.name for peer in PEERS} <= named
    assert any(contender.name == "scipy SLSQP" and contender.peer for contender in found)  # SciPy is there always


@pytest.mark.slow
@pytest.mark.parametrize(
    "found",
    [
        specimen("coulomb", mu="0.3"),
        specimen("box", mu_a="0.5", mu_b="0.25"),
        specimen("von-mises", yield_stress="1"),
        specimen("von-mises", ALIKE, yield_stress="1"),
        specimen("antoni2007-1d", mu_plus="0.2", mu_minus="0.1"),
    ],
)
@pytest.mark.parametrize("peer", PEERS, ids=lambda peer: peer.method.name)
def test_a_peer_solves_the_same_increment(peer: Peer, found: Specimen) -> None:
    """To the accuracy it has by default, which is a few digits; another set or another metric is off by more."""
    if find_spec(peer.package) is None:
        pytest.skip(f"{peer.method.name} is {peer.missing}")
    question = asked(found, 20)
    if peer.method.applies(question) is not None:
        return
    pressure = None if found.pressure is None else question.pressure
    mine = Projector.of(found.law, found.stiffness)(question.trial, pressure)
    other = Projector.of(found.law, found.stiffness, method=peer.method)(question.trial, pressure)
    assert not (other.status == Status.FAILED).any()
    assert np.abs(other.stress - mine.stress).max() <= 1e-2
    assert other.multiplier == pytest.approx(mine.multiplier, abs=1e-2)
    if np.ptp(np.diagonal(found.stiffness)) > 0.0 and planes(question) is None:
        assert np.abs(Projector.of(found.law)(question.trial, pressure).stress - mine.stress).max() > 2e-2


def test_tolerances_of_a_solver_go_where_it_reads_them() -> None:
    """Moreau's stand among the settings of its interior points, Clarabel's among its own."""
    ((inside,),), ((plain, *_),) = (conic_solvers.rungs(name, 1e-6) for name in ("MOREAU", "CLARABEL"))
    assert set(inside) == {"ipm_settings"} and inside["ipm_settings"]["tol_gap_rel"] == 1e-6
    assert plain["tol_gap_rel"] == 1e-6 and "ipm_settings" not in plain


def test_a_tolerance_is_a_positive_number() -> None:
    for bad in (0.0, -1.0, np.nan, np.inf):
        with pytest.raises(InputError, match="positive number"):
            PeerOptions(tolerance=bad)
    question = asked(specimen("coulomb", mu="0.3"), 6)
    loose, tight = (SLSQP.solve(question, PeerOptions(tolerance=t)).stress for t in (1e-3, 1e-12))
    right = Projector.of(question.law, question.stiffness)(question.trial, question.pressure).stress
    assert np.abs(tight - right).max() <= 1e-9 and np.abs(tight - right).max() <= np.abs(loose - right).max()


@pytest.mark.slow
def test_the_table_has_errors_flags_and_first_calls(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(throughput, "_KNOWN", 5)  # answers in many digits
    own = Contender.of("newton", "newton")
    law = specimen("limacon", mu="0.25", e="0.3").law
    result = bench(law, scenes=("throughput",), repeats=1, points=150, contenders=[own, SLSQP_ALONE])
    rows = {(row.method, row.setting): row for row in result.rows}
    mine, theirs = rows["newton", "N = 150"], rows["scipy SLSQP", "N = 150"]
    assert mine.error["stress"] < 1e-14 < theirs.error["stress"] < 1e-2  # by the reference, not by each other
    assert mine.flagged == 0 and mine.first is not None and mine.first > 0.0
    assert ("newton", "N = 100") in rows and "times what it takes at N = 100" in mine.note
    assert {t.what for t in result.targets if t.holds} >= {
        "scipy SLSQP / newton, time a point at N = 150",
        "newton / scipy SLSQP, error of the stress at N = 150",
    }
    assert "first" in text(result)
    monkeypatch.setattr(throughput, "LIMIT", 1e-9)
    (short,) = [
        r for r in bench(law, scenes=("throughput",), repeats=1, points=150, contenders=[SLSQP_ALONE]).rows if r.method in "scipy SLSQP"
    ]
    assert short.setting == "N = 100" and "150 points would take some" in short.note


def test_a_peer_that_raises_is_kept_with_its_failure() -> None:
    def gone(*_: object) -> Any:
        raise ArithmeticError("no root")

    broken = Contender("scipy SLSQP", replace(SLSQP, solve=gone), PeerOptions())
    result = bench(specimen("coulomb", mu="0.3").law, scenes=("throughput",), repeats=1, points=20, contenders=[broken])
    assert [row.failure for row in result.rows if row.method == "scipy SLSQP"] == ["ArithmeticError: no root"]
    assert "failed: ArithmeticError: no root" in text(result)
    assert result.targets and all("SLSQP" not in target.what for target in result.targets)


def measured(method: str, setting: str, seconds: float, stress: float | None) -> Measurement:
    return Measurement("throughput", method, setting, {} if stress is None else {"stress": stress}, Spread.of([seconds]))


def test_peers_are_compared_where_both_were_measured() -> None:
    rows = [
        measured("slow", "N = 100", 3.0, 0.0),
        measured("quick", "N = 100", 1.0, 1e-16),
        measured("quick", "N = 10000", 0.1, 1e-16),
        measured("them", "N = 100", 2.0, 1e-15),
        measured("exact", "N = 100", 0.5, 0.0),
        measured("alone", "N = 7", 0.5, 0.0),
    ]
    found = {target.what: target for target in beside_peers(rows, ("slow", "quick"), ("them", "exact", "alone", "failed"))}
    assert len(found) == 4
    assert found["them / quick, time a point at N = 100"].value == 2.0
    assert found["quick / them, error of the stress at N = 100"].value == pytest.approx(0.1)
    assert found["exact / quick, time a point at N = 100"].holds is False
    assert found["quick / exact, error of the stress at N = 100"].holds is False


@pytest.mark.slow
def test_extreme_cases_are_put_to_peers_too() -> None:
    result = stress(specimen("coulomb", mu="0.3").law, axes=("boundary distance",), contenders=[SLSQP_ALONE], every=9)
    assert {row.label for row in result.rows} == {"1e0", "1e-9"}
    assert all(row.stress_digits > 3.0 for row in result.rows) and ACCURACY < 1e-6
