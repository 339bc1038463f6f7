"""The parameters for which a claim holds, as a frozen value: cells, their ends, and the condition that tells them."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from itertools import combinations, islice, product
from typing import Any, ClassVar, NamedTuple

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
from duhem.proof.kernel.signs import RealRoot
from duhem.proof.kernel.term import NotWritten, Term, number, parse
from duhem.regions.asked import constraints_on
from duhem.regions.places import Decided, Node, ParameterCell, between, is_end, middle, share_of, written_root
from duhem.regions.seen import Array, met
from duhem.show.place import AnyPath, write
from duhem.show.printing import Shown, draw, latex

__all__ = ["FoundRegion", "ParameterRegion", "PavedRegion", "RegionCell", "RegionEnd"]

_MOST_JOINED = 100  # cells, of which any two may be one
_MOST_SAMPLES = 400
_SHARES = tuple(Fraction(k, 16) for k in (8, 4, 12, 2, 14, 6, 10, 1, 15))
_MOST_POINTS = 10_000
_MOST_PARTS = 6  # of a condition for people


class RegionCell(NamedTuple):
    """Where the verdict is one: ``proved``, ``refuted``, or ``open`` where nothing was confirmed.

    ``sample`` is a value in it, exactly; ``witness`` says which family of witnesses refutes the claim for each value in it.
    """

    condition: str
    verdict: str
    trust: str | None
    sample: Mapping[str, str]
    witness: Mapping[str, Any] | None


class RegionEnd(NamedTuple):
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

    ``known`` has the cells in order, each with what a certificate says of it, ``everything`` is what they cover as one cell, and ``tree``
    has the same as comparisons, as a certificate has it.
    ``condition`` is a text of comparisons, ``==`` among them, joined by ``and`` and ``or``, ``true`` or ``false``; it tells where the claim
    is proved, and is ``exact`` where it is refuted everywhere else.  ``open_share`` is the share of the domain that is neither, of an
    infinite one after x/(1 + |x|).  ``scales`` are parameters that a change of units made 1 here.  ``joined`` are constraints that may
    leave no values to the others where the claim is proved: there is no law there.  ``steps`` of the kernel were spent.
    """

    printed_by: ClassVar[str] = "duhem.regions.printing"

    criterion: Criterion
    claim: str
    parameters: tuple[str, ...]
    known: tuple[Decided, ...]
    everything: Any
    tree: Node
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

    def box(self, cell: Any) -> Mapping[str, Bounds]:
        """The least range of each parameter in which a cell is seen to lie."""
        return dict(cell.box)

    def sides(self, cell: Any) -> tuple[str, ...]:
        """The polynomials and conditions that bound a cell, beside the ends of its box."""
        return (*cell.polynomials, *self.conditions)

    @cached_property
    def conditions(self) -> tuple[str, ...]:
        """The constraints of the law on these parameters alone, which bound the domain too, but for those that bound the whole box."""
        return tuple(text for text in constraints_on(self.criterion, self.parameters)[0] if not is_end(text, self.parameters))

    def comparisons(self, cell: Any, with_domain: bool = True) -> list[str]:
        """Those that hold in a cell, with the ends of the domain and the conditions of the law or without."""
        said = list[str]()
        for name, own in cell.box.items():
            known = () if with_domain else (*ends(name, self.everything.box[name]),)
            said += [end for end in ends(name, own) if end not in known]
        said += self.conditions if with_domain else ()
        return [*said, *cell.polynomials]

    def relations(self, cell: Any, with_domain: bool = True) -> list[str]:
        """The same as :meth:`comparisons`, with an equation in the place of two that leave one value; none for the whole domain."""
        if not cell.polynomials and cell.box == self.everything.box:
            return []
        said, equal = self.comparisons(cell), " == " if with_domain else " = "
        both = {text: text.replace(" >= ", " <= ") for text in said if " >= " in text and text.replace(" >= ", " <= ") in said}
        kept = {*self.comparisons(cell, with_domain), *both}
        return [text.replace(" >= ", equal) if text in both else text for text in said if text in kept and text not in both.values()]

    def sample(self, cell: Any) -> Mapping[str, Fraction]:
        """An exact point in a cell; none where none of those that are tried lies in it."""
        comparisons = [parse(text) for text in self.sides(cell)]
        whole = self.everything.box.items()
        for shares in islice(product(_SHARES, repeat=len(self.parameters)), _MOST_SAMPLES):
            point = {name: between(cell.box[name], own, share) for (name, own), share in zip(whole, shares, strict=True)}
            here = {Term("name", name=name): number(x) for name, x in point.items()}
            with suppress(NotWritten):  # a root or an exponential there is no fraction
                if all(holds(c.put(here)) for c in comparisons):
                    return point
        return {}

    @cached_property
    def places(self) -> tuple[tuple[Any, str], ...]:
        """Each cell with one verdict on all of it, with the verdict: those joined that together are one."""
        found, joined = [(one.cell, one.leaf["verdict"]) for one in self.known], True
        while joined and len(found) <= _MOST_JOINED:
            alike = [(i, k) for i, k in combinations(range(len(found)), 2) if found[i][1] == found[k][1]]
            pairs = ((i, k, found[i][0].joined(found[k][0])) for i, k in alike)
            i, k, one = next((pair for pair in pairs if pair[2] is not None), (0, 0, None))
            if joined := one is not None:
                found[i], found[k:] = (one, found[i][1]), found[k + 1 :]
        return tuple(found)

    def stretches(self, verdict: str) -> list[Any]:
        """The cells of one verdict, those that meet joined."""
        return [cell for cell, own in self.places if own == verdict]

    @property
    def exact(self) -> bool:
        """Whether every cell is decided."""
        return all(one.leaf["verdict"] != "open" for one in self.known)

    def size(self, cell: Any) -> Fraction:
        """How much of the whole a cell is: of one that more bounds than its box, by the share of many points."""
        box, whole, bounds = self.box(cell), self.box(self.everything), self.sides(cell)
        size = share_of(box, whole)
        if bounds:
            n = int(_MOST_POINTS ** (1 / len(whole)))
            each = [[float(between(box[x], own, Fraction(2 * k + 1, 2 * n))) for k in range(n)] for x, own in whole.items()]
            points = dict(zip(whole, map(np.ravel, np.meshgrid(*each)), strict=True))
            size *= Fraction(int(np.sum(met(bounds, points))), n ** len(each))
        return size

    @cached_property
    def _sizes(self) -> dict[str, Fraction]:
        sizes = dict.fromkeys(("proved", "refuted", "open"), Fraction(0))
        for one in self.known:
            sizes[one.leaf["verdict"]] += self.size(one.cell)
        return sizes

    def share(self, verdict: str) -> float:
        """How much of the domain has a verdict, from 0 to 1; 0 too where single values have it."""
        return float(self._sizes[verdict] / (sum(self._sizes.values()) or 1))

    def percentage(self, verdict: str) -> str:
        """The same for people."""
        return f"{'about ' if any(self.sides(cell) for cell, _ in self.known) else ''}{self.share(verdict):.2%}"

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
        condition, trust = " and ".join(self.relations(cell)) or "true", "checked" if "rule" in leaf else None
        return RegionCell(condition, leaf["verdict"], trust, sample, witness)

    @property
    def over(self) -> str:
        """The domain asked for, as comparisons."""
        return " and ".join(self.comparisons(self.everything)) or "true"

    @property
    def ends(self) -> tuple[RegionEnd, ...]:
        """Where what is proved and what is refuted meet, of one parameter; none of several."""
        proved, refuted = (self.stretches(verdict) if len(self.parameters) == 1 else [] for verdict in ("proved", "refuted"))
        sides = ((cell[i], cell[i + 2]) for cell in proved for i in (0, 1) if cell[i] and cell[i] in [one[1 - i] for one in refuted])
        return tuple(dict.fromkeys(_end(self.parameters[0], end, not left_out) for end, left_out in sides))

    @property
    def proved(self) -> str:
        """Where the claim is proved, for people: how much of the domain that is, where the condition of several parameters is long."""
        if len(self.parameters) > 1 and len(self.stretches("proved")) > _MOST_PARTS:
            return f"{self.percentage('proved')} and refuted for {self.percentage('refuted')} of the domain"
        return "no value" if self.short == "false" else self.short

    def _told(self, *, with_domain: bool) -> str:
        parts = [" and ".join(self.relations(cell, with_domain)) for cell in self.stretches("proved")]
        if not parts or "" in parts or all(one.leaf["verdict"] == "proved" for one in self.known):
            return "true" if parts else "false"
        return " or ".join(f"({part})" if len(parts) > 1 and " and " in part else part for part in parts)

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

    def certificate(self, file: AnyPath | None = None) -> dict[str, Any]:
        """What was confirmed for :func:`duhem.recheck`, as an object for JSON; written into ``file`` too, if one is given."""
        if (inhabited := admitted_values(self.criterion)) is None:
            what = "no exact point of the parameters' domain was found"
            raise InputError(what, where=self.criterion.name, remedy="fix a parameter with --set")
        asked = {"law": law_as_text(self.criterion), "inhabited": inhabited, "claim": self.claim, "parameters": self.parameters}
        document = {"schema": SCHEMA, **asked, "tree": self.tree, "steps": self.steps}
        document = json.loads(json.dumps(document, default=_as_plain))
        document["sha256"] = digest(document)
        if file is not None:
            write(file, json.dumps(document, indent=1, ensure_ascii=False) + "\n")
        return dict(document)


