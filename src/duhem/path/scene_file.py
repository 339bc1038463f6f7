"""Scenes from TOML: the keys of a scene and what each says, how they are read, and every mistake listed with its place.

The reader, the reference and the scene to start from have the same keys.  Where a value is wrong a stand-in that fits everything else
takes its place, so that the other mistakes are found in the same reading.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from difflib import get_close_matches
from pathlib import Path as File
from typing import Any, NamedTuple

import numpy as np

from duhem.errors import InputError, meant
from duhem.expression import holds_at
from duhem.expression.given_array import reals
from duhem.expression.syntax import spelled
from duhem.law import catalogue
from duhem.law.catalogue import load_formula, load_named
from duhem.law.convex import CONVEX
from duhem.law.domain import Domain
from duhem.law.formula_law import Criterion
from duhem.law.parameter_domain import simple_points
from duhem.law.placed_toml import PlacedToml, parsed, text_of
from duhem.law.state import evolves, prescribed
from duhem.path.integrators import INTEGRATORS
from duhem.path.loading import CONTROLS, Path, Paths, paths_from_csv, spread
from duhem.path.run import Batch, Plan, Run
from duhem.path.scene import Scene
from duhem.path.simulate import check_compiled, first_stress
from duhem.path.state_question import StateQuestion
from duhem.projection.methods import METHODS
from duhem.show import figure
from duhem.show.place import check_place

__all__ = ["CHOICES", "KINDS", "KIND_KEYS", "SECTIONS", "VALUES", "Kind", "SceneFaults", "read", "reads", "template"]

SECTIONS: Mapping[str, Mapping[str, str]] = {  # beside [parameters], whose keys are the law's, and [path], see KINDS
    "": {
        "law": "the name of a built-in law or of a law in the atlas, or a criterion file in the folder of the scene",
        "stiffness": "k in Pa/m: one number, one number per force, or a symmetric matrix; a law with an energy has none",
        "state": "of a law with a state: the variables that do not begin at 0, and the temperature of an adiabatic path",
        "stress": "initial stress in Pa, one number per force; it must lie inside K (default 0)",
        "parameters": "a number for each parameter that has no value in the law",
        "points": "many points on the same path, each with its own numbers",
        "path": "the prescribed displacements or stresses",
        "method": "the method of computation",
        "output": "the files to write; --out and --plot on the command line take precedence",
    },
    "points": {"table": "a CSV file with one row per point: parameters, pressure, and factors scale or scale_a ... for the displacements"},
    "method": {
        "integrator": "implicit: error of first order in the step; extrapolated: second order; "
        "exact: each straight piece in one step, without discretisation error",
        "projection": "the method that finds the closest point; auto chooses the cheapest method that applies",
        "substeps": "number of substeps in each step of the path (default 1)",
        "accuracy": "of a law with a state, with extrapolated steps: each step is divided until the estimated error, relative to "
        "the state, is at most this number; for example 1e-8",
        "compiled": "true: compile with numba (extra fast)",
        "threads": "number of threads for many points (default 1); the results do not depend on it",
        "convex": "ask: look for a proof that K is convex; require: reject the law without such a proof; assume: do not look for one",
    },
    "output": {
        "table": "the file for the history, .csv or .parquet (extra parquet)",
        "plot": "the file for a picture of the stress path, hysteresis and energies (extra plot): .png, .svg, .pdf ...",
        "stress_unit": "the unit of the stresses, as text for the axes of the picture (default Pa); numbers are not converted",
        "length_unit": "the unit of the displacements, as text for the axes (default m)",
        "keep": 'for many points: n keeps every n-th knot, "last" keeps only the last knot',
        "checkpoint": "time in s between two checkpoints for --resume (default 60)",
    },
}

VALUES: Mapping[str, tuple[Any, Any, str]] = {  # keys that hold a value: its type, what is meant where it is left out, and the remedy
    "compiled": (bool, False, "write true or false"),
    "substeps": (int, 1, "give a whole number >= 1"),
    "accuracy": ((int, float), None, "give a number such as 1e-8"),
    "threads": (int, 1, "give a whole number >= 1"),
    "stress_unit": (str, "Pa", 'write for example stress_unit = "MPa"'),
    "length_unit": (str, "m", 'write for example length_unit = "mm"'),
    "keep": ((int, str), 1, 'give the number n to keep every n-th knot, or "last"'),
    "checkpoint": ((int, float), 60, "give seconds, above 0"),
}


class Kind(NamedTuple):
    """A kind of path: what it is, which keys it needs and which it may have beside the pressure."""

    means: str
    needs: tuple[str, ...]
    may: tuple[str, ...]


KINDS: Mapping[str, Kind] = {
    "linear": Kind("straight lines from point to point", ("points",), ("time", "control")),
    "cycle": Kind("from 0 to mean + amplitude, then to mean - amplitude and back", ("amplitude",), ("cycles", "mean", "control")),
    "circle": Kind("a circle, for two displacements", ("radius",), ("points", "turns", "start", "centre", "chords")),
    "random": Kind(
        "random points with a normal distribution, starting at 0; the same seed gives the same path", ("seed", "points"), ("scale",)
    ),
    "table": Kind("a CSV file with one row per knot", ("file",), ("columns", "time", "control", "point")),
}

CHOICES: Mapping[str, tuple[str, ...]] = {  # the words that a key may have; the first is meant where it is left out
    "kind": tuple(KINDS),
    "control": CONTROLS,
    "integrator": tuple(INTEGRATORS),
    "projection": ("auto", *METHODS),
    "convex": CONVEX,
}

KIND_KEYS: Mapping[str, str] = {  # a kind before the key where it means something else there
    "pressure": "sigma_n <= 0 in compression, in Pa: one number, or one number per knot; for a random path also [least, greatest]",
    "control": "the meaning of the values: displacements in m or stresses in Pa",
    "linear points": "the values at the knots (points of the path): one number, or a list with one number per force",
    "linear time": "the time of each knot in s, increasing; a label only, unless the law depends on the rate",
    "amplitude": "one number, or one number per force",
    "cycles": "number of cycles (default 1)",
    "mean": "the centre of the cycles (default 0)",
    "radius": "in m",
    "circle points": "number of steps per turn (default 64)",
    "turns": "number of turns (default 1); a negative number turns clockwise",
    "start": "the angle of the first knot, in rad",
    "centre": "centre of the circle (default [0, 0])",
    "chords": "true: straight lines between the knots",
    "seed": "a whole number",
    "random points": "number of knots after the first",
    "scale": "standard deviation, one number or one number per force (default 1)",
    "file": "the table, in the folder of the scene",
    "columns": "the columns with the values (default: every u_... except u_in_...)",
    "table pressure": "the column with the pressure (default sigma_n), or one number in Pa",
    "table time": "the column with the time (default time); without such a column, the path has no times",
    "point": "the column that numbers the points, if the table contains many points (default: the table is one path)",
}


def template(name: str) -> str:
    """A scene to start from, with every section explained; it runs as it stands.  InputError for what cannot name a file."""
    return catalogue.template(name, "scene", __file__)


# -- reading -----------------------------------------------------------------------------------------------------------

MOST_BYTES = 1_000_000
_PLAIN: Mapping[str, Any] = {"stiffness": 1.0, "threads": 1, "substeps": 1, "keep": 1, "stress": None, "compiled": False, "accuracy": None}
_MISFITS = {  # what a check of the run names: section and key of it
    "method": ("method", "integrator"),
    "accuracy": ("method", "accuracy"),
    "compiled": ("method", "compiled"),
    "stiffness": ("", "stiffness"),
    "point ": ("points", "table"),
    "parameters": ("", "parameters"),
    "threads": ("method", "threads"),
    "substeps": ("method", "substeps"),
    "keep": ("output", "keep"),
    "pressure": ("path", "pressure"),
    "stress": ("", "stress"),
    "state ": ("", "state"),
    "path": ("", "path"),
}

_ASKED = ("method", "substeps", "keep", "threads", "stress", "state", "compiled", "accuracy")


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
        path, each = self.points(law, self.path(law))
        parameters = self.parameters(law, each)
        asked = self.values("method") | self.values("output") | {"stress": self.stress(), "state": self.section("state") or None}
        asked["method"] = asked.pop("integrator")
        if (table := asked["table"]) is not None and not table.endswith((".csv", ".parquet")):
            self.fault(f"table {table!r} is neither .csv nor .parquet", "output", "table", 'write for example table = "history.csv"')
        own = law is not None and law.energy is not None  # which has a stiffness
        if "stiffness" not in self.document and not own:
            self.fault("there is no stiffness", "", "stiffness", "write for example stiffness = 1e9, in Pa/m, above the first [section]")
        stiffness, inputs = self.document.get("stiffness", None if own else 1.0), tuple(self.inputs)
        if law is not None:
            numbers = _admitted(law) if parameters is None or (path is None and each) else parameters
            run = Run(law, path or _resting(law), stiffness, numbers)
            if numbers is not None:
                self.fits(law, replace(run, **{key: asked[key] for key in _ASKED}))
        if self.faults or law is None or path is None:
            self.writable(asked)
            raise SceneFaults(self.faults)
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

    def fits(self, law: Criterion, run: Run) -> None:
        """Whether law, numbers and path fit each other, by the checks that the run itself makes."""
        instead: dict[str, Mapping[str, Any]] = {key: {key: value} for key, value in _PLAIN.items()}
        if (numbers := _admitted(law)) is not None:
            resting = {"path": _resting(law), "parameters": numbers}
            instead |= {"parameters": {"parameters": numbers}, "point ": {"parameters": numbers}, "pressure": resting, "path": resting}
        told = set[str]()
        while (fault := _misfit(run)) is not None:
            key = next((key for key in _MISFITS if key in f"{fault.where} {fault.what}"), "path")
            if key in told:
                return
            what = f"{fault.where}: {fault.what}" if key == "point " else fault.what
            self.fault(what, *_MISFITS[key], fault.remedy.replace("method=", "integrator = "))
            told.add(key)
            if key not in instead:
                return
            run = replace(run, **instead[key])

    def writable(self, asked: Mapping[str, Any]) -> None:
        """Whether the scene's outputs can be written; of a scene without faults that is asked once the command line has named its own."""
        for key, check in (("table", check_place), ("plot", figure.check)):
            try:
                if asked[key] is not None:
                    check(asked[key])
            except InputError as fault:
                self.fault(fault.what, "output", key, fault.remedy)

    def stress(self) -> tuple[float, ...] | None:
        given = self.document.get("stress")
        if given is None:
            return None
        if (stress := reals(given)) is not None and stress.ndim < 2:
            return tuple(np.atleast_1d(stress).tolist())
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

    def points(self, law: Criterion | None, path: Path | Paths | None) -> tuple[Path | Paths | None, Mapping[str, Any] | None]:
        """The paths of many points, and their own parameters, where the scene has them; None for what cannot be read."""
        given = self.section("points")
        self.known("points", given, SECTIONS["points"])
        if "points" not in self.document or law is None:
            return path, {}
        if not isinstance(given.get("table"), str):
            self.fault("[points] has no table", "points", "table", 'write for example table = "points.csv"')
            return None, None
        try:
            paths, own = spread(self.input(self.folder / given["table"]), law, path or _resting(law))
        except InputError as fault:
            self.faults.append(fault)
            return None, None
        return None if path is None else paths, own

    def parameters(self, law: Criterion | None, own: Mapping[str, Any] | None) -> Mapping[str, Any] | None:
        """The values of the scene, and those that are each point's ``own``; None where one is wrong or missing."""
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
        if own is None:
            return None
        values = {spelled(name): value for name, value in given.items()} | dict(own)
        if len(values) < len(given) + len(own):
            self.fault("a parameter is given twice, in two spellings or in [points] too", "", "parameters", "give it once")
        for name, domain in law.parameters.items():
            if name not in values and domain.value is None and name not in law.variables:
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
            kind = next(iter(get_close_matches(str(given.get("kind")), KINDS, n=1)), None)
        if kind is None:
            self.known("path", given, ("kind", "pressure", *(key for each in KINDS.values() for key in (*each.needs, *each.may))))
            return None
        _, needed, optional = KINDS[kind]
        allowed, dimension = ("kind", *needed, *optional, "pressure"), 2 if law is None else len(prescribed(law))
        self.known("path", given, allowed)
        given = {key: value for key, value in given.items() if key in allowed}
        for key in needed:
            if key not in given:
                self.fault(f"a {kind} path needs {key}", "", "path", f"write {key} = ... in [path]")
                given[key] = _instead(kind, key, given, dimension)
        if "control" in given:
            given["control"] = self.choice("path", given, "control")
        if "pressure" not in given and kind != "table" and "points" not in self.document and law is not None and law.pressure is not None:
            self.fault(f"{law.name} needs the pressure {law.pressure}", "", "path", "write pressure = -1e6 in [path], in Pa")
        del given["kind"]
        made, known = None, set[str]()
        while made is None and None not in (given[key] for key in needed):
            try:
                made = self.built(kind, given, dimension)
            except InputError as fault:
                table = given.get("file")
                if kind == "table" and isinstance(table, str) and fault.where.startswith(f"{self.folder / table}"):
                    self.faults.append(fault)  # with the line of the table
                    return None
                said = {key: found.start() for key in given if (found := re.search(rf"\b{key}\b", fault.what))}
                at = min(said, key=said.__getitem__, default="kind")
                if at in known:
                    return None
                self.fault(fault.what, "path", at, fault.remedy)
                known.add(at)
                if at in needed:
                    given[at] = _instead(kind, at, given, dimension)
                elif given.pop(at, None) is None:
                    return None
                if kind != "linear" and isinstance(given.get("pressure"), list):
                    del given["pressure"]  # one a knot, and how many knots there are is not known
            except TypeError:
                self.fault(
                    f"a value of a {kind} path has the wrong type", "path", "kind", "give numbers or lists of them, and names in quotes"
                )
                return None
        if len(self.faults) > before and isinstance(made, Path) and law is not None:
            load = _resting(law).pressure
            return replace(made, pressure=None if load is None else np.full(len(made.time), load[0]))
        return made

    def built(self, kind: str, given: dict[str, Any], dimension: int) -> Path | Paths:
        if kind == "table":
            rest = {key: value for key, value in given.items() if key != "file"}
            file = self.input(self.folder / given["file"])
            return paths_from_csv(file, **rest) if "point" in given else Path.from_csv(file, **rest)
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
            self.fault(f"unknown {key} {str(value)[:40]!r}", section, key, meant(value, allowed, f"choose {', '.join(allowed)}"))
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


