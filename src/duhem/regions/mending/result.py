"""What a mending returns: the nearest admissible law, by how much its limit load differs, what is proved of it, and what else was tried."""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike
from typing import Any, ClassVar

from duhem.law.formula_law import Criterion
from duhem.proof.verdict import Verdict
from duhem.proof.verification import Verification
from duhem.regions.mending.limit_load import NO_DISTANCE, Distance
from duhem.show.place import write
from duhem.show.printing import Shown, draw

__all__ = ["Mended", "Tried"]


@dataclass(frozen=True)
class Tried:
    """One way to mend a law: ``law`` is what it gives, None where it gives nothing; ``told`` says what it is, or why there is nothing."""

    by: str
    told: str
    law: Criterion | None = None
    distance: Distance = NO_DISTANCE
    convex: bool = False


@dataclass(frozen=True, eq=False)
class Mended(Shown):
    """``law`` is the nearest law of ``criterion`` that was found, by the way ``by``; ``criterion`` itself, and ``by`` "", if K is convex.

    ``before`` is what is known of the convexity of K of ``criterion``: it may be open.
    ``distance`` has the mean and the largest change of the limit load over directions of force, over the mean limit load, as far as
    the forces lie in their ranges.
    ``verification`` says what is proved of ``law``; ``tried`` are all ways that were asked, with what each gives.
    """

    printed_by: ClassVar[str] = "duhem.regions.mending.printing"

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
        from duhem.law.criterion_file import criterion_text

        write(file, criterion_text(self.law))

    def to_dict(self, file: str | None = None) -> dict[str, Any]:
        """The JSON of the interface; ``file`` is where the law was written."""
        values = {name: str(own.value) for name, own in self.law.parameters.items() if own.value is not None}
        tried = [{"by": x.by, "told": x.told, "convex": x.convex, **(x.distance.plain() if x.law else {})} for x in self.tried]
        mean, largest = self.distance.plain().values()
        return {
            "criterion": self.criterion.name, "before": self.before.value, "by": self.by or None,
            "parameters": values if self.by == "parameters" else None, "file": file, "mean_distance": mean, "largest_distance": largest,
            "admissible": self.admissible, "told": self.told, "tried": tried, "verification": self.verification.to_dict(),
        }  # fmt: skip

    def plot(self, file: Any = None, axes: Any = None) -> Any:
        """Both boundaries in the plane of the first two forces (extra ``plot``); written to ``file``, if one is given."""
        return draw(self, file, axes)
