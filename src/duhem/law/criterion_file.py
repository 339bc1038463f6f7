"""Criterion files: TOML in, a frozen law out, every fault with its line and column; and a law written as such a file.

``g`` in [criterion] or several [[surface]] give a :class:`duhem.law.formula_law.Criterion`, [boundary] gives a
:class:`duhem.law.curve_law.ParametricCriterion`.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import MAX_EMAX, MIN_EMIN, Context, Decimal, Inexact
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import Any, TypeVar

import sympy as sp

from duhem.errors import InputError, faults_at, meant
from duhem.expression import WORDS, symbol
from duhem.expression.abbreviations import INVARIANTS, Abbreviations, Indexed, Stress, component
from duhem.expression.parse import parse_expression, parse_relation, written_out
from duhem.expression.syntax import PlacedText, spelled
from duhem.expression.text import faithful
from duhem.law.curve_law import ANGLE, Law, ParametricCriterion, closes
from duhem.law.domain import POSITIVE, Domain, range_fault
from duhem.law.formula_law import FORCES, PRESSURE, Criterion, Definitions, YieldSurface, declared_symbols, definitions, name_fault
from duhem.law.given import Relations
from duhem.law.learned import table_beside
from duhem.law.parameter_domain import check_domain
from duhem.law.placed_toml import Key, PlacedToml, document_text, parsed, text_of, toml
from duhem.law.state import Variable, Variables, misfits, variables_of

__all__ = ["MOST_BYTES", "SectionReader", "criterion_text", "expected_verdicts", "read", "reads"]

Declared = tuple[str, str, str]  # a name, and the section and key that declare it
T = TypeVar("T")
Slots = Sequence[tuple[str, str | None]]  # what each entry of a flow is the rate of, and the force of that


@dataclass(frozen=True)
class SectionReader(PlacedToml):
    """A document that says what stands where in it; InputError for what is missing or of another kind."""

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
            other = ", or a potential or forces_of_rates in the section [dissipation]" if path == ("criterion", "g") else ""
            if other and "rates" in self.document.get("dissipation", {}):
                other += ": the rates that are there come beside one of these"
            raise self.error(f"{header} has no {key}", *section, remedy=f'add {key} = "..."{other}')
        if not isinstance(given, str) or (required and not given.strip()):
            raise self.error(f"{key} is not a text" if given != "" else f"{key} is empty", *path, remedy=f'write {key} = "..."')
        return given

    def line(self, section: str, key: str, *, required: bool = True) -> str:
        """A text for people, as one printable line."""
        given = " ".join(self.string(section, key, required=required).split())
        if not given.isprintable() or len(given) > 500:
            raise self.error(f"{key} is not a printable line of at most 500 characters", section, key, remedy="shorten it")
        return given

    def alone(self, header: str, *others: str, inside: str = "criterion") -> None:
        """No ``others`` beside what stands for them: sections in brackets, and keys of the section ``inside``."""
        for other in others:
            section, key = ("", other[1:-1]) if other[0] == "[" else (inside, other)
            if key in (self.document[section] if section else self.document):
                raise self.error(f"{header} and {other} are both given", section, key, remedy="remove one of them")

    def entries(self, *path: Key, example: str, of: str = "expressions") -> list[tuple[Key, ...]]:
        """The places of the formulas in a list."""
        given = self.value(*path)
        if not (isinstance(given, list) and all(isinstance(c, str) for c in given)):
            raise self.error(f"{path[-1]} is not a list of {of}", *path, remedy=f"write {path[-1]} = {example}")
        return [(*path, i) for i in range(len(given))]

    def error(self, what: str, *path: Key, remedy: str) -> InputError:
        return InputError(what, where=self.place(*path), remedy=remedy)

    def place(self, *path: Key) -> str:
        """file:line:column of a key, or the file where the key is not found."""
        return super().place(*(key for key in path if key != ""))


MOST_BYTES = 1_000_000
_MOST = {
    ("criterion", "forces"): 100, ("criterion", "constraints"): 200, ("parameters",): 200, ("define",): 500, ("surface",): 200,
}  # fmt: skip
_SECTIONS: Mapping[str, Sequence[str]] = {  # with their keys; none where the file chooses them, or has a list of tables
    "criterion": ("name", "summary", "source", "forces", "stress", "pressure", "g", "potential", "constraints", "expect"),
    **dict.fromkeys(("define", "tables", "domain", "parameters", "variables"), ()),
    "energy": ("psi",), "flow": ("direction",), "surface": (), "boundary": ("angle", "T", "direction"),
    "dissipation": ("potential", "rates", "forces_of_rates"), "heat": ("bodies",),
    "atlas": ("equation", "claims", "verdicts", "regions", "note"),  # what is said of the law: nothing of it is part of the law
}  # fmt: skip
_PARAMETER = ("positive", "min", "max", "value")
_VARIABLE = ("force", "observable", "temperature")
_ZERO = re.compile(r"\s*0+(\.0*)?\s*")  # the rate of a variable that surfaces leave alone


def read(path: str | PathLike[str]) -> Law:
    """The law of a TOML file; InputError names file, line and column of whatever is wrong in it."""
    absent = "check the path, or make one with: duhem init NAME"
    return reads(text_of(path, "criterion file", MOST_BYTES, absent=absent), f"{path}", Path(path).parent)


def reads(text: str, where: str = "criterion", folder: Path | None = None) -> Law:
    """The law written in ``text``; ``where`` names it in messages, tables of numbers lie in ``folder``."""
    if not text.strip():
        raise InputError("the file is empty", where=where, remedy="start from the template: duhem init NAME")
    return _CriterionReader(**vars(parsed(text, where, number=Decimal)), folder=folder).law()


def expected_verdicts(path: str | PathLike[str]) -> Mapping[str, str]:
    """What a file expects of its law, formulas unread; nothing where the file is none."""
    try:
        toml = parsed(text_of(path, "criterion file", MOST_BYTES), f"{path}", number=Decimal)
        return _CriterionReader(**vars(toml)).expected()
    except InputError:
        return {}


@dataclass(frozen=True)
class _CriterionReader(SectionReader):
    """From the document of a criterion file, in a ``folder``, to the law; stops at the first fault."""

    folder: Path | None = None

    def law(self) -> Law:
        self.keys("", self.document, [*_SECTIONS])
        for section, allowed in _SECTIONS.items():
            if allowed:
                self.keys(section, self.table(section, required=section == "criterion"), allowed)
        self.check_sizes()
        self.line("criterion", "name")  # a file without a name is told so first
        stress = self.stress()
        forces = self.names() if stress is None else list(stress.components)
        pressure = self.pressure()
        given = self.table("parameters", required=False)
        variables, bodies = self.variables(forces), self.bodies()
        domains = {spelled(p): self.domain(p, entry) for p, entry in given.items()}
        declared = [(f, "criterion", "forces") for f in forces] + ([(pressure, "criterion", "pressure")] if pressure else [])
        declared += [(name, "variables", name) for name in variables] + [(spelled(name), "heat", "bodies") for name in bodies]
        declared += [(spelled(p), "parameters", p) for p in given]
        domains = {name: own.domain for name, own in variables.items()} | dict.fromkeys(map(spelled, bodies), POSITIVE) | domains
        self.check_names(declared, Abbreviations(stress=stress).words())
        dissipation = self.table("dissipation", required=False)
        if "dissipation" in self.document and not dissipation:
            remedy = "write potential, rates or forces_of_rates in it, or remove the section"
            raise self.error("[dissipation] says nothing", "dissipation", remedy=remedy)
        rates = variables.rates(forces).values() if (of_rates := "forces_of_rates" in dissipation) else ()
        if "boundary" in self.document:
            other = ("g", "potential", "stress", "[flow]", "[surface]", "[domain]", "[energy]", "[variables]", "[heat]")
            self.alone("[boundary]", *other)
            return self.curve(forces, pressure, domains, declared)
        loads = [*forces, pressure] if pressure else forces
        define = definitions(self.placed[1], declared_symbols([*loads, *rates], pressure, domains), stress)
        viscous = "potential" in dissipation
        if viscous or of_rates:
            own = f"the {'potential' if viscous else 'forces_of_rates'} of [dissipation]"
            self.alone(own, "g", "potential", "[flow]", "[surface]")
        slots = variables.slots(forces)
        surfaces = self.surfaces(forces, slots)
        whole = YieldSurface(sp.nan) if surfaces or of_rates else self.whole(forces, slots)
        head = self.head(forces, pressure, domains, define) | self.state(variables, slots) | {"viscous": viscous}
        domain = self.ranges(forces, pressure)
        try:
            law = Criterion(**head, **vars(whole), stress=stress, define=define, domain=domain, surfaces=surfaces)
        except InputError as fault:
            where = fault.where if fault.where.startswith(f"{self.where}:") else self.where
            raise InputError(fault.what, where=where, remedy=fault.remedy) from None
        check_domain(law, where=self.place("criterion", "constraints"))
        return law

    def head(self, forces: Sequence[str], pressure: str | None, domains: Mapping[str, Domain], define: Definitions) -> dict[str, Any]:
        """What a law of either kind has."""
        constraints, texts = self.constraints({p: domain.symbol(p) for p, domain in domains.items()}, define, (*forces, pressure))
        said: dict[str, Any] = {key: self.line("criterion", key, required=key == "name") for key in ("name", "summary", "source")}
        said |= {"parameters": domains, "forces": tuple(forces), "pressure": pressure, "expect": self.expected()}
        return said | {"constraints": constraints, "written_constraints": texts}

    def curve(self, forces: Sequence[str], pressure: str | None, domains: Mapping[str, Domain], declared: Sequence[Declared]) -> Law:
        """A law given by its boundary, in an angle and the parameters."""
        angle = spelled(self.line("boundary", "angle", required=False) or ANGLE)
        self.check_names([*declared, (angle, "boundary", "angle")], frozenset())
        if pressure is None or len(forces) != 2:
            raise self.error("a boundary curve takes two forces and a pressure", "boundary", remedy="declare them, or write g instead")
        known = {angle: symbol(angle)} | {p: domain.symbol(p) for p, domain in domains.items()}
        define = definitions(self.placed[1], known, None)
        boundary = self.components("T", known[angle], known, define.short)
        flow = self.components("direction", known[angle], known, define.short) if "direction" in self.table("boundary") else None
        law = ParametricCriterion(**self.head(forces, pressure, domains, define), boundary=boundary, angle=angle, flow=flow)
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
            remedy = "remove forces: the components of the stress are the forces"
            raise self.error("forces and stress are both declared", "criterion", "stress", remedy=remedy)
        if not (isinstance(given, dict) and {*given} == {"name", "kind"} and all(isinstance(x, str) for x in given.values())):
            raise self.error("stress is not a table of name and kind", "criterion", "stress", remedy=example)
        with faults_at(self.place("criterion", "stress")):
            return Stress(**given)

    def expected(self) -> Mapping[str, str]:
        """The verdicts by claim that are no failure."""
        given = self.table("criterion").get("expect", {})
        if not (isinstance(given, dict) and all(isinstance(verdict, str) for verdict in given.values())):
            what = "expect is not a table of claims and verdicts"
            raise self.error(what, "criterion", "expect", remedy='write expect = { smoothness = "refuted" }')
        return given

    def variables(self, forces: Sequence[str]) -> Variables:
        """The variables of the state, each with its force and the range of its admissible values."""
        found = {}
        for key, entry in self.table("variables", required=False).items():
            if not isinstance(entry, dict):
                raise self.error(f"{key} is not a table", "variables", key, remedy=f'write {key} = {{ force = "sigma" }}')
            domain = self.domain(key, entry, "variables", (*_VARIABLE, *_PARAMETER))
            if not isinstance(entry.get("force", ""), str):
                raise self.error(f"force of {key} is no name", "variables", key, remedy='write force = "sigma"')
            force = spelled(entry["force"]) if "force" in entry else None
            found[spelled(key)] = Variable(force, "observable" in entry, "temperature" in entry, domain)
        variables = Variables(found)
        for name, what, remedy in misfits(variables, forces, "energy" in self.document):
            raise self.error(what, "variables", name, remedy=remedy)
        return variables

    def bodies(self) -> Mapping[str, Any]:
        """The temperatures of bodies that exchange heat, each with its conductance."""
        given = self.table("heat", required=False).get("bodies", {})
        if not isinstance(given, dict) or ("heat" in self.document and not given):
            raise self.error("[heat] has no table of bodies", "heat", "bodies", remedy='write bodies = { T1 = "h1", T2 = "h2" }')
        return given

    def state(self, variables: Variables, slots: Slots) -> dict[str, Any]:
        """The energy, and the rates of internal variables that have no force or need no multiplier."""
        given = self.table("dissipation", required=False)
        functions = {"rates": "alpha", "forces_of_rates": "sigma"}
        for key, name in functions.items():
            if not isinstance(given.get(key, {}), dict):
                raise self.error(f"{key} is not a table", "dissipation", key, remedy=f'write {key} = {{ {name} = "..." }}')
        energy = self.formula("energy", "psi") if "energy" in self.document else None
        said = {key: {spelled(name): self.formula("dissipation", key, name) for name in given.get(key, {})} for key in functions}
        flow = "flow" in self.document
        unforced = {name: self.formula("flow", "direction", i) for i, (name, force) in enumerate(slots) if force is None and flow}
        heat = {spelled(name): self.formula("heat", "bodies", name) for name in self.bodies()}
        return {"variables": variables, "energy": energy, "unforced": unforced, "heat": heat, **said}

    @cached_property
    def placed(self) -> tuple[Indexed, Mapping[str, PlacedText]]:
        """What may be written with an index, and the definitions, a vector part by part."""
        known, found = self.tables(), dict[str, PlacedText]()
        for key, given in self.table("define", required=False).items():
            if isinstance(given, list):
                entries, alike = self.entries("define", key, example='["sigma_a", "sigma_b"]'), False
                formulas = [self.over(*entry, change=known.written_over) for entry in entries]
            else:
                parts = self.over("define", key, change=known.parts)
                alike = bool(parts)
                formulas = parts or [self.over("define", key, change=known.written_over)]
            if vector := alike or isinstance(given, list):
                known = replace(known, vectors={**known.vectors, spelled(key): len(formulas)})
            for i, text in enumerate(formulas):
                name = component(spelled(key), i + 1) if vector else key
                if name in found:
                    raise self.error(f"{name!r} is declared twice", "define", key, remedy="give each definition a name of its own")
                found[name] = PlacedText(text, self.where, text.line, text.column, self.place("define", key), text.made, alike and i > 0)
        return known, found

    def tables(self) -> Indexed:
        """The tables of numbers, and the names that no index may have."""
        head, given, files = self.document["criterion"], self.table("define", required=False), self.table("tables", required=False)
        words = {*WORDS, *INVARIANTS, "pi", *map(spelled, given)}
        for name, file in files.items():
            if not isinstance(file, str) or not name.isidentifier() or spelled(name) in words:
                raise self.error(f"{name[:40]!r} names no table", "tables", name, remedy='write w = "weights.csv", with a name of its own')
        read = {spelled(name): table_beside(self.folder, file, self.place("tables", name)) for name, file in files.items()}
        named = [*self.table("parameters", required=False), *self.table("variables", required=False), head.get("pressure", PRESSURE)]
        forces = head.get("forces", FORCES) if (stress := self.stress()) is None else stress.components
        return Indexed(read, {}, frozenset({*words, *filter(lambda x: isinstance(x, str), [*named, *forces])}))

    def over(self, *path: Key, change: Callable[[PlacedText], T]) -> T:
        """What is made of the text of a formula; a fault lies where that begins.

        The text is taken as written in the file, so that the columns are the file's; a formula has no use for escapes.
        """
        value = self.value(*path) if isinstance(path[-1], int) else self.string(*path)
        written, line, column = self.written(*path) or (value, 1, 0)
        text = PlacedText(value if "\\" in written else written, self.where, line, column, self.place(*path))
        with faults_at(f"{self.where}:{line}:{column + 1}", unless_placed=True):
            return change(text)

    def formula(self, *path: Key) -> PlacedText:
        """A formula without indices."""
        return self.over(*path, change=self.placed[0].written_over)

    def pressure(self) -> str | None:
        given = self.document["criterion"].get("pressure", PRESSURE)
        if given is False:
            return None
        if not isinstance(given, str) or not given:
            raise self.error("pressure is not a name", "criterion", "pressure", remedy='write pressure = "sigma_n", or pressure = false')
        return str(spelled(given))

    def check_names(self, declared: Sequence[Declared], invariants: frozenset[str]) -> None:
        """Every name, with the section and key that declare it, is one, and is free."""
        names = [name for name, _, _ in declared]
        for name in names:
            if fault := name_fault(name, names, "force and parameter", invariants):
                places = [(section, key) for other, section, key in declared if other == name]
                raise self.error(fault[0], *places[-1 if fault[0].endswith("twice") else 0], remedy=fault[1])

    def ranges(self, forces: Sequence[str], pressure: str | None) -> Mapping[str, Domain]:
        found: dict[str, Domain] = {}
        for key, entry in self.table("domain", required=False).items():
            name = spelled(key)
            if name in found:
                raise self.error(f"{name!r} has two ranges, in two spellings", "domain", key, remedy="give it one")
            found[name] = self.domain(key, entry, "domain", ("min", "max"))
            if wrong := range_fault(name, found[name], forces, pressure):
                raise self.error(wrong[0], "domain", key, remedy=wrong[1])
        return found

    def domain(self, name: str, entry: Any, section: str = "parameters", allowed: Sequence[str] = _PARAMETER) -> Domain:
        if not isinstance(entry, dict):
            number = isinstance(entry, (int, Decimal)) and not isinstance(entry, bool) and "value" in allowed
            meant = f"value = {entry}" if number else "positive = true" if "positive" in allowed else "min = -100"
            raise self.error(f"the domain of {name} is not a table", section, name, remedy=f"write {name} = {{ {meant} }}")
        self.keys(section, entry, allowed, inside=name)
        said = [key for key in entry if key in _PARAMETER]
        if ("value" in entry and len(said) > 1) or ("positive" in entry and "min" in entry):
            mixed = " and ".join(said)
            remedy = "use positive = true, or min and max, or value, or {} for every real number"
            raise self.error(f"the domain of {name} mixes {mixed}", section, name, remedy=remedy)
        for kind in ("positive", "observable", "temperature"):
            if entry.get(kind, True) is not True:
                raise self.error(f"{kind} of {name} is not true", section, name, remedy=f"remove it, or write {kind} = true")
        try:
            if "value" in entry:
                return Domain.fixed(entry["value"])
            high = Domain.between(None, entry.get("max")).high
            return Domain(POSITIVE.low, high, positive=True) if "positive" in entry else Domain.between(entry.get("min"), high)
        except InputError as fault:
            raise self.error(f"{name}: {fault.what}", section, name, remedy=fault.remedy) from None

    def constraints(self, parameters: Mapping[str, sp.Symbol], define: Definitions, loads: Sequence[str | None]) -> Relations:
        at = ("criterion", "constraints")
        entries = self.entries(*at, example='["e < mu_b"]', of="comparisons") if at[1] in self.document[at[0]] else []
        placed = [self.formula(*entry) for entry in entries]
        for text in placed:
            for name in (name for name in re.finditer(r"\w+", text) if name[0] in loads):
                remedy = "constraints relate parameters only; a range of a force or of the pressure belongs in the section [domain]"
                where = f"{self.where}:{text.line}:{text.column + name.start() + 1}"
                raise InputError(f"a constraint depends on {name[0]}, which is no parameter", where=where, remedy=remedy)
        found = [parse_relation(text, parameters, short=define.short) for text in placed]
        return tuple(found), tuple(written_out(text, define.short) for text in placed)

    # -- what bounds K, and the slip there ----------------------------------------------------------------------

    def whole(self, forces: Sequence[str], slots: Slots) -> YieldSurface:
        """The one surface of a law without [[surface]]: g and potential in [criterion], or [flow]; or the potential of [dissipation]."""
        if "potential" in self.table("dissipation", required=False):
            return YieldSurface(self.formula("dissipation", "potential"))
        flow = ("flow", "direction") if "flow" in self.document else ()
        if flow and "direction" not in self.table("flow"):
            raise self.error("[flow] has no direction", "flow", remedy=f"write direction = {toml(forces)}")
        return self.surface(("criterion",), flow, "[flow]", forces, slots)

    def surfaces(self, forces: Sequence[str], slots: Slots) -> tuple[YieldSurface, ...]:
        """Those of [[surface]], in order; none where there is no such section."""
        given = self.document.get("surface", [])
        if not (isinstance(given, list) and all(isinstance(entry, dict) for entry in given)):
            raise self.error("surface is no list of tables", "surface", remedy="write [[surface]] above each of them")
        if given:
            self.alone("[[surface]]", "g", "potential", "[flow]")
        for i, entry in enumerate(given):
            self.keys("surface", entry, ("g", "flow", "potential"), at=("surface", i))
        flows = [("surface", i, "flow") if "flow" in entry else () for i, entry in enumerate(given)]
        return tuple(self.surface(("surface", i), flow, "flow", forces, slots) for i, flow in enumerate(flows))

    def surface(self, section: tuple[Key, ...], flow: tuple[Key, ...], flow_name: str, forces: Sequence[str], slots: Slots) -> YieldSurface:
        """The g and potential of a section with the flow at a place, if it has one; the law reads them."""
        g: Any = self.formula(*section, "g")
        if "potential" in self.value(*section):
            at = (*section, "potential")
            if flow:
                raise self.error(f"{flow_name} and potential are both given", *at, remedy="remove one of them")
            return YieldSurface(g, potential=self.formula(*at))
        if not flow:
            return YieldSurface(g)
        entries = self.entries(*flow, example=toml(forces))
        if len(entries) != len(slots):
            remedy = f"give one expression for each of {', '.join(name for name, _ in slots)}"
            counts = f"{len(entries)} components for {len(slots)} {'rates' if 'variables' in self.document else 'forces'}"
            raise self.error(f"the flow direction has {counts}", *flow, remedy=remedy)
        texts = {force: self.formula(*entry) for (_, force), entry in zip(slots, entries, strict=True) if force is not None}
        for (name, force), entry in zip(slots, entries, strict=True):
            if force is None and section[0] == "surface" and not _ZERO.fullmatch(self.formula(*entry)):
                remedy = 'write "0" here: of a law with several surfaces no rate of it is kept'
                raise self.error(f"{name} has no force, and a rate that belongs to a surface", *entry, remedy=remedy)
        return YieldSurface(g, tuple(texts[force] for force in forces))

    def components(self, key: str, angle: sp.Symbol, known: Mapping[str, sp.Symbol], short: Abbreviations) -> Any:
        """The texts of two components in [boundary]; they close because the angle enters by its cosine and sine only."""
        example = f'["cos({angle})", "sin({angle})"]'
        if key not in self.table("boundary"):
            raise self.error(f"[boundary] has no {key}", "boundary", remedy=f"add {key} = {example}")
        entries = self.entries("boundary", key, example=example)
        if len(entries) != 2:
            raise self.error(f"{key} has {len(entries)} components for 2 forces", "boundary", key, remedy=f"write {key} = {example}")
        texts = [self.formula(*entry) for entry in entries]
        for entry, text in zip(entries, texts, strict=True):
            if not closes(parse_expression(text, known, short=short), angle):
                remedy = f"write it in cos({angle}) and sin({angle}), multiples of the angle expanded"
                raise self.error(f"{key} uses {angle} otherwise than as cos({angle}) and sin({angle})", *entry, remedy=remedy)
        return tuple(written_out(text, short) for text in texts)


# -- a law written down -----------------------------------------------------------------------------------------------


def criterion_text(law: Law) -> str:
    """The law in TOML: formula, surfaces or boundary curve, parameters with exact values or domains, constraints, flow, state.

    InputError for a value or an end of a domain that is no finite decimal.
    """
    head: dict[str, Any] = {"name": law.name, "summary": law.summary or None, "source": law.source or None, "forces": law.forces}
    head["pressure"] = law.pressure or False
    constraints = {"constraints": _texts(law, law.constraints or None)}
    if isinstance(law, ParametricCriterion):
        boundary = {"angle": law.angle, "T": _texts(law, law.boundary), "direction": _texts(law, law.flow)}
        return document_text({"criterion": head | constraints, "parameters": _domains(law, law.parameters), "boundary": boundary})
    if not (law.surfaces or law.viscous or law.forces_of_rates):
        head |= {"g": law.graph.last if law.graph else _text(law, law.g), "potential": law.potential}
    if fixed := [name for name in law.heat if law.parameters[name] != POSITIVE]:
        what = f"no file states the temperature {fixed[0]} of a body"
        raise InputError(what, where=law.name, remedy="fix it with --set where the file is used")
    domains = _domains(law, law.parameters)
    slips = dict(zip(law.forces, law.flow or (), strict=False)) if law.potential is None else {}
    flow = [slips[force] if force in slips else law.unforced.get(name, sp.S.Zero) for name, force in variables_of(law).slots(law.forces)]
    rates = {key: _named(law, getattr(law, key)) or None for key in ("rates", "forces_of_rates")}
    sections = {
        "criterion": head | constraints,
        "define": dict(law.graph.nodes) if law.graph else None,
        "parameters": {name: own for name, own in domains.items() if name not in (*law.variables, *law.heat)},
        "domain": _domains(law, law.domain) or None,
        "flow": {"direction": _texts(law, flow)} if slips else None,
        "variables": {name: _kind(own) | domains[name] for name, own in law.variables.items()} or None,
        "energy": None if law.energy is None else {"psi": _text(law, law.energy)},
        "dissipation": {"potential": _text(law, law.g) if law.viscous else None, **rates} if law.viscous or any(rates.values()) else None,
        "heat": {"bodies": _named(law, law.heat)} if law.heat else None,
        "surface": [
            {"g": _text(law, own.g), "potential": own.potential, "flow": _texts(law, own.flow if own.potential is None else None)}
            for own in law.surfaces
        ],
    }
    return document_text({name: content for name, content in sections.items() if content is not None})


def _kind(own: Variable) -> dict[str, Any]:
    return {"observable": own.observable or None, "temperature": own.temperature or None, "force": own.force}


def _named(law: Law, formulas: Mapping[str, sp.Expr]) -> dict[str, str]:
    return {name: _text(law, x) for name, x in formulas.items()}


def _texts(law: Law, formulas: Sequence[sp.Basic] | None) -> list[str] | None:
    return None if formulas is None else [_text(law, x) for x in formulas]


def _text(law: Law, expr: sp.Basic) -> str:
    return faithful(expr, tuple(law.symbols().values()))


def _domains(law: Law, domains: Mapping[str, Domain]) -> dict[str, dict[str, Any]]:
    return {name: _domain(own, f"{law.name}: {name}") for name, own in domains.items()}


def _domain(own: Domain, where: str) -> dict[str, Any]:
    if own.value is not None:
        return {"value": _decimal(own.value, where)}
    low = None if own.positive else own.low
    return {"positive": own.positive or None, "min": _decimal(low, where), "max": _decimal(own.high, where)}


def _decimal(x: sp.Rational | None, where: str) -> Decimal | None:
    """``x`` in full, if there is one."""
    if x is None:
        return None
    exact = Context(int(x.p).bit_length() + int(x.q).bit_length() + 1, Emin=MIN_EMIN, Emax=MAX_EMAX, traps=[Inexact])
    try:
        return exact.divide(Decimal(int(x.p)), Decimal(int(x.q)))
    except Inexact:
        raise InputError(f"{x} is no finite decimal", where=where, remedy="give it as a decimal, such as 0.333333") from None
