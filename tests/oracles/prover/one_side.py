"""Parts of a maximum of which the other parts leave one side: a hyperbola of which a ball meets one branch, a gap beside a ball.

Let f be concave and depend on the forces through one load w alone, and let w <= e on K, e constant, by another part of the maximum.
{f > 0} is an interval of w; where it holds e, what is left of {f <= 0} is all w up to its lower end: a half-space, or nothing.

A load u <= 0 bounds its multiples.  So does a ball |(a_1, ..., a_n)| <= r, for w = m + y . a gives |w - m| <= r |y| (Cauchy, Schwarz).
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence

import sympy as sp

from duhem.expression import Norm
from tests.oracles.prover.loads import affine, alone

__all__ = ["left_on_one_side"]


def left_on_one_side(part: sp.Expr, others: Sequence[sp.Expr], forces: Collection[sp.Symbol], positive: Callable[[sp.Expr], bool]) -> bool:
    """Whether what the others leave of {part <= 0}, the part being concave, is a half-space or nothing, where they are <= 0."""
    loads = [node for node in sp.preorder_traversal(part) if isinstance(node, sp.Expr) and affine(node, forces)]
    for load in dict.fromkeys(loads):
        if alone(part, load, sp.S.Zero, forces) is None:
            continue
        for end in (end for other in others for end in _ends(load, other, forces)):
            there = alone(part, load, end, forces)
            if there is not None and positive(sp.simplify(there)):
                return True
    return False


def _ends(load: sp.Expr, other: sp.Expr, forces: Collection[sp.Symbol]) -> Iterator[sp.Expr]:
    """Constants beyond which the load does not go on K, because ``other`` is <= 0 on it."""
    if affine(other, forces):
        end = alone(load, other, sp.S.Zero, forces)
        if end is not None:
            yield end
        return
    if (ball := _ball(other, forces)) is None:
        return
    rows, radius = ball
    moving = sorted(forces, key=str)
    for row in rows:
        x = next(x for x in moving if row.has(x))
        share = sp.cancel(sp.diff(load, x) / sp.diff(row, x))
        rest = sp.expand(load - share * row)
        if not rest.free_symbols & set(moving):
            yield from (rest + s * radius * sp.Abs(share) for s in (-1, 1))
            return
    columns, aim = (sp.Matrix([[sp.diff(w, x) for w in some] for x in moving]) for some in (rows, [load]))
    if columns.free_symbols or aim.free_symbols or columns.row_join(aim).rank() > columns.rank():
        return
    shares = columns.pinv() * aim
    rest = sp.expand(load - sum(c * row for c, row in zip(shares, rows, strict=True)))
    yield from (rest + s * radius * sp.sqrt(sum(c**2 for c in shares)) for s in (-1, 1))


def _ball(part: sp.Expr, forces: Collection[sp.Symbol]) -> tuple[Sequence[sp.Expr], sp.Expr] | None:
    """(a, r) where |a| <= r: of a norm, or a root of a sum of squares, times a constant > 0, and a constant; or of a sum of squares."""
    still, moving = part.as_independent(*forces, as_Add=True)
    scale, size = moving.as_independent(*forces, as_Add=False)
    if not isinstance(moving, sp.Add) and scale.is_positive:
        if isinstance(size, Norm | sp.Abs):
            return size.args, -still / scale
        if size.is_Pow and size.exp == sp.S.Half:
            level, squares = size.base.as_independent(*forces, as_Add=True)
            return _of_squares(squares, level - (still / scale) ** 2)
    return _of_squares(moving, still)


def _of_squares(squares: sp.Expr, still: sp.Expr) -> tuple[Sequence[sp.Expr], sp.Expr] | None:
    """c_1 a_1^2 + ... + still <= 0, every c > 0."""
    rows = list[sp.Expr]()
    for term in sp.Add.make_args(squares):
        scale, square = term.as_coeff_Mul()
        if not (square.is_Pow and square.exp == 2 and scale.is_positive):
            return None
        rows.append(sp.sqrt(scale) * square.base)
    return rows, sp.sqrt(-still)
