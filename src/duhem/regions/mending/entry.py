"""What is asked for: a law with numbers for its shape, and the ways by which it is mended."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from os import PathLike
from typing import Any, ClassVar, NamedTuple

import numpy as np

from duhem.errors import InputError, meant
from duhem.law.catalogue import load_formula
from duhem.law.criterion_file import criterion_text, reads
from duhem.law.curve_law import Law
from duhem.law.formula_law import Criterion
from duhem.proof.verdict import Verdict
from duhem.proof.verification import Verification, verdict_within, verify
from duhem.regions.mending.by_hull import by_hull, by_sections
from duhem.regions.mending.by_least_squares import by_coefficients, by_harmonics
from duhem.regions.mending.by_parameters import by_parameters
from duhem.regions.mending.limit_load import Distance, ScaledLaw, distance, scale_of
from duhem.show.place import write
from duhem.show.printing import Shown, draw, finite

__all__ = ["WAYS", "Mended", "Tried", "mend"]


class Tried(NamedTuple):
    """One way to mend a law: ``law`` is what it gives, None where it gives nothing; ``told`` says what it is, or why there is nothing."""

    by: str
    told: str
    law: Criterion | None = None
    distance: Distance = Distance()
    convex: bool = False


@dataclass(frozen=True, eq=False)
class Mended(Shown):
    """``law`` is the nearest law of ``criterion`` that was found, by the way ``by``; ``criterion`` itself, and ``by`` "", if K is convex.

    ``before`` is what is known of the convexity of K of ``criterion``: it may be open.
    ``distance`` has the mean and the largest change of the limit load over directions of force, over the mean limit load, as far as
    the forces lie in their ranges.
    ``verification`` says what is proved of ``law``; ``tried`` are all ways that were asked, with what each gives.
    """

    printed_by: ClassVar[str] = "duhem.regions.printing"

    criterion: Criterion
    before: Verdict
    law: Criterion
    by: str
    told: str
    distance: Distance
    verification: Verification
    tried: tuple[Tried, ...] = ()

    def __repr__(self) -> str:
        how = f"by {self.by}, largest change {self.distance.largest:.3f}" if self.by else "nothing to mend"
        return f"<Mended of {self.criterion.name}: {how}{'' if self.admissible else ', not proved admissible'}>"

    @property
    def admissible(self) -> bool:
        """Whether the law is proved to be a generalized standard one that dissipates; never said of what is open."""
        return self.verification.generalized_standard is True and self.verification.dissipative is True

    def to_toml(self, file: str | PathLike[str]) -> None:
        """Write the law as a criterion file.  InputError if it cannot be written."""
        write(file, criterion_text(self.law))

    def to_dict(self, file: str | None = None) -> dict[str, Any]:
        """The JSON of the interface; ``file`` is where the law was written."""
        values = {name: str(own.value) for name, own in self.law.parameters.items() if own.value is not None}
        tried = [{"by": x.by, "told": x.told, "convex": x.convex, **(finite(x.distance._asdict()) if x.law else {})} for x in self.tried]
        mean, largest = finite(self.distance)
        return {
            "criterion": self.criterion.name, "before": self.before.value, "by": self.by or None,
            "parameters": values if self.by == "parameters" else None, "file": file, "mean_distance": mean, "largest_distance": largest,
            "admissible": self.admissible, "told": self.told, "tried": tried, "verification": self.verification.to_dict(),
        }  # fmt: skip

    def plot(self, file: Any = None, axes: Any = None) -> Any:
        """Both boundaries in the plane of the first two forces (extra ``plot``); written to ``file``, if one is given."""
        return draw(self, file, axes)


WAYS = ("parameters", "hull", "harmonics", "coefficients")
_STEPS = 4_000_000


def mend(law: str | Law, by: str = "auto", parameters: Mapping[str, Any] | None = None, *, harmonics: int = 8) -> Mended:
    """The nearest admissible law of a law whose K is not convex, with the change of its limit load, verified.

    ``by`` is ``parameters`` (the nearest point of the region of one parameter), ``hull`` (the convex hull of K), ``harmonics`` (the nearest
    gauge of so many ``harmonics``) or ``coefficients`` (the nearest sos-convex polynomial); ``auto`` takes the admissible law of which the
    largest change is least.  ``parameters`` fixes some values: all on which the shape of K depends need one.  Hull and harmonics are for
    laws of two forces without ranges, the hull also for sums of squares and cones about the hydrostatic axis.  The distance is that in the
    ranges of the forces.  Raises InputError for an unknown law or way, and where the law cannot be mended by it.
    """
    if by not in ("auto", *WAYS):
        raise InputError(f"no law is mended by {by!r}", where="by", remedy=meant(str(by), ("auto", *WAYS)))
    if not (isinstance(harmonics, int) and 1 <= harmonics <= 16):
        raise InputError(f"{harmonics} harmonics are asked for", where="harmonics", remedy="ask for 1 to 16")
    base = load_formula(law)
    given = base.fix(parameters)
    if given.variables or given.viscous or given.forces_of_rates or not given.associated:
        raise InputError("a law with a state, rates or a flow of its own is not mended", where=given.name, remedy="mend its g alone")
    known = verify(given)
    if (before := known["convexity"].verdict) is Verdict.PROVED:
        return Mended(given, before, given, "", "K is convex, there is nothing to mend", Distance(), known)
    scaled = scale_of(given)
    tried = tuple(_tried(way, scaled, base, harmonics) for way in (WAYS if by == "auto" else (by,)))
    best = ((one, one.law) for one in sorted(tried, key=_rank) if one.law is not None)
    mended = (Mended(given, before, own, one.by, one.told, one.distance, verify(own), tried) for one, own in best)
    if (nearest := next(mended, None)) is None:
        why = "; ".join(f"{one.by}: {one.told}" for one in tried)
        raise InputError(f"no such law was found ({why})", where=given.name, remedy="mend it in another way, or ask duhem region")
    return nearest if nearest.admissible else next((done for done in mended if done.admissible), nearest)


def _rank(one: Tried) -> tuple[bool, bool, float]:
    return one.law is None, not one.convex, one.distance.largest


def _tried(way: str, scaled: ScaledLaw, base: Criterion, harmonics: int) -> Tried:
    """The nearest law of one way that is proved to be convex, or else one that is not; why there is none."""
    name, best = scaled.law.name, Tried(way, "nothing was found")
    try:
        for other, told in _candidates(way, scaled, base, harmonics):
            written = reads(criterion_text(replace(other, name=f"{name}-mended", summary=f"{name}, mended: {told}")))
            assert isinstance(written, Criterion)  # what is verified is what is written
            convex = verdict_within(written, "convexity", _STEPS) is Verdict.PROVED
            best = min(best, Tried(way, told, written, distance(scaled, written), convex), key=_rank)
            if convex and way != "parameters":
                break
    except InputError as fault:
        best = best if best.law else Tried(way, fault.what)
    return best


def _candidates(way: str, scaled: ScaledLaw, base: Criterion, harmonics: int) -> Iterator[tuple[Criterion, str]]:
    """Laws that may be convex, and what each is."""
    law = scaled.law
    if way == "parameters":
        yield from by_parameters(scaled, base)
        return
    by_section = way == "hull" and len(law.forces) > 2
    needs = {
        "laws of two forces": len(law.forces) == 2 or by_section,
        "forces without ranges": not law.domain,
        "a K that grows in proportion to a power of the pressure": law.pressure is None or law.pressure in scaled.powers,
        "a K that ends in all directions": bool(np.isfinite(scaled.loads).all()) or by_section,
    }
    if way != "coefficients" and (unmet := [need for need, is_met in needs.items() if not is_met]):
        raise InputError(f"this is for {unmet[0]}", where=law.name, remedy="mend it by parameters or coefficients")
    free = {name: own for name, own in law.parameters.items() if own.value is None}
    hull = iter([by_sections(scaled)]) if by_section else by_hull(scaled)
    formulas = {"hull": hull, "harmonics": by_harmonics(scaled, harmonics), "coefficients": by_coefficients(scaled)}
    for g, told in formulas[way]:
        yield Criterion(law.name, g, free, law.forces, law.pressure, stress=law.stress, domain=law.domain, source=law.source), told
