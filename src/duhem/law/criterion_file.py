"""Criterion files: TOML in, a frozen law out, every fault with its line and column.

``g`` in [criterion] or several [[surface]] give a :class:`duhem.law.formula_law.Criterion`, [boundary] gives a
:class:`duhem.law.curve_law.ParametricCriterion`.
"""

from __future__ import annotations

import keyword
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from os import PathLike
from typing import Any

import sympy as sp
from sympy.core.relational import Relational

from duhem.errors import InputError
from duhem.expression import WORDS, symbol
from duhem.expression.abbreviations import Abbreviations
from duhem.expression.gradient import gradient
from duhem.expression.invariants import Stress
from duhem.expression.parse import parse_expression, parse_relation, written_out
from duhem.law.curve_law import ANGLE, Law, ParametricCriterion, closes
from duhem.law.definitions import Definitions, PlacedFormula, definitions
from duhem.law.domain import POSITIVE, Domain, range_fault
from duhem.law.formula_law import FORCES, PRESSURE, Criterion
from duhem.law.parameter_domain import check_domain
from duhem.law.placed_toml import Key, PlacedToml, meant, parsed, text_of
from duhem.law.yield_surface import YieldSurface

__all__ = ["read", "reads"]

MOST_BYTES = 1_000_000
_CRITERION = ("name", "summary", "source", "forces", "stress", "pressure", "g", "potential", "constraints")
_PARAMETER = ("positive", "min", "max", "value")


def read(path: str | PathLike[str]) -> Law:
    """The law of a TOML file; InputError names file, line and column of whatever is wrong in it."""
    absent = "check the path, or make one with: duhem init NAME"
    return reads(text_of(path, "criterion file", MOST_BYTES, absent=absent), where=f"{path}")


def reads(text: str, where: str = "criterion") -> Law:
    """The law written in ``text``; ``where`` names it in messages."""
    if not text.strip():
        raise InputError("the file is empty", where=where, remedy="start from the template: duhem init NAME")
    return _CriterionReader(parsed(text, where, number=Decimal)).law()


