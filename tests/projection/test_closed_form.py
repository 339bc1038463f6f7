"""The closed form: what each law declares, extreme values, and the facts of its increments."""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np
import pytest
import sympy as sp

import duhem
from duhem.expression import mpmath_
from duhem.law.domain import Domain
from duhem.law.formula_law import Criterion
from duhem.law.shapes import Disk, Interval, Quadrants
from duhem.projection.result import Status
from tests.long import long_at
from tests.oracles.projection import closest
from tests.projection.declared_shapes import FIGURE_5, MU, WITH_SHAPE, off, values

pytestmark = pytest.mark.usefixtures("many_digits")

# -- declarations ----------------------------------------------------------------------------------------------------


def test_laws_that_declare_a_shape() -> None:
    expected = {"antoni2007", "antoni2007-1d", "capped", "cohesive", "coulomb", "orthotropic", "regularised", "shifted-ellipse"}
    assert set(WITH_SHAPE) == expected


@pytest.mark.slow
@pytest.mark.parametrize("name", WITH_SHAPE)
def test_declared_boundary_is_where_g_vanishes_and_declared_slope_is_its(name: str) -> None:
    """g = 0 at gauge 1, and g grows by slope times the gauge's own size, at random boundary points and pressures."""
    law = duhem.load(name)
    assert law.closed_form is not None
    table = law.symbols()
    rng = np.random.default_rng(7)
    for pressure in (-0.3, -1.0, -7.5):
        known = {table[p]: v for p, v in values(law).items()} | {table["sigma_n"]: pressure}

        def at(entry: Any, known: dict[Any, Any] = known) -> Any:
            return mpmath_.evaluate(sp.sympify(entry), known, dps=40)

        def g(point: list[Any], known: dict[Any, Any] = known) -> Any:
            forces = dict(zip(law.force_symbols(), point, strict=True))
            return mpmath_.evaluate(law.g, known | forces, dps=40)

        for point, growth in _boundary(law.closed_form, at, rng):
            assert abs(g(point(1))) < 1e-35
            h = mpmath.mpf(10) ** -15
            rise = (g(point(1 + h)) - g(point(1 - h))) / (2 * h)
            assert abs(rise - growth * at(law.closed_form.slope)) < 1e-12


def _boundary(shape: Any, at: Any, rng: np.random.Generator) -> list[tuple[Any, Any]]:
    """Points by share of the way from the centre, with how fast the shape's gauge grows with that share."""
    load = at(shape.load)
    if isinstance(shape, Interval):
        return [(lambda s: [s * at(shape.plus) * load], load), (lambda s: [-s * at(shape.minus) * load], load)]
    found = []
    for angle in rng.uniform(0.0, 2 * np.pi, 12):
        cos, sin = mpmath.mpf(float(np.cos(angle))), mpmath.mpf(float(np.sin(angle)))
        norm = mpmath.sqrt(cos**2 + sin**2)
        if isinstance(shape, Disk):
            a = b = at(shape.coefficient)
            centre, growth = (0, 0), a * load
        else:
            a, b = at(shape.a_plus if cos > 0 else shape.a_minus), at(shape.b_plus if sin > 0 else shape.b_minus)
            centre, growth = (at(shape.centre_a), at(shape.centre_b)), load
        ray = (a * load * cos / norm, b * load * sin / norm)
        found.append((lambda s, r=ray, c=centre: [c[0] + s * r[0], c[1] + s * r[1]], growth))
    return found


# -- extreme values --------------------------------------------------------------------------------------------------

TINY = 5e-324


@pytest.mark.parametrize(
    ("trial", "pressure", "k"),
    [
        ((1e200, 2.0), -1e-300, 1.0),
        ((1e200, -3e200), -1.0, 1.0),
        ((1e16, 1.0), -1.0, (1.0, 1e12)),
        ((1.0, 2.0), -1.0, 1e300),
        ((1e300, 2e300), -1e300, 1e300),
        ((1e308, 1e308), -1e308, 1.0),
        ((1e308, 1e308), -1.0, 1.0),
        ((1.0, 2.0), -1e-12, 1.0),
        ((1.0, 2.0), -1.0, 1e-300),
    ],
)
def test_extremes(trial: tuple[float, float], pressure: float, k: Any) -> None:
    done = duhem.project("antoni2007", trial, pressure, k, FIGURE_5)
    answer = closest(trial, -pressure, MU, np.diag(np.broadcast_to(k, 2)))
    assert done.status[0] == Status.SLIP
    for i in (0, 1):
        if abs(answer.stress[i]) > 1e-307:
            assert off(done.stress[0, i], answer.stress[i]) <= 8
        if abs(answer.slip[i]) > 1e-307:
            assert off(done.slip[0, i], answer.slip[i]) <= 16


