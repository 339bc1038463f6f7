"""The parameters for which a claim holds, as a frozen value: cells, their ends, and the condition that tells them."""

from __future__ import annotations

import json
from abc import abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from itertools import islice, product
from typing import Any, ClassVar

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from duhem.errors import InputError
from duhem.law.formula_law import Criterion
from duhem.proof.certificate import law_as_text
from duhem.proof.facts.formula_subject import admitted_values
from duhem.proof.kernel.bounds import Bounds
from duhem.proof.kernel.certificate import digest
from duhem.proof.kernel.constant_value import holds
from duhem.proof.kernel.parameter_tree import SCHEMA, ends
from duhem.proof.kernel.real_root import RealRoot
from duhem.proof.kernel.term import NotWritten, Term, number, parse
from duhem.regions.asked import constraints_on
from duhem.regions.places import Decided, Node, ParameterCell, Place, between, is_end, leaves, middle, share_of, tree_of, written_root
from duhem.regions.seen import Array, met
from duhem.show.place import AnyPath, check_place, write
from duhem.show.printing import Shown, draw, latex

__all__ = ["FoundRegion", "ParameterRegion", "PavedRegion", "RegionCell", "RegionEnd"]

_MOST_JOINED = 100  # cells, of which any two may be one


@dataclass(frozen=True)
class RegionCell:
    """Where the verdict is one: ``proved``, ``refuted``, or ``open`` where nothing was confirmed.

    ``sample`` is a value in it, exactly; ``witness`` says which family of witnesses refutes the claim for each value in it.
    """

    condition: str
    verdict: str
    trust: str | None
    sample: Mapping[str, str]
    witness: Mapping[str, Any] | None


@dataclass(frozen=True)
class RegionEnd:
    """Where the claim begins or ceases to hold: the root of ``polynomial`` in ``enclosure``.

    ``closed`` where the claim holds at the end itself.
    """

    parameter: str
    value: str
    polynomial: str
    enclosure: tuple[str, str]
    closed: bool