@dataclass(frozen=True)
class _CriterionReader:
    """From the document of a criterion file to the law; stops at the first fault."""

    toml: PlacedToml

    @property
    def where(self) -> str:
        return self.toml.where

    @property
    def document(self) -> Mapping[str, Any]:
        return self.toml.document

    def law(self) -> Law:
        self.keys("", self.document, ("criterion", "define", "domain", "parameters", "flow", "surface", "boundary"))
        head = self.table("criterion")
        self.keys("criterion", head, _CRITERION)
        name = self.line("criterion", "name")
        stress = self.stress()
        forces = self.names() if stress is None else list(stress.components)
        pressure = self.pressure()
        domains = {p: self.domain(p, entry) for p, entry in self.table("parameters", required=False).items()}
        declared = [(f, "criterion", "forces") for f in forces] + ([(pressure, "criterion", "pressure")] if pressure else [])
        declared += [(p, "parameters", p) for p in domains]
        self.check_names(declared, Abbreviations(stress=stress).words())
        parameters = {p: domain.symbol(p) for p, domain in domains.items()}
        known = {f: symbol(f) for f in forces} | ({pressure: symbol(pressure, nonpositive=True)} if pressure else {}) | parameters
        if "boundary" in self.document:
            self.alone("boundary", "criterion", "g", "potential", "stress")
            self.alone("boundary", "", "flow", "surface", "domain")
            return self.curve(forces, pressure, domains, declared)
        define = self.definitions(known, stress)
        surfaces = self.surfaces(forces, known, define)
        g, written = (sp.nan, "") if surfaces else self.bound(forces, known, define, "criterion")
        constraints = self.constraints(parameters, define)
        domain = self.ranges(forces, pressure)
        flow, potential = self.flow(forces, known, define), self.potential(forces, known, define, "criterion")
        try:
            law = Criterion(
                name=name,
                g=g,
                parameters=domains,
                forces=tuple(forces),
                pressure=pressure,
                constraints=constraints,
                flow=flow,
                summary=self.line("criterion", "summary", required=False),
                source=self.line("criterion", "source", required=False),
                written=written,
                written_flow=self.written_flow(define),
                stress=stress,
                define=define,
                potential=potential,
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
        angle = self.line("boundary", "angle", required=False) or ANGLE
        self.check_names([*declared, (angle, "boundary", "angle")], frozenset())
        if pressure is None or len(forces) != 2:
            raise self.error("a boundary curve takes two forces and a pressure", "boundary", remedy="declare them, or write g instead")
        parameters = {p: domain.symbol(p) for p, domain in domains.items()}
        known = {angle: symbol(angle), **parameters}
        define = self.definitions(known, None)
        law = ParametricCriterion(
            name=self.line("criterion", "name"),
            boundary=self.pair("T", angle, known, define),
            parameters=domains,
            forces=tuple(forces),
            pressure=pressure,
            angle=angle,
            constraints=self.constraints(parameters, define),
            flow=self.pair("direction", angle, known, define) if "direction" in self.table("boundary") else None,
            summary=self.line("criterion", "summary", required=False),
            source=self.line("criterion", "source", required=False),
        )
        check_domain(law, where=self.place("criterion", "constraints"))
        return law

    # -- the parts ---------------------------------------------------------------------------------------------

    def alone(self, section: str, inside: str, *others: str) -> None:
        """No ``others`` beside a section that stands for them."""
        for key in others:
            if key in (self.document[inside] if inside else self.document):
                header = f"[[{section}]]" if section == "surface" else f"[{section}]"
                what = f"{header} and {key if inside else f'[{key}]'} are both given"
                raise self.error(what, inside, key, remedy="leave one of them out")

    def surfaces(self, forces: Sequence[str], known: Mapping[str, sp.Symbol], define: Definitions) -> tuple[YieldSurface, ...]:
        given = self.document.get("surface", [])
        if not (isinstance(given, list) and all(isinstance(entry, dict) for entry in given)):
            raise self.error("surface is no list of tables", "", "surface", remedy="write [[surface]] above each of them")
        if given:
            self.alone("surface", "criterion", "g", "potential")
            self.alone("surface", "", "flow")
        read = []
        for i, entry in enumerate(given):
            self.keys("surface", entry, ("g", "flow", "potential"), at=("surface", i))
            g, written = self.bound(forces, known, define, "surface", i)
            flow, potential = None, self.potential(forces, known, define, "surface", i)
            if "flow" in entry:
                if potential is not None:
                    raise self.error("flow and potential are both given", "surface", i, "potential", remedy="leave one of them out")
                flow = self.direction(forces, known, define, "surface", i, "flow")
            read.append(YieldSurface(g, flow, potential, written))
        return tuple(read)

    def bound(self, forces: Sequence[str], known: Mapping[str, sp.Symbol], define: Definitions, *section: Key) -> tuple[sp.Expr, str]:
        """The ``g`` of a section, and as it was given with all written out."""
        g = self.expression(*section, "g", known=known, define=define)
        if not g.free_symbols & {known[f] for f in forces}:
            raise self.error("g does not depend on any force", *section, "g", remedy=f"use at least one of {', '.join(forces)}")
        return g, written_out(self.formula(*section, "g", value=self.string(*section, "g"))[0], define.short)

    def pair(self, key: str, angle: str, known: Mapping[str, sp.Symbol], define: Definitions) -> tuple[sp.Expr, sp.Expr]:
        """The two components of a curve, in its angle."""
        given = self.table("boundary").get(key)
        if not (isinstance(given, list) and len(given) == 2 and all(isinstance(c, str) for c in given)):
            remedy = f'write {key} = ["cos({angle})", "sin({angle})"]'
            raise self.error(f"{key} is not a pair of expressions", "boundary", *([key] if given is not None else []), remedy=remedy)
        one, two = (self.curve_component(key, i, angle, known, define) for i in range(2))
        return one, two

    def curve_component(self, key: str, i: int, angle: str, known: Mapping[str, sp.Symbol], define: Definitions) -> sp.Expr:
        text, line, column = self.formula("boundary", key, i, value=self.value("boundary", key, i))
        expr = parse_expression(text, known, where=self.where, line=line, column=column, short=define.short)
        if not closes(expr, known[angle]):
            remedy = f"write it in cos({angle}) and sin({angle}), multiples of the angle expanded"
            raise self.error(f"{key} uses {angle} otherwise than as cos({angle}) and sin({angle})", "boundary", key, i, remedy=remedy)
        return expr

    def names(self) -> list[str]:
        given = self.document["criterion"].get("forces", list(FORCES))
        if not (isinstance(given, list) and given and all(isinstance(f, str) for f in given)):
            raise self.error("forces is not a list of names", "criterion", "forces", remedy='write forces = ["sigma_a", "sigma_b"]')
        return given

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

    def definitions(self, known: Mapping[str, sp.Symbol], stress: Stress | None) -> Definitions:
        placed = {}
        for name in self.table("define", required=False):
            text, line, column = self.formula("define", name, value=self.string("define", name))
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
        return given

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
        found = {}
        for name, entry in self.table("domain", required=False).items():
            if not isinstance(entry, dict):
                raise self.error(f"the range of {name} is not a table", "domain", name, remedy=f"write {name} = {{ min = -100 }}")
            self.keys("domain", entry, ("min", "max"), inside=name)
            try:
                found[name] = Domain.between(entry.get("min"), entry.get("max"))
            except InputError as fault:
                raise self.error(f"{name}: {fault.what}", "domain", name, remedy=fault.remedy) from None
            if wrong := range_fault(name, found[name], forces, pressure):
                raise self.error(wrong[0], "domain", name, remedy=wrong[1])
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

    def constraints(self, parameters: Mapping[str, sp.Symbol], define: Definitions) -> tuple[Relational, ...]:
        given = self.document["criterion"].get("constraints", [])
        if not (isinstance(given, list) and all(isinstance(c, str) for c in given)):
            raise self.error(
                "constraints is not a list of comparisons", "criterion", "constraints", remedy='write constraints = ["e < mu_b"]'
            )
        placed = [self.formula("criterion", "constraints", i, value=value) for i, value in enumerate(given)]
        short = define.short
        return tuple(parse_relation(t, parameters, where=self.where, line=line, column=column, short=short) for t, line, column in placed)

    def flow(self, forces: Sequence[str], known: Mapping[str, sp.Symbol], define: Definitions) -> tuple[sp.Expr, ...] | None:
        if "flow" not in self.document:
            return None
        self.keys("flow", self.table("flow"), ("direction",))
        if "direction" not in self.document["flow"]:
            example = ", ".join(f'"{f}"' for f in forces)
            raise self.error("[flow] has no direction", "", "flow", remedy=f"write direction = [{example}]")
        return self.direction(forces, known, define, "flow", "direction")

    def direction(self, forces: Sequence[str], known: Mapping[str, sp.Symbol], define: Definitions, *path: Key) -> tuple[sp.Expr, ...]:
        """A list of expressions, one for each force."""
        given, example, short = self.value(*path), ", ".join(f'"{f}"' for f in forces), define.short
        if not (isinstance(given, list) and all(isinstance(c, str) for c in given)):
            raise self.error(f"{path[-1]} is not a list of expressions", *path, remedy=f"write {path[-1]} = [{example}]")
        if len(given) != len(forces):
            counts = f"{len(given)} components for {len(forces)} forces"
            raise self.error(f"the flow direction has {counts}", *path, remedy=f"give one expression for each of {', '.join(forces)}")
        placed = [self.formula(*path, i, value=value) for i, value in enumerate(given)]
        return tuple(parse_expression(t, known, where=self.where, line=line, column=column, short=short) for t, line, column in placed)

    def potential(self, forces: Sequence[str], known: Mapping[str, sp.Symbol], define: Definitions, *section: Key) -> str | None:
        if "potential" not in self.value(*section):
            return None
        if "flow" in self.document:
            raise self.error("[flow] and potential are both given", *section, "potential", remedy="leave one of them out")
        value = self.expression(*section, "potential", known=known, define=define)
        try:
            flow = gradient(value, [known[f] for f in forces])
        except InputError as fault:
            raise self.error(fault.what, *section, "potential", remedy=fault.remedy) from None
        if not any(flow):
            remedy = f"use at least one of {', '.join(forces)}"
            raise self.error("the potential does not depend on any force", *section, "potential", remedy=remedy)
        return written_out(self.formula(*section, "potential", value=self.string(*section, "potential"))[0], define.short)

    def expression(self, *path: Key, known: Mapping[str, sp.Symbol], define: Definitions) -> sp.Expr:
        text, line, column = self.formula(*path, value=self.string(*path))
        return parse_expression(text, known, where=self.where, line=line, column=column, short=define.short)

    # -- tables and values -------------------------------------------------------------------------------------

    def table(self, section: str, *, required: bool = True) -> Mapping[str, Any]:
        given = self.document.get(section)
        if given is None and required:
            raise InputError(f"there is no [{section}]", where=self.where, remedy="start from the template: duhem init NAME")
        if given is not None and not isinstance(given, dict):
            raise self.error(f"{section} is not a table", "", section, remedy=f"write [{section}] on a line of its own")
        return given or {}

    def keys(self, section: str, given: Mapping[str, Any], allowed: Sequence[str], inside: str = "", at: tuple[Key, ...] = ()) -> None:
        for key in given:
            if key not in allowed:
                what = f"unknown {'key' if section else 'section'} {key[:40]!r}" + (f" of {inside}" if inside else "")
                raise self.error(what, *(at or (section,)), inside or key, remedy=meant(key, allowed))

    def value(self, *path: Key) -> Any:
        """What stands at a place that is known to be there."""
        found: Any = self.document
        for key in path:
            found = found[key]
        return found

    def string(self, *path: Key, required: bool = True) -> str:
        *section, key = path
        given = self.value(*section).get(key, None if required else "")
        if given is None:
            header = f"[[{section[0]}]]" if len(section) > 1 else f"[{section[0]}]"
            raise self.error(f"{header} has no {key}", *section, remedy=f'add {key} = "..."')
        if not isinstance(given, str) or (required and not given.strip()):
            raise self.error(f"{key} is not a text" if given != "" else f"{key} is empty", *path, remedy=f'write {key} = "..."')
        return given

    def line(self, section: str, key: str, *, required: bool = True) -> str:
        """A text for people, as one printable line."""
        given = " ".join(self.string(section, key, required=required).split())
        if not given.isprintable() or len(given) > 500:
            raise self.error(f"{key} is not a printable line of at most 500 characters", section, key, remedy="shorten it")
        return given

    # -- places ------------------------------------------------------------------------------------------------

    def error(self, what: str, *path: Key, remedy: str) -> InputError:
        return InputError(what, where=self.place(*path), remedy=remedy)

    def place(self, *path: Key) -> str:
        """file:line:column of a key, or the file where the key is not found."""
        return self.toml.place(*(key for key in path if key != ""))

    def formula(self, *path: Key, value: str) -> tuple[str, int, int]:
        """A formula with the line (from 1) and column (from 0) at which it begins.

        The text is taken as written in the file, so that the columns are the file's; a formula has no use for escapes.
        """
        written, line, column = self.toml.written(*path) or (value, 1, 0)
        return (value if "\\" in written else written), line, column
