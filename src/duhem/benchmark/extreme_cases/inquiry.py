"""The extreme cases as what a campaign asks of each of its rows: a line a case, its error against the reference, its status."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from time import monotonic
from typing import Any, ClassVar, TypeAlias

import numpy as np

from duhem.benchmark.contenders import Contender
from duhem.benchmark.extreme_cases.cases import AXES, labels
from duhem.benchmark.extreme_cases.refusals import Refusal
from duhem.benchmark.extreme_cases.stress import Tally, stress
from duhem.benchmark.specimen import Specimen
from duhem.errors import InputError
from duhem.law.catalogue import load_formula
from duhem.law.curve_law import Law
from duhem.law.formula_law import Criterion
from duhem.projection.methods import METHODS
from duhem.projection.projector import Projector

__all__ = ["StressCases"]

_REFUSALS = "refusals"
_Line: TypeAlias = tuple[str, str | None, str | None, str | None, str | None, int, float]


@dataclass(frozen=True)
class StressCases:
    """Stiff and extreme increments, as ``duhem stress`` tries them, for ``duhem.campaign(..., ask=StressCases())``.

    A line a case of the ``axes`` (all of them if left out), named as axis and label, and, of several ``methods``, the method; ``auto`` is
    the cheapest that applies.  It is ``wrong`` where an answer has fewer than 6 accurate digits of stress or slip and no flag, ``flagged``
    where the method says of an answer that it is none, else ``ok``; ``undecided`` where there is no reference, ``not_applicable`` where
    the law has no such case or the method does not take the law.  The witness has the fewest accurate digits of the points (16 at most)
    and how many are finite, in K, flagged and silently wrong; ``steps`` are the points.  One line more, ``refusals``: what is not
    finite is refused with argument and index named.

    Every row fixes all parameters of its law, at k = diag(1, 2, ...) Pa/m.  Raises InputError for an unknown axis or method.
    """

    axes: tuple[str, ...] = tuple(AXES)
    methods: tuple[str, ...] = ("auto",)
    options: ClassVar[tuple[str, ...]] = ()
    alone: ClassVar[bool] = False

    def __post_init__(self) -> None:
        for where, given, known in (("axes", self.axes, tuple(AXES)), ("methods", self.methods, ("auto", *METHODS))):
            remedy = f"they are: {', '.join(known)}"
            if not isinstance(given, tuple) or not given or len(set(given)) < len(given):
                raise InputError(f"{where} is no list of different names", where=where, remedy=remedy)
            if strange := [name for name in given if name not in known]:
                raise InputError(f"unknown name {str(strange[0])[:40]!r}", where=where, remedy=remedy)

    @property
    def names(self) -> tuple[str, ...]:
        cases = [f"{axis} {label}" for axis in self.axes for label in labels(axis)]
        return tuple(self._name(case, method) for method in self.methods for case in (*cases, _REFUSALS))

    def told(self) -> str:
        return f"stress {','.join(self.axes)} by {','.join(self.methods)}"

    def _name(self, case: str, method: str) -> str:
        return case if len(self.methods) == 1 else f"{case}, {method}"

    def answers(self, law: Law) -> Iterator[_Line]:
        """A line for each name; InputError where the law cannot be asked."""
        formula = load_formula(law)
        if missing := [name for name, domain in formula.parameters.items() if domain.value is None]:
            raise InputError(f"no value is given for {', '.join(missing)}", where=law.name, remedy="give it in set, grid, draw or table")
        for method in self.methods:
            yield from self._of_method(formula, method)

    def _of_method(self, law: Criterion, method: str) -> Iterator[_Line]:
        contender = _contender(law, method)
        if isinstance(contender, str):
            for case in (f"{axis} {label}" for axis in self.axes for label in labels(axis)):
                yield self._without(case, method, "not_applicable", contender)
            yield self._without(_REFUSALS, method, "not_applicable", contender)
            return
        last, taken = monotonic(), dict[str, float]()

        def on_row(row: Tally) -> None:
            nonlocal last
            now = monotonic()
            taken[f"{row.axis} {row.label}"], last = now - last, now

        found = stress(law, axes=self.axes, contenders=[contender], on_row=on_row)
        if found.interrupted:
            raise KeyboardInterrupt
        rows = {f"{row.axis} {row.label}": row for row in found.rows}
        why = {each.part: each.reason for each in found.left_out}
        for axis in self.axes:
            for case in (f"{axis} {label}" for label in labels(axis)):
                if case in rows:
                    row = rows[case]
                    told = self._name(case, method), _verdict(row), contender.name, None, json.dumps(_witness(row))
                    yield *told, row.points, round(taken[case], 6)
                elif case in why:
                    yield self._without(case, method, "undecided", why[case])
                else:
                    yield self._without(case, method, "not_applicable", why.get(f"axis {axis}", "the law has none"))
        refused = [each for each in found.refusals if not each.held]
        witness = json.dumps({"refused": len(found.refusals) - len(refused), "not": [_refusal(each) for each in refused]})
        verdict = "wrong" if refused else "ok"
        yield self._name(_REFUSALS, method), verdict, contender.name, None, witness, len(found.refusals), round(monotonic() - last, 6)

    def _without(self, case: str, method: str, verdict: str, reason: str) -> _Line:
        return self._name(case, method), verdict, None, None, json.dumps({"reason": reason}), 0, 0.0


def _contender(law: Criterion, method: str) -> Contender | str:
    """Who is asked, or why the method does not take the law."""
    specimen = Specimen.of(law)
    if method == "auto":
        chosen = Projector.of(specimen.law, specimen.stiffness).method
        return Contender(chosen.name, chosen, chosen.options_of({}))
    reason = METHODS[method]().applies(specimen.question(np.zeros((1, len(law.forces))), specimen.pressure))
    return Contender.of(method, method) if reason is None else reason


def _verdict(row: Tally) -> str:
    return "wrong" if row.wrong_stress or row.wrong_slip else "flagged" if row.flagged or row.failure is not None else "ok"


def _witness(row: Tally) -> Mapping[str, Any]:
    found = {
        "points": row.points,
        "digits": {"stress": round(row.stress_digits, 1), "slip": round(row.slip_digits, 1)},
        "finite": row.finite,
        "in_K": row.feasible,
        "flagged": row.flagged,
        "wrong": {"stress": row.wrong_stress, "slip": row.wrong_slip},
    }
    return found if row.failure is None else found | {"failure": row.failure}


def _refusal(refusal: Refusal) -> Mapping[str, str]:
    return {"input": refusal.what, "place": refusal.place, "answer": refusal.answer}
