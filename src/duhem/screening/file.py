"""Campaigns are read from TOML files; an error names file, line and column.

[campaign]
ask = "claims"                                # default claims; or increments, checks, stress, each with its own table below
claims = ["origin", "convexity"]              # default: all claims
effort = "normal"                             # quick, normal or thorough: the budget of steps for each claim
out = "table.csv"                             # or .parquet; --out on the command line takes precedence
seconds = 600                                 # limit of processor time for a row; a row may wait at most ten times as long
memory = 4                                    # limit of memory for a row in GB, at least 0.5

[[rows]]
laws = ["coulomb", "laws/*.toml"]             # several laws without changes; duhem searches in the folder of the campaign
[[rows]]
law = "limacon"
grid = { mu = [0.3], e = [0.1, 0.5, 0.6] }    # every combination of these values
[[rows]]
law = "limacon"
set = { mu = 0.3 }                            # the same values in every row
draw = { n = 1000, seed = 1, e = [0, 1] }     # random values from the domains, or from a range if a domain is infinite
[[rows]]
law = "quartic.toml"
table = "coefficients.csv"                    # or .parquet; the columns have the names of the parameters
columns = ["c40", "c22"]                      # the columns with parameters (default: all columns)

[increments]                                  # for ask = "increments"
n = 1000                                      # number of random trial stresses; or table = "trials.csv" with forces and pressure
seed = 1
pressure = -1                                 # pressure of the random trial stresses, in Pa
stiffness = 1                                 # in Pa/m: one number, one number per force, or the matrix row by row
method = "auto"                               # or closed-form, newton, cvxpy
convex = "ask"                                # ask: look for a proof that K is convex; require such a proof; assume that K is convex

[checks]                                      # for ask = "checks" with --routine module:callable; every key is optional
checks = ["feasibility", "dissipation"]       # default: all checks that apply to the law
examples = 30                                 # number of cases
seed = 0                                      # the same cases in every run
accuracy = 1e-9                               # relative error of the stress that you allow the routine
most_flagged = 0                              # maximum fraction of increments that the routine may flag as not solved
shrink = 200                                  # maximum number of attempts to simplify a failing case
expect = { slope = "no tangent yet" }         # checks that you expect to fail, with the reason

[stress]                                      # extreme cases, for ask = "stress"; every key is optional
axes = ["load", "trial size"]                 # default: all kinds of difficulty
methods = ["newton", "cvxpy"]                 # default "auto": the cheapest method that applies
"""

from __future__ import annotations

import glob
import os
import sys
from collections.abc import Callable, Collection, Iterable, Mapping
from decimal import Decimal
from functools import partial
from math import isfinite
from pathlib import Path
from typing import Any, TypedDict, Unpack

from duhem.errors import InputError, faults_at, meant
from duhem.expression.number import exact_number, exact_text, fraction
from duhem.expression.syntax import spelled
from duhem.law.convex import check_convex
from duhem.law.criterion_file import SectionReader
from duhem.law.curve_law import Law
from duhem.law.placed_toml import Key, parsed, text_of
from duhem.law.table_file import read_table
from duhem.screening.campaign import Campaign, Claimed, Draw, Given, Grid, Inquiry, LawName, RowBlock, Span, TableRows, cells_in_lines
from duhem.screening.increments import Increments, Project, Trials

__all__ = ["KEYS", "Means", "read", "reads"]

MOST_BYTES = 1_000_000
MOST_ROWS = 10_000_000
_LEAST_MEMORY = 0.5  # GB; with less some library does not load, another of its name is, and a row says anything but that
_SECTIONS = {
    "increments": ("n", "seed", "table", "pressure", "stiffness", "method", "convex"),
    "checks": ("checks", "examples", "seed", "accuracy", "most_flagged", "shrink", "expect"),
    "stress": ("axes", "methods"),
}
_ASKED = ("claims", *_SECTIONS)
_MOST_TRIALS = 1_000_000
KEYS = {
    "campaign": ("ask", "claims", "effort", "out", "seconds", "memory"),
    "rows": ("laws", "law", "set", "grid", "draw", "table", "columns"),
    **_SECTIONS,
}
_KINDS = ("grid", "draw", "table")


