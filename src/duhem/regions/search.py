"""The cells of one parameter: where a claim is proved, grown from values at which it is, and what lies between them.

Ends are found by the simplest fractions between a value that the proof reaches and one that it does not; what is no fraction is looked for
among roots of short polynomials.  Only what the kernel confirms over a whole cell counts; the rest is open.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import groupby, islice

from duhem.proof.kernel.bounds import Bounds
from duhem.proof.kernel.parameter_cells import ParameterCell
from duhem.proof.kernel.real_root import RealRoot
from duhem.regions.decided import Asked, Decided
from duhem.regions.numbers import simplest, square_root_near

__all__ = ["cells_of"]

_NARROW = Fraction(1, 2**30)
_ROUNDING, _SHORT, _BESIDE = 3e-8, 1000, (1e-6, 1e-4)
_MOST_HALVINGS, _MOST_TRIES, _FARTHEST, _FEW_SEEDS = 5, 60, 2**16, 3


def cells_of(asked: Asked) -> list[Decided]:
    """The cells that cover the domain, in order: proved, refuted or open."""
    if (whole := asked.proved(asked.whole)) is not None:
        return [whole]
    return list(_between(asked, asked.whole, _seen(asked)))


def _between(asked: Asked, gap: ParameterCell, proved: Sequence[Decided]) -> Iterator[Decided]:
    """The cells of a gap of which some are known."""
    start, start_open = gap.low, gap.open
    for done in proved:
        if (before := _cell(start, done.cell.low, start_open, not done.cell.open)) is not None and done.cell.low is not None:
            yield from _resolved(asked, before)
        yield done
        start, start_open = done.cell.high, not done.cell.open_high
        if start is None:
            return
    if (after := _cell(start, gap.high, start_open, gap.open_high)) is not None:
        yield from _resolved(asked, after)


def _resolved(asked: Asked, gap: ParameterCell) -> Iterator[Decided]:
    """The cells of a gap of which nothing is known: it is refuted, or a proof grows from a value in it, or it is refuted in parts."""
    if (found := asked.refuted(gap)) is not None:
        yield found
        return
    if gap != asked.whole and _is_sliver(gap):
        yield Decided(gap, "open")
        return
    for seed in () if asked.spent else _seeds(gap.bounds):
        if (grown := _grown(asked, seed, gap)) is not None:
            yield from _between(asked, gap, [grown])
            return
    if gap == asked.whole and asked.ask_all():
        for seed in islice(_seeds(gap.bounds), _FEW_SEEDS):
            if (grown := _grown(asked, seed, gap)) is not None:
                yield from _between(asked, gap, [grown])
                return
    yield from _refuted(asked, gap, _MOST_HALVINGS)


def _is_sliver(gap: ParameterCell) -> bool:
    """Whether nothing is looked for in a gap: it is beside an end that is told by no short number."""
    if gap.low is None or gap.high is None:
        return False
    return gap.high.low - gap.low.high <= 3 * Fraction(_BESIDE[1]) * max(Fraction(1), abs(gap.low.low))


def _seen(asked: Asked) -> list[Decided]:
    """Cells of the stretches in which the claim seems to hold, or to fail, by floating point, in order.

    The ends are short numbers; where these are not confirmed, a little less than the stretches beside is decided, in parts.
    """
    stretches = asked.seen() or []
    whole, last = asked.whole, len(stretches) - 1
    found = dict[int, list[Decided]]()
    for i, (low, high, holds) in enumerate(stretches):
        own = i == 0 and whole.open, i == last and whole.open_high
        cells = (
            _cell(whole.low if i == 0 else _number_near(low), whole.high if i == last else _number_near(high), *out)
            for out in (dict.fromkeys([own, (True, own[1]), (own[0], True), (True, True)]) if holds else ())
        )
        if done := next(filter(None, (asked.proved(cell) for cell in cells if cell is not None)), None):
            found[i] = [done]
    for i, (low, high, holds) in enumerate(stretches):
        if i in found or (not holds and all(k in found for k in (i - 1, i + 1) if 0 <= k <= last)):
            continue  # the gap that is left between cells is taken as a whole
        one, two = whole.low if i == 0 else _inside(low, 1), whole.high if i == last else _inside(high, -1)
        cell = _cell(one, two, i == 0 and whole.open, i == last and whole.open_high)
        if cell is not None and (one is None or two is None or one.below(two)):
            parts = _proved_parts(asked, cell, _MOST_HALVINGS - 1) if holds else _refuted(asked, cell, _MOST_HALVINGS)
            found[i] = [done for done in parts if done.verdict != "open"]
    return [done for i in sorted(found) for done in found[i]]


def _proved_parts(asked: Asked, cell: ParameterCell, halvings: int) -> Iterator[Decided]:
    """A cell on which the claim is proved in one, or those of its parts on which it is."""
    if (found := asked.proved(cell)) is not None:
        yield found
    elif halvings and not asked.spent and (middle := _middle(cell)) is not None:
        at = RealRoot.of(middle)
        yield from _proved_parts(asked, ParameterCell(cell.low, at, cell.open, False), halvings - 1)
        yield from _proved_parts(asked, ParameterCell(at, cell.high, True, cell.open_high), halvings - 1)


def _inside(x: float, way: int) -> RealRoot:
    """A short number a little beyond x."""
    near, far = (Fraction(x) + way * Fraction(max(1.0, abs(x)) * share) for share in _BESIDE)
    return RealRoot.of(simplest(min(near, far), max(near, far)))


def _number_near(x: float) -> RealRoot:
    """The simplest fraction that floating point cannot tell from x, or a root of a short polynomial where that is no short one."""
    wide = Fraction(max(1.0, abs(x)) * _ROUNDING)
    low, high = Fraction(x) - wide, Fraction(x) + wide
    plain = simplest(low, high)
    root = None if plain.denominator < _SHORT else square_root_near(low, high)
    return root or RealRoot.of(plain)


def _cell(low: RealRoot | None, high: RealRoot | None, left_out: bool, left_out_high: bool) -> ParameterCell | None:
    """The cell between two ends; None where nothing is between."""
    if low is not None and low == high:
        return None if left_out or left_out_high else ParameterCell(low, high)
    return ParameterCell(low, high, left_out and low is not None, left_out_high and high is not None)


def _seeds(domain: Bounds) -> Iterator[Fraction]:
    """Values inside a domain from which it is grown, plain ones first."""
    low, high = domain[:2]
    if low is not None and high is not None:
        if low == high:
            yield low
            return
        middle = simplest(low, high)
        yield from dict.fromkeys([middle, *(low + (high - low) * Fraction(k, 16) for k in (8, 4, 12, 2, 6, 10, 14, 1, 15))])
    else:
        far = [Fraction(x) for x in (1, 4, 16, Fraction(1, 4), Fraction(1, 16))]
        ways = [low + x for x in far] if low is not None else [high - x for x in far] if high is not None else [Fraction(0)]
        yield from ways if low is not None or high is not None else [*ways, *(s * x for x in far for s in (1, -1))]
    yield from (end for end, out in ((low, domain.open), (high, domain.open_high)) if end is not None and not out)


def _grown(asked: Asked, seed: Fraction, gap: ParameterCell) -> Decided | None:
    """The largest cell around a value in a gap on which the claim is seen to be proved; None where it is not proved at that value."""
    here = RealRoot.of(seed)
    if (found := asked.proved(ParameterCell(here, here))) is None:
        return None
    high, high_open = _farthest(asked, here, gap, upward=True)
    low, low_open = _farthest(asked, here, gap, upward=False)
    for cell in (_cell(low, high, low_open, high_open), _cell(low, here, low_open, False), _cell(here, high, False, high_open)):
        if cell is not None and (done := asked.proved(cell)) is not None:
            return done
    return found


def _farthest(asked: Asked, here: RealRoot, gap: ParameterCell, *, upward: bool) -> tuple[RealRoot | None, bool]:
    """How far a proof reaches from a value in one way, and whether that end is left out."""
    end, left_out = (gap.high, gap.open_high) if upward else (gap.low, gap.open)
    limit = None if end is None else end.low

    def reaches(end: RealRoot | None, out: bool = False) -> bool:
        cell = _cell(here, end, False, out) if upward else _cell(end, here, out, False)
        return cell is not None and asked.proved(cell) is not None

    if end == here:
        return end, False
    beside = _cell(here, end, True, left_out) if upward else _cell(end, here, left_out, True)
    if beside is not None and asked.refuted(beside) is not None:
        return here, False
    if reaches(end, left_out):
        return end, left_out
    way, near = 1 if upward else -1, here.low
    if limit is None:
        step = Fraction(1)
        while step < _FARTHEST and reaches(RealRoot.of(here.low + way * step)):
            near, step = here.low + way * step, 2 * step
        limit = here.low + way * step
        if step >= _FARTHEST:
            return RealRoot.of(near), False
    elif not left_out and reaches(end, True):
        return end, True
    beyond = limit
    small = _NARROW * max(Fraction(1), abs(here.low))
    if not reaches(RealRoot.of(near + way * small)):
        return RealRoot.of(near), False
    for i in range(_MOST_TRIES):
        if asked.spent or abs(beyond - near) <= small:
            break
        rim = abs(beyond - near) / 4 * (i % 2)  # every other time well inside, so that few are asked
        x = simplest(min(near, beyond) + rim, max(near, beyond) - rim)
        if reaches(RealRoot.of(x)):
            near = x
            if not reaches(RealRoot.of(x + way * small)):
                return RealRoot.of(x), False
        elif reaches(RealRoot.of(x - way * small)):
            if reaches(RealRoot.of(x), True):
                return RealRoot.of(x), True
            near, beyond = x - way * small, x
        else:
            beyond = x
    root = square_root_near(min(near, beyond), max(near, beyond))
    for out in (False, True):
        if root is not None and reaches(root, out):
            return root, out
    return RealRoot.of(near), False


def _refuted(asked: Asked, gap: ParameterCell, halvings: int) -> Iterator[Decided]:
    """What lies between two cells, refuted as a whole or in parts, the widest first; what is left is open."""
    parts, done = [(gap, halvings)], list[Decided]()
    while parts:
        part, left = parts.pop(max(range(len(parts)), key=lambda i: _width(parts[i][0])))
        middle = _middle(part)
        inside = part.low.low if part.single and part.low is not None and part.low.exact else middle
        if (found := asked.refuted(part) or (None if inside is None else asked.chord(part, inside))) is not None:
            low, high, out, out_high = found.cell
            done.append(found)
        elif left <= 0 or middle is None or asked.spent or (left < _MOST_HALVINGS - 2 and part not in asked.hopeful):
            done.append(Decided(part, "open"))
            continue
        else:
            low, high, out, out_high = (at := RealRoot.of(middle)), at, True, False
        before = None if low is None else _cell(part.low, low, part.open, not out)
        after = None if high is None else _cell(high, part.high, not out_high, part.open_high)
        parts += [(rest, left - 1) for rest in (before, after) if rest is not None]
    done.sort(key=lambda one: (one.cell.low is not None, one.cell.low and one.cell.low.low, one.cell.open))
    for verdict, same in groupby(done, key=lambda one: one.verdict):
        cells = list(same)
        whole = cells[0].cell._replace(high=cells[-1].cell.high, open_high=cells[-1].cell.open_high)
        yield from [Decided(whole, "open")] if verdict == "open" else cells


def _width(cell: ParameterCell) -> Fraction:
    return (cell.high.low - cell.low.high) if cell.low is not None and cell.high is not None else Fraction(_FARTHEST)


def _middle(cell: ParameterCell) -> Fraction | None:
    low, high = cell.low, cell.high
    if cell.single:
        return None
    if low is None or high is None:
        return (low.high + 1) if low is not None else (high.low - 1) if high is not None else Fraction(0)
    width = high.low - low.high
    return simplest(low.high + width / 4, high.low - width / 4)