@dataclass(frozen=True, repr=False)
class FoundRegion(Shown):
    """For which values of the ``parameters`` the ``claim`` holds of ``criterion``, all its other parameters being what they may be.

    ``condition`` is a text of comparisons, ``==`` among them, joined by ``and`` and ``or``, ``true`` or ``false``; it tells where the claim
    is proved, and is ``exact`` where it is refuted everywhere else.  ``open_share`` is the share of the domain that is neither, of an
    infinite one after x/(1 + |x|).  ``scales`` are parameters that a change of units made 1 here.  ``joined`` are constraints that may
    leave no values to the others where the claim is proved: there is no law there.  ``steps`` of the kernel were spent.
    """

    printed_by: ClassVar[str] = "duhem.regions.printing"

    criterion: Criterion
    claim: str
    parameters: tuple[str, ...]
    scales: tuple[str, ...] = field(default=(), kw_only=True)
    joined: tuple[str, ...] = field(default=(), kw_only=True)
    steps: int = field(default=0, kw_only=True)

    def __repr__(self) -> str:
        rest = "" if self.exact else ", the rest being open"
        return f"<{type(self).__name__} of {self.criterion.name}: {self.claim} if {self.proved}{rest}>"

    def plot(self, file: Any = None, axes: Any = None) -> Any:
        """Where the claim holds, fails and is open (extra ``plot``); written to ``file``, if one is given."""
        return draw(self, file, axes)

    def latex(self) -> str:
        """The condition as a formula."""
        return latex(self)

    @property
    @abstractmethod
    def known(self) -> Sequence[tuple[Any, Node]]:
        """Each cell with what a certificate says of it, in order."""

    @property
    @abstractmethod
    def everything(self) -> Any:
        """The whole domain as a cell."""

    @abstractmethod
    def box(self, cell: Any) -> Mapping[str, Bounds]:
        """The least range of each parameter in which a cell is seen to lie."""

    @abstractmethod
    def relations(self, cell: Any, with_domain: bool = True) -> list[str]:
        """The same as :meth:`comparisons`, with an equation in the place of two that leave one value; none for the whole domain."""

    def between(self, cell: Any, with_domain: bool) -> str:
        """A cell in words; "" for the whole domain."""
        return " and ".join(self.relations(cell, with_domain))

    @abstractmethod
    def sample(self, cell: Any) -> Mapping[str, Fraction]:
        """An exact point in a cell; none where none was found."""

    @cached_property
    def places(self) -> tuple[tuple[Any, str], ...]:
        """Each cell with one verdict on all of it, with the verdict: those joined that together are one."""
        found = [(cell, leaf["verdict"]) for cell, leaf in self.known]
        i = 0
        while i < len(found) and len(found) <= _MOST_JOINED:
            (one, verdict), joined = found[i], None
            for k in range(i + 1, len(found)):
                if found[k][1] == verdict and (joined := one.joined(found[k][0])) is not None:
                    found[i : i + 1], found[k : k + 1], i = [(joined, verdict)], [], -1
                    break
            i += 1
        return tuple(found)

    def stretches(self, verdict: str) -> list[Any]:
        """The cells of one verdict, those that meet joined."""
        return [cell for cell, own in self.places if own == verdict]

    @property
    def exact(self) -> bool:
        """Whether every cell is decided."""
        return all(leaf["verdict"] != "open" for _, leaf in self.known)

    def size(self, cell: Any) -> Fraction:
        """How much of the whole a cell is."""
        return share_of(self.box(cell), self.box(self.everything))

    @cached_property
    def _sizes(self) -> dict[str, Fraction]:
        sizes = dict.fromkeys(("proved", "refuted", "open"), Fraction(0))
        for cell, leaf in self.known:
            sizes[leaf["verdict"]] += self.size(cell)
        return sizes

    def share(self, verdict: str) -> float:
        """How much of the domain has a verdict, from 0 to 1; 0 too where single values have it."""
        return float(self._sizes[verdict] / (sum(self._sizes.values()) or 1))

    def percentage(self, verdict: str) -> str:
        """The same for people."""
        return f"{self.share(verdict):.2%}"

    @property
    def open_share(self) -> float:
        """How much of the domain is open, from 0 to 1; 0 too where single values are."""
        return self.share("open")

    def at(self, points: Mapping[str, Array]) -> NDArray[np.str_]:
        """The verdict at many points, in floating point; "" where none is, outside of the domain."""
        shape = next(iter(points.values())).shape
        found = np.full(shape, "", dtype="<U7")
        flat = {name: np.ravel(x) for name, x in points.items()}
        for cell, verdict in self.places:
            found[met(self.comparisons(cell), flat).reshape(shape)] = verdict
        return found

    @property
    def cells(self) -> tuple[RegionCell, ...]:
        """The cells in order."""
        return tuple(self._shown(cell, leaf) for cell, leaf in self.known)

    def _shown(self, cell: Any, leaf: Node) -> RegionCell:
        witness = {"rule": leaf["rule"], **leaf["evidence"]} if leaf["verdict"] == "refuted" else None
        sample = {name: str(x) for name, x in self.sample(cell).items()}
        return RegionCell(self.between(cell, True) or "true", leaf["verdict"], "checked" if "rule" in leaf else None, sample, witness)

    @abstractmethod
    def comparisons(self, cell: Any, with_domain: bool = True) -> list[str]:
        """Those that hold in a cell, with the ends of the domain and the conditions of the law or without."""

    @property
    def over(self) -> str:
        """The domain asked for, as comparisons."""
        return " and ".join(self.comparisons(self.everything)) or "true"

    @property
    def ends(self) -> tuple[RegionEnd, ...]:
        """Where what is proved ends inside of the domain of one parameter."""
        return ()

    @property
    def proved(self) -> str:
        """Where the claim is proved, for people."""
        return "no value" if self.short == "false" else self.short

    def _told(self, *, with_domain: bool) -> str:
        parts = [self.between(cell, with_domain) for cell in self.stretches("proved")]
        if not parts or "" in parts or all(leaf["verdict"] == "proved" for _, leaf in self.known):
            return "true" if parts else "false"
        return " or ".join(f"({part})" if len(parts) > 1 and " and " in part else part for part in parts)

    @abstractmethod
    def written(self) -> dict[str, Any]:
        """The tree of comparisons that a certificate has."""

    @property
    def condition(self) -> str:
        """Where the claim is proved, with the ends of the domain."""
        return self._told(with_domain=True)

    @property
    def short(self) -> str:
        """The same for people, without the ends of the domain, which go without saying: ``e <= 1/2``, ``e = 0``."""
        return self._told(with_domain=False)

    @property
    def sentence(self) -> str:
        """What was found in one sentence."""
        if self.exact:
            words = {"true": "for all values of the domain", "false": "for no value of the domain"}
            said = f"{self.claim} holds {words.get(self.short, f'exactly for {self.short}')}"
        else:
            said = f"{self.claim} is proved for {self.proved}; {self.percentage('open')} of the domain are open"
        said = f"{said}, where {' = '.join(self.scales)} = 1" if self.scales else said
        return f"{said}, as far as other parameters exist with {' and '.join(self.joined)}" if self.joined else said

    def to_dict(self) -> dict[str, Any]:
        """The JSON of the interface."""
        return {
            "criterion": self.criterion.name,
            "claim": self.claim,
            "parameters": list(self.parameters),
            "domain": self.over,
            "fixed": {name: str(own.value) for name, own in self.criterion.parameters.items() if own.value is not None},
            "condition": self.condition,
            "exact": self.exact,
            "cells": [vars(cell) | {"sample": dict(cell.sample)} for cell in self.cells],
            "ends": [vars(end) | {"enclosure": list(end.enclosure)} for end in self.ends],
            "open_share": self.open_share,
            "joined": list(self.joined),
        }

    def certificate(self, file: AnyPath | None = None) -> dict[str, Any]:
        """What was confirmed for :func:`duhem.recheck`, as an object for JSON; written into ``file`` too, if one is given."""
        if file is not None:
            check_place(file)
        if (inhabited := admitted_values(self.criterion)) is None:
            what = "no exact point of the parameters' domain was found"
            raise InputError(what, where=self.criterion.name, remedy="fix a parameter with --set")
        asked = {"law": law_as_text(self.criterion), "inhabited": inhabited, "claim": self.claim, "parameters": self.parameters}
        document = {"schema": SCHEMA, **asked, "tree": self.written(), "steps": self.steps}
        document = json.loads(json.dumps(document, default=_as_plain))
        document["sha256"] = digest(document)
        if file is not None:
            write(file, json.dumps(document, indent=1, ensure_ascii=False) + "\n")
        return dict(document)


