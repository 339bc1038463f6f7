"""Steps of laws with a state as C and UMAT: the numbers of duhem.simulate, and what has no answer."""

from __future__ import annotations

import ctypes
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import duhem
from duhem import Criterion, InputError
from duhem.export.source_files import c_file, fortran_file, identifier
from duhem.export.state_routine import state_routine
from duhem.law.catalogue import load_formula
from duhem.law.state import Variable, prescribed
from duhem.path.state_path import StateHistory
from duhem.path.state_step import StateLaw
from duhem.projection.result import Array
from duhem.proof.verification import verify
from tests.export.shared_library import OPTIMISED, compiler, shared, with_fortran

ATLAS = {  # parameters of laws of the atlas whose stress is the derivative of an energy
    "prager": {"R": 1.0, "C": 5.0, "k": 100.0},
    "armstrong-frederick-recall": {"R": 1.0, "C": 5.0, "gamma": 2.0, "k": 100.0},
    "slip-hardening": {"mu": 0.3, "H": 4.0, "k": 100.0},
}
VARIABLES = {name: Variable(force, observable=name[0] == "u") for name, force in (("ua", "a"), ("ub", "b"), ("pa", "a"), ("pb", "b"))}
POSITIVE = {"R": duhem.POSITIVE, "k": duhem.POSITIVE}
OWN = {
    "creeping": Criterion(
        "creeping", "pos(norm(a, b) - R)**2/2", POSITIVE, ("a", "b"), None, energy="k/2*((ua - pa)**2 + 2*(ub - pb)**2)",
        variables=VARIABLES, viscous=True,
    ),
    "warm": Criterion(
        "warm", "norm(a, 2*b) - R + T/10", POSITIVE, ("a", "b"), None,
        energy="k/2*((ua - pa)**2 + 2*(ub - pb)**2) - T**2/2 - T*(ua - pa)/10",
        variables=VARIABLES | {"T": Variable(temperature=True, domain=duhem.POSITIVE)},
    ),
}  # fmt: skip


def library(law: Criterion, folder: Path, name: str) -> Any:
    source = folder / f"{identifier(name)}.c"
    source.write_text(c_file(verify(law, claims=["convexity"])), encoding="utf-8")
    return getattr(shared([source], *OPTIMISED, with_=compiler("CC", "gcc", "cc")), f"{identifier(law.name)}_step")


def history(law: Criterion, values: Any, parameters: Any, pressure: Any) -> StateHistory:
    path = duhem.Path.linear(values, pressure=pressure, time=np.arange(len(values)))
    found = duhem.simulate(law, path, parameters=parameters, tangent=True)
    assert isinstance(found, StateHistory)
    return found


@pytest.mark.slow(12)
@pytest.mark.parametrize("name", [*ATLAS, *OWN])
def test_steps_are_those_of_simulate(name: str, tmp_path: Path) -> None:
    law = load_formula(name) if name in ATLAS else OWN[name]
    parameters = ATLAS.get(name, {"R": 1.0, "k": 100.0})
    step, own = library(law, tmp_path, name), StateLaw.of(law, None)
    step.argtypes = [ctypes.c_void_p] * 2 + [ctypes.c_double] * 3 + [ctypes.c_void_p] * 6
    o, i, warm = own.observables, own.internal, law.temperature is not None
    rng = np.random.default_rng(5)
    values = np.concatenate([np.zeros((1, o)), 0.03 * rng.normal(size=(12, o))])
    values[1] *= 0.01  # inside K
    given = np.column_stack([values, 2.0 + rng.uniform(size=13)]) if warm else values
    pressure = None if law.pressure is None else -2.0
    expected = history(law, given, parameters, pressure)
    numbers = np.array([parameters[name] for name in state_routine(law).parameters])
    state, statuses = np.zeros(i), set()
    for k in range(1, 13):
        stress, tangent, psi, loss = np.empty(o), np.empty((o, o)), np.empty(1), np.empty(1)
        places = [np.ascontiguousarray(x).ctypes.data for x in (values[k - 1], values[k])]
        outs = [x.ctypes.data for x in (numbers, state, stress, psi, loss, tangent)]
        statuses.add(step(*places, pressure or 0.0, given[k, -1] if warm else 0.0, 1.0, *outs))
        scale = np.abs(expected.force).max()
        assert state == pytest.approx(expected.state[k, o : o + i], rel=1e-11, abs=1e-13)
        assert stress == pytest.approx(expected.force[k, [law.forces.index(f) for f in prescribed(law)]], rel=1e-11, abs=1e-12 * scale)
        assert tangent == pytest.approx(expected.tangent[k], rel=1e-9, abs=1e-9 * np.abs(expected.tangent[1:]).max())  # type: ignore[index]
        assert psi[0] == pytest.approx(expected.psi[k], rel=1e-11, abs=1e-14)
        assert loss[0] == pytest.approx(expected.dissipation[k] - expected.dissipation[k - 1], rel=1e-10, abs=1e-13)
    assert statuses == {0, 1} or law.viscous
    before = state.copy()
    for bad in ({"dt": -1.0}, {"at": np.nan}, {"parameter": -1.0}):
        wrong, end = numbers.copy(), values[3].copy()
        wrong[0], end[0] = bad.get("parameter", wrong[0]), bad.get("at", end[0])
        places = [x.ctypes.data for x in (values[2], end)]
        outs = [x.ctypes.data for x in (wrong, state, stress, psi, loss, tangent)]
        assert step(*places, pressure or 0.0, 2.0, bad.get("dt", 1.0), *outs) == 3
        assert np.isnan([*stress, *tangent.ravel(), psi[0], loss[0]]).all() and (state == before).all()


