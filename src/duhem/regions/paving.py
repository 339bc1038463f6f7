"""A tree of comparisons of several parameters, grown until each leaf is decided or the budget is used up.

A leaf is a box, perhaps on one side of polynomials.  Floating point says where the claim seems to hold, and so what the kernel is asked: a
proof over the leaf, or a family of witnesses.  What it confirms neither of is divided by a polynomial that may tell the two apart, else in
the middle of its longest edge.  The largest leaf comes first, and what becomes of one depends on it alone: a paving that was interrupted
and goes on later ends as one that was not.

Such polynomials are the principal minors of a quadratic g; of a dent, its values where its ray ends and its discriminant, which vanishes
where the dent touches zero; and of two parameters the sum and the difference.  Nothing of them is trusted.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from fractions import Fraction
from functools import partial
from heapq import heapify, heappop, heappush
from itertools import combinations
from typing import Any

import numpy as np
import sympy as sp

from duhem.errors import InputError
from duhem.law.formula_law import Criterion
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.bounds import ANY, Bounds
from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.definedness import AGAINST
from duhem.proof.kernel.dents import Dent, form_of
from duhem.proof.kernel.domain import NEGATIVE, POSITIVE
from duhem.proof.kernel.forms import principal_minors
from duhem.proof.kernel.parameter_tree import at_values, law_where, not_outside, own_domain, recheck_tree
from duhem.proof.kernel.polynomial import Polynomial, in_powers, replaced, written
from duhem.proof.kernel.signs import RAY
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import UNREADABLE, NotWritten, Term, parse
from duhem.regions.asked import UNBOUNDED, AsksTheKernel, constraints_on
from duhem.regions.places import OPEN, Decided, Node, Place, against, between, compared, difference, law_at, leaves, length, share_of
from duhem.regions.seen import Array, Flags, count, looked_at, margins, value_of

__all__ = ["Paving", "deciding_parameters"]

_MOST_MINORS, _MOST_DEGREE, _MOST_TERMS, _MOST_FOUND = 4, 6, 40, 24


def deciding_parameters(law: StatedLaw) -> tuple[str, ...]:
    """Return the parameters in those factors of the minors of a quadratic form, in g or under its root, whose sign is open."""
    domain, names = over(law), set[str]()
    for minor in _minors(law):
        for factor, _ in sp.factor_list(minor)[1]:
            sign = domain.facts(term := parse(str(factor))).sign
            names |= term.names() if sign & POSITIVE and sign & NEGATIVE else set()
    return tuple(name for name, own in law.parameters.items() if name in names and not own.single)


def _sums(names: Sequence[str]) -> Iterator[sp.Expr]:
    for one, two in combinations([sp.Symbol(name) for name in names], 2):
        yield one - two
        yield one + two


def _minors(law: StatedLaw) -> Iterator[sp.Expr]:
    with suppress(*UNREADABLE):
        domain = over(law)
        for _, minor in principal_minors(form_of(law), domain, _MOST_MINORS):
            with suppress(NotWritten):
                yield _numerator(minor)


def _of_dent(dent: Dent) -> Iterator[sp.Expr]:
    with suppress(*UNREADABLE):
        for end in dent.between:
            yield _numerator(replaced(dent.poly, RAY, {(): end} if end else {}))
        if len(in_powers(dent.poly, RAY)) <= _MOST_DEGREE + 1:
            yield sp.discriminant(_numerator(dent.poly), sp.Symbol(RAY.name))


def _numerator(poly: Polynomial) -> sp.Expr:
    """What a polynomial of the kernel has above its divisors, as SymPy's; NotWritten unless that has whole powers of names alone."""
    found = sp.fraction(sp.together(_expression(written(poly))))[0]
    if not found.is_polynomial(*found.free_symbols):
        raise NotWritten("it is no polynomial of names")
    return found


def _expression(term: Term) -> sp.Expr:
    if not term.args:
        return sp.Symbol(term.name) if term.op == "name" else sp.Rational(term.value.numerator, term.value.denominator)
    if term.op not in _SYMPY:
        raise NotWritten("it is no polynomial of names")
    return _SYMPY[term.op](*map(_expression, term.args))


_SYMPY = {"+": sp.Add, "*": sp.Mul, "**": sp.Pow}


_BESIDE = Fraction(1, 64)  # of each range, the box in which the rule that proves the claim is looked for
_SEEDS = 4  # of these boxes
_MANY = 1000  # places of a leaf at which it is looked, where that takes no rays
_LARGE = Fraction(1, 4)  # of the whole, a leaf of which whole verifications are asked


