"""What a formula as written asks of its parts before it means anything: divisors, roots, logarithms, poles, angles.

They are read off the tree of the text, where nothing has cancelled, and before any branch is opened: abs(a)/a divides by a
although on either side of a = 0 it is a constant.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import sympy as sp

from duhem.expression import Where, holds_at
from duhem.expression.angles import algebraic_angles
from duhem.proof.decide import Sense
from duhem.proof.decide.needs import NEEDY, Need, needs_of

__all__ = ["Obligation", "obligations", "with_algebraic_angles"]


class Obligation(NamedTuple):
    """``expr`` is not 0 (``sense`` ZERO), >= 0 or > 0 wherever ``given`` holds, or else those ``instead`` of it are met.

    ``does`` says what the formula does to it.  An expression that cannot be computed is nan: nothing is shown of it.
    """

    expr: sp.Expr
    sense: Sense
    does: str
    given: tuple[sp.Basic, ...] = ()
    instead: tuple[Obligation, ...] = ()

    def symbols(self) -> set[sp.Symbol]:
        """What it speaks of."""
        return self.expr.free_symbols.union(*(r.free_symbols for r in self.given), *(o.symbols() for o in self.instead))

    def put(self, values: dict[sp.Symbol, sp.Expr]) -> Obligation:
        """The same with symbols replaced."""
        given = tuple(r.xreplace(values) for r in self.given)
        return self._replace(expr=self.expr.xreplace(values), given=given, instead=tuple(o.put(values) for o in self.instead))

    def broken(self, values: dict[sp.Symbol, sp.Expr]) -> bool:
        """Whether it certainly fails at exact values of all symbols."""
        if not all(holds_at(r, values) for r in self.given):
            return False
        value = self.expr.subs(values)
        fails = {Sense.ZERO: value.is_zero, Sense.NONNEGATIVE: value.is_negative, Sense.POSITIVE: value.is_nonpositive}[self.sense]
        return fails is True and (not self.instead or any(other.broken(values) for other in self.instead))


def obligations(tree: sp.Basic, given: tuple[sp.Basic, ...] = ()) -> Iterator[Obligation]:
    """Those of every part of a formula's tree; what a ``where`` does not choose needs no value."""
    if isinstance(tree, Where):
        condition, then, otherwise = tree.args
        yield from obligations(condition, given)
        holds = _evaluated(condition)
        for choice, part in ((holds, then), (sp.Not(holds), otherwise)):
            if choice != sp.false:
                yield from obligations(part, given if choice == sp.true else (*given, choice))
        return
    for part in tree.args:
        yield from obligations(part, given)
    if isinstance(tree, NEEDY):
        yield from (_obligation(need, given) for need in needs_of(tree.func, tuple(map(_evaluated, tree.args))))


def _obligation(need: Need, given: tuple[sp.Basic, ...]) -> Obligation:
    return Obligation(need.expr, need.sense, need.does, given, tuple(_obligation(other, ()) for other in need.instead))


def with_algebraic_angles(tree: sp.Basic) -> sp.Basic:
    """The tree with waves of a polar angle as algebra, which continues them to where the quotient under atan has a pole."""
    if isinstance(tree, sp.cos | sp.sin) and [o.does for o in obligations(tree)] == ["divides by"]:
        wave = _evaluated(tree)
        if (algebra := algebraic_angles(wave)) != wave:
            return algebra
    return tree.func(*map(with_algebraic_angles, tree.args), evaluate=False) if tree.has(sp.atan) else tree


def _evaluated(tree: sp.Basic) -> sp.Basic:
    """The tree as SymPy computes it: the same wherever all obligations of its parts are met."""
    if not tree.args:
        return tree
    try:
        return tree.func(*map(_evaluated, tree.args))
    except (ValueError, TypeError):  # nan compared with something
        return sp.nan
