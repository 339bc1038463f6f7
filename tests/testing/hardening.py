"""Von Mises plasticity with hardening as a UMAT in C, right and with each of its mistakes, and the laws that it is held to."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

from duhem import Criterion, Domain
from duhem.law.state import Variable
from duhem.testing.foreign import umat
from tests.testing.examples import compiled_with, elastic

__all__ = ["KINDS", "MISTAKES", "PAIRS", "UNNAMED", "hardening", "law"]

SOURCE = Path(__file__).with_name("hardening.c")
YOUNG, NU = 200e3, 0.3
_NONE = {"R": 250.0, "Q": 0.0, "b": 10.0, "H": 1000.0, "C": 0.0, "gamma": 0.0, "c": 0.0, "a": 0.0, "T0": 293.0}
KINDS: dict[str, dict[str, float]] = {
    "isotropic": {},
    "saturating": {"Q": 100.0, "b": 20.0},
    "kinematic": {"C": 20e3},
    "recovering": {"C": 40e3, "gamma": 300.0},
    "recovering-at-rest": {"C": 40e3, "gamma": 300.0, "c": 0.3},
    "warm": {"a": 1e-3},
}
# by number: the kind of law that shows it, and words that name it
MISTAKES: dict[int, tuple[str, str]] = {
    1: ("isotropic", "p is not accumulated: only what the step adds is kept"),
    2: ("isotropic", "p is not advanced"),
    3: ("isotropic", "p is advanced twice"),
    4: ("kinematic", "p is advanced 0.816497 times"),
    5: ("isotropic", "u_in is not accumulated"),
    6: ("kinematic", "u_in is not advanced"),
    7: ("isotropic", "u_in is kept as shear strains of the tensor"),
    8: ("isotropic", "u_in is advanced with the opposite sign"),
    9: ("kinematic", "X does not enter the yield check"),
    10: ("kinematic", "X enters the yield check with the opposite sign"),
    11: ("kinematic", "X is not advanced"),
    12: ("recovering", "X is advanced twice"),
    13: ("kinematic", "X is advanced 1.5 times"),
    14: ("recovering", "in the evolution of X, gamma is left out"),
    15: ("recovering-at-rest", "the rate of X is not multiplied by the time step"),
    16: ("recovering-at-rest", "such as its recovery at rest, is left out"),
    17: ("isotropic", "the hardening of the old step"),
    18: ("isotropic", "in the yield check H is taken as 2000, not 1000"),
    19: ("isotropic", "or the limit 1.1 times"),
    20: ("warm", "the temperature T is taken as 293"),
    21: ("warm", "the temperature T is taken as"),
    22: ("kinematic", "returned in another order: X_xz holds X_xy, X_xy holds X_xz"),
    23: ("kinematic", "returned in another order"),
    24: ("kinematic", "returned in another order"),
    25: ("isotropic", "the tangent is the elastic stiffness"),
    26: ("isotropic", "the tangent is wrong in"),
    27: ("kinematic", "the tangent is wrong in 2 of 36 components: (4, 5)"),
    28: ("saturating", "the tangent is wrong in"),
    29: ("recovering", "the tangent is transposed"),
    30: ("kinematic", "if X does not enter its direction"),
    31: ("isotropic", "components of the plastic strain"),
    32: ("recovering", "the change of X is taken at the state before the step"),
    33: ("isotropic", "p changes in elastic steps too"),
    34: ("saturating", "a loose tolerance"),
    36: ("isotropic", "or the limit 0.816497 times"),
    37: ("isotropic", "components of the plastic strain"),
    38: ("isotropic", "the tangent is not set: it is zero"),
    39: ("isotropic", "depends"),
    41: ("isotropic", "the tangent is wrong in 3 of 36 components: (4, 4)"),
    42: ("isotropic", "a shear strain of the tensor taken for one of engineers?"),
    43: ("isotropic", "p is advanced 1.001 times"),
    44: ("isotropic", "a single-precision literal?"),
    45: ("recovering", "in the evolution of X, gamma is taken 2 times as large"),
    46: ("recovering-at-rest", "in the evolution of X, c is taken 3 times as large"),
}
# two at once, which a law of the kind shows
PAIRS: list[tuple[str, int, int]] = [
    ("isotropic", 2, 25), ("isotropic", 2, 5), ("isotropic", 3, 7), ("isotropic", 18, 3), ("isotropic", 17, 38), ("isotropic", 19, 2),
    ("kinematic", 9, 25), ("kinematic", 9, 4), ("kinematic", 10, 3), ("kinematic", 11, 27), ("kinematic", 13, 17), ("kinematic", 13, 18),
    ("kinematic", 22, 6), ("recovering", 14, 18), ("recovering", 14, 4), ("recovering", 12, 29), ("recovering-at-rest", 15, 17),
    ("recovering-at-rest", 16, 5), ("warm", 20, 3), ("warm", 20, 27),
]  # fmt: skip
UNNAMED = {23, 31, 32, 37, 39}  # found, and told by what is violated alone


@cache
def law(kind: str) -> Criterion:
    """The law of a kind, its parameters open: back stresses are variables without a force."""
    own = KINDS[kind]
    positive, tails = Domain(positive=True), ("xx", "yy", "zz", "yz", "xz", "xy")
    used = ["R", "H", *(name for name in ("Q", "b", "C", "gamma", "c", "a") if name in own), *(["T0"] if "a" in own else [])]
    variables, unforced, rates = {"p": Variable(domain=Domain.between(0))}, {"p": "1"}, {}
    size, limit = "sqrt(3*J2(sigma))", "R + H*p" + (" + Q*(1 - exp(-b*p))" if "Q" in own else "")
    if "C" in own:
        mean = "(sigma_xx + sigma_yy + sigma_zz - X_xx - X_yy - X_zz)/3"
        apart = {t: f"(sigma_{t} - X_{t}{f' - {mean}' if t[0] == t[1] else ''})" for t in tails}
        size = f"sqrt(3/2*({' + '.join(f'{1 if t[0] == t[1] else 2}*{apart[t]}**2' for t in tails)}))"
        variables |= {f"X_{t}": Variable() for t in tails}
        unforced |= {f"X_{t}": f"C*{apart[t]}/{size}" + (f" - gamma*X_{t}" if "gamma" in own else "") for t in tails}
        rates = {f"X_{t}": f"-c*X_{t}" for t in tails} if "c" in own else {}
    if "a" in own:
        variables["T"], limit = Variable(temperature=True, domain=positive), f"({limit})*(1 - a*(T - T0))"
    return Criterion(
        "hardening", f"{size} - ({limit})", dict.fromkeys(used, positive), pressure=None, stress={"name": "sigma", "kind": "3d"},
        variables=variables, unforced=unforced, rates=rates,
    )  # fmt: skip


def hardening(kind: str, mistake: int = 0, other: int | None = None, **options: Any) -> tuple[Criterion, Any, dict[str, Any]]:
    """What conformance is given: law, material and parameters."""
    values, known = _NONE | KINDS[kind], law(kind)
    parameters: dict[str, Any] = {name: values[name] for name in known.parameters if name in values}
    if known.temperature is not None:
        parameters["T"] = [293.0, 400.0, 600.0]
    state = {"p": 0, "u_in": slice(1, 7)} | ({"X": slice(7, 13)} if "C" in KINDS[kind] else {})
    given: dict[str, Any] = {"isolated": False, "nstatv": 13, "state": state} | options
    props = [YOUNG, NU, *(values[name] for name in ("R", "Q", "b", "H", "C", "gamma", "c", "a", "T0"))]
    return known, umat(compiled_with(SOURCE, mistake, other), props, elastic(YOUNG, NU), **given), parameters
