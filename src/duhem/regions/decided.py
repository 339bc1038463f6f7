"""One cell decided: a proof over it by the kernel's rules, or a family of witnesses that floating point finds and the kernel confirms."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from fractions import Fraction
from functools import partial
from typing import Any

from duhem.errors import InputError
from duhem.law.domain import Domain
from duhem.law.formula_law import Criterion
from duhem.proof import verification
from duhem.proof.certificate import admitted_values, law_as_text
from duhem.proof.kernel.bounds import Bounds
from duhem.proof.kernel.certificate import stated
from duhem.proof.kernel.claims import objection, row_of, rules_of
from duhem.proof.kernel.domain import StatedLaw
from duhem.proof.kernel.parameter_cells import AS, ParameterCell, at_values, law_over, own_domain, refutation_fails
from duhem.proof.kernel.real_root import RealRoot
from duhem.proof.kernel.steps import TooDearError, within
from duhem.proof.kernel.term import NotWritten
from duhem.proof.verdict import Trust
from duhem.regions.suggested import Suggestion, changes, suggestions

__all__ = ["MOST_STEPS", "Asked", "Decided"]

MOST_STEPS = 60_000_000  # for a region
_MOST_STEPS = 2_500_000  # for one rule on one cell
_IN_DEPTH = 10_000_000  # from so many steps on whole verifications are asked for
_MOST_ASKED = 30  # of these, for proofs
_MOST_CHORDS = 6  # counterexamples at one value that are looked for, each as dear as a verification
_FEW_TRIED = 6  # suggestions that the kernel is asked about on one cell


def _ways(cell: ParameterCell) -> tuple[str, ...]:
    """How a law may be put over a cell."""
    inexact = any(end is not None and not end.exact for end in (cell.low, cell.high))
    return tuple(way for way in AS if (way == "range") is not inexact)


@dataclass(frozen=True)
class Decided:
    """A cell with what the kernel confirmed of it; ``row`` is how a certificate says so, None where it is open."""

    cell: ParameterCell
    verdict: str
    row: Mapping[str, Any] | None = None

    def written(self) -> dict[str, Any]:
        """As a certificate has it."""
        return {**self.cell.written(), "verdict": self.verdict, **(self.row or {})}


@dataclass
class Asked:
    """A claim of a law, asked for the values of one of its parameters.  ``steps`` counts what the kernel spent, ``most`` what it may."""

    law: Criterion
    claim: str
    name: str
    most: int = MOST_STEPS
    steps: int = 0
    by_all: bool = False
    chords: int = 0
    verifications: int = 0
    hopeful: set[ParameterCell] = field(default_factory=set)  # cells over which a family of witnesses was suggested
    stated: StatedLaw = field(init=False)
    domain: Bounds = field(init=False)
    values: dict[str, str] = field(init=False)
    _known: dict[ParameterCell, Decided | None] = field(default_factory=dict)
    _refuted: dict[ParameterCell, Decided | None] = field(default_factory=dict)
    _usual: dict[str, tuple[str, bool]] = field(default_factory=dict)  # the rule that first proved a claim on a cell, asked alone then

    def __post_init__(self) -> None:
        try:
            found = stated(law_as_text(self.law))
            if not isinstance(found, StatedLaw):
                raise NotWritten("it is a boundary curve")
            self.stated, self.domain = found, own_domain(found, self.name)
        except NotWritten as fault:
            raise InputError(f"regions are not known of such a law: {fault}", where=self.law.name, remedy="use duhem verify") from None
        self.values = dict(self._plain_values())

    def _plain_values(self) -> Iterator[tuple[str, str]]:
        """One for each other parameter that is not fixed: 1, if all are admitted there, else what the law admits."""
        free = [n for n, own in self.stated.parameters.items() if n != self.name and not own.single]
        ones = {name: "1" for name in free}
        if free and not self._admitted(ones):
            ones = {**dict(admitted_values(self.law) or ones)}
        yield from ((name, ones[name]) for name in free)

    def _admitted(self, values: Mapping[str, str]) -> bool:
        try:
            at_values(self.stated, values, {})
        except NotWritten:
            return False
        return True

    def inhabited(self, found: Decided) -> bool:
        """Whether plain values of the other parameters are seen to be admitted at every value in a cell."""
        with suppress(NotWritten):
            law, swap = law_over(self.stated, self.name, found.cell, (found.row or {})["as"])
            at_values(law, self.values, swap)
            return True
        return False

    @property
    def spent(self) -> bool:
        """Whether the budget is used up."""
        return self.steps >= self.most

    # -- proved ----------------------------------------------------------------------------------------------------

    def proved(self, cell: ParameterCell) -> Decided | None:
        """The proof over a cell; None where no rule confirms it."""
        if cell not in self._known:
            found = None if self.spent else next(filter(None, (self._proved_as(cell, way) for way in _ways(cell))), None)
            self._known[cell] = found or (self.proved_by_all(cell) if self.by_all else None)
        return self._known[cell]

    def ask_all(self) -> bool:
        """From now on everything that makes proofs is asked too; False where it is already, or the steps are too few."""
        if self.by_all or self.spent or self.most < _IN_DEPTH:
            return False
        self.by_all = True
        self._known.clear()
        return True

    def _proved_as(self, cell: ParameterCell, way: str) -> Decided | None:
        try:
            law, _ = law_over(self.stated, self.name, cell, way)
            steps = self._steps_of(self.claim, law, frozenset(), {})
        except NotWritten:
            return None
        if steps is None:
            return None
        *needs, last = steps
        return Decided(cell, "proved", {"as": way, "rule": last["rule"], "evidence": last["evidence"], "needs": needs})

    def _steps_of(
        self, claim: str, law: StatedLaw, asked: frozenset[str], known: dict[str, list[dict[str, Any]] | None]
    ) -> list[dict[str, Any]] | None:
        """The claims that a proof of this one rests on, each with its rule, and it as the last; None where no rule confirms it."""
        if claim in known or claim in asked:
            return known.get(claim)
        found: list[dict[str, Any]] | None = None
        usual = self._usual.get(claim)
        readings = (True, False) if usual is None else (usual[1],)
        every = [(rule, as_written) for as_written in readings for rule in rules_of(claim, law)]
        for rule, as_written in every if usual is None or self.name not in law.parameters else [usual]:
            row, before = row_of(claim, rule, law), list[dict[str, Any]]()
            for need in sorted(row.needed if row is not None else ()):
                more = self._steps_of(need, law, asked | {claim}, known)
                if more is None:
                    break
                before += [step for step in more if step not in before]
            else:
                settled = frozenset(step["claim"] for step in before)
                if not self._within(partial(objection, claim, rule, settled, law, {}, as_written)):
                    found = [*before, {"claim": claim, "rule": rule, "evidence": {}}]
                    if self.name in law.parameters:  # a single value may have a proof of its own
                        self._usual[claim] = rule, as_written
                    break
        known[claim] = found
        return found

    def _within(self, ask: Callable[[], str]) -> str:
        """What the kernel has against something, for no more steps than one rule may cost on one cell."""
        with within(_MOST_STEPS) as purse:
            try:
                said = ask()
            except TooDearError:
                said = "it is too dear"
        self.steps += purse.spent
        return said

    def proved_by_all(self, cell: ParameterCell) -> Decided | None:
        """The proof that everything which makes proofs finds, over a cell with fractions for ends that belong to it."""
        ends = [None if end is None else end.low for end in (cell.low, cell.high)]
        own, inexact = self.law.parameters[self.name], any(end is not None and not end.exact for end in (cell.low, cell.high))
        at_zero = own.positive and (cell.low is None or (ends[0] == 0 and cell.open))
        if self.spent or self.verifications == _MOST_ASKED or inexact or cell.open_high or (cell.open and not at_zero):
            return None
        self.verifications += 1
        domain = Domain.between(None if at_zero else ends[0], ends[1])
        law = self.law.within({self.name: Domain(high=domain.high, positive=True) if at_zero else domain})
        try:
            found = verification.verify(law, claims=[self.claim], effort="quick")
        except InputError:
            return None
        self.steps += sum(r.steps for r in (*found.results, *found.rests_on))
        rows = {r.claim: r for r in (*found.rests_on, *found.results) if r.proof is not None or r.claim == self.claim}
        if rows[self.claim].trust is not Trust.CHECKED or rows[self.claim].proof is None:
            return None
        steps = [{"claim": r.claim, "rule": r.proof.rule, "evidence": dict(r.proof.evidence)} for r in rows.values() if r.proof is not None]
        if any("over" in step["evidence"] for step in steps):
            return None
        *needs, last = [*(s for s in steps if s["claim"] != self.claim), *(s for s in steps if s["claim"] == self.claim)]
        return self._replayed(cell, needs, last)

    def _replayed(self, cell: ParameterCell, needs: list[dict[str, Any]], last: dict[str, Any]) -> Decided | None:
        """The same proof, if the kernel confirms it for the law over the cell."""
        settled, (law, _) = set[str](), law_over(self.stated, self.name, cell, "range")
        for step in (*needs, last):
            if objection(step["claim"], step["rule"], frozenset(settled), law, step["evidence"]):
                return None
            settled.add(step["claim"])
        return Decided(cell, "proved", {"as": "range", "rule": last["rule"], "evidence": last["evidence"], "needs": needs})

    def seen(self) -> list[tuple[float, float, bool]] | None:
        """Stretches of the parameter where the claim seems to hold, and to fail, in floating point; None where that tells nothing."""
        if self.claim != "convexity":
            return None
        found = None
        with within(_MOST_STEPS) as purse, suppress(NotWritten, TooDearError):
            law, swap = law_over(self.stated, self.name, self.whole, "range")
            found = changes(at_values(law, self.values, swap), self.name)
        self.steps += purse.spent
        return found

    @property
    def whole(self) -> ParameterCell:
        """The whole domain as a cell."""
        low, high = (None if end is None else RealRoot.of(end) for end in self.domain[:2])
        return ParameterCell(low, high, self.domain.open, self.domain.open_high)

    # -- refuted ---------------------------------------------------------------------------------------------------

    def refuted(self, cell: ParameterCell) -> Decided | None:
        """A family of witnesses over a cell; None where none is confirmed."""
        if cell not in self._refuted:
            self._refuted[cell] = self._against(cell)
        return self._refuted[cell]

    def _against(self, cell: ParameterCell) -> Decided | None:
        for way in _ways(cell):
            for found in self._suggested(cell, way):
                free = {name: text for name, text in self.values.items() if name != found.evidence.get("scale")}
                evidence = {**found.evidence, "values": free}
                if not self.spent and (done := self._confirmed(cell, way, found.rule, evidence)) is not None:
                    return done
        return None

    def chord(self, cell: ParameterCell, inside: Fraction) -> Decided | None:
        """The counterexample that refutes the claim at a value in a cell, if it does so for the whole cell."""
        if self.spent or self.claim != "convexity" or self.chords == _MOST_CHORDS or self.most < _IN_DEPTH:
            return None
        self.chords += 1
        try:
            (found,) = verification.verify(self.law.fix({self.name: inside}), claims=[self.claim], effort="quick")
        except InputError:
            return None
        self.steps += found.steps
        if found.witness is None or not {"p", "q"} <= set(found.witness.points):
            return None
        self.hopeful.add(cell)
        p, q = (dict(found.witness.points[key]) for key in ("p", "q"))
        pressure = {} if self.law.pressure is None else {"pressure": p.pop(self.law.pressure)}
        if self.law.pressure is not None and q.pop(self.law.pressure) != pressure["pressure"]:
            return None
        values = {name: x for name, x in found.witness.parameters.items() if name in self.values}
        evidence = {"p": p, "q": q, "values": {**self.values, **values}, **pressure}
        return next(filter(None, (self._confirmed(cell, way, "chord", evidence) for way in _ways(cell))), None)

    def _suggested(self, cell: ParameterCell, way: str) -> list[Suggestion]:
        """The first families that floating point suggests over a cell; none where nothing is told in so many steps."""
        found = list[Suggestion]()
        with within(_MOST_STEPS) as purse, suppress(NotWritten, TooDearError):
            law, swap = law_over(self.stated, self.name, cell, way)
            for one in suggestions(at_values(law, self.values, swap), law, self.claim, self.name, cell, swap):
                found.append(one)
                if len(found) == _FEW_TRIED:
                    break
        self.steps += purse.spent
        if found:
            self.hopeful.add(cell)
        return found

    def _confirmed(self, cell: ParameterCell, way: str, rule: str, evidence: Mapping[str, Any]) -> Decided | None:
        """A family of witnesses, if the kernel confirms it."""
        fault = self._within(partial(refutation_fails, self.claim, rule, self.stated, self.name, cell, way, evidence))
        return None if fault else Decided(cell, "refuted", {"as": way, "rule": rule, "evidence": evidence})
