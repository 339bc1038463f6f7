"""The keys of a scene and what each says: what the reader knows, what the reference prints, and the scene to start from."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any, NamedTuple

from duhem.errors import InputError
from duhem.law.convex import CONVEX
from duhem.path.integrators import INTEGRATORS
from duhem.path.loading import CONTROLS
from duhem.projection.methods import METHODS

__all__ = ["CHOICES", "KINDS", "KIND_KEYS", "SECTIONS", "VALUES", "Kind", "template"]

SECTIONS: Mapping[str, Mapping[str, str]] = {  # beside [parameters], whose keys are the law's, and [path], see KINDS
    "": {
        "law": "a built-in name, a name of the atlas, or a criterion file beside the scene",
        "stiffness": "k in Pa/m: a number, one a force, or a symmetric matrix",
        "stress": "stress at the beginning, one number a force, in Pa, inside K; 0 if left out",
        "parameters": "a number for each parameter that the law leaves open",
        "points": "many points that go the same way, each with numbers of its own",
        "path": "what is prescribed",
        "method": "how it is computed",
        "output": "what is written; the command line's --out and --plot come first",
    },
    "points": {
        "table": "a CSV file, one row a point: parameters of the law, the pressure, scale or scale_a ..., which multiply displacements"
    },
    "method": {
        "integrator": "implicit: first order in the step; extrapolated: second order; exact: each straight piece at once, to rounding",
        "projection": "how the closest point is found; auto takes the cheapest method that applies",
        "substeps": "into how many steps each step of the path is cut, 1 if left out",
        "compiled": "true: through numba (extra fast)",
        "threads": "how many share the work of many points, 1 if left out; no number depends on it",
        "convex": "whether K is: look for a proof, require one, or do without",
    },
    "output": {
        "table": "the history, .csv or .parquet (extra parquet)",
        "plot": "stress path, hysteresis and energies (extra plot), .png, .svg, .pdf ...",
        "stress_unit": "the unit of all stresses here, written at the axes of the picture, Pa if left out; no number is converted",
        "length_unit": "that of displacements, m if left out",
        "keep": 'of many points: every how many knots are kept, or "last"',
        "checkpoint": "how often what is done is kept for --resume, in s, 60 if left out",
    },
}

VALUES: Mapping[str, tuple[Any, Any, str]] = {  # keys that hold a value: its type, what is meant where it is left out, and the remedy
    "compiled": (bool, False, "write true or false"),
    "substeps": (int, 1, "give a whole number from 1 on"),
    "threads": (int, 1, "give a whole number from 1 on"),
    "stress_unit": (str, "Pa", 'write for example stress_unit = "MPa"'),
    "length_unit": (str, "m", 'write for example length_unit = "mm"'),
    "keep": ((int, str), 1, 'give every how many knots are kept, or "last"'),
    "checkpoint": ((int, float), 60, "give seconds, above 0"),
}


class Kind(NamedTuple):
    """A kind of path: what it is, which keys it needs and which it may have beside the pressure."""

    means: str
    needs: tuple[str, ...]
    may: tuple[str, ...]


KINDS: Mapping[str, Kind] = {
    "linear": Kind("straight from point to point", ("points",), ("time", "control")),
    "cycle": Kind("0, then from mean + amplitude to mean - amplitude and back", ("amplitude",), ("cycles", "mean", "control")),
    "circle": Kind("round a circle, of two displacements", ("radius",), ("points", "turns", "start", "centre", "chords")),
    "random": Kind("from 0 through normal deviates; the same seed gives the same path", ("seed", "points"), ("scale",)),
    "table": Kind("a CSV file, one row a knot", ("file",), ("columns", "time", "control", "point")),
}

CHOICES: Mapping[str, tuple[str, ...]] = {  # the words that a key may have; the first is meant where it is left out
    "kind": tuple(KINDS),
    "control": CONTROLS,
    "integrator": tuple(INTEGRATORS),
    "projection": ("auto", *METHODS),
    "convex": CONVEX,
}

KIND_KEYS: Mapping[str, str] = {  # a kind before the key where it means something else there
    "pressure": "sigma_n <= 0 in compression, in Pa: one number, or one a knot; of a random path also [least, greatest], to draw from",
    "control": "whether the values are displacements in m or stresses in Pa",
    "linear points": "the values at the knots, one number or a list of one a force",
    "linear time": "at each knot, in s, increasing; it only labels them, for the laws are rate independent",
    "amplitude": "one number, or one a force",
    "cycles": "how many, 1 if left out",
    "mean": "what the cycles go round, 0 if left out",
    "radius": "in m",
    "circle points": "steps a turn, 64 if left out",
    "turns": "how many, 1 if left out; below 0 clockwise",
    "start": "the angle of the first knot, in rad",
    "centre": "of the circle, [0, 0] if left out",
    "chords": "true: straight between the knots",
    "seed": "a whole number",
    "random points": "how many knots after the first",
    "scale": "of the deviates, one number or one a force, 1 if left out",
    "file": "the table, beside the scene",
    "columns": "which columns the values are; every u_... that is no u_in_... if left out",
    "table pressure": "the column of the pressure, sigma_n if left out, or one number in Pa",
    "table time": "the column of the time, time if left out; a name that is not there states no times",
    "point": "the column that tells points apart, of a table of many points; left out, it is one path",
}


def template(name: str) -> str:
    """A scene to start from, with every section explained; it runs as it stands.  InputError for what cannot name a file."""
    if not re.fullmatch(r"[A-Za-z0-9][\w.-]{0,60}", name):
        raise InputError(f"{name[:60]!r} cannot name a scene", remedy="use letters, digits, hyphens and underscores")
    return _TEMPLATE.replace("NAME", name)


_TEMPLATE = """\
# A scene for duhem: a law along a loading path.  Run it with:  duhem simulate NAME.toml
# What it needs and what is left out:  duhem simulate NAME.toml --explain