class Means(TypedDict, total=False):
    """What this room does not know and a file may ask: ``project`` solves increments, ``checks`` makes the inquiry about a ``routine``,
    and ``stress`` that about extreme cases; InputError, by the name of the option, of what cannot be used."""

    project: Project | None
    routine: Any
    checks: Callable[..., Inquiry] | None
    stress: Callable[..., Inquiry] | None


def read(file: str | os.PathLike[str], **means: Unpack[Means]) -> Campaign:
    """The campaign of a TOML file; InputError names file, line and column of what is wrong in it.

    ``means`` are what solves increments or asks a routine, where these are asked.
    """
    text = text_of(file, "campaign", MOST_BYTES, large="put the values into a table")
    return reads(text, where=f"{file}", folder=Path(file).parent, **means)


def reads(text: str, where: str = "campaign", folder: str | os.PathLike[str] = ".", **means: Unpack[Means]) -> Campaign:
    """The campaign written in ``text``; files it names are looked for in ``folder``."""
    return _CampaignReader(**vars(parsed(text, where, number=Decimal))).campaign(Path(folder), means)


class _CampaignReader(SectionReader):
    """From the document of a campaign to its value; stops at the first fault."""

    def campaign(self, folder: Path, means: Means) -> Campaign:
        self.keys("", self.document, tuple(KEYS))
        head = self.table("campaign", required=False)
        self.keys("campaign", head, KEYS["campaign"])
        inquiry, tables = self.inquiry(head, folder, means)
        given = self.document.get("rows")
        if not isinstance(given, list) or not given or not all(isinstance(each, dict) for each in given):
            raise self.error("the file has no [[rows]]", "rows", remedy='write for example [[rows]] and below it laws = ["coulomb"]')
        blocks, inputs = list[RowBlock](), [self.where, *tables]
        for i in range(len(given)):
            block, files = self.block(i, folder)
            blocks.append(block)
            inputs += files
        try:
            count = sum(map(len, blocks))
        except OverflowError:  # more than a length can be
            count = sys.maxsize
        if count > MOST_ROWS:
            many = f"{count}" if count < sys.maxsize else f"more than {count}"
            raise self.error(f"there are {many} rows", "rows", remedy=f"a campaign may have at most {MOST_ROWS}")
        out = self.string("campaign", "out", required=False) if "out" in head else ""
        return Campaign(
            tuple(blocks),
            inquiry,
            seconds=self.limit(head, "seconds", 600.0, 0.0, "give a number above 0"),
            memory=self.limit(head, "memory", 4.0, _LEAST_MEMORY, f"give {_LEAST_MEMORY:g} or more: duhem itself needs this much"),
            out=str(folder / out) if out else None,
            inputs=tuple(inputs),
        )

    def limit(self, head: Mapping[str, Any], key: str, usual: float, least: float, remedy: str) -> float:
        given = head.get(key, usual)
        known = isinstance(given, int | float | Decimal) and not isinstance(given, bool) and isfinite(given)
        if not known or not least <= given < 1e9 or not given:
            raise self.error(f"{key} = {str(given)[:40]}", "campaign", key, remedy=remedy)
        return float(given)

    # -- rows --------------------------------------------------------------------------------------------------

    def block(self, i: int, folder: Path) -> tuple[RowBlock, list[str]]:
        """The rows of the i-th table, and the files that they are read from."""
        given: Mapping[str, Any] = self.value("rows", i)
        self.keys("rows", given, KEYS["rows"], at=("rows", i))
        kinds = [kind for kind in _KINDS if kind in given]
        if len(kinds) > 1:
            raise self.error(f"{kinds[0]} and {kinds[1]} are both given", "rows", i, kinds[1], remedy="give each its own [[rows]]")
        if "columns" in given and "table" not in given:
            raise self.error("columns needs a table", "rows", i, "columns", remedy="add a table, or remove columns")
        if ("laws" in given) == ("law" in given):
            raise self.error("a [[rows]] needs either law or laws", "rows", i, remedy='write law = "..." or laws = ["...", "..."]')
        if "laws" in given:
            if kinds:
                raise self.error(f"{kinds[0]} applies only to one law", "rows", i, kinds[0], remedy='write law = "..."')
            names = self.names(i, folder)
            values = self.fixed(i)
            return Given(tuple((name, values) for name in names)), [name.path for name in names if name.path]
        name = self.named(self.string("rows", i, "law"), folder, "rows", i, "law")
        values, files = self.fixed(i), [name.path] if name.path else []
        if not kinds:
            return Given(((name, values),)), files
        law = self.law(name, i)
        for parameter, _ in values:
            self.known(law, parameter, "rows", i, "set", parameter)
        match kinds[0]:
            case "grid":
                axes = self.axes(i, law)
                self.once(i, "grid", values, [axis for axis, _ in axes])
                return Grid(name, axes, values), files
            case "draw":
                drawn = self.draw(i, name, law, values)
                self.once(i, "draw", values, [span.parameter for span in drawn.spans])
                return drawn, files
        table = str(folder / self.string("rows", i, "table"))
        columns, text = cells_in_lines(table)
        taken = self.columns(i, law, columns, table)
        self.once(i, "table", values, taken)
        return TableRows(name, taken, text, values), [*files, table]

    def once(self, i: int, kind: str, values: Iterable[tuple[str, str]], names: Iterable[str | None]) -> None:
        """No parameter has a value for all rows and one for each, nor two spellings."""
        every = [name for name in (*dict(values), *names) if name is not None]
        if twice := next((name for name in every if every.count(name) > 1), None):
            raise self.error(f"{twice} is given twice", "rows", i, kind, remedy="give it once")

    def names(self, i: int, folder: Path) -> tuple[LawName, ...]:
        found = list[LawName]()
        for path in self.entries("rows", i, "laws", example='["coulomb", "laws/*.toml"]'):
            text = self.value(*path)
            if any(letter in text for letter in "*?["):
                files = sorted(glob.glob(text, root_dir=folder, recursive=True))
                if not files:
                    raise self.error(f"no file matches {text[:60]!r}", *path, remedy=f"duhem searched in {os.path.abspath(folder)}")
                found += [LawName(file, os.path.abspath(folder / file)) for file in files]
            else:
                found.append(self.named(text, folder, *path))
        if not found:
            raise self.error("laws names none", "rows", i, "laws", remedy='write for example laws = ["coulomb"]')
        return tuple(found)

    def named(self, text: str, folder: Path, *path: Key) -> LawName:
        """A law of duhem, or a criterion file beside the campaign; what is wrong in it is said of its rows."""
        from duhem.law.catalogue import load_named

        beside = os.path.abspath(folder / text)
        if text.endswith(".toml") or os.path.isfile(beside):
            if not os.path.isfile(beside):
                raise self.error(f"there is no file {text[:60]!r}", *path, remedy=f"it is looked for in {os.path.abspath(folder)}")
            return LawName(text, beside)
        with faults_at(partial(self.place, *path)):
            load_named(text)
        return LawName(text)

    def law(self, name: LawName, i: int) -> Law:
        """The law whose parameters are given values: what is wrong in its file is wrong with all its rows."""
        with faults_at(partial(self.place, "rows", i, "law"), unless_placed=True):
            return name.law()

    def known(self, law: Law, name: str, *path: Key) -> None:
        if name not in law.parameters:
            raise self.error(f"unknown parameter {name[:40]!r} of {law.name}", *path, remedy=meant(name, law.parameters))

    def fixed(self, i: int) -> tuple[tuple[str, str], ...]:
        given = self.value("rows", i).get("set", {})
        if not isinstance(given, dict):
            raise self.error("set is not a table", "rows", i, "set", remedy="write for example set = { mu = 0.3 }")
        return tuple((spelled(name), self.number(value, "rows", i, "set", name)) for name, value in given.items())

    def number(self, value: Any, *path: Key) -> str:
        with faults_at(partial(self.place, *path)):
            return exact_text(value)

    def axes(self, i: int, law: Law) -> tuple[tuple[str, tuple[str, ...]], ...]:
        given = self.value("rows", i, "grid")
        if not isinstance(given, dict) or not given:
            raise self.error("grid is not a table of values", "rows", i, "grid", remedy="write for example grid = { mu = [0.1, 0.2] }")
        axes = []
        for name, values in given.items():
            self.known(law, spelled(name), "rows", i, "grid", name)
            if not isinstance(values, list) or not values:
                raise self.error(f"{name} is not a list of numbers", "rows", i, "grid", name, remedy=f"write {name} = [0.1, 0.2]")
            axes.append((spelled(name), tuple(self.number(value, "rows", i, "grid", name, k) for k, value in enumerate(values))))
        return tuple(axes)

    def draw(self, i: int, name: LawName, law: Law, values: tuple[tuple[str, str], ...]) -> Draw:
        given = self.value("rows", i, "draw")
        if not isinstance(given, dict):
            raise self.error("draw is not a table", "rows", i, "draw", remedy="write for example draw = { n = 1000, seed = 1 }")
        ranges = {spelled(key): (key, value) for key, value in given.items() if key not in ("n", "seed")}
        for parameter, (key, _) in ranges.items():
            self.known(law, parameter, "rows", i, "draw", key)
        n, seed = (self.whole("draw", "rows", i, "draw", key, least=least) for key, least in (("n", 1), ("seed", 0)))
        fixed = dict(values)
        free = [p for p, d in law.parameters.items() if p in ranges or (p not in fixed and d.value is None)]
        spans = tuple(self.span(i, law, parameter, *ranges.get(parameter, (parameter, None))) for parameter in free)
        return Draw(name, spans, n, seed, values)

    def span(self, i: int, law: Law, parameter: str, key: str, given: Any) -> Span:
        path: tuple[Key, ...] = ("rows", i, "draw", key)
        domain = law.parameters[parameter]
        if given is None:
            if domain.low is None or domain.high is None:
                words = f"the domain of {parameter} has no end ({domain.describe()})"
                raise self.error(words, "rows", i, "draw", remedy=f"give the range to draw in: {parameter} = [0.1, 1]")
            return Span(parameter, fraction(domain.low), fraction(domain.high), domain.positive)
        if not isinstance(given, list) or len(given) != 2:
            raise self.error(f"{key} is not a range", *path, remedy=f"write {key} = [least, greatest]")
        low, high = (fraction(exact_number(self.number(end, *path, k))) for k, end in enumerate(given))
        if low > high:
            raise self.error(f"the range of {key} ends before it begins", *path, remedy="write the least value first")
        return Span(parameter, low, high, domain.positive)

    def columns(self, i: int, law: Law, columns: Iterable[str], table: str) -> tuple[str | None, ...]:
        """Which parameter each column of the table gives, or None."""
        found = list(columns)
        asked = self.value("rows", i).get("columns", found)
        if not isinstance(asked, list) or not all(isinstance(name, str) for name in asked):
            raise self.error("columns is not a list of names", "rows", i, "columns", remedy='write columns = ["a", "b"]')
        wanted = {spelled(name) for name in asked}
        for name in wanted:
            if name not in found:
                raise self.error(f"{table} has no column {name[:40]!r}", "rows", i, "columns", remedy=meant(name, found))
            if name not in law.parameters:
                where = self.place("rows", i, "columns" if "columns" in self.value("rows", i) else "table")
                remedy = f"{meant(name, law.parameters)}; columns = [...] selects the columns with parameters"
                raise InputError(f"the column {name[:40]!r} is no parameter of {law.name}", where=where, remedy=remedy)
        return tuple(name if name in wanted else None for name in found)

    # -- what is asked ------------------------------------------------------------------------------------------

    def inquiry(self, head: Mapping[str, Any], folder: Path, means: Means) -> tuple[Inquiry, list[str]]:
        """What is asked, and the files that it is read from."""
        ask = self.one_of(_ASKED, head.get("ask", "claims"), "campaign", "ask")
        for section in _SECTIONS:
            if section in self.document and section != ask:
                raise self.error(f"[{section}] is not asked for", section, remedy=f'write ask = "{section}" in [campaign]')
        routine = means.get("routine")
        if routine is not None and ask != "checks":
            raise self.error(f'a routine is given, but ask = "{ask}"', "campaign", "ask", remedy='write ask = "checks"')
        if ask == "claims":
            from duhem.proof.decide import EFFORTS

            return Claimed(self.claims(head), self.one_of(EFFORTS, head.get("effort", "normal"), "campaign", "effort")), []
        for key in ("claims", "effort"):
            if key in head:
                raise self.error(f'{key} is for claims, but ask = "{ask}"', "campaign", key, remedy="remove it")
        if ask == "increments":
            return self.increments(folder, means.get("project"))
        if ask == "stress":
            return self.made("stress", means.get("stress"), "give stress=duhem.benchmark.extreme_cases.StressCases"), []
        if routine is None:
            remedy = "name it with --routine module:callable, or routine=... in Python: a campaign file cannot name code"
            raise self.error('ask = "checks" needs a routine', "campaign", "ask", remedy=remedy)
        return self.made("checks", means.get("checks"), "give checks=duhem.testing.RoutineChecks", routine), []

    def made(self, section: str, make: Callable[..., Inquiry] | None, remedy: str, *given: Any) -> Inquiry:
        """What another room makes of the options in a section; what it refuses is told with its place."""
        if make is None:
            raise self.error(f'ask = "{section}" needs an argument that is missing', "campaign", "ask", remedy=remedy)
        options = self.table(section, required=False)
        self.keys(section, options, _SECTIONS[section])
        try:
            return make(*given, **{key: _plain(value) for key, value in options.items()})
        except InputError as fault:
            if fault.where not in _SECTIONS[section]:
                raise
            raise self.error(fault.what, section, fault.where, remedy=fault.remedy) from None

    def claims(self, head: Mapping[str, Any]) -> tuple[str, ...]:
        from duhem.proof.claims import CLAIMS, asked_of

        asked = head.get("claims", list(asked_of(None)))
        if not isinstance(asked, list) or not asked:
            raise self.error("claims is not a list of claims", "campaign", "claims", remedy=f"the claims are: {', '.join(CLAIMS)}")
        for i, name in enumerate(asked):
            if not isinstance(name, str) or name not in CLAIMS:
                raise self.error(f"unknown claim {str(name)[:40]!r}", "campaign", "claims", i, remedy=meant(f"{name}", CLAIMS))
        return tuple(dict.fromkeys(asked))

    def one_of(self, allowed: Collection[str], given: Any, *path: Key) -> str:
        """A word that is allowed at a place."""
        if not isinstance(given, str) or given not in allowed:
            raise self.error(f"unknown {path[-1]} {str(given)[:40]!r}", *path, remedy=f"one of: {', '.join(allowed)}")
        return given

    # -- increments --------------------------------------------------------------------------------------------

    def increments(self, folder: Path, project: Project | None) -> tuple[Increments, list[str]]:
        from duhem.projection.methods import METHODS

        if project is None:
            raise self.error('ask = "increments" needs an argument that is missing', "campaign", "ask", remedy="give project=duhem.project")
        given = self.table("increments", required=False)
        self.keys("increments", given, _SECTIONS["increments"])
        if ("n" in given) == ("table" in given):
            raise self.error(
                "give either n and seed, or a table", "increments", remedy='write n = 1000 and seed = 1, or table = "trials.csv"'
            )
        if "table" in given:
            self.alone("table", "seed", "pressure", inside="increments")
        method, convex = given.get("method", "auto"), given.get("convex", "ask")
        if method not in ("auto", *METHODS):
            raise self.error(f"unknown method {str(method)[:40]!r}", "increments", "method", remedy=meant(f"{method}", ("auto", *METHODS)))
        with faults_at(partial(self.place, "increments", "convex")):
            check_convex(convex)
        how = {"stiffness": self.stiffness(given), "method": method, "convex": convex}
        if "table" in given:
            table = str(folder / self.string("increments", "table"))
            columns, rows = read_table(table, least=1)
            return Increments(project, trials=Trials(tuple(columns), tuple(map(tuple, rows.tolist()))), **how), [table]
        pressure = self.real(given.get("pressure", -1), "increments", "pressure")
        if pressure > 0.0:
            raise self.error(f"pressure = {pressure:g}", "increments", "pressure", remedy="give it <= 0 in compression")
        n = self.whole("[increments]", "increments", "n", least=1, most=_MOST_TRIALS)
        seed = self.whole("[increments]", "increments", "seed", least=0)
        return Increments(project, n, seed, pressure=pressure, **how), []

    def whole(self, told: str, *path: Key, least: int, most: int | None = None) -> int:
        """The whole number at a place in what is ``told``, from ``least`` to ``most``."""
        *place, key = path
        value = self.value(*place).get(key)
        if not isinstance(value, int) or isinstance(value, bool) or value < least or (most is not None and value > most):
            what = f"{told} has no {key}" if value is None else f"{key} = {str(value)[:40]}"
            span = f"from {least} on" if most is None else f"from {least} to {most}"
            raise self.error(what, *(place if value is None else path), remedy=f"give a whole number {span}")
        return value

    def real(self, value: Any, *path: Key) -> float:
        return float(exact_number(self.number(value, *path)))

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