@dataclass(frozen=True, repr=False)
class ParameterRegion(FoundRegion):
    """The region of one parameter: ``decided`` has the cells with what the kernel confirmed, ``domain`` is what they cover."""

    decided: tuple[Decided, ...]
    domain: ParameterCell

    @property
    def known(self) -> list[tuple[ParameterCell, Node]]:
        """Each cell with what a certificate says of it, in order."""
        return [(done.cell, done.leaf) for done in self.decided]

    @property
    def everything(self) -> ParameterCell:
        """The whole domain."""
        return self.domain

    def box(self, cell: ParameterCell) -> dict[str, Bounds]:
        """The least range of the parameter in which a cell is seen to lie."""
        return {self.parameters[0]: cell.bounds}

    def comparisons(self, cell: ParameterCell, with_domain: bool = True) -> list[str]:
        """Those that hold in a cell, with the ends of the domain or without; of two the lower end first, as it stands on a line."""
        said = [*cell.where(self.parameters[0], ParameterCell(None, None) if with_domain else self.domain)]
        if len(said) < 2 or not with_domain:
            return said
        name, op, low = said[0].split(" ", 2)
        return [f"{low} {op.replace('>', '<')} {name}", said[1]]

    def relations(self, cell: ParameterCell, with_domain: bool = True) -> list[str]:
        """The same as :meth:`comparisons`, with an equation in the place of two that leave one value."""
        if cell.single and cell.low is not None:
            return [f"{self.parameters[0]} {'==' if with_domain else '='} {written_root(cell.low)}"]
        return self.comparisons(cell, with_domain)

    def written(self) -> dict[str, Any]:
        """The cells as leaves of a tree of comparisons, as a certificate has it."""
        return tree_of(self.parameters[0], self.decided)

    def sample(self, cell: ParameterCell) -> dict[str, Fraction]:
        """A short fraction in a cell; none where the cell is one number that is none."""
        exact = cell.low is None or not cell.single or cell.low.exact
        return {self.parameters[0]: middle(cell.bounds)} if exact else {}

    @property
    def ends(self) -> tuple[RegionEnd, ...]:
        """Where what is proved ends inside of the domain."""
        (name,), low, high = self.parameters, self.domain.low, self.domain.high
        each = ((cell.low, low, cell.open, cell.high, high, cell.open_high) for cell in self.stretches("proved"))
        sides = (side for one in each for side in (one[:3], one[3:]))
        return tuple(dict.fromkeys(_end(name, end, not left_out) for end, own, left_out in sides if end is not None and end != own))


def _as_plain(x: Any) -> Any:
    return dict(x) if isinstance(x, Mapping) else list(x) if isinstance(x, Iterable) else str(x)


def _end(name: str, end: RealRoot, closed: bool) -> RegionEnd:
    poly = sp.Poly(end.poly[::-1], sp.Symbol(name)).as_expr() * (1 if end.poly[-1] > 0 else -1)
    return RegionEnd(name, written_root(end), str(sp.expand(poly)), (str(end.low), str(end.high)), closed)


