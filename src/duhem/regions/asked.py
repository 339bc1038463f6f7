"""A claim of a law asked of the kernel where some of its parameters lie: a proof by its rules, or a family of witnesses."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import partial
from itertools import islice
from typing import Any

import sympy as sp

from duhem.errors import InputError
from duhem.law.formula_law import Criterion
from duhem.proof import verification
from duhem.proof.certificate import law_as_text
from duhem.proof.facts.formula_subject import admitted_values
from duhem.proof.kernel.claims import objection, row_of, rules_of
from duhem.proof.kernel.dents import Dent
from duhem.proof.kernel.parameter_tree import at_values, family_fails, proof_fails, settled
from duhem.proof.kernel.signs import RealRoot
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.steps import TooDearError, within
from duhem.proof.kernel.term import UNREADABLE, NotWritten, parse
from duhem.regions.chords import Family, Suggestion
from duhem.regions.seen import looked_at, of_one_sign, telling
from duhem.regions.suggested import suggestions

__all__ = ["MOST_STEPS", "UNBOUNDED", "AsksTheKernel", "constraints_on"]

MOST_STEPS = 60_000_000  # for a region
_MOST_STEPS_OF_A_RULE = 2_500_000  # on one cell
UNBOUNDED = {"convexity": (("sign", True), ("polar-sign", True))}  # rules of claims that hold where K has no boundary too
_FEW_TRIED = 9  # suggestions that the kernel is asked about on one cell


def constraints_on(law: Criterion, names: Collection[str]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The constraints of a law on these parameters alone, and those that relate them to others, as text."""
    alone, joined = list[str](), list[str]()
    for text, c in zip(law.written_constraints, law.constraints, strict=True):
        own = {x.name for x in c.free_symbols if isinstance(x, sp.Symbol)}
        if own & {*names}:
            (joined if own - {*names} else alone).append(text or str(c))
    return tuple(alone), tuple(joined)


