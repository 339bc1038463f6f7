"""The parameters for which a claim holds, as a frozen value: cells, their ends, and the condition that tells them."""

from __future__ import annotations

import json
from abc import abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any, ClassVar

import sympy as sp

from duhem.errors import InputError
from duhem.law.formula_law import Criterion
from duhem.proof.certificate import admitted_values, law_as_text
from duhem.proof.kernel.certificate import digest
from duhem.proof.kernel.parameter_tree import SCHEMA
from duhem.proof.kernel.real_root import RealRoot
from duhem.regions.line import Decided, ParameterCell, tree_of
from duhem.regions.numbers import simplest, written_root
from duhem.regions.places import Known
from duhem.show.place import AnyPath, check_place, write
from duhem.show.printing import Shown, draw, latex

__all__ = ["FoundRegion", "ParameterRegion", "RegionCell", "RegionEnd"]


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
    def known(self) -> Sequence[tuple[Any, Decided | Known]]:
        """Each cell with what is known of it, in order."""

    @abstractmethod
    def stretches(self, verdict: str) -> Sequence[Any]:
        """The cells of one verdict, those that meet joined."""

    @abstractmethod
    def between(self, cell: Any, with_domain: bool) -> str:
        """A cell in words; "" for the whole domain."""

    @abstractmethod
    def sample(self, cell: Any) -> Mapping[str, Fraction]:
        """An exact point in a cell; none where none was found."""

    @property
    def exact(self) -> bool:
        """Whether every cell is decided."""
        return all(done.verdict != "open" for _, done in self.known)

    @abstractmethod
    def share(self, verdict: str) -> float:
        """How much of the domain has a verdict, from 0 to 1; 0 too where single values have it."""

    def percentage(self, verdict: str) -> str:
        """The same for people."""
        return f"{self.share(verdict):.2%}"

    @property
    def open_share(self) -> float:
        """How much of the domain is open, from 0 to 1; 0 too where single values are."""
        return self.share("open")

    @property
    def cells(self) -> tuple[RegionCell, ...]:
        """The cells in order."""
        return tuple(self._shown(cell, done.verdict, done.row) for cell, done in self.known)

    def _shown(self, cell: Any, verdict: str, row: Mapping[str, Any] | None) -> RegionCell:
        witness = {"rule": row["rule"], **row["evidence"]} if row is not None and verdict == "refuted" else None
        sample = {name: str(x) for name, x in self.sample(cell).items()}
        return RegionCell(self.between(cell, True) or "true", verdict, "checked" if row else None, sample, witness)

    @property
    @abstractmethod
    def over(self) -> str:
        """The domain asked for, as comparisons."""

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
        if not parts or "" in parts or all(done.verdict == "proved" for _, done in self.known):
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
            raise InputError(
                "no exact point of the parameters' domain was found", where=self.criterion.name, remedy="fix a parameter with --set"
            )
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
    def known(self) -> list[tuple[ParameterCell, Decided]]:
        """Each cell with what is known of it, in order."""
        return [(done.cell, done) for done in self.decided]

    def share(self, verdict: str) -> float:
        """How much of the domain has a verdict, from 0 to 1; 0 too where single values have it."""
        endless, own = None in self.domain[:2], [done.cell for done in self.decided if done.verdict == verdict]
        return sum(_length(cell, endless) for cell in own) / whole if (whole := _length(self.domain, endless)) else float(bool(own))

    def stretches(self, verdict: str) -> list[ParameterCell]:
        """The cells of one verdict, those that meet joined."""
        found = list[ParameterCell]()
        for done in self.decided:
            if done.verdict != verdict:
                continue
            before = found[-1] if found else None
            if before is not None and before.meets(done.cell):
                found[-1] = before._replace(high=done.cell.high, open_high=done.cell.open_high)
            else:
                found.append(done.cell)
        return found

    def between(self, cell: ParameterCell, with_domain: bool) -> str:
        """A cell in words; "" for the whole domain."""
        return "" if cell == self.domain else self._comparisons(cell, with_domain)

    def _comparisons(self, cell: ParameterCell, with_domain: bool) -> str:
        (name,), own = self.parameters, self.domain
        if cell.single and cell.low is not None:
            return f"{name} {'==' if with_domain else '='} {written_root(cell.low)}"
        said = list[str]()
        if cell.low is not None and (with_domain or (cell.low, cell.open) != (own.low, own.open)):
            said.append(f"{written_root(cell.low)} {'<' if cell.open else '<='} {name}" if cell.high is not None and with_domain
                        else f"{name} {'>' if cell.open else '>='} {written_root(cell.low)}")  # fmt: skip
        if cell.high is not None and (with_domain or (cell.high, cell.open_high) != (own.high, own.open_high)):
            said.append(f"{name} {'<' if cell.open_high else '<='} {written_root(cell.high)}")
        return " and ".join(said)

    def written(self) -> dict[str, Any]:
        """The cells as leaves of a tree of comparisons, as a certificate has it."""
        return tree_of(self.parameters[0], self.decided)

    def sample(self, cell: ParameterCell) -> dict[str, Fraction]:
        """A short fraction in a cell; none where the cell is one number that is none."""
        return {self.parameters[0]: inside} if (inside := _inside(cell)) is not None else {}

    @property
    def ends(self) -> tuple[RegionEnd, ...]:
        """Where what is proved ends inside of the domain."""
        (name,) = self.parameters
        found = list[RegionEnd]()
        for cell in self.stretches("proved"):
            for end, own, left_out in ((cell.low, self.domain.low, cell.open), (cell.high, self.domain.high, cell.open_high)):
                if end is not None and end != own:
                    found.append(_end(name, end, not left_out))
        return tuple(dict.fromkeys(found))

    @property
    def over(self) -> str:
        """The domain asked for, as comparisons."""
        return self._comparisons(self.domain, True) or "true"


def _as_plain(x: Any) -> Any:
    return dict(x) if isinstance(x, Mapping) else list(x) if isinstance(x, Iterable) else str(x)


def _length(cell: ParameterCell, endless: bool) -> float:
    """How long a cell is, in a domain that is ``endless`` after x/(1 + |x|)."""
    low, high = (None if end is None else float(end.low) for end in (cell.low, cell.high))
    if low is not None and high is not None and not endless:
        return high - low
    return (1.0 if high is None else high / (1 + abs(high))) - (-1.0 if low is None else low / (1 + abs(low)))


def _inside(cell: ParameterCell) -> Any:
    """A short fraction in a cell; None where the cell is one number that is none."""
    if cell.single and cell.low is not None:
        return cell.low.low if cell.low.exact else None
    low, high = None if cell.low is None else cell.low.high, None if cell.high is None else cell.high.low
    if low is None or high is None:
        return low + 1 if low is not None else high - 1 if high is not None else 0
    return simplest(low, high)


def _end(name: str, end: RealRoot, closed: bool) -> RegionEnd:
    poly = sp.Poly(end.poly[::-1], sp.Symbol(name)).as_expr() * (1 if end.poly[-1] > 0 else -1)
    return RegionEnd(name, written_root(end), str(sp.expand(poly)), (str(end.low), str(end.high)), closed)
