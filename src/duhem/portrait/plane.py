"""Planes through the space of a law's forces and its pressure: pairs of axes, and for tensors the deviatoric plane and the meridian."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from duhem.errors import InputError
from duhem.expression.syntax import spelled
from duhem.law.curve_law import Law, ParametricCriterion
from duhem.law.formula_law import Criterion
from duhem.show.printing import latex_name, latex_number

__all__ = ["DEVIATORIC", "MERIDIAN", "Plane", "elsewhere", "named", "oblique", "usual"]

Array = NDArray[np.float64]
DEVIATORIC, MERIDIAN = "deviatoric", "meridian"
MOST = 6  # panels of a sheet that nobody has asked for one by one


@dataclass(frozen=True)
class Plane:
    """The points base + x X + y Y over the coordinates ``names`` of a law, its forces and then its pressure; stresses in the law's unit.

    ``x_symbol`` and ``y_symbol`` name the axes in LaTeX, ``caption`` says where the plane lies.  ``slips`` where x and y are forces,
    so that the slip is normal to the section's boundary by the normality rule; not so where one of them is the pressure.  ``pressed``
    where x is the pressure, which is <= 0.  ``guides`` are directions (2,) in the plane with a symbol each.
    """

    names: tuple[str, ...]
    base: Array
    x: Array
    y: Array
    x_symbol: str
    y_symbol: str
    caption: str = ""
    slips: bool = True
    pressed: bool = False
    guides: Mapping[str, tuple[float, float]] = field(default_factory=dict)

    def at(self, points: Array) -> Array:
        """The coordinates (..., n) of points (..., 2) of the plane."""
        return self.base + points[..., :1] * self.x + points[..., 1:] * self.y

    def within(self, coordinates: Array) -> Array:
        """Points (..., 2) of the plane below coordinates (..., n); what is across the plane is left out."""
        across = np.column_stack([self.x, self.y])
        return np.asarray((coordinates - self.base) @ np.linalg.pinv(across).T)

    @property
    def plain(self) -> str:
        """The plane in the names of the law, as a message says it."""
        along = [name for name, x, y in zip(self.names, self.x, self.y, strict=True) if x or y]
        kept = [f"{name} = {at:g}" for name, x, y, at in zip(self.names, self.x, self.y, self.base, strict=True) if not x and not y]
        return f"the {'plane' if len(along) > 1 else 'line'} of {', '.join(along)}" + (f" at {', '.join(kept)}" if kept else "")

    def told(self, unit: str) -> str:
        """Where the plane lies, its stresses in their ``unit``."""
        return re.sub(
            r"\$[^$]* = [^$]*[^$ ]\$", lambda said: said[0] if said[0].endswith(" = 0$") else f"{said[0]} {unit}".rstrip(), self.caption
        )

    def shares(self, directions: Array) -> Array:
        """Slips (..., n) by the force that does work along X and along Y: their parts (..., 2) in the plane."""
        return np.stack([directions @ self.x, directions @ self.y], axis=-1)


def usual(law: Law, pressure: float | None) -> tuple[Plane, ...]:
    """What a sheet shows if nobody says what: six planes at most, those that tell most first."""
    kind = _kind(law)
    pairs = [_pair(law, a, b, pressure) for a, b in combinations(law.forces, 2)]
    if kind in ("3d", "principal"):
        shear = [_pair(law, law.forces[0], law.forces[5], pressure)] if kind == "3d" else []
        return (_deviatoric(law, pressure), _meridian(law), pairs[0], *shear)
    curve = isinstance(law, ParametricCriterion)  # known at one pressure at a time
    pressed = [] if law.pressure is None or curve else [_pair(law, law.pressure, a, pressure) for a in law.forces]
    if not pairs and not pressed:
        return (_line(law),)
    return tuple([*pairs[: MOST - min(2, len(pressed))], *pressed[:2]])


def named(law: Law, text: str, pressure: float | None) -> tuple[Plane, ...]:
    """The planes that a user names: two forces or the pressure and a force with a comma, ``deviatoric``, ``meridian``, or ``all``."""
    tensor = _kind(law) in ("3d", "principal")
    axes = law.forces if isinstance(law, ParametricCriterion) else law.coordinates
    if text == "all":
        first = (_deviatoric(law, pressure), _meridian(law)) if tensor else ()
        return (*first, *(_pair(law, a, b, pressure) for a, b in combinations(axes, 2))) or (_line(law),)
    if text in (DEVIATORIC, MERIDIAN):
        if not tensor:
            remedy = f"name two of {', '.join(axes)}, or all"
            raise InputError(f"{law.name} has no stress tensor with three normal components", where=f"plane {text}", remedy=remedy)
        return (_deviatoric(law, pressure) if text == DEVIATORIC else _meridian(law),)
    pair = [spelled(name.strip()) for name in text.split(",")]
    if len(pair) != 2 or pair[0] == pair[1] or not set(pair) <= set(axes):
        other = f"{DEVIATORIC}, {MERIDIAN}, " if tensor else ""
        remedy = f"name two of {', '.join(axes)} with a comma between them; or {other}all"
        raise InputError("this is not a plane of the law", where=f"plane {text}"[:80], remedy=remedy)
    return (_pair(law, pair[0], pair[1], pressure),)


def elsewhere(law: Law, plane: Plane, size: float) -> Iterator[Plane]:
    """The same plane away from 0, where K may only begin: other forces at shares of size, the mean stress of a deviatoric plane."""
    for value in (sense * size / part for part in (1, 4, 16) for sense in (-1, 1)):
        if plane.guides:
            yield _deviatoric(law, value)
            continue
        for i, name in enumerate(law.forces):
            if plane.x[i] == plane.y[i] == 0.0:
                said = [f"${latex_name(name)} = {latex_number(value)}$"]
                said += [f"${latex_name(law.pressure)} = {latex_number(plane.base[-1])}$"] if law.pressure and not plane.pressed else []
                said += ["other forces 0"] if len(law.forces) > 3 - plane.pressed else []
                base = plane.base.copy()
                base[i] = value
                yield replace(plane, base=base, caption=", ".join(said))


def oblique(law: Law, p: Array, q: Array, aside: Array | None = None) -> Plane:
    """A plane through the points p and q (n,), X from p to q: a pair of axes if they are in one, else with ``aside`` or 0 in it."""
    names = law.coordinates
    along = (q - p) / np.linalg.norm(q - p)
    used = [i for i in range(len(law.forces)) if p[i] != 0.0 or q[i] != 0.0 or (aside is not None and aside[i] != 0.0)]
    level = law.pressure is None or (p[-1] == q[-1] and (aside is None or aside[-1] == p[-1]))
    if level and len(used) <= 2 <= len(law.forces):
        free = [i for i in range(len(law.forces)) if i not in used]
        a, b = sorted([*used, *free][:2])
        return _pair(law, names[a], names[b], float(p[-1]) if law.pressure else None)
    if not level and len(used) <= 1:
        return _pair(law, names[-1], names[used[0] if used else 0], None)
    middle = (p + q) / 2.0
    home = np.where(np.arange(len(names)) < len(law.forces), 0.0, middle)
    wanted = [middle - (home if aside is None else aside), *np.eye(len(names))[: len(law.forces)]]
    rests = [w - (w @ along) * along for w in wanted]
    sizes = [float(np.linalg.norm(r) / (np.linalg.norm(w) or 1.0)) for r, w in zip(rests, wanted, strict=True)]
    chosen = 0 if sizes[0] > 0.05 else int(np.argmax(sizes))
    across = rests[chosen] / np.linalg.norm(rests[chosen])
    caption = "plane through the points of the counterexample"
    return Plane(names, middle, along, across, "along the line", "normal to the line", caption, slips=level)


def _kind(law: Law) -> str | None:
    return law.stress.kind if isinstance(law, Criterion) and law.stress is not None else None


def _symbol(name: str) -> str:
    return f"${latex_name(name)}$"


def _unit(names: Sequence[str], name: str) -> Array:
    return np.array([float(own == name) for own in names])


def _pair(law: Law, a: str, b: str, pressure: float | None) -> Plane:
    """Two axes, the pressure the first of them; the other forces are 0."""
    names = law.coordinates
    if b == law.pressure:
        a, b = b, a
    pressed = a == law.pressure
    base = np.zeros(len(names))
    said = []
    if law.pressure and not pressed:
        base[-1] = -1.0 if pressure is None else pressure
        said.append(f"${latex_name(law.pressure)} = {latex_number(base[-1])}$")
    others = [name for name in law.forces if name not in (a, b)]
    if others:
        said.append(f"${latex_name(others[0])} = 0$" if len(others) == 1 else "other forces 0")
    return Plane(names, base, _unit(names, a), _unit(names, b), _symbol(a), _symbol(b), ", ".join(said), not pressed, pressed)


def _line(law: Law) -> Plane:
    """The one force of a law without pressure; Y is no stress."""
    names = law.coordinates
    return Plane(names, np.zeros(1), np.ones(1), np.zeros(1), _symbol(names[0]), "")


def _deviatoric(law: Law, mean: float | None) -> Plane:
    """Haigh and Westergaard's: sigma_xx points upwards; a length in it is that of the stress tensor."""
    names = law.coordinates
    n = len(names)
    p = 0.0 if mean is None else mean
    one, two, three = (f"{latex_name(name)}" for name in names[:3])
    x, y, base = np.zeros(n), np.zeros(n), np.zeros(n)
    x[:3], y[:3], base[:3] = np.array([0.0, 1.0, -1.0]) / sqrt(2.0), np.array([2.0, -1.0, -1.0]) / sqrt(6.0), p
    guides = {one: (0.0, 1.0), two: (sqrt(0.75), -0.5), three: (-sqrt(0.75), -0.5)}
    x_symbol, y_symbol = rf"$({two} - {three})/\sqrt{{2}}$", rf"$(2{one} - {two} - {three})/\sqrt{{6}}$"
    return Plane(names, base, x, y, x_symbol, y_symbol, f"deviatoric plane, $p = {latex_number(p)}$", guides=guides)


def _meridian(law: Law) -> Plane:
    """Triaxial stresses: p is the mean stress, q > 0 where the first normal stress is the greatest; slips are volume and shape."""
    names = law.coordinates
    x, y = np.zeros(len(names)), np.zeros(len(names))
    x[:3], y[:3] = 1.0, np.array([2.0, -1.0, -1.0]) / 3.0
    one, two = latex_name(names[0]), latex_name(names[1])
    return Plane(names, np.zeros(len(names)), x, y, "$p$", f"$q = {one} - {two}$", "meridian plane: two equal normal stresses")
