"""The loop of laws with a state: the same steps as those of arrays, and what it leaves to them."""

from __future__ import annotations

import inspect
from typing import Any

import numpy as np
import pytest
import sympy as sp

import duhem
from duhem import Criterion, Domain, Path, Paths, YieldSurface
from duhem.law.state import Variable
from duhem.path import compiled_state, state_kernel
from duhem.path.state_kernel import LEFT
from duhem.path.state_path import StateHistory
from duhem.projection.code_cache import interpreted_text
from tests.path.states import ALONG, BACK, POSITIVE, QUADRATIC, SLIP, STORED

NUMBERS = {"R": 1.0, "k": 100.0, "C": 5.0, "gamma": 2.0, "c": 0.3, "m": 3.0, "H": 3.0, "eta": 2.0, "N": 1.0}


def law(g: Any, energy: str = QUADRATIC, variables: Any = SLIP, names: str = "", **given: Any) -> Criterion:
    forces = tuple(dict.fromkeys(own.force for own in variables.values() if own.force is not None))
    return Criterion(
        "made", g, dict.fromkeys(("R", "k", *names.split()), POSITIVE), forces, None, energy=energy, variables=variables, **given
    )


def plane(g: Any, energy: str, **given: Any) -> Criterion:
    variables = {name: Variable(force, observable=name[0] == "u") for name, force in (("ua", "a"), ("ub", "b"), ("pa", "a"), ("pb", "b"))}
    return law(g, energy, variables, **given)


ROUND = "k/2*((ua - pa)**2 + 2*(ub - pb)**2)"
LAWS = {
    "prager": law("norm(sigma + X) - R", STORED, BACK, "C"),
    "armstrong-frederick": law("norm(sigma + X) - R", STORED, BACK, "C gamma", flow=(ALONG, f"{ALONG} - gamma*alpha")),
    "recovery": law("norm(sigma + X) - R", STORED, BACK, "C c m", rates={"alpha": "c/C*abs(X)**(m - 1)*X"}),
    "isotropic": law("abs(sigma) + A - R", f"{QUADRATIC} + H/2*alpha**2", SLIP | {"alpha": Variable("A")}, "H"),
    "quartic": law("sigma**4 + X**2 - R", STORED, BACK, "C"),
    "bingham": law("pos(norm(sigma) - R)**2/(2*eta)", names="eta", viscous=True),
    "creeping": law(
        "pos(norm(sigma) - R)**2/(2*eta)", STORED, BACK, "C c eta", viscous=True, rates={"u_in": "c*sigma/10", "alpha": "c*X + c*sigma/5"}
    ),
    "worn": law("norm(sigma) - R - w/10", variables=SLIP | {"w": Variable()}, unforced={"w": "abs(sigma)"}),
    "oval": plane("norm(a, 3*b) - R", ROUND),
    "corners": plane("max(abs(a) - R, abs(b) - R, abs(a + b)/1.2 - R)", ROUND),
    "sides": plane("where(a > 0, a**2, 2*a**2) + b**2 - R**2", f"{ROUND} + k/20*exp(ua/10)"),
    "surfaces": plane(sp.nan, ROUND, surfaces=(YieldSurface("a + b/2 - R"), YieldSurface("b - a/3 - R"), YieldSurface("a + b - R*1.2"))),
    "dropped": plane(sp.nan, "k/2*(4*(ua - pa)**2 + (ub - pb)**2)", surfaces=(YieldSurface("a - b - R"), YieldSurface("a - 10*R"))),
    "warm": law("norm(sigma) - R + T/10", f"{QUADRATIC} - T**2/2 - T*u/10", SLIP | {"T": Variable(temperature=True, domain=POSITIVE)}),
}  # fmt: skip
LEFT_OVER = {"corners", "surfaces"}  # whose points end at corners: there some are left


def history(made: Criterion, **asked: Any) -> StateHistory:
    """Six points on random loads."""
    width = sum(own.observable for own in made.variables.values()) + (made.temperature is not None)
    points = np.random.default_rng(3).normal(size=(6, 4, width)) * 0.05
    points[:, 0] = 0.0
    if made is LAWS["dropped"]:  # the surface that is violated most is not the one where the step ends
        points[:, 1:] = [0.03, 0.08] + 0.01 * points[:, 1:]
    if made.temperature:
        points[:, :, -1] = 2.0 + 10.0 * points[:, :, -1]
    numbers: dict[str, Any] = {name: NUMBERS[name] for name in made.parameters if name in NUMBERS and name not in made.variables}
    numbers["R"] = np.linspace(1.0, 1.02, len(points))
    found = duhem.simulate(
        made, Paths.linear(points, time=[0, 1, 2, 4]), parameters=numbers, substeps=1 if made is LAWS["dropped"] else 3, **asked
    )
    assert isinstance(found, StateHistory)
    return found


