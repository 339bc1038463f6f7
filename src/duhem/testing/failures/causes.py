"""Which failure is likely the cause of which others: one cause is told once, with the checks that it explains."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

from duhem.testing.failures.report import Failure

__all__ = ["CAUSES", "Cause", "by_cause", "explained_by", "likeliest_first", "of_stress"]


@dataclass(frozen=True)
class Cause:
    """Where a check that fails is the cause: the checks that fail with it, and why they do."""

    check: str
    explains: frozenset[str]
    why: str


_STRESS = (  # of a stress that is not the closest point, what says most of it first
    "feasibility", "idempotence", "homogeneity", "stiffness-scale", "complementarity", "variational-inequality", "dissipation", "ray",
    "non-expansiveness", "firmness", "potential", "path",
)  # fmt: skip
_OUTPUTS = ("slip", "energy", "multiplier", "slope", "tangent")
_SHAPE = (
    "variational-inequality",
    "non-expansiveness",
    "firmness",
    "potential",
    "ray",
    "idempotence",
    "complementarity",
    "tangent",
    "slope",
)


def _cause(check: str, explains: Sequence[str], why: str) -> Cause:
    return Cause(check, frozenset(explains) - {check}, why)


# The likely causes, the first first.  What is said of the stress comes before what is returned beside it.
CAUSES: tuple[Cause, ...] = (
    _cause("vacuity", (), "what was not visited was not tested, whatever else is found"),
    _cause("answers", (*_STRESS, *_OUTPUTS, "repeatability"), "without a stress there is nothing that could satisfy the others"),
    _cause("origin", _SHAPE, "a set without the origin is no K, and the closest point of it has none of these properties"),
    _cause("convexity", _SHAPE, "on a set that is not convex the closest point is not unique and has none of these properties"),
    _cause("smoothness", (), "a corner of K breaks none of the others"),
    _cause("repeatability", (*_STRESS, *_OUTPUTS), "an answer that depends on what was asked before cannot satisfy a rule"),
    _cause("inputs", (), "an answer may be right though what was given is gone"),
    *(_cause(name, _STRESS[i:], "each follows from the stress being the closest point") for i, name in enumerate(_STRESS)),
    _cause("slip", ("energy",), "the balance of energy is taken with the slip returned"),
    _cause("energy", (), "no other check looks at it"),
    _cause("multiplier", (), "no other check looks at it"),
    _cause("slope", ("tangent",), "a tangent that is not the slope of the stress need be neither symmetric nor bounded"),
    _cause("tangent", (), "where it is the slope of the stress, the stress derives from no potential"),
)
_RANK = {cause.check: i for i, cause in enumerate(CAUSES)}
_TABLE = {cause.check: cause.explains for cause in CAUSES}
_UNSYMMETRIC = {"potential", "firmness", "variational-inequality"}  # a stress without a potential has no symmetric slope


def by_cause(failures: Sequence[Failure]) -> tuple[tuple[Failure, ...], tuple[Failure, ...]]:
    """The failures that are likely causes, the likeliest first, and those that they explain.

    The diagnosis that explains most failures of a kind is taken first, and they are one; the others are ordered by the table.
    """
    roots: list[Failure] = []
    explained: list[Failure] = []
    for root, names in _groups(sorted(failures, key=likeliest_first), {f.check.name for f in failures}):
        roots.append(replace(root, explains=tuple(f.check.name for f in names)))
        explained += names
    return tuple(sorted(roots, key=likeliest_first)), tuple(explained)


def _groups(left: list[Failure], failed: set[str]) -> list[tuple[Failure, list[Failure]]]:
    groups: list[tuple[Failure, list[Failure]]] = []
    while left:
        root = left[0]
        of_a_kind = [f for f in left if _kind(f) == _kind(root)]
        met = Counter(name for f in of_a_kind for name in f.diagnoses)
        told = max(met, key=lambda name: met[name]) if met and _kind(root) else None  # of equals the first met
        if told is not None:
            root = next(f for f in of_a_kind if told in f.diagnoses)
            root = replace(root, diagnoses={told: root.diagnoses[told]})
        names = [f for f in left if f.check != root.check and _explains(root, f, failed)]
        groups.append((root, names))
        gone = {root.check.name, *(f.check.name for f in names)}
        left = [f for f in left if f.check.name not in gone]
    return groups


def explained_by(check: str, failed: Collection[str]) -> frozenset[str]:
    """The checks that may fail for the reason for which ``check`` does, by the table alone; those that ``failed`` are with it."""
    behind = _TABLE.get(check, frozenset())
    turned = _UNSYMMETRIC & {check, *behind} & set(failed)
    return behind | {"tangent"} if check in _STRESS and turned and "slope" not in failed else behind


def likeliest_first(failure: Failure) -> tuple[int, int]:
    """A key to sort failures by."""
    return _kind(failure), _RANK.get(failure.check.name, len(CAUSES))


def of_stress(failure: Failure) -> bool:
    """Whether it is one of the stress itself, not of what is returned beside it or of the calls."""
    return failure.check.name in _STRESS


def _kind(failure: Failure) -> int:
    """Causes of all, then of stresses, then of what is returned beside them."""
    name = failure.check.name
    return 1 if of_stress(failure) else 0 if name in _TABLE and name not in _OUTPUTS else 2


def _explains(root: Failure, other: Failure, failed: set[str]) -> bool:
    name = other.check.name
    if _kind(root) == 1:  # a diagnosis may have put it before a check that ranks higher
        return name in _STRESS or (name == "tangent" and "slope" not in failed and bool(failed & _UNSYMMETRIC))
    if root.diagnoses.keys() & other.diagnoses.keys():
        return True
    return name in _TABLE.get(root.check.name, ())
