"""Methods as values: their names, their options, what one more of them takes; and that answers can be sent and copied."""

from __future__ import annotations

import copy
import pickle
import subprocess
import sys
from collections.abc import Callable
from dataclasses import FrozenInstanceError, dataclass, fields, replace
from typing import Any

import numpy as np
import pytest

import duhem
from duhem.benchmark import contenders
from duhem.benchmark.contenders import Contender, Specimen, applicable
from duhem.errors import InputError
from duhem.projection import projector
from duhem.projection.increment import Increment
from duhem.projection.method import Method, Options
from duhem.projection.methods import METHODS
from duhem.projection.newton import NEWTON
from duhem.projection.projector import Projector
from duhem.projection.result import Projection, Residuals, Solution

MU = {"mu_a_plus": 0.2, "mu_a_minus": 0.08, "mu_b_plus": 0.12, "mu_b_minus": 0.15}
TRIAL = np.random.default_rng(7).normal(size=(20, 2))


def test_the_names_users_write_are_the_names_the_methods_have() -> None:
    assert tuple(METHODS) == ("closed-form", "newton", "cvxpy")  # cheapest first, which is what auto means
    assert {name: imported().name for name, imported in METHODS.items()} == {name: name for name in METHODS}


def test_names_cost_nothing() -> None:
    code = "import sys, duhem.projection.methods; print(*[m for m in ('numpy', 'sympy', 'scipy', 'cvxpy', 'numba') if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True)
    assert done.stdout.strip() == ""


# -- options ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", METHODS)
def test_options_are_frozen_and_have_defaults(method: str) -> None:
    options = METHODS[method]().options()
    assert isinstance(options, Options) and options == METHODS[method]().options_of({})
    with pytest.raises(FrozenInstanceError):
        options.depth = 3