def by_python(text: str, entry: str) -> Any:
    """The loop as Python runs it, which takes no minute to compile."""
    run = interpreted_text(text, entry)

    def quietly(*arguments: Any) -> None:
        with np.errstate(all="ignore"):
            run(*arguments)
        STATES.extend(arguments[-1].tolist())

    return quietly


STATES: list[int] = []


def compared(made: Criterion, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compiled_state, "compiled_text", by_python)
    STATES.clear()
    found, wanted = history(made, compiled=True), history(made)
    assert "compiled" in found.why and "compiled" not in wanted.why
    assert (found.status == wanted.status).all() and (found.reached == wanted.reached).all()
    assert (wanted.status != 2).sum() >= 5 and wanted.multiplier.size + made.viscous
    for name in ("state", "force", "multiplier", "psi", "dissipation", "work", "numerical", "entropy", "heat"):
        if (array := getattr(wanted, name)) is not None:
            assert getattr(found, name) == pytest.approx(array, rel=1e-11, abs=1e-12, nan_ok=True), name
    assert np.nanmax(found.residual) <= 1e-10


@pytest.mark.parametrize("name", LAWS)
def test_the_loop_takes_the_steps_of_arrays(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    compared(LAWS[name], monkeypatch)
    left = STATES.count(LEFT)
    assert left <= len(STATES) / 2 if name in LEFT_OVER else left == 0


MUTANTS = [
    ("r[i] = at[SEEN + i] - start[SEEN + i] - moved[i]", "r[i] = at[SEEN + i] - start[SEEN + i] - 1.001 * moved[i]"),
    ("y[k] = 0.0 - f[SEEN + order[k]]", "y[k] = 0.0 - f[SEEN + order[0]]"),
    ("held[s], active[s], done = 0.0, 0, False", "pass"),
    ("if w > most:", "if w > 1.0:"),
    ("numerical[n] += f[i] * (at[i] - start[i])", "numerical[n] += f[i] * (start[i] - at[i])"),
    ("entropy[n] -= f[i]", "entropy[n] += f[i]"),
    ("share = dt if", "share = 1.0 if"),
    ("q[j] = others[n, j]", "q[j] = others[0, j]"),
    ("multiplier[n, s] = held[s]", "multiplier[n, s] = 0.0"),
    ("at[Z - 1] = given[n, SEEN]", "at[Z - 1] = base[n, Z - 1]"),
]


@pytest.mark.parametrize(("old", "new"), MUTANTS)
def test_a_wrong_loop_is_caught(old: str, new: str, monkeypatch: pytest.MonkeyPatch) -> None:
    source = inspect.getsource
    assert source(state_kernel).count(old) == 1
    monkeypatch.setattr(inspect, "getsource", lambda part: source(part).replace(old, new))
    with pytest.raises(AssertionError):
        for name in ("dropped", "surfaces", "recovery", "warm"):
            compared(LAWS[name], monkeypatch)


def test_a_bound_that_is_reached_is_left_to_arrays(monkeypatch: pytest.MonkeyPatch) -> None:
    bounded = {"u": Variable("sigma", observable=True), "p": Variable("sigma", domain=Domain.between(0, "1/100"))}
    compared(law("norm(sigma) - R", "k/2*(u - p)**2", bounded), monkeypatch)
    assert 0 < STATES.count(LEFT) < len(STATES)


def test_what_the_loop_does_not_know_is_taken_by_arrays(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compiled_state, "compiled_text", by_python)
    path = Path.linear([0.0, 0.02, -0.01], time=[0, 1, 2])
    numbers = {"R": 1.0, "k": 100.0}
    plain = duhem.simulate(LAWS["worn"], path, parameters=numbers, tangent=True)
    found = duhem.simulate(LAWS["worn"], path, parameters=numbers, tangent=True, compiled=True)
    assert isinstance(found, StateHistory) and isinstance(plain, StateHistory) and found.tangent is not None
    assert "compiled" not in found.why and np.array_equal(found.tangent, plain.tangent, equal_nan=True)  # type: ignore[arg-type]
    stressed = Path.linear([[0.0], [0.9], [-0.5]], control="stress")
    driven = duhem.simulate(LAWS["worn"], stressed, parameters=numbers, compiled=True)
    assert "compiled" not in driven.why and driven.state[-1, 0] == pytest.approx(-0.005, rel=1e-12)  # type: ignore[union-attr]


@pytest.mark.slow(2)
def test_the_compiled_loop_is_the_one_of_python(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("numba")
    compiled = history(LAWS["isotropic"], compiled=True)
    monkeypatch.setattr(compiled_state, "compiled_text", by_python)
    assert history(LAWS["isotropic"], compiled=True).state == pytest.approx(compiled.state, rel=1e-13, abs=1e-15)
