"""What is asked for: a law with numbers for its shape, and the ways by which it is mended."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from difflib import get_close_matches
from functools import partial
from typing import Any

from duhem.errors import InputError
from duhem.law.catalogue import load_formula
from duhem.law.criterion_file import criterion_text, reads
from duhem.law.curve_law import Law
from duhem.law.formula_law import Criterion
from duhem.mending.by_coefficients import by_coefficients
from duhem.mending.by_harmonics import by_harmonics
from duhem.mending.by_hull import by_hull
from duhem.mending.by_parameters import by_parameters
from duhem.mending.limit_load import Distance, LoadScale, distance, scale_of
from duhem.mending.result import Mended, Tried
from duhem.proof.verdict import Verdict
from duhem.proof.verification import verdict_within, verify

__all__ = ["HARMONICS", "WAYS", "mend"]

WAYS = ("parameters", "hull", "harmonics", "coefficients")
HARMONICS = 8
_STEPS = 4_000_000
Candidates = Iterator[tuple[Criterion, str]]


def mend(law: str | Law, by: str = "auto", parameters: Mapping[str, Any] | None = None, *, harmonics: int = HARMONICS) -> Mended:
    """The nearest admissible law of a law whose K is not convex, with the change of its limit load, verified.

    ``by`` is ``parameters`` (the nearest point of the region of one parameter), ``hull`` (the convex hull of K), ``harmonics`` (the nearest
    gauge of so many ``harmonics``) or ``coefficients`` (the nearest sos-convex polynomial); ``auto`` takes what changes the limit load
    least at its largest.  ``parameters`` fixes some values: all on which the shape of K depends must have one.  Hull and harmonics are for
    laws of two forces.  Raises InputError for an unknown law or way, and where the law cannot be mended by it.
    """
    if by not in ("auto", *WAYS):
        near = get_close_matches(str(by), WAYS, n=1)
        remedy = f"did you mean {near[0]!r}?" if near else f"one of: auto, {', '.join(WAYS)}"
        raise InputError(f"no law is mended by {by!r}", where="by", remedy=remedy)
    if not 1 <= harmonics <= 16:
        raise InputError(f"{harmonics} harmonics are asked for", where="harmonics", remedy="ask for 1 to 16")
    base = load_formula(law)
    given = base.fix(parameters)
    if given.variables or given.viscous or given.forces_of_rates or not given.associated:
        what = "a law with a state, rates or a flow of its own is not mended"
        raise InputError(what, where=given.name, remedy="mend its criterion alone: leave these out of the file")
    scale = scale_of(given)
    if verify(given, claims=["convexity"])["convexity"].verdict is Verdict.PROVED:
        return Mended(given, given, "", "K is convex: there is nothing to mend", Distance(0.0, 0.0), verify(given))
    tried = [_tried(way, given, base, scale, harmonics) for way in (WAYS if by == "auto" else (by,))]
    found = [one for one in tried if one.law is not None]
    if not found:
        why = "; ".join(f"{one.by}: {one.told}" for one in tried)
        raise InputError(f"no such law was found ({why})", where=given.name, remedy="mend it in another way")
    best = min(found, key=lambda one: (not one.convex, one.distance.largest if one.distance else 0.0))
    assert best.law is not None and best.distance is not None
    return Mended(given, best.law, best.by, best.told, best.distance, verify(best.law), tuple(tried))


def _tried(way: str, law: Criterion, base: Criterion, scale: LoadScale, harmonics: int) -> Tried:
    """The nearest law of one way that is proved to be convex, or else its last one; why there is none."""
    best: Tried | None = None
    try:
        for other, told in _CANDIDATES[way](law, base, scale, harmonics):
            other = reads(criterion_text(other))  # what is verified is what is written
            assert isinstance(other, Criterion)
            convex = verdict_within(other, "convexity", _STEPS) is Verdict.PROVED
            one = Tried(way, told, other, distance(law, other), convex)
            if best is None or (convex, -_largest(one)) > (best.convex, -_largest(best)):
                best = one
            if convex and way != "parameters":
                break
    except InputError as fault:
        if best is None:
            return Tried(way, fault.what)
    return best or Tried(way, "no value of a parameter that is known makes K convex" if way == "parameters" else "nothing was found")


def _largest(one: Tried) -> float:
    return one.distance.largest if one.distance else 0.0


def _in_the_plane(law: Criterion, scale: LoadScale) -> None:
    if len(law.forces) != 2:
        what = f"it has {len(law.forces)} forces; hull and harmonics are for laws of two"
        raise InputError(what, where=law.name, remedy="mend it by parameters or coefficients")
    if not scale.whole or law.domain:
        what = "K does not grow in proportion to a power of the pressure, or has ranges"
        raise InputError(what, where=law.name, remedy="mend it by parameters or coefficients")


def _by_parameters(law: Criterion, base: Criterion, scale: LoadScale, harmonics: int) -> Candidates:
    for other, told in by_parameters(law, base):
        yield replace(other, name=_name(law), summary=_summary(law, told)), told


def _by_formula(formulas: Callable[..., Iterator[tuple[str, str]]], plane: bool, law: Criterion, scale: LoadScale) -> Candidates:
    if plane:
        _in_the_plane(law, scale)
    free = {name: own for name, own in law.parameters.items() if own.value is None}
    for g, told in formulas(law, scale) if plane else formulas(law):
        yield Criterion(
            name=_name(law), g=g, parameters=free, forces=law.forces, pressure=law.pressure, stress=law.stress, domain=law.domain,
            summary=_summary(law, told), source=law.source,
        ), told  # fmt: skip


_CANDIDATES: Mapping[str, Callable[[Criterion, Criterion, LoadScale, int], Candidates]] = {
    "parameters": _by_parameters,
    "hull": lambda law, base, scale, harmonics: _by_formula(by_hull, True, law, scale),
    "harmonics": lambda law, base, scale, harmonics: _by_formula(partial(by_harmonics, most=harmonics), True, law, scale),
    "coefficients": lambda law, base, scale, harmonics: _by_formula(by_coefficients, False, law, scale),
}


def _name(law: Criterion) -> str:
    return f"{law.name}-mended"


def _summary(law: Criterion, told: str) -> str:
    return f"{law.name}, mended: {told}"