def test_no_pressure_leaves_no_stress() -> None:
    done = duhem.project("antoni2007", [[1.0, -2.0], [0.0, 0.0]], 0.0, [2.0, 4.0], FIGURE_5)
    assert done.stress.tolist() == [[0.0, 0.0], [0.0, 0.0]]
    assert np.allclose(done.slip, [[0.5, -0.5], [0.0, 0.0]], rtol=1e-15, atol=0)
    assert done.multiplier[0] == pytest.approx(np.hypot(0.2 * 0.5, 0.15 * 0.5), rel=1e-15)
    assert done.status.tolist() == [Status.SLIP, Status.STICK]


def test_denormal_trials_stick_under_pressure() -> None:
    done = duhem.project("antoni2007", [[TINY, TINY], [TINY, -TINY]], -1.0, parameters=FIGURE_5)
    assert done.status.tolist() == [Status.STICK] * 2


@pytest.mark.slow
@pytest.mark.parametrize("name", long_at([3], ["coulomb", "capped", "cohesive", "regularised", "orthotropic", "shifted-ellipse"]))
@pytest.mark.parametrize("k", [1.0, [1.0, 30.0], [[2.0, 1.0], [1.0, 3.0]]], ids=["isotropic", "diagonal", "full"])
def test_every_plane_law_is_optimal_to_rounding(name: str, k: Any) -> None:
    law = duhem.load(name)
    rng = np.random.default_rng(3)
    trial, pressure = rng.normal(size=(500, 2)) * 10 ** rng.uniform(-2, 2, (500, 1)), -(10 ** rng.uniform(-1.5, 1, 500))
    done = duhem.project(law, trial, pressure, k, values(law))
    assert set(done.status) == {Status.STICK, Status.SLIP}
    assert done.residuals.worst().max() <= (2e-14 if name == "regularised" else 4e-15)  # its g takes the difference of what c adds
    again = duhem.project(law, done.stress, pressure, k, values(law))
    assert np.abs(again.stress - done.stress).max() <= 1e-14 * np.abs(done.stress).max()


def test_interval() -> None:
    at = {"mu_plus": 0.25, "mu_minus": 0.5}
    trial = np.array([[0.25], [np.nextafter(0.25, 1)], [1.0], [-0.5], [-2.0], [0.0]])
    done = duhem.project("antoni2007-1d", trial, -1.0, 2.0, at)
    assert done.stress[:, 0].tolist() == [0.25, 0.25, 0.25, -0.5, -0.5, 0.0]
    assert done.slip[:, 0].tolist() == [0.0, (trial[1, 0] - 0.25) / 2, 0.375, 0.0, -0.75, 0.0]
    assert done.multiplier.tolist() == pytest.approx([0.0, 0.25 * (trial[1, 0] - 0.25) / 2, 0.25 * 0.375, 0.0, 0.5 * 0.75, 0.0], rel=1e-15)


def test_the_plane_law_on_an_axis_is_the_law_along_a_line() -> None:
    along = np.linspace(-1.0, 1.0, 41)
    plane = duhem.project("antoni2007", np.stack([along, 0 * along], axis=1), -1.3, 2.0, FIGURE_5)
    line = duhem.project("antoni2007-1d", along[:, None], -1.3, 2.0, {"mu_plus": 0.2, "mu_minus": 0.08})
    assert np.allclose(plane.stress[:, 0], line.stress[:, 0], rtol=1e-15, atol=0)
    assert np.allclose(plane.slip[:, 0], line.slip[:, 0], rtol=1e-14, atol=0)
    assert np.allclose(plane.multiplier, line.multiplier, rtol=1e-14, atol=0)


def test_zero_coefficients() -> None:
    """Where the domain lets a coefficient be zero, K has no width there."""
    g = "norm(sigma_a, sigma_b) - mu*abs(sigma_n)"
    law = Criterion("maybe-smooth", g, {"mu": Domain.between(0, 1)}, closed_form=Disk("mu"))
    done = duhem.project(law, [[3.0, 4.0]], -1.0, 2.0, {"mu": 0})
    assert done.stress.tolist() == [[0.0, 0.0]]
    assert done.slip.tolist() == [[1.5, 2.0]]
    assert done.multiplier[0] == pytest.approx(2.5, rel=1e-15)
    assert done.status[0] == Status.SLIP


def test_quadrants_and_disk_agree() -> None:
    g = "norm(sigma_a/mu, sigma_b/mu) - abs(sigma_n)"
    law = Criterion("as-ellipse", g, {"mu": Domain.fixed("0.3")}, closed_form=Quadrants("mu", "mu", "mu", "mu"))
    trial = np.random.default_rng(2).normal(size=(100, 2))
    ellipse, disk = duhem.project(law, trial, -1.0, [1.0, 5.0]), duhem.project("coulomb", trial, -1.0, [1.0, 5.0], {"mu": "0.3"})
    assert np.allclose(ellipse.stress, disk.stress, rtol=1e-15, atol=0)
    assert np.allclose(0.3 * disk.multiplier, ellipse.multiplier, rtol=1e-14, atol=0)
