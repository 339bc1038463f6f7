"""Which failure is likely the cause of which others: one cause is told once, with the checks that it explains, expected or not."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

from duhem.testing.failures.failure import Failure

__all__ = ["CAUSES", "FREE_CAUSES", "as_expected", "by_cause", "likeliest_first", "of_stress"]


_STRESS = (  # of a stress that is not the closest point, what says most of it first
    "feasibility", "idempotence", "homogeneity", "stiffness-scale", "complementarity", "variational-inequality", "dissipation", "ray",
    "non-expansiveness", "firmness", "potential", "path",
)  # fmt: skip
_OUTPUTS = ("slip", "energy", "multiplier", "slope", "tangent")
_SHAPE = (
    "variational-inequality", "non-expansiveness", "firmness", "potential", "ray", "idempotence", "complementarity", "tangent", "slope",
)  # fmt: skip

# The checks that may be the cause, the likeliest first, and those that fail with each.  What is said of the stress comes before what is
# returned beside it.
CAUSES: Mapping[str, tuple[str, ...]] = {
    "vacuity": (),
    "answers": (*_STRESS, *_OUTPUTS, "repeatability"),  # without a stress, they cannot pass
    "origin": _SHAPE,  # if K does not contain the origin, the closest point has none of these properties
    "convexity": _SHAPE,  # if K is not convex, the closest point is not unique and has none of these properties
    "smoothness": (),  # a corner of K affects no other check
    "repeatability": (*_STRESS, *_OUTPUTS),  # an answer that depends on earlier calls cannot satisfy them
    "inputs": (),  # an answer may be right although the routine has changed its inputs
    **{name: _STRESS[i + 1 :] for i, name in enumerate(_STRESS)},  # each of them follows if the stress is the closest point
    "slip": ("energy",),  # the balance of energy uses the returned slip
    "energy": (),
    "multiplier": (),
    "slope": ("tangent",),  # a tangent that is not the slope of the stress need be neither symmetric nor bounded
    "tangent": (),  # where it is the slope of the stress, the stress derives from no potential
}
_STATES = ("kept-state", "stress-of-the-state", "admissibility", "loading", "flow", "evolution", "law-dissipation")
_FREE_STRESS = (*_STATES, "rest", "slip", "stored-energy", "dissipation", "energy", "slope", "subdivision")
_ASSOCIATED = ("associated-symmetry", "associated-non-expansiveness", "associated-potential", "associated-ray")
# The same of the checks that need no law, the likeliest cause first.
FREE_CAUSES: Mapping[str, tuple[str, ...]] = {
    "answers": ("repeatability", "elasticity", "vacuity", "rate", *_FREE_STRESS, *_ASSOCIATED),
    "repeatability": ("elasticity", "vacuity", "rate", *_FREE_STRESS, *_ASSOCIATED),
    "inputs": (),
    "elasticity": ("vacuity", *_FREE_STRESS, "isotropic-plastic-work"),
    "vacuity": (),
    **{name: (*_STATES[i + 1 :], *_FREE_STRESS[len(_STATES) :]) for i, name in enumerate(_STATES)},
    "rate": ("energy", "subdivision"),
    "dissipation": ("energy", "isotropic-plastic-work", "associated-potential"),
    "rest": ("slip", "stored-energy", "energy", "subdivision", *_ASSOCIATED),
    "slip": ("dissipation", "energy"),
    "stored-energy": ("energy",),
    "energy": (),
    "slope": ("associated-symmetry",),
    "subdivision": (),
}
_TABLES = {True: CAUSES, False: FREE_CAUSES}  # with a law, and without
_UNSYMMETRIC = {"potential", "firmness", "variational-inequality"}  # a stress without a potential has no symmetric slope


def by_cause(failures: Sequence[Failure]) -> tuple[tuple[Failure, ...], tuple[Failure, ...]]:
    """Return the failures that are likely causes, the likeliest first, and those that they explain.

    The diagnosis that explains most failures of a kind is taken first, and they are one; the others are ordered by the table.
    """
    left, failed = sorted(failures, key=likeliest_first), {f.check.name for f in failures}
    roots: list[Failure] = []
    explained: list[Failure] = []
    while left:
        root = left[0]
        of_a_kind = [f for f in left if _kind(f) == _kind(root)]
        met = Counter(name for f in of_a_kind for name in f.diagnoses)
        if met and _kind(root):
            told = max(met, key=lambda name: met[name])  # of equals the first met
            root = next(f for f in of_a_kind if told in f.diagnoses)
            root = replace(root, diagnoses={told: root.diagnoses[told], **({} if root.check.of_a_law else root.diagnoses)})
        behind = [f for f in left if f.check != root.check and _explains(root, f, failed)]
        names = tuple(f.check.name for f in behind)
        roots.append(replace(root, explains=names))
        explained += behind
        left = [f for f in left if f.check.name not in (root.check.name, *names)]
    return tuple(sorted(roots, key=likeliest_first)), tuple(explained)


def as_expected(
    reasons: Mapping[str, str], failed: Collection[str], passed: Collection[str], left_out: Mapping[str, str], of_a_law: bool
) -> tuple[dict[str, str], dict[str, str], dict[str, str]]:
    """Return the checks that failed as expected, those that passed though they had to fail, and those left out, each with the reason.

    ``reasons`` are those for which checks are known to fail.  Which of the checks that a cause explains fail with it depends on the
    cases that were drawn, so that they may fail or pass.
    """
    causes = [name for name in reasons if name in failed]
    explained = {name: cause for cause in causes[::-1] for name in _explained_by(cause, failed, of_a_law)}
    likely = {name: f"likely for the same reason as [{cause}]" for name, cause in explained.items()}
    met = {name: why for name, why in {**likely, **reasons}.items() if name in failed}
    unmet = {name: why for name, why in reasons.items() if name in passed and name not in likely}
    vain = reasons.keys() - likely.keys()
    told = {name: f"{why}; so it is expected to fail in vain" if name in vain else why for name, why in left_out.items()}
    return met, unmet, told


def _explained_by(check: str, failed: Collection[str], of_a_law: bool) -> tuple[str, ...]:
    """Return the checks that may fail for the reason for which ``check`` does, by the tables; ``failed`` are all that failed with it."""
    behind = _TABLES[of_a_law].get(check, ())
    turned = _UNSYMMETRIC & {check, *behind} & set(failed)
    return (*behind, "tangent") if check in _STRESS and turned and "slope" not in failed else behind


def likeliest_first(failure: Failure) -> tuple[int, int]:
    """Return a key that sorts failures, the likeliest cause first."""
    order = [*_TABLES[failure.check.of_a_law], failure.check.name]
    return _kind(failure), order.index(failure.check.name)


def of_stress(failure: Failure) -> bool:
    """Return whether a failure is one of the stress itself, not of what is returned beside it or of the calls."""
    return failure.check.of_a_law and failure.check.name in _STRESS


def _kind(failure: Failure) -> int:
    """Return 0 for causes of all, 1 for those of stresses, 2 for those of what is returned beside them; without a law always 0."""
    if not failure.check.of_a_law:
        return 0
    name = failure.check.name
    return 1 if of_stress(failure) else 0 if name in _TABLES[True] and name not in _OUTPUTS else 2


def _explains(root: Failure, other: Failure, failed: set[str]) -> bool:
    name = other.check.name
    if _kind(root) == 1:  # a diagnosis may have put it before a check that ranks higher
        return name in _STRESS or (name == "tangent" and "slope" not in failed and bool(failed & _UNSYMMETRIC))
    if root.diagnoses.keys() & other.diagnoses.keys():
        return True
    if root.diagnoses and other.diagnoses and not root.check.of_a_law:
        return False  # another mistake
    return name in _TABLES[root.check.of_a_law].get(root.check.name, ())