law = "antoni2007"                        # a name (duhem list, duhem atlas), or a criterion file beside this one: "mine.toml"
stiffness = [1e9, 2e9]                    # Pa/m: a number, one a force, or a symmetric matrix [[k_aa, k_ab], [k_ab, k_bb]]
# stress = [0, 0]                         # Pa, at the beginning

[parameters]                              # a number for each that the law leaves open
mu_a_plus = 0.2
mu_a_minus = 0.08
mu_b_plus = 0.12
mu_b_minus = 0.15

[path]
kind = "linear"                           # straight from point to point
points = [[0, 0], [1e-3, 0], [1e-3, 5e-4], [0, 0]]  # m; with control = "stress" Pa
pressure = -1e6                           # Pa, <= 0 in compression: one number, or one a knot
# Other kinds:
#   kind = "cycle"    amplitude = [1e-3, 0]   cycles = 3   mean = 0
#   kind = "circle"   radius = 1e-3   points = 64   turns = 2   start = 0   centre = [0, 0]
#   kind = "random"   seed = 1   points = 50   scale = 1e-3
#   kind = "table"    file = "path.csv"       with columns u_a, u_b, and sigma_n, time if there

[method]                                  # optional
integrator = "implicit"                   # first order; "extrapolated": second order; "exact": to rounding
substeps = 10                             # each step of the path is cut into so many
# compiled = true                         # through numba (extra fast)
# convex = "require"                      # refuse a K that is not shown to be convex; "ask" is meant if left out

# [output]                                # optional; else the history goes to standard output, or where --out and --plot say
# table = "NAME.csv"                      # or .parquet (extra parquet)
# plot = "NAME.png"                       # extra plot
# stress_unit = "MPa"                     # at the axes of the picture, where all numbers above are in MPa and, below, in mm
# length_unit = "mm"

# Many points that go the same way, each with parameters, pressure or scale of its own, a row each:
# [points]
# table = "points.csv"
"""