_MOST_SAMPLES = 400
_SHARES = tuple(Fraction(k, 16) for k in (8, 4, 12, 2, 14, 6, 10, 1, 15))
_MOST_POINTS = 10_000
_MOST_PARTS = 6  # of a condition for people


@dataclass(frozen=True, repr=False)
class PavedRegion(FoundRegion):
    """The region of several parameters: a ``tree`` of comparisons with what the kernel confirmed of its leaves, over the ``whole`` box.

    It was ``stopped`` where the search was interrupted.  :func:`duhem.region` goes on with its certificate.
    """

    tree: Node
    whole: Mapping[str, Bounds]
    stopped: bool = False

    @cached_property
    def known(self) -> list[tuple[Place, Node]]:
        """The place of each leaf with what a certificate says of it, in order; those outside of the domain are none."""
        found = ((Place.of(where, self.whole), holder[key]) for _, where, holder, key in leaves({"tree": self.tree}))
        return [(place, leaf) for place, leaf in found if leaf["verdict"] != "outside"]

    @cached_property
    def conditions(self) -> tuple[str, ...]:
        """The constraints of the law on these parameters alone, which bound the domain too, but for those that bound the whole box."""
        return tuple(text for text in constraints_on(self.criterion, self.parameters)[0] if not is_end(text, self.parameters))

    @property
    def everything(self) -> Place:
        """The whole domain as a place."""
        return Place((), self.whole)

    def box(self, cell: Place) -> Mapping[str, Bounds]:
        """The range of each parameter in a place."""
        return cell.box

    def size(self, cell: Place) -> Fraction:
        """How much of the whole a place is: of one on sides of polynomials, or under conditions, the share of many points."""
        size, bounds = super().size(cell), (*cell.polynomials, *self.conditions)
        if bounds:
            n = int(_MOST_POINTS ** (1 / len(self.whole)))
            shares = [Fraction(2 * k + 1, 2 * n) for k in range(n)]
            each = [[float(between(cell.box[name], own, share)) for share in shares] for name, own in self.whole.items()]
            points = dict(zip(self.whole, map(np.ravel, np.meshgrid(*each)), strict=True))
            size *= Fraction(int(np.sum(met(bounds, points))), n ** len(each))
        return size

    def percentage(self, verdict: str) -> str:
        """The same for people."""
        sampled = self.conditions or any(place.polynomials for place, _ in self.known)
        return f"{'about ' if sampled else ''}{super().percentage(verdict)}"

    @property
    def proved(self) -> str:
        """Where the claim is proved, for people: how much of the domain that is, where the condition is long."""
        shares = f"{self.percentage('proved')} and refuted for {self.percentage('refuted')} of the domain"
        return super().proved if len(self.stretches("proved")) <= _MOST_PARTS else shares

    def relations(self, cell: Place, with_domain: bool = True) -> list[str]:
        """The same as :meth:`comparisons`, with an equation in the place of two that leave one value; none for the whole domain."""
        if not cell.polynomials and cell.box == self.whole:
            return []
        said, equal = self.comparisons(cell), " == " if with_domain else " = "
        both = {text: text.replace(" >= ", " <= ") for text in said if " >= " in text and text.replace(" >= ", " <= ") in said}
        kept = {*self.comparisons(cell, with_domain), *both}
        return [text.replace(" >= ", equal) if text in both else text for text in said if text in kept and text not in both.values()]

    def comparisons(self, cell: Place, with_domain: bool = True) -> list[str]:
        """Those that hold in a place, with the ends of the domain and the conditions of the law or without."""
        said = list[str]()
        for name, own in cell.box.items():
            known = () if with_domain else (*ends(name, self.whole[name]),)
            said += [end for end in ends(name, own) if end not in known]
        said += self.conditions if with_domain else ()
        return [*said, *cell.polynomials]

    def sample(self, cell: Place) -> dict[str, Fraction]:
        """An exact point in a place; none where none of those that are tried lies in it."""
        comparisons = [parse(text) for text in (*cell.polynomials, *self.conditions)]
        for shares in islice(product(_SHARES, repeat=len(self.parameters)), _MOST_SAMPLES):
            point = {name: between(cell.box[name], own, share) for (name, own), share in zip(self.whole.items(), shares, strict=True)}
            here = {Term("name", name=name): number(x) for name, x in point.items()}
            with suppress(NotWritten):  # a root or an exponential there is no fraction
                if all(holds(c.put(here)) for c in comparisons):
                    return point
        return {}

    def written(self) -> dict[str, Any]:
        """The tree of comparisons that a certificate has."""
        return self.tree
