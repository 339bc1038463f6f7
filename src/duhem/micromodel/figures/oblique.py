"""The wedges slid over obliquely: a limit curve whose slip is not normal to it, and the nearest law whose slip would be."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from duhem.errors import InputError
from duhem.micromodel.figures.recipe import Recipe
from duhem.micromodel.figures.value import Array, Arrows, Axis, Curve, Fact, Figure, Panel, Rule
from duhem.micromodel.fit import associated_fit
from duhem.micromodel.wedge import limit_point, slip_direction

if TYPE_CHECKING:
    from duhem.law.formula_law import Criterion

__all__ = ["RECIPE", "oblique"]

_SLIPS = 1440  # sampled slip directions, a multiple of those drawn
_DRAWN = 24
_FINE = 4  # times denser still for the derivative of the limit curve


def oblique(tan_alpha: float = 1.0, tan_beta: float = 0.25, mu_alpha: float = 0.25, mu_beta: float = 0.25) -> Figure:
    """The tractions over |sigma_n| that slip at each angle phi to t_a needs, and the slips themselves.

    Beside them the four-quadrant law (Antoni et al. 2007, Eq. 35) that comes nearest to them.  The second panel is by how much
    the outward normal is turned from the slip: of the limit curve, and of the fitted law at the same direction of the
    traction.  For a generalized standard law both would be zero; the paper expects that they are not (end of its section
    2.6).  Angles in degrees, counted positive from t_a towards t_b.
    """
    from duhem.law.catalogue import load
    from duhem.micromodel.figures.boundary import boundary

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
    theta = np.unwrap(np.arctan2(points[:, 1], points[:, 0]))  # increases with phi: proved in duhem.micromodel.oblique
    off_curve = np.degrees(_turn(slip, normal))
    at_fit, off_fit = _fitted_slip(associated, fit, points, theta, phi)
    fitted = boundary(associated, fit, np.linspace(0.0, 2.0 * np.pi, 721))
    drawn = slice(0, None, _SLIPS // _DRAWN)
    closed = np.vstack([points, points[:1]])
    reach = 0.22 * float(np.abs(points).max())
    stresses = Panel(
        Axis("sigma_a/|sigma_n|", r"$\sigma_a\,/\,|\sigma_n|$"),
        Axis("sigma_b/|sigma_n|", r"$\sigma_b\,/\,|\sigma_n|$"),
        (
            Rule("sigma_a = 0", "x", 0.0),
            Rule("sigma_b = 0", "y", 0.0),
            Arrows("slip direction", points[drawn], slip[drawn], reach, None, "slip direction"),
            Curve("limit curve", closed[:, 0], closed[:, 1], 0, "limit curve"),
            Curve("best associated law", fitted[:, 0], fitted[:, 1], 1, "best associated law"),
        ),
        equal=True,
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
    settings = {"tan_alpha": tan_alpha, "tan_beta": tan_beta, "mu_alpha": mu_alpha, "mu_beta": mu_beta}
    return Figure(RECIPE.title, "the wedges of Antoni et al. (2007), Fig. 2, slid over at any angle", settings, (stresses, angles), facts)


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


RECIPE = Recipe("oblique", "Sliding obliquely over wedges: the slip is not normal to the limit curve", oblique)
