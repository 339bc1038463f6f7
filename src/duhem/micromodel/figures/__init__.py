"""Figures of the source paper (Antoni et al. 2007) and one beyond it, each a value computed from the model.

``FIGURES[name](**settings)`` gives a :class:`Figure` or a :class:`Table`: arrays, labels, units and the numbers to read off.
:func:`duhem.micromodel.figures.value.save` draws a figure; nothing else here needs matplotlib.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from types import MappingProxyType

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from duhem.errors import InputError
from duhem.expression.rays import exits
from duhem.law.catalogue import load
from duhem.law.formula_law import Criterion
from duhem.micromodel.experiment import STEEL_ON_ALUMINIUM, Experiment
from duhem.micromodel.figures.value import (
    Array,
    Arrows,
    Axis,
    Band,
    Curve,
    Fact,
    Figure,
    Layer,
    Marks,
    Note,
    Panel,
    Recipe,
    Rule,
    Table,
    unknown,
)
from duhem.micromodel.wedge import associated_fit, coefficients, limit_point, slip_direction

__all__ = ["FIGURES", "Figure", "Recipe", "Table", "boundary", "unknown"]


# -- sketches ----------------------------------------------------------------------------------------------------------


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
    for hue, ((name, start, way), tangential) in enumerate(zip(arrows, loads, strict=True)):
        said = f"{name}: {tangential:g} N"
        layers.append(Arrows(said, np.array([start]), np.array([way]), size * tangential, hue, said.replace("t_a", "$t_a$")))
    axes = (Axis("x", "along $t_a$, not to scale", "", (-0.5, 17.5)), Axis("z", "along $n$, not to scale", "", (-0.5, 8.0)))
    names = ("normal load", "steady tangential load along +t_a", "steady tangential load along -t_a")
    facts = (*(Fact(name, load, "N") for name, load in zip(names, loads, strict=True)), Fact("velocity of the jack", velocity, "m/s"))
    return Figure((Panel(*axes, tuple(layers), equal=True),), facts=facts)


def _box(x: float, y: float, wide: float, high: float) -> tuple[Array, Array]:
    corners: Sequence[tuple[float, float]] = ((0, 0), (1, 0), (1, 1), (0, 1), (0, 0))
    at = np.array(corners) * (wide, high) + (x, y)
    return at[:, 0], at[:, 1]


_DOUBLINGS = np.arange(-40, 41)  # from |sigma_n|: coefficients from 1e-12 to 1e12

_SUBSTEPS = 240  # with the defaults the corners of the loop fall on steps

_POINTS_4 = 1201
_WITHIN = 1e-9  # how close to the ends of the sliding range, as a part of it, the curves are sampled

_RAYS = 721
_ARROWS = 24

_MISPRINT = 229

_POINTS_9 = 401

_SLIPS = 1440  # sampled slip directions, a multiple of those drawn
_DRAWN = 24
_FINE = 4  # times denser still for the derivative of the limit curve


def _stress_plane(*layers: Layer) -> Panel:
    """The plane of both forces over the pressure, with its axes."""
    axes = Rule("sigma_a = 0", "x", 0.0), Rule("sigma_b = 0", "y", 0.0)
    a, b = (Axis(f"sigma_{i}/|sigma_n|", rf"$\sigma_{i}\,/\,|\sigma_n|$") for i in "ab")
    return Panel(a, b, (*axes, *layers), equal=True)


def boundary(law: Criterion, parameters: Mapping[str, float], angle: ArrayLike, pressure: float = -1.0) -> Array:
    """Points (n, 2) where the rays at ``angle`` (n,), in rad from the first force, leave K(sigma_n = ``pressure``).

    K has to be star-shaped about 0, which lies inside.  InputError for parameters outside their domain and for a ray
    along which g does not become positive.
    """
    fixed = law.fix(parameters)
    table = fixed.symbols()
    theta = np.asarray(angle, dtype=np.float64)
    ways = np.stack([np.cos(theta), np.sin(theta)], axis=-1)
    others = {table[str(fixed.pressure)]: pressure, **{table[name]: value for name, value in parameters.items()}}
    last, first = exits(fixed.g, fixed.force_symbols(), ways, abs(pressure) * np.ldexp(1.0, _DOUBLINGS), others)
    if (last == first).any():
        raise InputError("a ray from 0 does not leave K", where=law.name, remedy="draw a law that is bounded")
    return last[:, None] * ways


def law_1d(
    mu_plus: float = 0.2, mu_minus: float = 0.08, stiffness: float = 1e11, pressure: float = -1e6, amplitude: float = 6e-6
) -> Figure:
    """sigma_t over u_t from rest to +amplitude, back to -amplitude and to +amplitude again (Antoni et al. 2007, Eq. 1, Fig. 1).

    ``stiffness`` k_t in Pa/m, ``pressure`` sigma_n <= 0 in Pa, ``amplitude`` in m; the figure is in micrometres and MPa.
    The dissipation of the closed cycle is the integral of sigma_t du_in as the integrator sums it, and the area of the loop.
    """
    from duhem.path import Path, simulate

    if not (pressure < 0.0 < amplitude):
        raise InputError("without pressure or displacement there is no loop", remedy="give pressure < 0 < amplitude")
    path = Path.cycle(amplitude, pressure=pressure)
    fixed = {"mu_plus": mu_plus, "mu_minus": mu_minus}
    history = simulate(load("antoni2007-1d"), path, stiffness=stiffness, parameters=fixed, method="exact", substeps=_SUBSTEPS)
    u, sigma = 1e6 * history.displacement[:, 0], 1e-6 * history.stress[:, 0]
    rest, loop = slice(0, _SUBSTEPS + 1), slice(_SUBSTEPS, None)
    back, forth = 3 * _SUBSTEPS // 2, 5 * _SUBSTEPS // 2
    # Halfway along the elastic rise, to say what its slope is.
    half = int(np.argmax(sigma[rest] >= 0.5 * sigma[rest].max()))
    at = np.array([back + _SUBSTEPS // 4, forth + _SUBSTEPS // 4])
    limit = 1e-6 * abs(pressure)
    panel = Panel(
        Axis("u_t", r"tangential displacement $u_t$", "µm"),
        Axis("sigma_t", r"tangential stress $\sigma_t$", "MPa", (-1.5 * mu_minus * limit, 1.2 * mu_plus * limit)),
        (
            Rule("upper limit", "y", mu_plus * limit, 1, r"$\mu^+|\sigma_n|$"),
            Rule("lower limit", "y", -mu_minus * limit, 2, r"$-\mu^-|\sigma_n|$"),
            Rule("zero", "y", 0.0),
            Curve("first loading", u[rest], sigma[rest], None, "first loading"),
            Curve("closed cycle", u[loop], sigma[loop], 0, "closed cycle"),
            Arrows("sense", np.stack([u[at], sigma[at]], axis=1), np.array([[-1.0, 0.0], [1.0, 0.0]]), 0.16e6 * amplitude, 0),
            Note(r"slope $k_t$", float(u[half]), float(sigma[half]), "left"),
        ),
    )
    facts = (
        Fact("dissipation per cycle", float(history.dissipation[-1] - history.dissipation[_SUBSTEPS]), "J/m²"),
        Fact("greatest stress", float(sigma.max()), "MPa"),
        Fact("least stress", float(sigma.min()), "MPa"),
    )
    return Figure((panel,), facts=facts)


def asymmetry(height_over_period: float = 0.2, mu_high: float = 0.3, mu_low: float = 0.2) -> Figure:
    """mu_a^+ - mu_a^- over alpha, where 1/tan alpha + 1/tan beta = L/h (Antoni et al. 2007, Eqs. 4, 16, 17, Fig. 4).

    Three cases of (mu_alpha, mu_beta): (high, high), (high, low), (low, high).  Each curve ends where a side can no longer
    be climbed, mu_alpha tan alpha = 1 or mu_beta tan beta = 1; there the asymmetry is unbounded.  Angles in degrees.
    """
    if not (height_over_period > 0.0 < mu_low < mu_high):
        raise InputError("this is no figure of three cases", remedy="give height_over_period > 0 and 0 < mu_low < mu_high")
    period = 1.0 / height_over_period
    layers: list[Layer] = []
    facts: list[Fact] = [Fact("alpha where alpha = beta", float(np.degrees(np.arctan(2.0 * height_over_period))), "deg")]
    for hue, (mu_alpha, mu_beta) in enumerate([(mu_high, mu_high), (mu_high, mu_low), (mu_low, mu_high)]):
        case = f"{mu_alpha:g}, {mu_beta:g}"
        if period <= mu_alpha + mu_beta:
            raise InputError(
                f"no wedge of this height and period can be climbed on both sides with {case}",
                remedy=f"keep height_over_period below 1/(mu_alpha + mu_beta) = {1.0 / (mu_alpha + mu_beta):g}",
            )
        # cot alpha lies between mu_alpha (Eq. 4) and L/h - mu_beta (Eq. 16).
        low, high = np.arctan(1.0 / (period - mu_beta)), np.arctan(1.0 / mu_alpha)
        alpha = low + (high - low) * (0.5 - 0.5 * np.cos(np.pi * np.linspace(0.0, 1.0, _POINTS_4)))
        alpha = np.clip(alpha, low + _WITHIN * (high - low), high - _WITHIN * (high - low))
        difference = _difference(alpha, period, mu_alpha, mu_beta)
        zero = _zero(alpha, period, mu_alpha, mu_beta)
        said = "".join(f": zero at {angle:.1f}°" for angle in np.degrees(zero))
        layers += [
            Curve(case, np.degrees(alpha), difference, hue, rf"$\mu_\alpha = {mu_alpha:g},\ \mu_\beta = {mu_beta:g}$" + said),
            Marks(f"zero ({case})", np.degrees(zero), 0.0 * zero, hue),
        ]
        ends = {"least alpha": low, "greatest alpha": high}
        facts += [Fact(f"{name} ({case})", float(np.degrees(end)), "deg") for name, end in ends.items()]
        facts += [Fact(f"zero ({case})", float(angle), "deg") for angle in np.degrees(zero)]
    panel = Panel(
        Axis("alpha", r"slope angle $\alpha$", "deg"),
        Axis("mu_plus - mu_minus", r"asymmetry $\mu_a^+ - \mu_a^-$", "", (-0.3, 0.3)),
        (Rule("no asymmetry", "y", 0.0), Rule("alpha = beta", "x", facts[0].value, None, r"$\alpha = \beta$"), *layers),
        legend="lower right",
    )
    return Figure((panel,), facts=tuple(facts))


def _difference(alpha: Array, period: float, mu_alpha: float, mu_beta: float) -> Array:
    beta = np.arctan2(np.tan(alpha), period * np.tan(alpha) - 1.0)
    plus, minus = coefficients(alpha, beta, mu_alpha, mu_beta)
    return np.asarray(plus - minus)


def _zero(alpha: Array, period: float, mu_alpha: float, mu_beta: float) -> Array:
    """Every angle at which the sampled curve changes sign, to rounding."""
    from scipy.optimize import brentq

    def at(angle: float) -> float:
        return float(_difference(np.array(angle), period, mu_alpha, mu_beta))

    signs = np.sign(_difference(alpha, period, mu_alpha, mu_beta))
    brackets = ((float(p), float(q)) for (p, q), (s, t) in zip(pairwise(alpha), pairwise(signs), strict=True) if s * t < 0.0)
    return np.array([brentq(at, *bracket, xtol=1e-15) for bracket in brackets])


def criterion(
    mu_a_plus: float = 0.2, mu_a_minus: float = 0.08, mu_b_plus: float = 0.12, mu_b_minus: float = 0.15, mu_isotropic: float = 0.08
) -> Figure:
    """The boundary of K over |sigma_n| (Antoni et al. 2007, Eq. 35, Fig. 5), dimensionless.

    The curves are the laws' own formulas solved on rays; the arrows are the slips of :func:`duhem.project` on stresses
    outside, with equal stiffness in both directions: outward normals, by the normality rule (Eq. 36).
    """
    from duhem.projection.projector import Projector

    law = load("antoni2007")
    parameters = {"mu_a_plus": mu_a_plus, "mu_a_minus": mu_a_minus, "mu_b_plus": mu_b_plus, "mu_b_minus": mu_b_minus}
    angle = np.linspace(0.0, 2.0 * np.pi, _RAYS)
    asymmetric = boundary(law, parameters, angle)
    isotropic = boundary(load("coulomb"), {"mu": mu_isotropic}, angle)
    reach = float(np.abs(asymmetric).max())
    around = np.linspace(0.0, 2.0 * np.pi, _ARROWS, endpoint=False)
    outside = boundary(law, parameters, around) * 1.5
    slipped = Projector.of(law, 1.0, parameters, "newton")(outside, -1.0)
    direction = slipped.slip / np.linalg.norm(slipped.slip, axis=1, keepdims=True)
    panel = _stress_plane(
        Arrows("slip direction", slipped.stress, direction, 0.17 * reach, None, "slip direction"),
        Curve("asymmetric", asymmetric[:, 0], asymmetric[:, 1], 0, "asymmetric, Eq. (35)"),
        Curve("isotropic", isotropic[:, 0], isotropic[:, 1], 1, rf"isotropic, $\mu = {mu_isotropic:g}$"),
    )
    ends = boundary(law, parameters, np.pi * np.array([0.0, 1.0, 0.5, 1.5]))
    names = ("along +a", "along -a", "along +b", "along -b")
    facts = tuple(Fact(name, float(np.hypot(*end))) for name, end in zip(names, ends, strict=True))
    return Figure((panel,), facts=facts)


def loads(
    mu: float = 0.25,
    normal_load: float = float(STEEL_ON_ALUMINIUM.normal_load),
    measured_plus: float = float(STEEL_ON_ALUMINIUM.measured_plus),
    measured_minus: float = float(STEEL_ON_ALUMINIUM.measured_minus),
) -> Table:
    """Steady tangential loads along +t_a and -t_a under ``normal_load`` in N (Antoni et al. 2007, Fig. 8, Eqs. 13, 15).

    ``measured_plus`` and ``measured_minus`` are the measured coefficients, ``mu`` the local one that the prediction takes, which
    was not measured.  Of the record only these steady values stand in the text, not the curves.
    """
    test = replace(STEEL_ON_ALUMINIUM, normal_load=normal_load, measured_plus=measured_plus, measured_minus=measured_minus)
    found = test.predicted(mu)
    best, least = test.least_scatter()
    fitted = test.predicted(best.low)

    def row(sense: str, measured: sp.Rational, predicted: sp.Rational) -> tuple[str | float, ...]:
        sizes = (measured * test.normal_load, measured, predicted, predicted * test.normal_load, 100 * (predicted / measured - 1))
        return (sense, *map(float, sizes))

    remarks = (
        f"The text prints {_MISPRINT} N along -t_a beside the coefficient 0.29, which is 290 N: a misprint "
        "(duhem.micromodel.experiment.errata).",
        f"At mu = {float(best):.4g} both are off by the same, {float(least):.2g}, and at no mu by less: "
        f"{float(fitted.plus):.4g} and {float(fitted.minus):.4g}.",
    )
    columns = ("sense", "measured load (N)", "measured mu", "predicted mu", "predicted load (N)", "predicted above measured (%)")
    rows = (row("+t_a", test.measured_plus, found.plus), row("-t_a", test.measured_minus, found.minus))
    facts = (Fact("mu that meets both best", float(best)), Fact("misfit of the coefficients there", float(least)))
    return Table(columns, rows, remarks, facts=facts)


def apparent(
    mu: float = 0.25,
    mu_low: float = float(STEEL_ON_ALUMINIUM.mu_low),
    mu_high: float = float(STEEL_ON_ALUMINIUM.mu_high),
    mu_least: float = 0.15,
    mu_greatest: float = 0.35,
    period: float = float(STEEL_ON_ALUMINIUM.period),
    height: float = float(STEEL_ON_ALUMINIUM.height),
    tan_alpha: float = float(STEEL_ON_ALUMINIUM.tan_alpha),
    measured_plus: float = float(STEEL_ON_ALUMINIUM.measured_plus),
    measured_minus: float = float(STEEL_ON_ALUMINIUM.measured_minus),
) -> Figure:
    """mu_a^+ and mu_a^- over the local coefficient mu_alpha = mu_beta (Antoni et al. 2007, Eqs. 13, 15, Fig. 9).

    ``mu`` at which values are marked, the range mu_low to mu_high that the paper takes as admissible, the ends mu_least and
    mu_greatest of the curves, ``period`` and ``height`` of the wedges in m, the slope of one side, and the measured
    coefficients; but for the lengths all dimensionless.
    """
    if not 0.0 <= mu_least < mu_greatest:
        raise InputError("this range of mu is empty", remedy="give 0 <= mu_least < mu_greatest")
    test = Experiment(period, height, tan_alpha, STEEL_ON_ALUMINIUM.normal_load, measured_plus, measured_minus, mu_low, mu_high)
    local = np.linspace(mu_least, mu_greatest, _POINTS_9)
    plus, minus = coefficients(np.arctan(tan_alpha), np.arctan(float(test.tan_beta)), local, local)
    marked = test.predicted(mu)
    panel = Panel(
        Axis("mu", r"local coefficient $\mu = \mu_\alpha = \mu_\beta$", "", (mu_least, mu_greatest)),
        Axis("mu_a", r"apparent coefficient $\mu_a^\pm$"),
        (
            Band("admissible", mu_low, mu_high, rf"admissible, ${mu_low:g} \leq \mu \leq {mu_high:g}$"),
            Rule("measured along +t_a", "y", measured_plus, 0, rf"measured along $+t_a$: {measured_plus:g}"),
            Rule("measured along -t_a", "y", measured_minus, 1, rf"measured along $-t_a$: {measured_minus:g}"),
            Curve("mu_a_plus", local, plus, 0, r"$\mu_a^+$, Eq. (13)"),
            Curve("mu_a_minus", local, minus, 1, r"$\mu_a^-$, Eq. (15)"),
            Marks("marked mu_a_plus", np.array([mu]), np.array([float(marked.plus)]), 0),
            Marks("marked mu_a_minus", np.array([mu]), np.array([float(marked.minus)]), 1),
            Note(f"{float(marked.plus):.4f}", mu, float(marked.plus), "above left"),
            Note(f"{float(marked.minus):.4f}", mu, float(marked.minus), "below right"),
        ),
    )
    facts = (
        Fact(f"mu_a_plus at mu = {mu:g}", float(marked.plus)),
        Fact(f"mu_a_minus at mu = {mu:g}", float(marked.minus)),
        Fact(f"mu at which mu_a_plus = {measured_plus:g}", float(test.local_friction(plus=measured_plus))),
        Fact(f"mu at which mu_a_minus = {measured_minus:g}", float(test.local_friction(minus=measured_minus))),
    )
    return Figure((panel,), facts=facts)


def oblique(tan_alpha: float = 1.0, tan_beta: float = 0.25, mu_alpha: float = 0.25, mu_beta: float = 0.25) -> Figure:
    """The tractions over |sigma_n| that slip at each angle phi to t_a needs, and the slips themselves.

    Beside them the four-quadrant law (Antoni et al. 2007, Eq. 35) that comes nearest to them.  The second panel is by how much
    the outward normal is turned from the slip: of the limit curve, and of the fitted law at the same direction of the
    traction.  For a generalized standard law both would be zero; the paper expects that they are not (end of its section
    2.6).  Angles in degrees, counted positive from t_a towards t_b.
    """

    if min(tan_alpha, tan_beta) <= 0.0:
        raise InputError("a side of a wedge has a positive slope", remedy="give tan_alpha > 0 and tan_beta > 0")
    profile = (np.arctan(tan_alpha), np.arctan(tan_beta), mu_alpha, mu_beta)
    associated = load("antoni2007")
    phi = 2.0 * np.pi * np.arange(_SLIPS) / _SLIPS
    points = limit_point(phi, *profile)
    nearest = associated_fit(*profile)
    fit = nearest.parameters()
    slip = slip_direction(phi)
    normal = _normals(limit_point(2.0 * np.pi * np.arange(_FINE * _SLIPS) / (_FINE * _SLIPS), *profile))[::_FINE]
    theta = np.unwrap(np.arctan2(points[:, 1], points[:, 0]))  # increases with phi: proved in duhem.micromodel.derivation
    off_curve = np.degrees(_turn(slip, normal))
    at_fit, off_fit = _fitted_slip(associated, fit, points, theta, phi)
    fitted = boundary(associated, fit, np.linspace(0.0, 2.0 * np.pi, 721))
    drawn = slice(0, None, _SLIPS // _DRAWN)
    closed = np.vstack([points, points[:1]])
    reach = 0.22 * float(np.abs(points).max())
    stresses = _stress_plane(
        Arrows("slip direction", points[drawn], slip[drawn], reach, None, "slip direction"),
        Curve("limit curve", closed[:, 0], closed[:, 1], 0, "limit curve"),
        Curve("best associated law", fitted[:, 0], fitted[:, 1], 1, "best associated law"),
    )
    angles = Panel(
        Axis("angle of traction", r"angle of the traction to $t_a$", "deg", (0.0, 360.0), 45.0),
        Axis("normal - slip", "normal turned from slip", "deg"),
        (
            Rule("slip", "y", 0.0),
            Curve("limit curve", np.degrees(theta), off_curve, 0, "normal of the limit curve"),
            Curve("best associated law", at_fit, off_fit, 1, "normal of the best associated law"),
        ),
    )
    worst = int(np.argmax(np.abs(off_curve[: _SLIPS // 2])))  # the other half is its mirror image
    facts = (
        Fact("mu_a_plus", float(points[0, 0])),
        Fact("mu_a_minus", float(-points[_SLIPS // 2, 0])),
        Fact("mu_b", float(points[_SLIPS // 4, 1])),
        Fact("greatest deviation from normality", float(abs(off_curve[worst])), "deg"),
        Fact("slip angle there", float(np.degrees(phi[worst])), "deg"),
        Fact("least dissipation", float((points * slip).sum(axis=1).min())),
        *(Fact(f"fitted {name}", value) for name, value in fit.items()),
        Fact("greatest misfit of the limit load", nearest.largest_error),
        Fact("greatest deviation of the fitted law", float(np.abs(off_fit).max()), "deg"),
    )
    return Figure((stresses, angles), facts=facts)


def _fitted_slip(law: Criterion, fit: Mapping[str, float], points: Array, theta: Array, phi: Array) -> tuple[Array, Array]:
    """Directions of traction (n,), increasing, and by how much the fitted law's slip is turned from the wedges' there; degrees.

    The wedges' tractions ``points`` have the directions ``theta``, increasing, and the slips ``phi``, all in rad.
    """
    from duhem.projection.projector import Projector

    # The closest point of K to a stress outside moves along the normal there: the fitted law's slip.
    predicted = Projector.of(law, 1.0, fit)(1.5 * points, -1.0)
    at = np.arctan2(predicted.stress[:, 1], predicted.stress[:, 0])
    wedges = slip_direction(at + np.interp(at, theta, phi - theta, period=2.0 * np.pi))
    order = np.argsort(at % (2.0 * np.pi))
    return np.degrees(at % (2.0 * np.pi))[order], np.degrees(_turn(wedges, predicted.slip))[order]


def _normals(points: Array) -> Array:
    """Outward unit normals (n, 2) of a smooth closed curve sampled evenly in its parameter, anticlockwise."""
    n = len(points)
    along = np.fft.irfft(1j * np.arange(n // 2 + 1)[:, None] * np.fft.rfft(points, axis=0), n, axis=0)
    outward = np.stack([along[:, 1], -along[:, 0]], axis=1)
    return outward / np.linalg.norm(outward, axis=1, keepdims=True)


def _turn(start: Array, end: Array) -> Array:
    """The angles (n,) from the directions ``start`` to the directions ``end``, in (-pi, pi]."""
    cross = start[:, 0] * end[:, 1] - start[:, 1] * end[:, 0]
    return np.asarray(np.arctan2(cross, (start * end).sum(axis=1)))


_RECIPES = (
    Recipe("1", "Asymmetric friction along a line: one cycle of displacement", "Antoni et al. (2007), Fig. 1, Eq. (1)", law_1d),
    Recipe("2", "Wedges on the surface of a body, and their two sides", "Antoni et al. (2007), Fig. 2", texture),
    Recipe("3", "Springs on a wedge, and their forces", "Antoni et al. (2007), Fig. 3, Eqs. (2)-(12)", contact),
    Recipe(
        "4",
        "Asymmetry of friction against the slope of a wedge of given height and period",
        "Antoni et al. (2007), Fig. 4, Eq. (17)",
        asymmetry,
    ),
    Recipe("5", "Asymmetric friction criterion beside an isotropic one", "Antoni et al. (2007), Fig. 5, Eq. (35)", criterion),
    Recipe("6", "Surfaces of the two specimens", "Antoni et al. (2007), Fig. 6", specimens),
    Recipe("7", "Parts of the test bench", "Antoni et al. (2007), Fig. 7", bench),
    Recipe(
        "8",
        "Tangential loads measured on the wedge specimen beside the predicted ones",
        "Antoni et al. (2007), Fig. 8, section 3.2",
        loads,
        drawn=False,
    ),
    Recipe(
        "9",
        "Apparent coefficients of friction of the specimen against the local one",
        "Antoni et al. (2007), Fig. 9, Eqs. (13), (15)",
        apparent,
    ),
    Recipe(
        "oblique",
        "Sliding obliquely over wedges: the slip is not normal to the limit curve",
        "the wedges of Antoni et al. (2007), Fig. 2, slid over at any angle",
        oblique,
    ),
)
FIGURES: Mapping[str, Recipe] = MappingProxyType({recipe.name: recipe for recipe in _RECIPES})
