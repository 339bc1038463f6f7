"""Criterion files: TOML in, a frozen law out, every fault with its line and column.

``g`` in [criterion] or several [[surface]] give a :class:`duhem.law.formula_law.Criterion`, [boundary] gives a
:class:`duhem.law.curve_law.ParametricCriterion`.
"""

from __future__ import annotations

import keyword
from collections.abc import Mapping, Sequence
from decimal import Decimal
from os import PathLike
from typing import Any

import sympy as sp

from duhem.errors import InputError
from duhem.expression import WORDS, symbol
from duhem.expression.abbreviations import Abbreviations
from duhem.expression.invariants import Stress
from duhem.expression.parse import parse_relation, written_out
from duhem.expression.spelling import spelled
from duhem.law.bounding_sections import BoundingSections, curve
from duhem.law.curve_law import ANGLE, Law, ParametricCriterion
from duhem.law.definitions import Definitions, PlacedFormula, definitions
from duhem.law.domain import POSITIVE, Domain, range_fault
from duhem.law.formula_law import FORCES, PRESSURE, Criterion
from duhem.law.given_text import Relations
from duhem.law.parameter_domain import check_domain
from duhem.law.placed_toml import parsed, text_of
from duhem.law.section_reader import SectionReader
from duhem.law.yield_surface import YieldSurface

__all__ = ["expected_verdicts", "read", "reads"]

MOST_BYTES = 1_000_000
_CRITERION = ("name", "summary", "source", "forces", "stress", "pressure", "g", "potential", "constraints", "expect")
_MOST = {
    ("criterion", "forces"): 100, ("criterion", "constraints"): 200, ("parameters",): 200, ("define",): 500, ("surface",): 200,
}  # fmt: skip
_PARAMETER = ("positive", "min", "max", "value")
_ATLAS = ("equation", "claims", "verdicts", "note")  # what is said of the law: nothing of it is part of the law


def read(path: str | PathLike[str]) -> Law:
    """The law of a TOML file; InputError names file, line and column of whatever is wrong in it."""
    absent = "check the path, or make one with: duhem init NAME"
    return reads(text_of(path, "criterion file", MOST_BYTES, absent=absent), where=f"{path}")


def reads(text: str, where: str = "criterion") -> Law:
    """The law written in ``text``; ``where`` names it in messages."""
    if not text.strip():
        raise InputError("the file is empty", where=where, remedy="start from the template: duhem init NAME")
    return _CriterionReader(parsed(text, where, number=Decimal)).law()


def expected_verdicts(path: str | PathLike[str]) -> Mapping[str, str]:
    """What a file expects of its law, formulas unread; nothing where the file is none."""
    try:
        return _CriterionReader(parsed(text_of(path, "criterion file", MOST_BYTES), f"{path}", number=Decimal)).expected()
    except InputError:
        return {}