@pytest.mark.parametrize(
    ("method", "options", "message"),
    [
        ("closed-form", {"complied": True}, "complied: .*'complied'; did you mean 'compiled'\\? its options are compiled, threads, into"),
        ("newton", {"tolerance": 1e-6}, "tolerance: method newton has no option 'tolerance'; its options are compiled"),
        ("cvxpy", {"tolerence": 1e-6}, "did you mean 'tolerance'\\? its options are solver, tolerance, batch, warm_start"),
        ("cvxpy", {"depth": 3}, "'depth'; its options are solver, tolerance, batch, warm_start"),
    ],
)
def test_an_option_that_there_is_not_is_named(method: str, options: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        duhem.project("antoni2007", [1.0, 1.0], -1.0, parameters=MU, method=method, **options)


def test_a_type_error_of_a_method_stays_what_it_is() -> None:
    """It is not taken for an unknown option, whatever its words."""

    def solve(question: Increment, options: Options) -> Solution:
        raise TypeError("unexpected keyword argument")

    with pytest.raises(TypeError, match="unexpected"):
        duhem.project("antoni2007", [1.0, 1.0], -1.0, parameters=MU, method=replace(NEWTON, solve=solve, again=None))


# -- one more --------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Scaled(Options):
    """The stress of newton, times ``factor``."""

    factor: float = 1.0


def scaled(question: Increment, options: Scaled) -> Solution:
    found = NEWTON.solve(question, Options())
    return replace(found, stress=found.stress * options.factor)


def rows(monkeypatch: pytest.MonkeyPatch, there: dict[str, Callable[[], Method[Any]]]) -> None:
    """Other rows in the registry, wherever it is read."""
    for reader in (projector, contenders):
        monkeypatch.setattr(reader, "METHODS", there)


MINE = Method("mine", lambda question: None if question.law.pressure else "it needs a pressure", scaled, Scaled)


@pytest.mark.slow
def test_a_method_of_ones_own_is_judged_like_any_other() -> None:
    right = duhem.project("antoni2007", TRIAL, -1.0, parameters=MU, method="newton")
    same = duhem.project("antoni2007", TRIAL, -1.0, parameters=MU, method=MINE)
    assert (same.method, same.why) == ("mine", "you selected it")
    assert np.array_equal(same.stress, right.stress) and np.array_equal(same.status, right.status)
    wrong = duhem.project("antoni2007", TRIAL, -1.0, parameters=MU, method=MINE, factor=1.01)
    slips = right.status == duhem.Status.SLIP
    assert (wrong.status[slips] == duhem.Status.INACCURATE).all()
    with pytest.raises(InputError, match="method mine does not apply: it needs a pressure"):
        duhem.project("von-mises", [1.0, 0.0, 0.0], parameters={"yield_stress": 1}, method=MINE)
    with pytest.raises(InputError, match="method mine has no tangent"):
        duhem.project("antoni2007", TRIAL, -1.0, parameters=MU, method=MINE, tangent=True)


def test_one_row_makes_it_known_everywhere(monkeypatch: pytest.MonkeyPatch) -> None:
    rows(monkeypatch, {**METHODS, "mine": lambda: MINE})
    assert duhem.project("antoni2007", TRIAL, -1.0, parameters=MU, method="mine", factor=1.0).method == "mine"
    with pytest.raises(InputError, match="choose auto, closed-form, newton, cvxpy, mine"):
        duhem.project("antoni2007", TRIAL, -1.0, parameters=MU, method="yours")
    found, left_out = applicable(Specimen.of(duhem.load("coulomb").fix({"mu": "1/4"})).question(TRIAL, -1.0))
    assert [c for c in found if c.method is MINE] == [Contender("mine", MINE, Scaled())]
    metal = Specimen.of(duhem.load("von-mises").fix({"yield_stress": 1}))
    _, left_out = applicable(metal.question(np.zeros((1, 3)), None))
    assert ("mine", "it needs a pressure") in [(part.part, part.reason) for part in left_out]


def test_auto_takes_a_row_in_its_turn(monkeypatch: pytest.MonkeyPatch) -> None:
    rows(monkeypatch, {"mine": lambda: MINE, **METHODS})
    assert duhem.project("antoni2007", TRIAL, -1.0, parameters=MU).method == "mine"
    metal = duhem.project("von-mises", [1.0, 0.0, 0.0], parameters={"yield_stress": 1})
    assert metal.method != "mine" and "not mine: it needs a pressure" in metal.why


# -- values ----------------------------------------------------------------------------------------------------------


def arrays(value: Projection) -> dict[str, np.ndarray]:
    own = {field.name: getattr(value, field.name) for field in fields(value)}
    kept = {name: entry for name, entry in own.items() if isinstance(entry, np.ndarray)}
    return kept | {f"residuals.{field.name}": getattr(value.residuals, field.name) for field in fields(Residuals)}


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("copied", [lambda x: pickle.loads(pickle.dumps(x)), copy.deepcopy], ids=["pickle", "deepcopy"])
def test_a_projection_survives_a_journey_bit_by_bit(method: str, copied: Callable[[Projection], Projection]) -> None:
    tangent = METHODS[method]().tangent is not None
    done = duhem.project("antoni2007", [*TRIAL, [0.0, -0.0]], -1.0, parameters=MU, method=method, tangent=tangent)
    again = copied(done)
    before, after = arrays(done), arrays(again)
    assert len(before) == (12 if tangent else 10) and before.keys() == after.keys()
    for name, array in before.items():
        assert array.dtype == after[name].dtype and array.tobytes() == after[name].tobytes(), name
        assert not np.shares_memory(array, after[name]), name
    assert (again.method, again.why) == (done.method, done.why)


def test_answers_are_frozen() -> None:
    done = duhem.project("antoni2007", TRIAL, -1.0, parameters=MU)
    solution = Solution(done.stress, done.slip, done.multiplier, done.status == 3)
    for value, name in ((done, "stress"), (done.residuals, "feasibility"), (solution, "slip")):
        with pytest.raises(FrozenInstanceError):
            setattr(value, name, None)


@pytest.mark.parametrize("method", METHODS)
def test_a_method_is_itself_after_a_journey(method: str) -> None:
    found = METHODS[method]()
    assert pickle.loads(pickle.dumps(found)) == found and copy.deepcopy(found) == found


def test_a_projector_takes_a_method_as_it_is() -> None:
    assert Projector.of("antoni2007", 1.0, MU, NEWTON).method is NEWTON


@pytest.mark.slow
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("copied", [lambda x: pickle.loads(pickle.dumps(x)), copy.deepcopy], ids=["pickle", "deepcopy"])
def test_a_projector_gives_the_same_numbers_after_a_journey(method: str, copied: Callable[[Projector], Projector]) -> None:
    prepared = Projector.of("antoni2007", [1.0, 3.0], MU, method)
    before, after = prepared(TRIAL, -1.0), copied(prepared)(TRIAL, -1.0)
    assert np.array_equal(before.stress, after.stress) and np.array_equal(before.residuals.worst(), after.residuals.worst())
