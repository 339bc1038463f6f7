"""Scenes from TOML: the keys of :mod:`duhem.path.scene_keys` read, and every mistake listed with its place."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Mapping, Sequence
from difflib import get_close_matches
from pathlib import Path as File
from typing import Any

import numpy as np

from duhem.errors import InputError
from duhem.expression.spelling import spelled
from duhem.law.catalogue import load_formula, load_named
from duhem.law.formula_law import Criterion
from duhem.law.placed_toml import PlacedToml, meant, parsed, text_of
from duhem.path.batch import Batch
from duhem.path.integrators import INTEGRATORS
from duhem.path.loading import Path
from duhem.path.paths import Paths, paths_from_csv, spread
from duhem.path.run import Plan, Run
from duhem.path.scene import Scene
from duhem.path.scene_keys import CHOICES, KINDS, SECTIONS, VALUES

__all__ = ["SceneFaults", "read", "reads"]

MOST_BYTES = 1_000_000


class SceneFaults(InputError):
    """Everything that is wrong in a scene: ``faults``, each with its place and remedy."""

    def __init__(self, faults: Sequence[InputError]) -> None:
        self.faults = tuple(faults)
        super().__init__("; ".join(map(str, self.faults)))


def read(file: str | os.PathLike[str]) -> Scene:
    """The scene of a TOML file; SceneFaults (an InputError) lists everything wrong in it, each with file, line and column."""
    text = text_of(file, "scene", MOST_BYTES, large="put the points into a table")
    return reads(text, where=f"{file}", folder=File(file).parent)


def reads(text: str, where: str = "scene", folder: str | os.PathLike[str] = ".") -> Scene:
    """The scene written in ``text``; files it names are looked for in ``folder``."""
    try:
        toml = parsed(text, where)
    except InputError as fault:
        raise SceneFaults([fault]) from None
    return _SceneReader(toml, File(folder)).scene()


class _SceneReader:
    """From the document of a scene to its value; gathers faults instead of stopping at the first."""

    def __init__(self, toml: PlacedToml, folder: File) -> None:
        self.toml, self.document, self.folder = toml, toml.document, folder
        self.faults: list[InputError] = []
        self.inputs: list[str] = []

    def scene(self) -> Scene:
        self.known("", self.document, SECTIONS[""])
        law = self.law()
        path, own = self.points(law, self.path(law))
        parameters = self.parameters(law, own)
        asked = self.values("method") | self.values("output") | {"stress": self.stress()}
        asked["method"] = asked.pop("integrator")
        if (table := asked["table"]) is not None and not table.endswith((".csv", ".parquet")):
            self.fault(f"table {table!r} is neither .csv nor .parquet", "output", "table", 'write for example table = "history.csv"')
        if "stiffness" not in self.document:
            self.fault("there is no stiffness", "", "stiffness", "write for example stiffness = 1e9, in Pa/m, above the first [section]")
        elif law is not None and path is not None and parameters is not None:
            self.fits(Run(law, path, self.document["stiffness"], parameters, substeps=asked["substeps"], keep="last"), asked["method"])
        if self.faults or law is None or path is None:
            raise SceneFaults(self.faults)
        stiffness, inputs = self.document["stiffness"], tuple(self.inputs)
        return Scene(law=law, path=path, stiffness=stiffness, parameters=parameters or {}, inputs=inputs, **asked)

    def values(self, section: str) -> dict[str, Any]:
        """What each key of a section is set to, or what is meant where it is left out or of another kind."""
        given = self.section(section)
        self.known(section, given, SECTIONS[section])
        return {key: self.value(section, given, key) for key in SECTIONS[section]}

    def value(self, section: str, given: Mapping[str, Any], key: str) -> Any:
        if key in CHOICES:
            return self.choice(section, given, key)
        if key not in VALUES:
            return self.file(section, given, key)
        kind, meant, remedy = VALUES[key]
        if key not in given or _is(given[key], kind):
            return given.get(key, meant)
        self.fault(f"{key} = {repr(given[key])[:40]}", section, key, remedy)
        return meant

    def fits(self, run: Run, integrator: str) -> None:
        """Whether law, numbers and path fit each other, by the check that the run itself makes."""
        try:
            if isinstance(run.path, Paths):
                Batch.of(run)
                return
            plan = Plan.of(run)
        except InputError as fault:
            key = next((k for k in ("stiffness", "pressure", "parameters", "path") if k in f"{fault.where} {fault.what}"), "path")
            self.fault(fault.what, "path" if key == "pressure" else "", key, fault.remedy)
            return
        try:
            if plan.path.control == "displacement" and (pieces := INTEGRATORS[integrator].piece) is not None:
                pieces(plan)
        except InputError as fault:
            self.fault(fault.what, "method", "integrator", fault.remedy.replace("method=", "integrator = "))

    def stress(self) -> tuple[float, ...] | None:
        given = self.document.get("stress")
        if given is None:
            return None
        try:
            stress = np.atleast_1d(np.asarray(given))
            if stress.ndim == 1 and stress.dtype.kind in "iuf":
                return tuple(stress.astype(np.float64).tolist())
        except ValueError:  # ragged
            pass
        self.fault("stress is not made of numbers", "", "stress", "give one number a force, in Pa")
        return None

    def law(self) -> Criterion | None:
        given = self.document.get("law")
        if not isinstance(given, str):
            what = "there is no law" if given is None else "law is not a text"
            self.fault(what, "", "law", 'write law = "antoni2007" above the first [section]; duhem list names the laws')
            return None
        beside = self.folder / given
        try:
            return load_formula(self.input(beside) if given.endswith(".toml") or os.path.isfile(beside) else load_named(given))
        except InputError as fault:
            place = fault.where if fault.where.startswith(str(beside)) else self.place("", "law")
            self.faults.append(InputError(fault.what, where=place, remedy=fault.remedy))
            return None

    def points(self, law: Criterion | None, path: Path | Paths | None) -> tuple[Path | Paths | None, Mapping[str, Any]]:
        """The paths of many points, and their own parameters, where the scene has them."""
        given = self.section("points")
        self.known("points", given, SECTIONS["points"])
        if "points" not in self.document or law is None or path is None:
            return path, {}
        if not isinstance(given.get("table"), str):
            self.fault("[points] has no table", "points", "table", 'write for example table = "points.csv"')
            return path, {}
        try:
            return spread(self.input(self.folder / given["table"]), law, path)
        except InputError as fault:
            self.faults.append(fault)
            return path, {}

    def parameters(self, law: Criterion | None, own: Mapping[str, Any]) -> Mapping[str, Any] | None:
        """The values of the scene, and those that are each point's ``own``."""
        given = self.section("parameters")
        if law is None:
            return None
        before = len(self.faults)
        for name, value in given.items():
            if spelled(name) not in law.parameters:
                self.unknown("parameter", name, tuple(law.parameters), "parameters")
                continue
            try:
                law.fix({name: value})
            except InputError as fault:
                self.fault(f"{name}: {fault.what}", "parameters", name, fault.remedy)
        values = {spelled(name): value for name, value in given.items()} | dict(own)
        if len(values) < len(given) + len(own):
            self.fault("a parameter is given twice, in two spellings or in [points] too", "", "parameters", "give it once")
        for name, domain in law.parameters.items():
            if name not in values and domain.value is None:
                needs = f"{law.name} needs a value for {name}, {domain.describe()}"
                self.fault(needs, "", "parameters", f"write {name} = ... in [parameters]")
        return values if len(self.faults) == before else None

    def path(self, law: Criterion | None) -> Path | Paths | None:
        given = dict(self.section("path"))
        if "path" not in self.document:
            self.fault("there is no [path]", "", "path", f"add [path] with kind = {' or '.join(KINDS)}")
            return None
        before = len(self.faults)
        kind = self.choice("path", given, "kind")
        if kind is None:
            return None
        _, needed, optional = KINDS[kind]
        self.known("path", given, ("kind", *needed, *optional, "pressure"))
        for key in needed:
            if key not in given:
                self.fault(f"a {kind} path needs {key}", "", "path", f"write {key} = ... in [path]")
        if "control" in given:
            self.choice("path", given, "control")
        if "pressure" not in given and kind != "table" and "points" not in self.document and law is not None and law.pressure is not None:
            self.fault(f"{law.name} needs the pressure {law.pressure}", "", "path", "write pressure = -1e6 in [path], in Pa")
        if len(self.faults) > before:
            return None
        del given["kind"]
        table = given.get("file")
        try:
            return self.built(kind, given, 2 if law is None else len(law.forces))
        except InputError as fault:
            if kind == "table" and isinstance(table, str) and fault.where.startswith(f"{self.folder / table}"):
                self.faults.append(fault)  # with the line of the table
                return None
            at = next((key for key in given if re.search(rf"\b{key}\b", fault.what)), "kind")
            self.fault(fault.what, "path", at, fault.remedy)
        except TypeError:
            self.fault(f"a value of a {kind} path has the wrong type", "path", "kind", "give numbers or lists of them, and names in quotes")
        return None

    def built(self, kind: str, given: dict[str, Any], dimension: int) -> Path | Paths:
        if kind == "table":
            file = self.input(self.folder / given.pop("file"))
            return paths_from_csv(file, **given) if "point" in given else Path.from_csv(file, **given)
        made: Path = getattr(Path, kind)(**given, **({"dimension": dimension} if kind == "random" else {}))
        return made

    # -- values and places -------------------------------------------------------------------------------------

    def section(self, name: str) -> Mapping[str, Any]:
        given = self.document.get(name, {})
        if not isinstance(given, dict):
            self.fault(f"{name} is not a table", "", name, f"write [{name}] on a line of its own")
            return {}
        return given

    def input(self, file: File) -> File:
        """A file that the scene names, noted as one that is read; InputError for what is no file, such as a pipe that nobody fills."""
        if os.path.exists(file) and not os.path.isfile(file) and not os.path.isdir(file):
            raise InputError("this is a device or a pipe, not a file", where=f"{file}", remedy="name a file")
        self.inputs.append(f"{file}")
        return file

    def file(self, section: str, given: Mapping[str, Any], key: str) -> str | None:
        """The place of a file beside the scene; None where no file is named."""
        name = given.get(key)
        if isinstance(name, str) and name:
            return str(self.folder / name)
        if name is not None:
            self.fault(f"{key} is not a file name", section, key, f'write for example {key} = "history.csv"')
        return None

    def choice(self, section: str, given: Mapping[str, Any], key: str) -> Any:
        """One of the words of a key, the first where it is left out; a kind of path is not left out."""
        allowed = CHOICES[key]
        default = None if key == "kind" else allowed[0]
        value = given.get(key, default)
        if value in allowed:
            return value
        if value is None:
            self.fault(f"[{section}] has no {key}", "", section, f"choose {', '.join(allowed)}")
        else:
            near = get_close_matches(str(value), allowed, n=1)
            remedy = f"did you mean {near[0]!r}?" if near else f"choose {', '.join(allowed)}"
            self.fault(f"unknown {key} {str(value)[:40]!r}", section, key, remedy)
        return default

    def known(self, section: str, given: Mapping[str, Any], allowed: Iterable[str]) -> None:
        for key in given:
            if key not in allowed:
                self.unknown("key", key, allowed, section)

    def unknown(self, what: str, name: str, allowed: Iterable[str], section: str) -> None:
        self.fault(f"unknown {what} {name[:40]!r}", section, name, meant(name, allowed))

    def fault(self, what: str, section: str, key: str, remedy: str) -> None:
        self.faults.append(InputError(what, where=self.place(section, key), remedy=remedy))

    def place(self, section: str, key: str) -> str:
        """file:line:column of a key (or of the section it names), or the file where it is not written."""
        return self.toml.place(*filter(None, (section, key)))


def _is(value: Any, kind: Any) -> bool:
    """Whether a value is of a kind; a number above 0, a text not empty."""
    if isinstance(value, bool) or not isinstance(value, kind):
        return isinstance(value, bool) and kind is bool
    return bool(value) if isinstance(value, str) else bool(value > 0)