@dataclass
class Paving(AsksTheKernel):
    """The question over all values of several parameters, and the tree of what is known."""

    known: Node = field(default_factory=lambda: {"tree": OPEN})  # by its key "tree"
    stopped: bool = False
    whole: dict[str, Bounds] = field(init=False)
    seen: tuple[Dent, ...] = field(init=False)
    boundaries: list[str] = field(init=False, default_factory=list)
    away: list[str] = field(init=False, default_factory=list)  # what the constraints on the parameters hold >= 0

    def __post_init__(self) -> None:
        super().__post_init__()
        self.whole = {name: own_domain(self.stated, name) for name in self.names}
        for text in constraints_on(self.law, self.names)[0]:
            with suppress(*UNREADABLE):
                self.away.append(f"({difference(text)})")
        known, self.seen = self.steps, self.told(self.stated)
        self.boundaries = self._boundaries(self.stated, self.seen) if self.seen else []
        self.steps = known

    def _boundaries(self, law: StatedLaw, dents: Iterable[Dent]) -> list[str]:
        """Polynomials that may tell apart where the claim holds of a law over a leaf and where it fails, as text, the shorter first."""
        found = dict[str, int]()
        with suppress(NotWritten):
            here = at_values(law, self.values, self.names)
            for poly in (*_minors(here), *(part for dent in dents for part in _of_dent(dent)), *_sums(self.names)):
                for factor, _ in sp.factor_list(poly)[1] if not poly.is_number else ():
                    if {x.name for x in factor.free_symbols} <= {*self.names} and len(sp.Add.make_args(factor)) <= _MOST_TERMS:
                        found.setdefault(str(factor), len(sp.Add.make_args(sp.expand(factor))))
        return sorted(found, key=lambda text: (found[text], len(text)))[:_MOST_FOUND]

    @classmethod
    def resumed(cls, law: Criterion, claim: str, names: tuple[str, ...], most: int, document: Mapping[str, Any]) -> Paving:
        """The question with what a certificate knows of it, once the kernel has confirmed that; InputError where it does not."""
        remedy = "resume with the law, claim, parameters and ranges it was made for"
        asked = {"law": law_as_text(law), "claim": claim, "parameters": list(names)}
        try:
            failed = [leaf.said for leaf in recheck_tree(document) if leaf.reason]
        except NotWritten as fault:
            raise InputError(f"the certificate cannot be resumed: {fault}", where="resume", remedy=remedy) from None
        if any(document[key] != own for key, own in asked.items()):
            raise InputError("the certificate is about something else", where="resume", remedy=remedy)
        if failed:
            raise InputError(f"the certificate is not confirmed where {failed[0]}", where="resume", remedy="start without it")
        spent = document["steps"] if isinstance(document["steps"], int) else 0
        return cls(law, claim, names, most, spent, known={"tree": document["tree"]})

    def grow(self) -> None:
        """Decide or divide the largest open leaf until none is left, the budget is used up, or it is interrupted."""
        before = self.steps
        try:
            self._learn()
            queue = [*self._left(self.known, "tree")]
            heapify(queue)
            while queue and not self.spent:
                _, way, where, holder, key = heappop(queue)
                if (found := self.decided(Place.of(where, self.whole))) is None:
                    break
                holder[key], before = found, self.steps
                for more in self._left(holder, key, where, way):
                    heappush(queue, more)
        except KeyboardInterrupt:
            self.stopped = True
        self.steps = before

    def over(self, cell: Place) -> StatedLaw:
        """The law over a place."""
        return law_at(self.stated, cell.where, self.names)

    def places(self) -> tuple[Decided, ...]:
        """The place of each leaf with what is known of it, in order; those outside of the domain are none."""
        found = (Decided(Place.of(where, self.whole), holder[key]) for _, where, holder, key in leaves(self.known))
        return tuple(one for one in found if one.leaf["verdict"] != "outside")

    def _left(self, *at: Any) -> Iterator[tuple[Any, ...]]:
        """The open leaves below a node, the largest first in a heap."""
        for way, where, holder, key in leaves(*at):
            if holder[key]["verdict"] == "open":
                yield -share_of(Place.of(where, self.whole).box, self.whole), way, where, holder, key

    def _learn(self) -> None:
        """The rule by which the claim is proved in a small box in which it seems to hold; that alone is asked on boxes."""
        spent = self.steps
        places = looked_at(self.stated, self.names)
        points = np.array(list(places.values())).T
        widths = np.maximum(np.ptp(points, axis=0), 1e-300)
        good = margins(self.seen, places) if self.seen else -np.sum(((points - np.median(points, axis=0)) / widths) ** 2, axis=1)
        for point in points[np.argsort(-good, kind="stable")[:_SEEDS]].tolist():
            law = self.stated
            for name, x in zip(places, point, strict=True):
                at, whole = Fraction(x).limit_denominator(1000), self.whole[name]
                up, down = Bounds(at, whole.high), Bounds(whole.low, at)
                near = between(up, whole, _BESIDE) if at != whole.high else between(down, whole, 1 - _BESIDE)
                law = law._replace(parameters={**law.parameters, name: Bounds(min(at, near), max(at, near))})
            if self.proof(law) is not None:
                break
        self.learning, self.steps = False, spent

    def decided(self, place: Place) -> Node | None:
        """A leaf, or a comparison that divides it with what is known of the two parts; None where the budget ends before that is known."""
        law = self.over(place)
        known = self.seen or self.told(law)
        rays = not known or any(dent.between[0] < dent.between[1] for dent in known)
        places = looked_at(law, self.names, *(() if rays else (_MANY,)))
        holds = margins(known, places) >= 0 if known else None
        mixed, unseen = holds is not None and holds.any() and not holds.all(), not count(places)
        seems = None if holds is None or unseen else bool(holds.all())
        if not mixed and (found := self._confirmed(law, place, seems, unseen)) is not None:
            return found
        told = self.boundaries or self._boundaries(law, known)
        unused = [text for text in told if not {f"{text} {op} 0" for op in AGAINST} & {*place.where}]
        sides = {text: np.sign(value_of(parse(text), places)) for text in unused}
        for clearly in (True, False):
            for text in unused:
                if self.spent:
                    return None
                if (parts := self._divided_by(text, law, place, sides[text], holds, clearly)) is not None:
                    return parts
        trivial = self.claim in UNBOUNDED and (holds is None or not holds.any())
        return (self._without_zero(law, place) if trivial else None) or self._halved(place)

    def _without_zero(self, law: StatedLaw, place: Place) -> Node | None:
        """A leaf at whose edge a parameter is 0 divided into that edge and the rest, if the kernel confirms a verdict of one."""
        edges = [(name, own) for name, own in place.box.items() if own.holds(Fraction(0)) and 0 in own[:2] and not own.single]
        parts = (self._parts(f"{name} {'<=' if own.low == 0 else '>='} 0", law, place, 1) for name, own in edges)
        return next(filter(None, parts), None)

    def _halved(self, place: Place) -> Node:
        """A leaf divided where a parameter changes its sign, on which much depends, else in the middle of its longest edge."""
        longest = max(self.names, key=lambda name: length(place.box[name], self.whole[name]))
        middle = f"{longest} <= {between(place.box[longest], self.whole[longest])}"
        split = next((f"{name} <= 0" for name, own in place.box.items() if own.sign() == ANY), middle)
        return {"split": split, "holds": OPEN, "fails": OPEN}

    def _divided_by(self, text: str, law: StatedLaw, place: Place, sides: Array, holds: Flags | None, clearly: bool) -> Node | None:
        """A leaf divided by a polynomial, if the kernel confirms a verdict of both sides, or of one on which all is seen to be alike.

        ``clearly`` where the two are seen to be told apart by it: then of both.
        """
        if not clearly and not (np.any(sides > 0) and np.any(sides < 0)):
            return None
        share = share_of(place.box, self.whole)
        large = share >= _LARGE / 4
        for op, side in ((">=", sides >= 0), ("<=", sides <= 0)):
            if holds is None:
                asked, least = large and not clearly, 1 if share == 1 else 2
            elif clearly:
                asked, least = holds.any() != holds.all() and np.array_equal(side, holds), 2
            else:
                asked, least = bool(holds[side].any() and not holds[~side].any()), 1 if large else 2
            if asked and (parts := self._parts(f"{text} {op} 0", law, place, least)) is not None:
                return parts
        return None

    def _parts(self, comparison: str, law: StatedLaw, place: Place, least: int) -> Node | None:
        """The sides on which a comparison holds and fails, if at least so many are decided."""
        found = list[Node]()
        for text, holds in ((comparison, True), (against(comparison), False)):
            here = law_where(law, compared(text, self.names))
            there = Place.of((*place.where, text), self.whole)
            found.append(self._confirmed(here, there, holds) or OPEN)
            if found.count(OPEN) > 2 - least:
                return None
        return {"split": comparison, "holds": found[0], "fails": found[1]}

    def _confirmed(self, law: StatedLaw, place: Place, holds: bool | None, unseen: bool = False) -> Node | None:
        """What the kernel confirms of a leaf; asked for a proof where the claim seems to hold, for witnesses where it seems to fail.

        One in which there is no place at which to look may be ``unseen`` because it is outside.
        """
        if law.constraints and (self.stated.constraints or unseen) and self.confirmed(partial(not_outside, law)):
            return {"verdict": "outside"}
        if holds is not False and (row := self.proof(law)) is not None:
            return {"verdict": "proved", **row}
        away = [f"({difference(text)})" for text in place.polynomials] + self.away
        if holds is not True and (row := self.refutation(law, away)) is not None:
            return {"verdict": "refuted", **row}
        if holds is False and self.claim in UNBOUNDED and (row := self.proof(law)) is not None:
            return {"verdict": "proved", **row}  # K may be everything or empty there, which no dent tells
        return None
