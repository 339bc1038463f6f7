"""What a campaign file asks of each row: claims, increments, checks or stress; the tables that say how are named as what is asked."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from decimal import Decimal
from pathlib import Path
from typing import Any, TypedDict

from duhem.errors import InputError
from duhem.expression.number import exact_number
from duhem.law.convex import check_convex
from duhem.law.placed_toml import Key, meant
from duhem.law.section_reader import SectionReader
from duhem.path.table_file import read_table
from duhem.screening.increments import Increments, Project, Trials
from duhem.screening.inquiries import Claimed, Inquiry

__all__ = ["SECTIONS", "InquiryReader", "Means"]

SECTIONS = {
    "increments": ("n", "seed", "table", "pressure", "stiffness", "method", "convex"),
    "checks": ("checks", "examples", "seed", "accuracy", "most_flagged", "shrink", "expect"),
    "stress": ("axes", "methods"),
}
_ASKED = ("claims", *SECTIONS)
_MOST_TRIALS = 1_000_000


class Means(TypedDict, total=False):
    """What this room does not know and a file may ask: ``project`` solves increments, ``checks`` makes the inquiry about a ``routine``,
    and ``stress`` that about extreme cases; InputError, by the name of the option, of what cannot be used."""

    project: Project | None
    routine: Any
    checks: Callable[..., Inquiry] | None
    stress: Callable[..., Inquiry] | None


class InquiryReader(SectionReader):
    """Reads what is asked, and stops at the first fault."""

    def inquiry(self, head: Mapping[str, Any], folder: Path, means: Means) -> tuple[Inquiry, list[str]]:
        """What is asked, and the files that it is read from."""
        ask = head.get("ask", "claims")
        if ask not in _ASKED:
            raise self.error(f"unknown ask {str(ask)[:40]!r}", "campaign", "ask", remedy=f"one of: {', '.join(_ASKED)}")
        for section in SECTIONS:
            if section in self.document and section != ask:
                raise self.error(f"[{section}] is not asked for", section, remedy=f'write ask = "{section}" in [campaign]')
        routine = means.get("routine")
        if routine is not None and ask != "checks":
            raise self.error(f"a routine is given, and {ask} are asked", "campaign", "ask", remedy='write ask = "checks"')
        if ask == "claims":
            return Claimed(self.claims(head), self.effort(head)), []
        for key in ("claims", "effort"):
            if key in head:
                raise self.error(f"{key} is for claims, and {ask} are asked", "campaign", key, remedy="leave it out")
        if ask == "increments":
            return self.increments(folder, means.get("project"))
        if ask == "stress":
            return self.made("stress", means.get("stress"), "give stress=duhem.benchmark.extreme_cases.StressCases"), []
        if routine is None:
            remedy = "name it: --routine module:callable, or routine=... in Python; a file is data and runs nothing"
            raise self.error("checks are of a routine, and none is given", "campaign", "ask", remedy=remedy)
        return self.made("checks", means.get("checks"), "give checks=duhem.testing.RoutineChecks", routine), []

    def made(self, section: str, make: Callable[..., Inquiry] | None, remedy: str, *given: Any) -> Inquiry:
        """What another room makes of the options in a section; what it refuses is told with its place."""
        if make is None:
            raise self.error(f"{section} is asked, and nothing is given that asks it", "campaign", "ask", remedy=remedy)
        options = self.section(section)
        self.keys(section, options, SECTIONS[section])
        try:
            return make(*given, **{key: _plain(value) for key, value in options.items()})
        except InputError as fault:
            if fault.where not in SECTIONS[section]:
                raise
            raise self.error(fault.what, section, fault.where, remedy=fault.remedy) from None

    def claims(self, head: Mapping[str, Any]) -> tuple[str, ...]:
        from duhem.proof.claims import CLAIMS

        asked = head.get("claims", list(CLAIMS))
        if not isinstance(asked, list) or not asked:
            raise self.error("claims is not a list of claims", "campaign", "claims", remedy=f"the claims are: {', '.join(CLAIMS)}")
        for i, name in enumerate(asked):
            if not isinstance(name, str) or name not in CLAIMS:
                raise self.error(f"unknown claim {str(name)[:40]!r}", "campaign", "claims", i, remedy=meant(f"{name}", CLAIMS))
        return tuple(dict.fromkeys(asked))

    def effort(self, head: Mapping[str, Any]) -> str:
        from duhem.proof.decide import EFFORTS

        effort = head.get("effort", "normal")
        if not isinstance(effort, str) or effort not in EFFORTS:
            raise self.error(f"unknown effort {str(effort)[:40]!r}", "campaign", "effort", remedy=f"one of: {', '.join(EFFORTS)}")
        return effort

    # -- increments --------------------------------------------------------------------------------------------

    def increments(self, folder: Path, project: Project | None) -> tuple[Increments, list[str]]:
        from duhem.projection.methods import METHODS

        if project is None:
            raise self.error(
                "increments are asked, and nothing is given to solve them", "campaign", "ask", remedy="give project=duhem.project"
            )
        given = self.section("increments")
        self.keys("increments", given, SECTIONS["increments"])
        if ("n" in given) == ("table" in given):
            raise self.error("increments are drawn or given", "increments", remedy='write n = 1000 and seed = 1, or table = "trials.csv"')
        if "table" in given:
            self.alone("table", "increments", "seed", "pressure")
        method, convex = given.get("method", "auto"), given.get("convex", "ask")
        if method not in ("auto", *METHODS):
            raise self.error(f"unknown method {str(method)[:40]!r}", "increments", "method", remedy=meant(f"{method}", ("auto", *METHODS)))
        try:
            check_convex(convex)
        except InputError as fault:
            raise self.error(fault.what, "increments", "convex", remedy=fault.remedy) from None
        how = {"stiffness": self.stiffness(given), "method": method, "convex": convex}
        if "table" in given:
            table = str(folder / self.string("increments", "table"))
            columns, rows = read_table(table, least=1)
            return Increments(project, trials=Trials(tuple(columns), tuple(map(tuple, rows.tolist()))), **how), [table]
        pressure = self.real(given.get("pressure", -1), "increments", "pressure")
        if pressure > 0.0:
            raise self.error(f"pressure = {pressure:g}", "increments", "pressure", remedy="give it <= 0 in compression")
        n, seed = self.whole("increments", "n", 1, _MOST_TRIALS), self.whole("increments", "seed", 0)
        return Increments(project, n, seed, pressure=pressure, **how), []

    def section(self, name: str) -> Mapping[str, Any]:
        given = self.document.get(name, {})
        if not isinstance(given, dict):
            raise self.error(f"{name} is not a table", name, remedy=f"write [{name}] on a line of its own")
        return given

    def whole(self, section: str, key: str, least: int, most: int | None = None) -> int:
        value = self.value(section).get(key)
        if not isinstance(value, int) or isinstance(value, bool) or value < least or (most is not None and value > most):
            what = f"[{section}] has no {key}" if value is None else f"{key} = {str(value)[:40]}"
            span = f"from {least} on" if most is None else f"from {least} to {most}"
            raise self.error(what, *(section, key)[: 1 if value is None else 2], remedy=f"give a whole number {span}")
        return value

    def real(self, value: Any, *path: Key) -> float:
        try:
            return float(exact_number(value))
        except InputError as fault:
            raise self.error(fault.what, *path, remedy=fault.remedy) from None

    def stiffness(self, given: Mapping[str, Any]) -> Any:
        """One number, one a force, or the matrix; whether it fits a law is said of its row."""
        value = given.get("stiffness", 1)
        if not isinstance(value, list):
            return self.real(value, "increments", "stiffness")
        path = ("increments", "stiffness")
        if not value:
            raise self.error("stiffness is empty", *path, remedy="give one number, one a force, or the matrix row by row")
        if any(isinstance(row, list) for row in value):
            if not all(isinstance(row, list) and len(row) == len(value) for row in value):
                raise self.error("stiffness is no square matrix", *path, remedy="give as many rows as columns")
            return tuple(tuple(self.real(x, *path, i, j) for j, x in enumerate(row)) for i, row in enumerate(value))
        return tuple(self.real(x, *path, i) for i, x in enumerate(value))


def _plain(value: Any) -> Any:
    """A value of TOML as a program gives it."""
    if isinstance(value, list):
        return tuple(map(_plain, value))
    if isinstance(value, dict):
        return tuple((key, _plain(each)) for key, each in value.items())
    return float(value) if isinstance(value, Decimal) else value