def _misfit(run: Run) -> InputError | None:
    """What the run would say of law, numbers and path before its first step."""
    try:
        if evolves(load_formula(run.law)):
            StateQuestion.of(run)
            return None
        if isinstance(run.path, Paths):
            Batch.of(run)
            return None
        plan = Plan.of(run)
        if run.stress is not None:
            first_stress(plan, run.stress)
        if run.compiled:
            check_compiled(run.method)
    except InputError as fault:
        return fault
    try:
        if plan.path.control == "displacement" and (pieces := INTEGRATORS[run.method].piece) is not None:
            pieces(plan)
    except InputError as fault:
        return InputError(fault.what, where="method", remedy=fault.remedy)
    return None


def _instead(kind: str, key: str, given: Mapping[str, Any], dimension: int) -> Any:
    """A value of a path in the place of one that is wrong or missing, as many numbers as the others ask for; None for a table's name."""
    sizes = {name: len(value) for name, value in given.items() if isinstance(value, list)}
    if key == "amplitude":
        return [1.0] * sizes.get("mean", dimension)
    if (kind, key) == ("linear", "points"):
        return [[0.0] * dimension] * max(2, next((sizes[name] for name in ("points", "time", "pressure") if name in sizes), 2))
    return {"radius": 1.0, "seed": 0, "points": 1}.get(key)


def _resting(law: Criterion) -> Path:
    """A path on which nothing moves, at a pressure that the law admits."""
    domain = law.domain.get(law.pressure or "", Domain())
    load = next((float(end) for end in (domain.high, domain.low) if end is not None), -1.0)
    return Path.linear(
        [[0.0] * len(prescribed(law))] * 2, time=[0.0, 1.0] if evolves(law) else None, pressure=None if law.pressure is None else load
    )


def _admitted(law: Criterion) -> Mapping[str, Any] | None:
    """Plain values of the parameters that the law admits, where some are at hand."""
    for point in simple_points(law):
        if all(holds_at(constraint, point) for constraint in law.constraints):
            free = (name for name, domain in law.parameters.items() if domain.value is None and name not in law.variables)
            return {name: point[law.symbols()[name]] for name in free}
    return None


def _is(value: Any, kind: Any) -> bool:
    """Whether a value is of a kind; a number above 0, a text not empty."""
    if isinstance(value, bool) or not isinstance(value, kind):
        return isinstance(value, bool) and kind is bool
    return bool(value) if isinstance(value, str) else bool(value > 0)