def at(array: Array) -> ctypes.c_void_p:
    return ctypes.c_void_p(array.ctypes.data)


@pytest.mark.slow(3)
def test_umat_keeps_the_state(tmp_path: Path) -> None:
    law = OWN["warm"]
    verification = verify(law, claims=["convexity"])
    compiled = with_fortran(tmp_path, c_file(verification), fortran_file(verification))
    rng = np.random.default_rng(2)
    values = np.concatenate([np.zeros((1, 2)), 0.03 * rng.normal(size=(8, 2))])
    heat = 2.0 + rng.uniform(size=9)
    expected = history(law, np.column_stack([values, heat]), {"R": 1.0, "k": 100.0}, None)
    stress, statev, slope = np.zeros(2), np.zeros(2), np.zeros((2, 2))
    energies = [np.zeros(1) for _ in range(3)]
    for k in range(1, 9):
        numbers = {"props": np.array([1.0, 100.0]), "stran": values[k - 1].copy(), "dstran": values[k] - values[k - 1]}
        whole = {name: ctypes.byref(ctypes.c_int(n)) for name, n in (("ndi", 1), ("nshr", 1), ("ntens", 2), ("nstatv", 2), ("nprops", 2))}
        temp, dtemp, dtime, pnewdt = (np.array([x]) for x in (heat[k - 1], heat[k] - heat[k - 1], 1.0, 1.0))
        nothing, name = np.zeros(90), ctypes.create_string_buffer(80)
        zero = at(nothing)
        compiled.umat_(
            at(stress), at(statev), at(slope), *map(at, energies), zero, zero, zero, zero, at(numbers["stran"]), at(numbers["dstran"]),
            zero, at(dtime), at(temp), at(dtemp), zero, zero, name, whole["ndi"], whole["nshr"], whole["ntens"], whole["nstatv"],
            at(numbers["props"]), whole["nprops"], zero, zero, at(pnewdt), zero, zero, zero, zero, zero, zero, zero, zero, zero, 80,
        )  # fmt: skip
        assert stress == pytest.approx(expected.force[k], rel=1e-11, abs=1e-12)
        assert statev == pytest.approx(expected.state[k, 2:4], rel=1e-11, abs=1e-13)
        assert pytest.approx(expected.tangent[k], rel=1e-9, abs=1e-7) == slope.T  # type: ignore[index]
        assert energies[0][0] == pytest.approx(expected.psi[k], rel=1e-11) and pnewdt[0] == 1.0


def test_no_line_of_the_umat_is_too_long_for_fortran() -> None:
    law = replace(OWN["creeping"], name="a" * 60)
    text = fortran_file(verify(law, claims=["convexity"]))
    assert max(len(line) for line in text.splitlines() if line[:1] != "!") <= 132 and "nstatv < 2" in text and "nprops < 2" in text
    with pytest.raises(InputError, match="FRIC does not give the displacement"):
        fortran_file(verify("slip-hardening", claims=["convexity"]))


@pytest.mark.parametrize(
    ("law", "what"),
    [
        (load_formula("frictional-heating"), "follows from heat"),
        (load_formula("norton-hoff"), "states no energy"),
        (Criterion("softer", "a**4 - 3*a**2*b**2 + b**4 - R", POSITIVE, ("a", "b"), None, energy="k/2*((ua - pa)**2 + (ub - pb)**2)",
                   variables=VARIABLES), "convexity is"),
    ],
)  # fmt: skip
def test_what_has_no_routine_is_refused(law: Criterion, what: str) -> None:
    with pytest.raises(InputError, match=what):
        state_routine(law)
        c_file(verify(law, claims=["convexity"]))
