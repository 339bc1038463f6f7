r"""The associated four-quadrant criterion (Antoni et al. 2007, Eq. 35) that comes nearest to the oblique limit curve.

gamma(s)^2 = (s_a/mu_a^+-)^2 + (s_b/mu_b^+-)^2 is linear in the four 1/mu^2, so gamma(T)^2 = 1 is fitted by least squares over
slip directions; the error is measured afterwards, as the relative error of the limit load along each loading direction.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from duhem.errors import InputError
from duhem.micromodel.wedge import limit_point

__all__ = ["FourQuadrantFit", "associated_fit"]


@dataclass(frozen=True)
class FourQuadrantFit:
    """Coefficients of ``antoni2007`` and how well they do.

    ``largest_error`` is the greatest |limit load of the fit / true limit load - 1| over loading directions, taken at the slip
    angle ``error_angle`` (rad); ``root_mean_square`` the mean over slip angles.
    """

    mu_a_plus: float
    mu_a_minus: float
    mu_b_plus: float
    mu_b_minus: float
    largest_error: float
    error_angle: float
    root_mean_square: float

    def parameters(self) -> dict[str, float]:
        """The four coefficients by the names of the law ``antoni2007``."""
        return {name: getattr(self, name) for name in ("mu_a_plus", "mu_a_minus", "mu_b_plus", "mu_b_minus")}


def associated_fit(alpha: float, beta: float, mu_alpha: float, mu_beta: float, *, angles: int = 3600) -> FourQuadrantFit:
    """Least squares over ``angles`` slip directions; angles in radians.

    InputError as :func:`duhem.micromodel.wedge.coefficients`, for fewer than 16 angles, and for a profile without friction,
    whose limit curve is a point.
    """
    if angles < 16:
        raise InputError(f"{angles} slip directions are too few", where="angles", remedy="give 16 or more")
    phi = 2 * np.pi * (np.arange(angles) + 0.5) / angles
    points = limit_point(phi, alpha, beta, mu_alpha, mu_beta)
    squares = np.concatenate([np.where(points > 0, points, 0) ** 2, np.where(points < 0, points, 0) ** 2], axis=1)
    if not (squares.max(axis=0) > 0).all():
        raise InputError("the limit curve does not surround zero", where="mu_alpha, mu_beta", remedy="give a coefficient > 0")
    scale = squares.max(axis=0)
    inverse = np.linalg.lstsq(squares / scale, np.ones(angles), rcond=None)[0] / scale
    if not (inverse > 0).all():
        raise InputError(
            "no four-quadrant ellipse comes near this limit curve", where="profile", remedy="give gentler slopes or less friction"
        )
    error = 1 / np.sqrt(squares @ inverse) - 1
    worst = int(np.argmax(np.abs(error)))
    a_plus, b_plus, a_minus, b_minus = (float(x) for x in 1 / np.sqrt(inverse))
    rms = float(np.sqrt(np.mean(error**2)))
    return FourQuadrantFit(a_plus, a_minus, b_plus, b_minus, float(abs(error[worst])), float(phi[worst]), rms)
