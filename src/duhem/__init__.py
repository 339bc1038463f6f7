"""duhem decides whether a friction or yield law is thermodynamically admissible, and proves it.

Nothing is imported until it is used, so that ``import duhem`` and ``duhem --help`` cost next to nothing.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from duhem.version import __version__

__all__ = [
    "POSITIVE",
    "REAL",
    "Criterion",
    "Derivation",
    "Domain",
    "DuhemError",
    "Histories",
    "History",
    "Identification",
    "InputError",
    "Mended",
    "MissingExtraError",
    "ParameterRegion",
    "ParametricCriterion",
    "Path",
    "Paths",
    "PavedRegion",
    "Projection",
    "Recheck",
    "StateHistory",
    "Status",
    "Verdict",
    "Verification",
    "Witness",
    "YieldSurface",
    "__version__",
    "atlas",
    "campaign",
    "contact",
    "criterion",
    "derive",
    "identify",
    "load",
    "mend",
    "plot",
    "prepare",
    "project",
    "recheck",
    "region",
    "simulate",
    "verify",
]

if TYPE_CHECKING:
    from duhem.api.contact import contact
    from duhem.api.histories import simulate
    from duhem.api.increments import prepare, project
    from duhem.derivation import Derivation, derive
    from duhem.errors import DuhemError, InputError, MissingExtraError
    from duhem.identification import Identification, identify
    from duhem.law.atlas.entry import atlas
    from duhem.law.catalogue import load
    from duhem.law.curve_law import ParametricCriterion
    from duhem.law.domain import POSITIVE, REAL, Domain
    from duhem.law.formula_law import Criterion, YieldSurface, criterion
    from duhem.path import Histories, History, Path, Paths, StateHistory
    from duhem.portrait import plot
    from duhem.projection.result import Projection, Status
    from duhem.proof.recheck import Recheck, recheck
    from duhem.proof.verdict import Verdict, Witness
    from duhem.proof.verification import Verification, verify
    from duhem.regions import ParameterRegion, PavedRegion, region
    from duhem.regions.mending import Mended, mend
    from duhem.screening import campaign

_HOMES = {
    "derivation": ("Derivation", "derive"),
    "errors": ("DuhemError", "InputError", "MissingExtraError"),
    "identification": ("Identification", "identify"),
    "law.atlas.entry": ("atlas",),
    "law.catalogue": ("load",),
    "law.curve_law": ("ParametricCriterion",),
    "law.domain": ("POSITIVE", "REAL", "Domain"),
    "law.formula_law": ("Criterion", "criterion", "YieldSurface"),
    "path": ("Histories", "History", "Path", "Paths", "StateHistory"),
    "portrait": ("plot",),
    "projection.result": ("Projection", "Status"),
    "proof.recheck": ("Recheck", "recheck"),
    "proof.verdict": ("Verdict", "Witness"),
    "proof.verification": ("Verification", "verify"),
    "regions.mending": ("Mended", "mend"),
    "regions": ("ParameterRegion", "PavedRegion", "region"),
    "screening": ("campaign",),
    "api.contact": ("contact",),
    "api.histories": ("simulate",),
    "api.increments": ("prepare", "project"),
}


def __getattr__(name: str) -> Any:
    for module, names in _HOMES.items():
        if name in names:
            return getattr(import_module(f"duhem.{module}"), name)
    raise AttributeError(f"module 'duhem' has no attribute {name!r}")


def __dir__() -> list[str]:
    return __all__
