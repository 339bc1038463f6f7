"""Scenes: a law, its numbers, a loading path, a method and what to write, in one TOML file.

law = "antoni2007"                  # a built-in name, or the path of a criterion file beside the scene
stiffness = [1e9, 2e9]              # Pa/m: a number, one a force, or a symmetric matrix

[parameters]
mu_a_plus = 0.2

[path]                              # kind: linear, cycle, circle, random or table
kind = "linear"
points = [[0, 0], [1e-3, 5e-4]]     # m
pressure = -1e6                     # Pa, <= 0 in compression; one number, or one a point

[method]                            # optional
integrator = "exact"                # implicit (the default), extrapolated or exact
substeps = 10

[output]                            # optional; the command line's --out and --plot come first
table = "history.csv"
plot = "history.png"
"""

from __future__ import annotations

from duhem.scene.performing import Stopped, check_outputs, perform
from duhem.scene.reading import MOST_BYTES, SceneFaults, read, reads
from duhem.scene.scene import Part, Scene

__all__ = ["MOST_BYTES", "Part", "Scene", "SceneFaults", "Stopped", "check_outputs", "perform", "read", "reads"]
