"""The keys of a scene and what each says: what the reader knows, what the reference prints, and the scene to start from."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

from duhem.law import catalogue
from duhem.law.convex import CONVEX
from duhem.path.integrators import INTEGRATORS
from duhem.path.loading import CONTROLS
from duhem.projection.methods import METHODS

__all__ = ["CHOICES", "KINDS", "KIND_KEYS", "SECTIONS", "VALUES", "Kind", "template"]

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
