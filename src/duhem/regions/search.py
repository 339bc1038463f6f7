"""The cells of one parameter: where a claim is proved, grown from values at which it is, and what lies between them, halved where need be.

Ends are found by the simplest fractions between a value that the proof reaches and one that it does not; what is no fraction is looked for
among roots of short polynomials.  Only what the kernel confirms over a whole cell counts; the rest is open.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import islice, pairwise

from duhem.proof.kernel.bounds import Bounds
from duhem.proof.kernel.parameter_tree import own_domain
from duhem.proof.kernel.signs import RealRoot
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.regions.asked import AsksTheKernel
from duhem.regions.places import OPEN, Decided, ParameterCell, between, law_at, middle, order, simplest, square_root_near
from duhem.regions.seen import changes

__all__ = ["Asked", "cells_of"]

_IN_DEPTH, _MOST_ASKED = 10_000_000, 30  # from so many steps on whole verifications are asked for; the most of these


@dataclass
class Asked(AsksTheKernel):
    """A claim of a law, asked for the values of one of its parameters."""

    by_all: bool = False  # whether everything that makes proofs is asked too
    verifications: int = 0
    whole: ParameterCell = field(init=False)
    _known: dict[ParameterCell, Decided | None] = field(default_factory=dict)
    _refuted: dict[ParameterCell, Decided | None] = field(default_factory=dict)

    def __post_init__(self) -> None:
        super().__post_init__()
        low, high, *left_out = own_domain(self.stated, self.names[0])
        self.whole = ParameterCell(*(None if end is None else RealRoot.of(end) for end in (low, high)), *left_out)  # type: ignore[arg-type]

    def over(self, cell: ParameterCell) -> StatedLaw:
        """The law over a cell."""
        return law_at(self.stated, cell.where(self.names[0], self.whole), self.names)

    # -- proved ----------------------------------------------------------------------------------------------------

    def proved(self, cell: ParameterCell) -> Decided | None:
        """The proof over a cell; None where no rule confirms it."""
        if cell not in self._known:
            row = None if self.spent else self.proof(self.over(cell))
            if row is None and self.by_all and not self.spent and self.verifications < _MOST_ASKED:
                self.verifications += 1
                row = self.proof_by_all(self.over(cell), cell.where(self.names[0], self.whole))
            self._known[cell] = None if row is None else Decided(cell, {"verdict": "proved", **row})
        return self._known[cell]

    # -- refuted ---------------------------------------------------------------------------------------------------

    def refuted(self, cell: ParameterCell) -> Decided | None:
        """A family of witnesses over a cell; None where none is confirmed."""
        if cell not in self._refuted:
            name, both = self.names[0], ((cell.low, cell.open), (cell.high, cell.open_high))
            ends = [(end, left_out) for end, left_out in both if end is not None and end.exact]
            away = [f"({end.low} - {name})" if end is cell.high else f"({name} - ({end.low}))" for end, _ in reversed(ends)]
            held = {end for known in self._known.values() if known is not None for end in known.cell[:2]}
            turning = [end.low for end, left_out in ends if left_out and end in held]
            row = None if self.spent else self.refutation(self.over(cell), away, [end for end, _ in ends], turning)
            self._refuted[cell] = None if row is None else Decided(cell, {"verdict": "refuted", **row})
        return self._refuted[cell]


_NARROW = Fraction(1, 2**30)
_ROUNDING, _SHORT, _UNDIVIDED = 3e-8, 1000, Fraction(3, 10_000)
_MOST_IN_VAIN, _MOST_TRIES, _FARTHEST, _FEW_SEEDS = 12, 60, 2**16, 3  # the first: gaps one after the other that are halved


def cells_of(asked: Asked) -> tuple[Decided, ...]:
    """The cells that cover the domain, in order: proved, refuted or open.

    The widest gap comes first.  What is decided in one may leave others, and a gap in which nothing is decided is halved.
    """
    done, cuts = _seen(asked) if (whole := asked.proved(asked.whole)) is None else ([whole], [])
    gaps, in_vain = [(gap, True) for gap in _left(asked.whole, [one.cell for one in done])], 0
    while gaps:
        gap, fresh = gaps.pop(max(range(len(gaps)), key=lambda i: _width(gaps[i][0])))
        if (found := None if asked.spent else _decided(asked, gap, fresh)) is not None:
            done.append(found)
            gaps += [(rest, fresh and found.leaf["verdict"] == "proved") for rest in _left(gap, [found.cell])]
            in_vain = 0
        elif gap == asked.whole and cuts:  # nothing grows, so each stretch in which floating point sees no change is asked by itself
            gaps += [(part, False) for part in _left(gap, cuts)]
        elif gap == asked.whole and asked.most >= _IN_DEPTH and not (asked.by_all or asked.spent):
            asked.by_all, asked._known = True, {}
            gaps.append((gap, fresh))
        elif asked.spent or in_vain == _MOST_IN_VAIN or (_is_narrow(gap) and gap != asked.whole):
            done.append(Decided(gap, OPEN))
        else:
            at, in_vain = RealRoot.of(middle(gap.bounds)), in_vain + 1
            gaps += [(gap._replace(high=at, open_high=False), False), (gap._replace(low=at, open=True), False)]
    cells = list[Decided]()
    for one in sorted(done, key=lambda one: order(one.cell)):
        if cells and cells[-1].leaf["verdict"] == one.leaf["verdict"] == "open":
            cells[-1] = cells[-1]._replace(cell=cells[-1].cell._replace(high=one.cell.high, open_high=one.cell.open_high))
        else:
            cells.append(one)
    return tuple(cells)


def _left(whole: ParameterCell, cells: Iterable[ParameterCell]) -> Iterator[ParameterCell]:
    """What cells leave of one."""
    start, left_out = whole.low, whole.open
    for low, high, out, out_high in sorted(cells, key=order):
        if low is not None and (before := _cell(start, low, left_out, not out)) is not None:
            yield before
        start, left_out = high, not out_high
        if start is None:
            return
    if (after := _cell(start, whole.high, left_out, whole.open_high)) is not None:
        yield after


def _decided(asked: Asked, gap: ParameterCell, fresh: bool) -> Decided | None:
    """A gap refuted or proved as a whole, or a cell in it to which a proof grows.

    Proofs grow from values in a ``fresh`` gap alone, one in which nothing was tried.
    """
    if (found := asked.refuted(gap)) is not None:
        return found
    if _is_narrow(gap) and gap != asked.whole:
        one = RealRoot.of(middle(gap.bounds))  # it may hold at one value alone, about which floating point sees more
        return asked.proved(gap) or asked.proved(ParameterCell(one, one))
    if not fresh:
        return asked.proved(gap)
    few = asked.by_all or gap != asked.whole  # such a gap is halved where nothing grows
    seeds = islice(_seeds(gap.bounds), _FEW_SEEDS if few else None)
    return next(filter(None, (_grown(asked, seed, gap) for seed in seeds if not asked.spent)), None)


def _is_narrow(gap: ParameterCell) -> bool:
    """Whether a gap is not divided: it is one value, beside an end that is told by no short number, or far away."""
    if gap.low is None or gap.high is None:
        return any(end is not None and abs(end.low) >= _FARTHEST for end in gap[:2])
    return gap.high.low - gap.low.high <= _UNDIVIDED * max(Fraction(1), abs(gap.low.low))


def _seen(asked: Asked) -> tuple[list[Decided], list[ParameterCell]]:
    """Cells on which the claim seems to hold, by floating point, and is proved; and the numbers at which it seems to change over.

    The ends of cells are short numbers, or those of the domain.  A number at which it changes over is told as what lies between the cells
    on both sides, of which the one where the claim holds has it: (x, False, True) where the claim holds above x, else (x, True, False).
    """
    whole, told = asked.whole, asked.told(asked.over(asked.whole))
    stretches = changes(told, asked.names[0], whole.bounds) if told else []
    cuts = [ParameterCell(at := _number_near(low), at, not holds, holds) for low, _, holds in stretches[1:]]
    ends, found = [(whole.low, whole.open), *((cut.low, False) for cut in cuts), (whole.high, whole.open_high)], list[Decided]()
    for (*_, holds), ((low, out), (high, out_high)) in zip(stretches, pairwise(ends), strict=False):
        each = dict.fromkeys([(out, out_high), (True, out_high), (out, True), (True, True)])
        cells = (_cell(low, high, *left_out) for left_out in each if holds)
        found += islice(filter(None, (asked.proved(cell) for cell in cells if cell is not None)), 1)
    return found, cuts


def _number_near(x: float) -> RealRoot:
    """The simplest fraction that floating point cannot tell from x, or a root of a short polynomial where that is no short one."""
    wide = Fraction(max(1.0, abs(x)) * _ROUNDING)
    low, high = Fraction(x) - wide, Fraction(x) + wide
    plain = simplest(low, high)
    return (None if plain.denominator < _SHORT else square_root_near(low, high)) or RealRoot.of(plain)


def _cell(low: RealRoot | None, high: RealRoot | None, left_out: bool, left_out_high: bool) -> ParameterCell | None:
    """The cell between two ends; None where nothing is between."""
    if low is not None and low == high:
        return None if left_out or left_out_high else ParameterCell(low, high)
    return ParameterCell(low, high, left_out and low is not None, left_out_high and high is not None)


def _seeds(domain: Bounds) -> Iterator[Fraction]:
    """Values inside a domain from which it is grown, plain ones first."""
    inner = [between(domain, domain, Fraction(k, 16)) for k in (8, 4, 12, 2, 6, 10, 14, 1, 15)]
    ends = [end for end, out in zip(domain[:2], domain[2:], strict=True) if end is not None and not out]
    yield from dict.fromkeys([middle(domain), *inner, *ends])


def _grown(asked: Asked, seed: Fraction, gap: ParameterCell) -> Decided | None:
    """The largest cell around a value in a gap on which the claim is seen to be proved; None where it is not proved at that value."""
    here = RealRoot.of(seed)
    if (found := asked.proved(ParameterCell(here, here))) is None:
        return None
    high, high_open = _farthest(asked, here, gap, upward=True)
    low, low_open = _farthest(asked, here, gap, upward=False)
    cells = _cell(low, high, low_open, high_open), _cell(low, here, low_open, False), _cell(here, high, False, high_open)
    return next(filter(None, (asked.proved(cell) for cell in cells if cell is not None)), found)


def _farthest(asked: Asked, here: RealRoot, gap: ParameterCell, *, upward: bool) -> tuple[RealRoot | None, bool]:
    """How far a proof reaches from a value in one way, and whether that end is left out."""
    end, left_out = (gap.high, gap.open_high) if upward else (gap.low, gap.open)

    def reaches(end: RealRoot | None, out: bool = False) -> bool:
        cell = _cell(here, end, False, out) if upward else _cell(end, here, out, False)
        return cell is not None and asked.proved(cell) is not None

    def told(end: RealRoot | None, outs: Iterable[bool] = (False, True)) -> tuple[RealRoot | None, bool] | None:
        return next(((end, out) for out in outs if reaches(end, out)), None)

    if end == here:
        return end, False
    beside = _cell(here, end, True, left_out) if upward else _cell(end, here, left_out, True)
    if beside is not None and asked.refuted(beside) is not None:
        return here, False
    if (found := told(end, (left_out,) if left_out or end is None else (False, True))) is not None:
        return found
    way, near, beyond = 1 if upward else -1, here.low, None if end is None else end.low
    small = _NARROW * max(Fraction(1), abs(near))
    if not reaches(RealRoot.of(near + way * small)):
        return here, False
    for i in range(_MOST_TRIES):
        if beyond is None:
            x = here.low + way * 2**i
        elif asked.spent or abs(beyond - near) <= small:
            break
        else:
            rim = abs(beyond - near) / 4 * (i % 2)  # every other time well inside, so that few are asked
            x = simplest(min(near, beyond) + rim, max(near, beyond) - rim)
        if not reaches(RealRoot.of(x - way * small)):
            beyond = x
        elif abs(x) < _FARTHEST and reaches(RealRoot.of(x + way * small)):
            near = x
        elif (found := told(RealRoot.of(x))) is not None:
            return found
        else:
            near, beyond = x - way * small, x
    root = None if beyond is None else square_root_near(min(near, beyond), max(near, beyond))
    short = RealRoot.of(simplest(*sorted((near, near - way * 2**8 * small))))  # nearly as far, in fewer digits
    return (None if root is None else told(root)) or told(short, (False,)) or (RealRoot.of(near), False)


def _width(cell: ParameterCell) -> Fraction:
    return (cell.high.low - cell.low.high) if cell.low is not None and cell.high is not None else Fraction(_FARTHEST)
