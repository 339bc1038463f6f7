"""Laws with a state that several tests drive along paths, what their histories satisfy, and steps with another text."""

from __future__ import annotations

import inspect
import sys
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import duhem
from duhem import Criterion, Domain, Path
from duhem.law.state import Variable
from duhem.path import state_path, state_question, state_step
from duhem.path.state_path import StateHistory

__all__ = [
    "ADHESIVE", "ALONG", "BACK", "BINGHAM", "FREDERICK", "GAMMA", "HEAT", "ISOTROPIC", "MOST", "NORTON", "NUMBERS", "ONE",
    "POSITIVE", "PRAGER", "QUADRATIC", "RECALL", "RECOVERING", "SLIP", "SOFTENING", "STORED", "WARM", "YIELDED", "C", "H", "K", "R",
    "balanced", "made", "mutate", "order_of", "plane", "run",
]  # fmt: skip

POSITIVE = duhem.POSITIVE
SLIP = {"u": Variable("sigma", observable=True), "u_in": Variable("sigma")}
QUADRATIC = "k/2*(u - u_in)**2"
BACK = SLIP | {"alpha": Variable("X")}
STORED = f"{QUADRATIC} + C/2*alpha**2"
ALONG = "(sigma + X)/norm(sigma + X)"
RECALL = (ALONG, f"{ALONG} - gamma*alpha")
R, K, C, H, GAMMA = 1.0, 100.0, 5.0, 3.0, 2.0
ONE = {"R": R, "k": K}


def made(g: str, energy: str | None = QUADRATIC, variables: Any = SLIP, **given: Any) -> Criterion:
    """A law in the forces that its internal variables have."""
    forces = tuple(dict.fromkeys(own.force for own in variables.values() if own.force is not None))
    names = ("R", "k", *given.pop("names", ()))
    return Criterion(
        "made", g, dict.fromkeys(names, POSITIVE), forces, given.pop("pressure", None), energy=energy, variables=variables, **given
    )


PRAGER = made("norm(sigma + X) - R", STORED, BACK, names=("C",))
FREDERICK = made("norm(sigma + X) - R", STORED, BACK, names=("C", "gamma"), flow=RECALL)
RECOVERING = made(
    "norm(sigma + X) - R", STORED, BACK, names=("C", "gamma", "c", "m"), flow=RECALL, rates={"alpha": "c/C*abs(X)**(m - 1)*X"}
)
ISOTROPIC = made("abs(sigma) + A - R", f"{QUADRATIC} + H/2*alpha**2", SLIP | {"alpha": Variable("A")}, names=("H",))
BINGHAM = made("pos(norm(sigma) - R)**2/(2*eta)", names=("eta",), viscous=True)
NORTON = Criterion("norton", "A/(n + 1)*norm(sigma_a, sigma_b)**(n + 1)", {"A": POSITIVE, "n": POSITIVE}, pressure=None, viscous=True)
ADHESIVE = made(
    "max(abs(sigma) - R, -B)",
    "beta**2*k*(u - u_in)**2/2 - w*beta",
    SLIP | {"beta": Variable("B", domain=Domain.between(0, 1))},
    names=("w",),
)
WARM = SLIP | {"T": Variable(temperature=True, domain=POSITIVE)}
HEAT = f"{QUADRATIC} - c*(T*log(T/T0) - T + T0)"
SOFTENING = made("abs(sigma) - R*(1 - b*(T - T0))", HEAT, WARM, names=("c", "T0", "b"))
NUMBERS = ONE | {"c": 2.0, "T0": 300.0, "b": 0.5}
YIELDED = [0.0, R / K, 1.0]  # knots of a shear whose second is where flow begins


def plane(g: Any, parameters: Any = None, **more: Any) -> Criterion:
    """Two forces with unit moduli."""
    variables = {
        "ua": Variable("sa", observable=True), "ub": Variable("sb", observable=True), "pa": Variable("sa"), "pb": Variable("sb"),
    }  # fmt: skip
    energy = "((ua - pa)**2 + (ub - pb)**2)/2"
    return Criterion("plane", g, parameters or {}, ("sa", "sb"), None, energy=energy, variables=variables, **more)


def run(law: Criterion, path: Any = None, **asked: Any) -> StateHistory:
    found = duhem.simulate(law, Path.linear(YIELDED) if path is None else path, **asked)
    assert isinstance(found, StateHistory)
    return found


def balanced(found: StateHistory) -> float:
    """The largest residual of the energies of a step, relative to the largest of them."""
    size = max(np.abs(getattr(found, name)).max() for name in ("work", "psi", "dissipation"))
    return float(np.abs(found.balance).max() / (size or 1.0))


MOST = {1: 0.05, 2: 1e-3}


def order_of(law: Criterion, exact: Any, path: Any, method: str, most: float, **asked: Any) -> float:
    """The order with which the error falls from 16 substeps to 32, with which it is below ``most``."""
    errors = []
    for count in (16, 32):
        found = run(law, path, method=method, substeps=count, **asked)
        assert balanced(found) < 1e-12 and found.residual.max() <= state_step.KKT
        errors.append(float(np.abs(exact(found)).max()))
    assert errors[1] < most
    return float(np.log2(errors[0] / errors[1]))


def mutate(module: Any, old: str, new: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """What paths take of a module is taken of one with another text."""
    source = inspect.getsource(module)
    assert source.count(old) == 1
    mutant = ModuleType("mutant")
    monkeypatch.setitem(sys.modules, "mutant", mutant)
    exec(compile(source.replace(old, new), "mutant", "exec"), mutant.__dict__)
    taken = ((state_question, "StateLaw"), (state_path, "own_dissipation"))
    for place, name in taken if module is state_step else ((state_path, "implicit"),):
        monkeypatch.setattr(place, name, getattr(mutant, name))