class _CriterionReader(SectionReader):
    """From the document of a criterion file to the law; stops at the first fault."""

    def law(self) -> Law:
        self.keys("", self.document, ("criterion", "define", "domain", "parameters", "flow", "surface", "boundary", "atlas"))
        self.keys("atlas", self.table("atlas", required=False), _ATLAS)
        head = self.table("criterion")
        self.keys("criterion", head, _CRITERION)
        self.check_sizes()
        name = self.line("criterion", "name")
        stress = self.stress()
        forces = self.names() if stress is None else list(stress.components)
        pressure = self.pressure()
        given = self.table("parameters", required=False)
        domains = {spelled(p): self.domain(p, entry) for p, entry in given.items()}
        declared = [(f, "criterion", "forces") for f in forces] + ([(pressure, "criterion", "pressure")] if pressure else [])
        declared += [(spelled(p), "parameters", p) for p in given]
        self.check_names(declared, Abbreviations(stress=stress).words())
        parameters = {p: domain.symbol(p) for p, domain in domains.items()}
        known = {f: symbol(f) for f in forces} | ({pressure: symbol(pressure, nonpositive=True)} if pressure else {}) | parameters
        if "boundary" in self.document:
            self.alone("[boundary]", "criterion", "g", "potential", "stress")
            self.alone("[boundary]", "", "flow", "surface", "domain")
            return self.curve(forces, pressure, domains, declared)
        define = self.definitions(known, stress)
        bounding = BoundingSections(self, forces, known, define.short)
        surfaces = bounding.surfaces()
        whole = YieldSurface(sp.nan) if surfaces else bounding.whole()
        constraints, texts = self.constraints(parameters, define)
        domain = self.ranges(forces, pressure)
        expect = self.expected()
        try:
            law = Criterion(
                name=name,
                g=whole.g,
                parameters=domains,
                forces=tuple(forces),
                pressure=pressure,
                constraints=constraints,
                flow=whole.flow,
                summary=self.line("criterion", "summary", required=False),
                source=self.line("criterion", "source", required=False),
                expect=expect,
                written=whole.written,
                written_flow=whole.written_flow,
                written_constraints=texts,
                stress=stress,
                define=define,
                potential=whole.potential,
                domain=domain,
                surfaces=surfaces,
            )
        except InputError as fault:
            raise InputError(fault.what, where=self.where, remedy=fault.remedy) from None
        check_domain(law, where=self.place("criterion", "constraints"))
        return law

    def curve(
        self, forces: Sequence[str], pressure: str | None, domains: Mapping[str, Domain], declared: Sequence[tuple[str, str, str]]
    ) -> Law:
        """A law given by its boundary, in an angle and the parameters."""
        self.keys("boundary", self.table("boundary"), ("angle", "T", "direction"))
        angle = spelled(self.line("boundary", "angle", required=False) or ANGLE)
        self.check_names([*declared, (angle, "boundary", "angle")], frozenset())
        if pressure is None or len(forces) != 2:
            raise self.error("a boundary curve takes two forces and a pressure", "boundary", remedy="declare them, or write g instead")
        parameters = {p: domain.symbol(p) for p, domain in domains.items()}
        known = {angle: symbol(angle), **parameters}
        define = self.definitions(known, None)
        boundary = curve(self, "T", known[angle], known, define.short)
        flow = curve(self, "direction", known[angle], known, define.short) if "direction" in self.table("boundary") else []
        constraints, texts = self.constraints(parameters, define)
        law = ParametricCriterion(
            name=self.line("criterion", "name"),
            boundary=tuple(x for _, x in boundary),
            parameters=domains,
            forces=tuple(forces),
            pressure=pressure,
            angle=angle,
            constraints=constraints,
            flow=tuple(x for _, x in flow) or None,
            written=tuple(text for text, _ in (*boundary, *flow)),
            written_constraints=texts,
            summary=self.line("criterion", "summary", required=False),
            source=self.line("criterion", "source", required=False),
            expect=self.expected(),
        )
        check_domain(law, where=self.place("criterion", "constraints"))
        return law

    def check_sizes(self) -> None:
        """Nothing is longer than a law has use for, before anything is made of it."""
        for path, most in _MOST.items():
            *section, key = path
            table = self.document.get(section[0], {}) if section else self.document
            given = table.get(key, ()) if isinstance(table, dict) else ()
            if isinstance(given, dict | list) and len(given) > most:
                raise self.error(f"{key} has {len(given)} entries", *path, remedy=f"at most {most} are read")

    # -- the parts ---------------------------------------------------------------------------------------------

    def names(self) -> list[str]:
        given = self.document["criterion"].get("forces", list(FORCES))
        if not (isinstance(given, list) and given and all(isinstance(f, str) for f in given)):
            raise self.error("forces is not a list of names", "criterion", "forces", remedy='write forces = ["sigma_a", "sigma_b"]')
        return [spelled(name) for name in given]

    def stress(self) -> Stress | None:
        head, example = self.document["criterion"], 'write stress = { name = "sigma", kind = "3d" }'
        if (given := head.get("stress")) is None:
            return None
        if "forces" in head:
            raise self.error("forces and stress are both declared", "criterion", "stress", remedy="leave them out: they are its components")
        if not (isinstance(given, dict) and {*given} == {"name", "kind"} and all(isinstance(x, str) for x in given.values())):
            raise self.error("stress is not a table of name and kind", "criterion", "stress", remedy=example)
        try:
            return Stress(**given)
        except InputError as fault:
            raise self.error(fault.what, "criterion", "stress", remedy=fault.remedy) from None

    def expected(self) -> Mapping[str, str]:
        """The verdicts by claim that are no failure."""
        given = self.table("criterion").get("expect", {})
        if not (isinstance(given, dict) and all(isinstance(verdict, str) for verdict in given.values())):
            what = "expect is not a table of claims and verdicts"
            raise self.error(what, "criterion", "expect", remedy='write expect = { smoothness = "refuted" }')
        return given

    def definitions(self, known: Mapping[str, sp.Symbol], stress: Stress | None) -> Definitions:
        placed = {}
        for name in self.table("define", required=False):
            text, line, column = self.formula("define", name)
            placed[name] = PlacedFormula(text, self.where, line, column, self.place("define", name))
        return definitions(placed, known, stress)

    def pressure(self) -> str | None:
        given = self.document["criterion"].get("pressure", PRESSURE)
        if given is False:
            return None
        if not isinstance(given, str):
            raise self.error(
                "pressure is not a name", "criterion", "pressure", remedy='write pressure = "sigma_n", or false for a law without'
            )
        return str(spelled(given))

    def check_names(self, declared: Sequence[tuple[str, str, str]], invariants: frozenset[str]) -> None:
        """Every name, with the section and key that declare it, is one, and is free."""
        names = [name for name, _, _ in declared]
        for name, section, key in declared:
            if not name.isidentifier():
                raise self.error(f"{name!r} is not a name", section, key, remedy="use letters, digits and underscores")
            if name in WORDS or name in invariants or name == "pi" or keyword.iskeyword(name):
                raise self.error(f"the name {name!r} already means something", section, key, remedy="choose another")
            if names.count(name) > 1:
                _, section, key = next(last for last in reversed(declared) if last[0] == name)
                raise self.error(f"{name!r} is declared twice", section, key, remedy="give each force and parameter a name of its own")

    def ranges(self, forces: Sequence[str], pressure: str | None) -> Mapping[str, Domain]:
        found: dict[str, Domain] = {}
        for key, entry in self.table("domain", required=False).items():
            name = spelled(key)
            if not isinstance(entry, dict):
                raise self.error(f"the range of {name} is not a table", "domain", key, remedy=f"write {name} = {{ min = -100 }}")
            self.keys("domain", entry, ("min", "max"), inside=key)
            if name in found:
                raise self.error(f"{name!r} has two ranges, in two spellings", "domain", key, remedy="give it one")
            try:
                found[name] = Domain.between(entry.get("min"), entry.get("max"))
            except InputError as fault:
                raise self.error(f"{name}: {fault.what}", "domain", key, remedy=fault.remedy) from None
            if wrong := range_fault(name, found[name], forces, pressure):
                raise self.error(wrong[0], "domain", key, remedy=wrong[1])
        return found

    def domain(self, name: str, entry: Any) -> Domain:
        if not isinstance(entry, dict):
            number = isinstance(entry, (int, Decimal)) and not isinstance(entry, bool)
            remedy = f"write {name} = {{ value = {entry} }}" if number else f"write {name} = {{ positive = true }}"
            raise self.error(f"the domain of {name} is not a table", "parameters", name, remedy=remedy)
        self.keys("parameters", entry, _PARAMETER, inside=name)
        if ("value" in entry and len(entry) > 1) or ("positive" in entry and "min" in entry):
            mixed = " and ".join(entry)
            remedy = "use positive = true, or min and max, or value, or {} for every real number"
            raise self.error(f"the domain of {name} mixes {mixed}", "parameters", name, remedy=remedy)
        if entry.get("positive", True) is not True:
            raise self.error(f"positive of {name} is not true", "parameters", name, remedy="leave it out, or write positive = true")
        try:
            if "value" in entry:
                return Domain.fixed(entry["value"])
            high = Domain.between(None, entry.get("max")).high
            return Domain(POSITIVE.low, high, positive=True) if "positive" in entry else Domain.between(entry.get("min"), high)
        except InputError as fault:
            raise self.error(f"{name}: {fault.what}", "parameters", name, remedy=fault.remedy) from None

    def constraints(self, parameters: Mapping[str, sp.Symbol], define: Definitions) -> Relations:
        given = self.document["criterion"].get("constraints", [])
        if not (isinstance(given, list) and all(isinstance(c, str) for c in given)):
            raise self.error(
                "constraints is not a list of comparisons", "criterion", "constraints", remedy='write constraints = ["e < mu_b"]'
            )
        placed = [self.formula("criterion", "constraints", i) for i in range(len(given))]
        short = define.short
        found = [parse_relation(t, parameters, where=self.where, line=line, column=column, short=short) for t, line, column in placed]
        return tuple(found), tuple(written_out(t, short) for t, _, _ in placed)
