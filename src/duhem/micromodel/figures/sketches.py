"""The sketches of the paper (Antoni et al. 2007, Figs. 2, 3, 6, 7), to the scale of their numbers and with the forces of the model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from duhem.errors import InputError
from duhem.micromodel.experiment import STEEL_ON_ALUMINIUM, Experiment
from duhem.micromodel.figures.value import Array, Arrows, Axis, Curve, Fact, Figure, Layer, Note, Panel

__all__ = ["bench", "contact", "specimens", "texture"]

_PERIOD, _HEIGHT, _TAN = (float(getattr(STEEL_ON_ALUMINIUM, name)) for name in ("period", "height", "tan_alpha"))
_UM = 1e6  # from m
_SPRINGS, _COILS = 10, 9
_ALONG, _ACROSS = Axis("x", "distance along $t_a$", "µm"), Axis("z", "height along $n$", "µm")
_SEEN = 600.0  # of a specimen, in µm
_PEAKS = 15
_FLAT = {"mu_low": "1/1000", "mu_high": "1/999"}  # these sketches have no range of mu: one at which sides up to 89.9 degrees slide


def _wedge(period: float, height: float, tan_alpha: float) -> tuple[Experiment, float, float, float]:
    """The specimen, and in µm its period, its height and the length of the side Gamma_alpha along t_a."""
    test = replace(STEEL_ON_ALUMINIUM, period=period, height=height, tan_alpha=tan_alpha, **_FLAT)
    return test, _UM * period, _UM * height, _UM * height / tan_alpha


def _angles(test: Experiment) -> tuple[Fact, Fact]:
    slopes = {"alpha": test.tan_alpha, "beta": test.tan_beta}
    one, other = (Fact(name, float(np.degrees(np.arctan(float(slope)))), "deg") for name, slope in slopes.items())
    return one, other


def _profile(name: str, first: int, last: int, period: float, height: float, foot: float, hue: int | None = None) -> Curve:
    """The wedges ``first`` to before ``last``."""
    x = np.array([part for i in range(first, last) for part in (i * period, i * period + foot)] + [last * period])
    return Curve(name, x, np.array([0.0, height] * (last - first) + [0.0]), hue)


def texture(period: float = _PERIOD, height: float = _HEIGHT, tan_alpha: float = _TAN) -> Figure:
    """Wedges of period L and height h in m; Gamma_alpha rises along t_a at ``tan_alpha``, Gamma_beta falls (Antoni et al. 2007, Fig. 2)."""
    test, long, high, foot = _wedge(period, height, tan_alpha)
    alpha, beta = _angles(test)
    layers: tuple[Layer, ...] = (
        _profile("before", 0, 1, long, high, foot),
        _profile("after", 2, 3, long, high, foot),
        Curve("Gamma_alpha", np.array([long, long + foot]), np.array([0.0, high]), 0, r"$\Gamma_\alpha$, with $\mu_\alpha$"),
        Curve("Gamma_beta", np.array([long + foot, 2.0 * long]), np.array([high, 0.0]), 1, r"$\Gamma_\beta$, with $\mu_\beta$"),
        Curve("h", np.array([long + foot] * 2), np.array([0.0, high]), None),
        Curve("L", np.array([long, 2.0 * long]), np.array([-0.6 * high] * 2), None),
        Arrows("t_a, n", np.array([[0.0, 1.6 * high]] * 2), np.eye(2), 0.6 * high, None, "$t_a$ and $n$"),
        Note(rf"$\alpha = {alpha.value:.3g}°$", long, 0.0, "below right"),
        Note(rf"$\beta = {beta.value:.3g}°$", 2.0 * long, 0.0, "below right"),
        Note(f"$h = {high:g}$ µm", long + foot, high, "above left"),
        Note(f"$L = {long:g}$ µm", 1.5 * long, -0.6 * high, "below right"),
        Note("body (2)", 0.5 * long, -0.9 * high, "centre"),
    )
    return Figure((Panel(_ALONG, replace(_ACROSS, limits=(-1.5 * high, 2.6 * high)), layers, equal=True),), facts=(alpha, beta))


def contact(mu: float = 0.25, pressed: float = 1.5, period: float = _PERIOD, height: float = _HEIGHT, tan_alpha: float = _TAN) -> Figure:
    """A period with the springs of body (1), which slides along +t_a, and the forces on both sides (Antoni et al. 2007, Eqs. 2-12, Fig. 3).

    ``pressed`` is delta/h >= 1; a spring at the height z presses with k_n (delta - h + z), and pulls with H(mu, +-slope) times as much
    (Eq. 6).  The lengths of the two arrows are in the ratio of the forces in the middle of the sides.
    """
    test, long, high, foot = _wedge(period, height, tan_alpha)
    if pressed < 1.0:
        raise InputError(f"delta/h = {pressed:g} leaves springs without load", where="pressed", remedy="give 1 or more")
    test.predicted(mu)  # or a side is not climbed
    ends, slopes = ((0.0, foot), (foot, long)), (tan_alpha, -float(test.tan_beta))
    pulls = [(mu + slope) / (1.0 - mu * slope) for slope in slopes]
    top = high * (1.4 + pressed)
    layers: list[Layer] = [_profile("wedge", 0, 1, long, high, foot, 2)]
    layers += [Curve("body (1)", np.array([0.0, long]), np.array([top, top])), Note("body (1)", 0.5 * long, 1.06 * top, "centre")]
    for x in (np.arange(_SPRINGS) + 0.5) * long / _SPRINGS:
        at = x * tan_alpha if x < foot else (long - x) * float(test.tan_beta)
        y = np.linspace(at, top, 2 * _COILS + 1)
        layers.append(Curve(f"spring {x:.4g}", x + 0.015 * long * np.sin(0.5 * np.pi * np.arange(len(y))), y))
    middle = high * (pressed - 0.5)  # of the press on each side, over k_n
    for hue, (name, (a, b), pull) in enumerate(zip(("alpha", "beta"), ends, pulls, strict=True)):
        size = float(np.hypot(pull, 1.0))
        way = np.array([[pull / size, -1.0 / size]])
        tip, length = np.array([[0.5 * (a + b), 0.5 * high]]), 0.7 * middle * size
        layers.append(Arrows(f"F_{name}", tip, way, length, hue, rf"$F_\{name}$ on body (2)"))
    layers.append(Arrows("sliding", np.array([[0.3 * long, 1.12 * top]]), np.array([[1.0, 0.0]]), 0.4 * long, None, "sliding direction"))
    facts = (
        *(Fact(f"tangential over normal force on Gamma_{name}", pull) for name, pull in zip(("alpha", "beta"), pulls, strict=True)),
        Fact("mean tangential over mean normal force", sum(p * (b - a) for p, (a, b) in zip(pulls, ends, strict=True)) / long),
        Fact("least force of a spring over the greatest", (pressed - 1.0) / pressed),
    )
    return Figure((Panel(_ALONG, replace(_ACROSS, limits=(-1.2 * high, 1.25 * top)), tuple(layers), equal=True),), facts=facts)


def specimens(period: float = _PERIOD, height: float = _HEIGHT, tan_alpha: float = _TAN, roughness: float = 15e-6) -> Figure:
    """Both surfaces, to scale: the wedges of steel, and aluminium (Antoni et al. 2007, Fig. 6).

    Of aluminium the paper says the average height of its asperities, ``roughness`` in m; the profile is one of many that have it.
    """
    test, long, high, foot = _wedge(period, height, tan_alpha)
    if not roughness > 0.0:
        raise InputError(f"the average height {roughness:g} is not positive", where="roughness", remedy="give a positive number")
    steel = replace(_profile("steel", 0, max(1, round(_SEEN / long)), long, high, foot, 0), label="steel")
    draw = np.random.default_rng(2007)
    x = np.linspace(0.0, _SEEN, 2 * _PEAKS + 1)
    x[1:-1] += draw.uniform(-0.3, 0.3, 2 * _PEAKS - 1) * x[1]
    peaks = draw.lognormal(0.0, 0.4, _PEAKS)
    z = np.zeros(len(x))
    z[1::2] = _UM * roughness * peaks / peaks.mean()
    across = replace(_ACROSS, limits=(-high, 3.0 * high))
    panels = tuple(
        Panel(_ALONG, across, (curve,), equal=True) for curve in (steel, Curve("aluminium", x, z, 0, "aluminium: one profile of many"))
    )
    return Figure(panels, facts=(*_angles(test), Fact("average height of the asperities of aluminium", float(z[1::2].mean()), "µm")))


def bench(
    normal_load: float = float(STEEL_ON_ALUMINIUM.normal_load),
    measured_plus: float = float(STEEL_ON_ALUMINIUM.measured_plus),
    measured_minus: float = float(STEEL_ON_ALUMINIUM.measured_minus),
    velocity: float = 5e-4,
) -> Figure:
    """The parts of the test bench that the text names, not to scale, with its loads in N, to scale (Antoni et al. 2007, Fig. 7).

    ``velocity`` of the hydraulic jack in m/s.  The tangential loads are those at which sliding is steady: ``measured_plus`` and
    ``measured_minus`` times the normal load.
    """
    test = replace(STEEL_ON_ALUMINIUM, normal_load=normal_load, measured_plus=measured_plus, measured_minus=measured_minus)
    loads = tuple(float(part * test.normal_load) for part in (1, test.measured_plus, test.measured_minus))
    boxes = {
        "steel specimen, fixed": (0.0, 0.0, 10.0, 1.0), "aluminium specimen": (2.0, 1.05, 6.0, 1.0),
        "guidance": (2.0, 2.1, 6.0, 0.8), "rigid interface": (2.0, 2.95, 6.0, 0.8), "spring: normal load": (2.0, 3.8, 6.0, 1.2),
        f"hydraulic jack, {1e3 * velocity:g} mm/s": (10.5, 1.05, 6.5, 1.0), "cells: loads, displacement": (10.5, 3.8, 6.5, 1.2),
    }  # fmt: skip
    layers: list[Layer] = [Curve(name, *_box(*place)) for name, place in boxes.items()]
    layers += [Note(name, x + 0.5 * wide, y + 0.5 * high, "centre") for name, (x, y, wide, high) in boxes.items()]
    layers.append(Curve("rod", np.array([8.0, 10.5]), np.array([1.55, 1.55])))
    size = 2.5 / loads[0]  # of a newton
    arrows = (
        ("normal", (5.0, 7.7), (0.0, -1.0)),
        ("tangential, +t_a", (8.3, 2.6), (1.0, 0.0)),
        ("tangential, -t_a", (1.7, 2.6), (-1.0, 0.0)),
    )
    for hue, ((name, start, way), load) in enumerate(zip(arrows, loads, strict=True)):
        said = f"{name}: {load:g} N"
        layers.append(Arrows(said, np.array([start]), np.array([way]), size * load, hue, said.replace("t_a", "$t_a$")))
    axes = (Axis("x", "along $t_a$, not to scale", "", (-0.5, 17.5)), Axis("z", "along $n$, not to scale", "", (-0.5, 8.0)))
    names = ("normal load", "steady tangential load along +t_a", "steady tangential load along -t_a")
    facts = (*(Fact(name, load, "N") for name, load in zip(names, loads, strict=True)), Fact("velocity of the jack", velocity, "m/s"))
    return Figure((Panel(*axes, tuple(layers), equal=True),), facts=facts)


def _box(x: float, y: float, wide: float, high: float) -> tuple[Array, Array]:
    corners: Sequence[tuple[float, float]] = ((0, 0), (1, 0), (1, 1), (0, 1), (0, 0))
    at = np.array(corners) * (wide, high) + (x, y)
    return at[:, 0], at[:, 1]
