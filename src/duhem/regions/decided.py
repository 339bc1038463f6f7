"""One cell decided: a proof over it by the kernel's rules, or a family of witnesses that floating point finds and the kernel confirms."""

from __future__ import annotations

from dataclasses import dataclass, field

from duhem.proof.kernel.parameter_cells import own_domain
from duhem.proof.kernel.real_root import RealRoot
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.regions.asked import AsksTheKernel
from duhem.regions.line import Decided, ParameterCell
from duhem.regions.places import law_at
from duhem.regions.seen import changes

__all__ = ["Asked"]

_IN_DEPTH = 10_000_000  # from so many steps on whole verifications are asked for
_MOST_ASKED = 30  # of these, for proofs


@dataclass
class Asked(AsksTheKernel):
    """A claim of a law, asked for the values of one of its parameters."""

    name: str = field(init=False)
    by_all: bool = False
    verifications: int = 0
    whole: ParameterCell = field(init=False)
    _known: dict[ParameterCell, Decided | None] = field(default_factory=dict)
    _refuted: dict[ParameterCell, Decided | None] = field(default_factory=dict)

    def __post_init__(self) -> None:
        super().__post_init__()
        (self.name,) = self.names
        low, high, *left_out = own_domain(self.stated, self.name)
        self.whole = ParameterCell(*(None if end is None else RealRoot.of(end) for end in (low, high)), *left_out)  # type: ignore[arg-type]

    def over(self, cell: ParameterCell) -> StatedLaw:
        """The law over a cell."""
        return law_at(self.stated, cell.where(self.name, self.whole), self.names)

    # -- proved ----------------------------------------------------------------------------------------------------

    def proved(self, cell: ParameterCell) -> Decided | None:
        """The proof over a cell; None where no rule confirms it."""
        if cell not in self._known:
            row = None if self.spent else self.proof(self.over(cell))
            if row is None and self.by_all and not self.spent and self.verifications < _MOST_ASKED:
                self.verifications += 1
                row = self.proof_by_all(self.over(cell), cell.where(self.name, self.whole))
            self._known[cell] = None if row is None else Decided(cell, "proved", row)
        return self._known[cell]

    def ask_all(self) -> bool:
        """From now on everything that makes proofs is asked too; False where it is already, or the steps are too few."""
        if self.by_all or self.spent or self.most < _IN_DEPTH:
            return False
        self.by_all = True
        self._known.clear()
        return True

    def seen(self) -> list[tuple[float, float, bool]] | None:
        """Stretches of the parameter where the claim seems to hold, and to fail, in floating point; None where that tells nothing."""
        return None if (holding := self.holding(self.over(self.whole))) is None else changes(holding, self.name, self.whole.bounds)

    # -- refuted ---------------------------------------------------------------------------------------------------

    def refuted(self, cell: ParameterCell) -> Decided | None:
        """A family of witnesses over a cell; None where none is confirmed."""
        if cell not in self._refuted:
            ends = [end for end in (cell.high, cell.low) if end is not None and end.exact]
            away = [f"({self.name} - ({end.low}))" if end is cell.low else f"({end.low} - {self.name})" for end in ends]
            row = None if self.spent else self.refutation(self.over(cell), away, ends[::-1])
            self._refuted[cell] = None if row is None else Decided(cell, "refuted", row)
        return self._refuted[cell]