def _row(steps: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """What a certificate says of a proof, the last step, with those that it rests on."""
    return {"rule": steps[-1]["rule"], "evidence": steps[-1]["evidence"], "needs": [*steps[:-1]]}


@dataclass
class AsksTheKernel:
    """A claim of a law, asked for the values of its parameters ``names``.  ``steps`` counts what was spent, ``most`` what may be."""

    law: Criterion
    claim: str
    names: tuple[str, ...]
    most: int = MOST_STEPS
    steps: int = 0
    stated: StatedLaw = field(init=False)
    values: dict[str, str] = field(init=False)  # of the other parameters that are not fixed: 1, or else what the law admits
    usual: dict[str, tuple[str, bool]] = field(default_factory=dict)  # the rule that first proved a claim on a cell, asked alone then
    learning: bool = True
    chords: tuple[Family, ...] = ()  # the family that refuted the claim on the cell before, of one parameter

    def __post_init__(self) -> None:
        try:
            self.stated = StatedLaw.read(law_as_text(self.law))
            if not self.stated.around_zero:
                raise NotWritten("zero force is outside the ranges of the forces")
        except NotWritten as fault:
            raise InputError(f"regions are not known of such a law: {fault}", where=self.law.name, remedy="use duhem verify") from None
        self.values = dict.fromkeys((n for n, own in self.stated.parameters.items() if n not in self.names and not own.single), "1")
        if self.values and not self.admitted(self.stated) and (known := admitted_values(self.law)):
            self.values = {name: known[name] for name in self.values}

    def admitted(self, law: StatedLaw) -> bool:
        """Whether the values of the other parameters are seen to be admitted by a law over some values, at all of these."""
        with suppress(NotWritten):
            at_values(law, self.values, self.names)
            return True
        return False

    @property
    def spent(self) -> bool:
        """Whether the budget is used up."""
        return self.steps >= self.most

    @contextmanager
    def paid(self) -> Iterator[None]:
        """What is asked inside of it may cost the steps of one rule on one cell, which count; what is dearer, or is refused, ends it."""
        with within(_MOST_STEPS_OF_A_RULE) as purse, suppress(NotWritten, TooDearError):
            yield
        self.steps += purse.spent

    def confirmed(self, objection: Callable[[], str]) -> bool:
        """Whether the kernel has nothing against something."""
        with self.paid():
            return not objection()
        return False

    def proof(self, law: StatedLaw) -> dict[str, Any] | None:
        """The rule that proves the claim of a law over some values, with those for the claims that it rests on; None where none does."""
        steps = self._steps_of(self.claim, settled(law, self.names), {})
        return None if steps is None else _row(steps)

    def _steps_of(self, claim: str, law: StatedLaw, known: dict[str, list[dict[str, Any]] | None]) -> list[dict[str, Any]] | None:
        """The claims that a proof of this one rests on, each with its rule, and it as the last; None where no rule confirms it.

        A claim that is asked for already is ``known`` as one without a proof: no proof goes round.
        """
        if claim in known:
            return known[claim]
        known[claim] = None
        usual = self.usual.get(claim)
        readings = (True, False) if usual is None else (usual[1],)
        every = [(rule, as_written) for as_written in readings for rule in rules_of(claim, law)]
        told = every if usual is None or not self.is_usual(law) else [usual]
        trivial = UNBOUNDED[claim] if claim in UNBOUNDED and self._seems_trivial(law) else ()
        for rule, as_written in (*trivial, *told):
            row, before = row_of(claim, rule, law), list[dict[str, Any]]()
            for need in sorted(row.needed if row is not None else ()):
                if (more := self._steps_of(need, law, known)) is None:
                    break
                before += [step for step in more if step not in before]
            else:
                settled = frozenset(step["claim"] for step in before)
                if self.confirmed(partial(objection, claim, rule, settled, law, {}, as_written)):
                    known[claim] = [*before, {"claim": claim, "rule": rule, "evidence": {}}]
                    if self.learning and self.is_usual(law) and (rule, as_written) not in trivial:
                        self.usual[claim] = rule, as_written
                    break
        return known[claim]

    def _seems_trivial(self, law: StatedLaw) -> bool:
        """Whether g is seen to have one sign at all forces but zero, so that K has no boundary."""
        with suppress(*UNREADABLE):
            here = at_values(law, self.values, self.names)
            return of_one_sign(here, looked_at(here))
        return False

    def proof_by_all(self, stated: StatedLaw, where: Iterable[str]) -> dict[str, Any] | None:
        """The proof, with evidence, of all that makes proofs where comparisons hold; ``stated`` is the law there, for the kernel."""
        ones = {name: own.low for name, own in stated.parameters.items() if name in self.names and own.single}
        texts = [text for text in where if not parse(text).names() <= {*ones}]
        try:
            law = self.law.fix(ones)
            law = replace(law, constraints=(*law.constraints, *texts))  # a text is read on construction
            found = verification.verify(law, claims=[self.claim], effort="quick")
        except InputError:
            return None
        self.steps += sum(r.steps for r in (*found.results, *found.rests_on))
        rows = {r.claim: r.proof for r in (*found.rests_on, *found.results) if r.proof is not None}
        steps = [{"claim": claim, "rule": proof.rule, "evidence": dict(proof.evidence)} for claim, proof in rows.items()]
        if self.claim not in rows or any("over" in step["evidence"] for step in steps):
            return None
        proof = _row(steps)
        return proof if self.confirmed(partial(proof_fails, self.claim, settled(stated, self.names), proof)) else None

    def told(self, law: StatedLaw) -> tuple[Dent, ...]:
        """Where the claim seems to hold of a law over some values; None where that is not told in so many steps."""
        with self.paid():
            return telling(at_values(law, self.values, self.names), self.claim)
        return ()

    def is_usual(self, law: StatedLaw) -> bool:
        """Whether what proves a claim of one such law is asked alone of all: a single value may have a proof of its own."""
        return {*self.names} <= {*law.parameters}

    def refutation(
        self, law: StatedLaw, away: Sequence[str], ends: Sequence[RealRoot] = (), turning: Sequence[Fraction] = ()
    ) -> dict[str, Any] | None:
        """The first family of those that floating point suggests which refutes the claim of a law over some values; None where none does.

        ``away`` are formulas that are >= 0 over these, ``ends`` the numbers at which those of one parameter end, ``turning``
        those of them that are left out and are ends of a cell on which the claim is proved.
        """
        with self.paid():
            whole, here = settled(law, self.names), at_values(law, self.values, self.names)
            found = suggestions(here, whole, self.claim, self.names, [*away, *self.names], ends, turning, self.chords)
            for one in islice(found, _FEW_TRIED):
                free = {name: text for name, text in self.values.items() if name != one.evidence.get("scale")}
                if self.refutes(law, told := one._replace(evidence={**one.evidence, "values": free})):
                    self.chords = (one.family,) if one.family is not None else ()
                    return {"rule": told.rule, "evidence": told.evidence}
        return None

    def refutes(self, law: StatedLaw, one: Suggestion) -> bool:
        """Whether the kernel confirms a family of witnesses for a law over some values."""
        return self.confirmed(partial(family_fails, self.claim, one.rule, law, self.names, one.evidence))
