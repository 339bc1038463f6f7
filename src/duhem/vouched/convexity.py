"""Whether K is convex, asked once for a law and its numbers, within a small budget of steps.

Projection finds a stationary point; on a convex K that is the closest one, and nothing that is seen at the point itself
tells.  The claim ``convexity`` is put to :func:`duhem.verify` for the law over its whole domain, which answers for all
numbers at once, and where that shows nothing for the numbers given, decimals taken exactly.  It speaks of sigma_n < 0: K at
sigma_n = 0 is a question of its own.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from typing import Any

import sympy as sp

from duhem.errors import DuhemError, InputError
from duhem.law.convex import check_convex
from duhem.law.formula_law import Criterion
from duhem.projection.increment import Convexity
from duhem.projection.validation import exact_parameters

__all__ = ["asked"]
_EFFORT = "quick"
_REMEDY = 'take numbers for which duhem verify proves convexity, or convex="ask" and look at the statuses'


def asked(law: Criterion, parameters: Mapping[str, Any] | None, convex: str, *, unloaded: bool) -> Convexity | None:
    """What is shown of K with these numbers; None where ``convex`` is ``assume``, and nobody is asked.

    ``unloaded``: sigma_n = 0 occurs, and is asked about too.  Where it is ``require`` an InputError says what is not shown.
    """
    check_convex(convex)
    if convex == "assume":
        return None
    fixed = law.fix(exact_parameters(law, parameters))
    loaded = _shown(law, fixed)
    if convex == "require" and not loaded:
        found = "refuted" if _verdict(_everywhere(fixed)) == "refuted" else "not shown"
        raise InputError(f"that K of {law.name} is convex is {found}", where="convex", remedy=_REMEDY)
    if law.pressure is None or not unloaded:
        return Convexity(loaded, unloaded=False)
    bare = [_unloaded(one) for one in (law, fixed)]
    known = Convexity(loaded, unloaded=_shown(*bare))
    if convex == "require" and not known.unloaded:
        raise InputError(f"that K of {law.name} is convex is not shown at {law.pressure} = 0", where="convex", remedy=_REMEDY)
    return known


def _shown(law: Criterion | None, fixed: Criterion | None) -> bool:
    """For all numbers in the law's domain, or else for those of ``fixed``."""
    return any(one is not None and _verdict(_everywhere(one)) == "proved" for one in (law, fixed))


@lru_cache(maxsize=1024)
def _verdict(law: Criterion) -> str:
    """The verdict on K over every number that the law leaves open; none, "", where the question has no meaning."""
    from duhem.proof.verification import verify

    try:
        return verify(law, claims="convexity", effort=_EFFORT)["convexity"].verdict.value
    except DuhemError:  # undefined somewhere, or no numbers at all
        return ""


def _everywhere(law: Criterion) -> Criterion:
    """The law without its ranges of forces: a K that is convex within them may come nearer to a trial stress beyond."""
    return replace(law, domain={name: own for name, own in law.domain.items() if name == law.pressure})


def _unloaded(law: Criterion) -> Criterion | None:
    """The law at sigma_n = 0, over its forces alone; None where its formula has no meaning there."""
    assert law.pressure is not None
    g = law.g.xreplace({law.symbols()[law.pressure]: sp.S.Zero})
    if g.has(sp.nan, sp.zoo, sp.oo, -sp.oo):
        return None
    try:
        return Criterion(law.name, g, law.parameters, forces=law.forces, pressure=None, constraints=law.constraints)
    except InputError:  # no force is left in it
        return None