@dataclass(frozen=True, repr=False)
class ParameterRegion(FoundRegion):
    """The region of one parameter, of which a cell lies between two ends."""

    def box(self, cell: ParameterCell) -> dict[str, Bounds]:
        """The least range of the parameter in which a cell is seen to lie."""
        return {self.parameters[0]: cell.bounds}

    def sides(self, cell: ParameterCell) -> tuple[str, ...]:
        """None: constraints on the parameter alone are ends of cells."""
        return ()

    def comparisons(self, cell: ParameterCell, with_domain: bool = True) -> list[str]:
        """Those that hold in a cell, with the ends of the domain or without; of two the lower end first, as it stands on a line."""
        said = [*cell.where(self.parameters[0], ParameterCell(None, None) if with_domain else self.everything)]
        if len(said) < 2 or not with_domain:
            return said
        name, op, low = said[0].split(" ", 2)
        return [f"{low} {op.replace('>', '<')} {name}", said[1]]

    def relations(self, cell: ParameterCell, with_domain: bool = True) -> list[str]:
        """The same as :meth:`comparisons`, with an equation in the place of two that leave one value."""
        if cell.single and cell.low is not None:
            return [f"{self.parameters[0]} {'==' if with_domain else '='} {written_root(cell.low)}"]
        return self.comparisons(cell, with_domain)

    def sample(self, cell: ParameterCell) -> dict[str, Fraction]:
        """A short fraction in a cell; none where the cell is one number that is none."""
        exact = cell.low is None or not cell.single or cell.low.exact
        return {self.parameters[0]: middle(cell.bounds)} if exact else {}


def _as_plain(x: Any) -> Any:
    return dict(x) if isinstance(x, Mapping) else list(x) if isinstance(x, Iterable) else str(x)


def _end(name: str, end: RealRoot, closed: bool) -> RegionEnd:
    poly = sp.Poly(end.poly[::-1], sp.Symbol(name)).as_expr() * (1 if end.poly[-1] > 0 else -1)
    return RegionEnd(name, written_root(end), str(sp.expand(poly)), (str(end.low), str(end.high)), closed)


@dataclass(frozen=True, repr=False)
class PavedRegion(FoundRegion):
    """The region of several parameters, of which a cell is the place of a leaf of the tree.

    It was ``stopped`` where the search was interrupted.  :func:`duhem.region` goes on with its certificate.
    """

    stopped: bool = False
