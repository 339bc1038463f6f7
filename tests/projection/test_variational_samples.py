"""Points of K that the judge knows: where they lie, what they cost, and that those of one law are never taken for another's."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from duhem.law.formula_law import Criterion
from duhem.projection.increment import Metric, increment
from duhem.projection.projector import Projector
from duhem.projection.scaled_formula import Level, level
from duhem.projection.variational_samples import Variational, beyond_tangents, tips


def of(law: Criterion | str, **values: float) -> Level:
    asked = Projector.of(law, 1.0, values, "newton").setting
    named = asked.law
    return level(asked.g, named.force_symbols(), named.symbols()[named.pressure] if named.pressure else None)


@pytest.mark.parametrize("order", [1, -1])
def test_tips_are_of_these_parameters_and_this_pressure(order: int) -> None:
    asked = list(product([0.2, 0.5], [1.0, 3e-4, 7e80], [-2.0, -2.1, -1e-150, 0.0]))[::order]
    for mu, cohesion, pressure in [*asked, *asked[::-1]]:  # every one again, after the others
        reach = cohesion - mu * pressure
        known = tips(of("cohesive", mu=mu, cohesion=cohesion), 2, pressure)
        assert known == pytest.approx(reach * np.array([[0, 0], [1, 0], [0, 1], [-1, 0], [0, -1]]), rel=2e-12, abs=0.0)
        assert (np.linalg.norm(known, axis=1) <= reach).all()


def test_tips_tell_the_axes_and_the_sides_apart() -> None:
    law = of(Criterion("uneven", "max(sigma_a - 3, -sigma_a - 2e-9, sigma_b - 5e12, -sigma_b - 1e-9)"))
    known = np.array([[0, 0], [3, 0], [0, 5e12], [-2e-9, 0], [0, -1e-9]])
    assert tips(law, 2, None) == pytest.approx(known, rel=2e-12, abs=0.0)


def test_k_is_seen_not_to_be_convex_with_these_parameters() -> None:
    given = [0.3, 0.8, 0.45, 0.95]  # the limacon is convex to e = 1/2
    for e in [*given, *given[::-1]]:
        for pressure in (-1.0, -30.0):
            beyond = beyond_tangents(of("limacon", mu=0.4, e=e), 2, np.array([pressure]))
            assert bool(len(beyond)) == (e > 0.5)


def test_k_is_seen_not_to_be_convex_under_this_pressure() -> None:
    notched = of(Criterion("notched", "max(norm(sigma_a, sigma_b) - 2, min(sigma_a - 1, sigma_b + sigma_n))"))
    given = [-1.0, -2.0, -1.5, -3.0]  # where sigma_a > 1 the disk ends at sigma_b = sqrt(3)
    for pressure in [*given, *given[::-1]]:
        assert bool(len(beyond_tangents(notched, 2, np.array([pressure])))) == (pressure > -np.sqrt(3.0))


def test_a_pressure_that_is_new_costs_few_evaluations() -> None:
    class Counted:
        calls = 0

        def __call__(self, a: np.ndarray, b: np.ndarray, pressure: np.ndarray) -> np.ndarray:
            self.calls += 1
            return np.hypot(a, b) + 0.3 * pressure

    for pressure in (-1e-290, -1.0, -1e290, 0.0):
        counted = Counted()
        assert tips(counted, 2, pressure)[1, 0] == pytest.approx(-0.3 * pressure, rel=2e-12, abs=0.0)  # type: ignore[arg-type]
        assert counted.calls <= 11


@pytest.mark.parametrize("convex", [True, False])
@pytest.mark.parametrize("pressure", [-1.0, -1.99, -1.5e-3])
def test_what_is_known_where_k_may_not_be_convex_is_of_the_pressure_itself(pressure: float, convex: bool) -> None:
    """Points scaled from another pressure would mostly lie outside K where it does not grow in proportion, and speak against nothing."""
    law = Criterion("two discs", "min(norm(a - 2, b), norm(a + 2, b)) - 1 + p/3", forces=("a", "b"), pressure="p")
    asked = increment(law, [[5.0, 1.0]], pressure, 1.0, {})
    g = level(asked.g, law.force_symbols(), law.symbols()["p"])
    known = Variational.of(asked, g, Metric.of(asked.stiffness), convex)
    assert (known.largest == pressure) == (not convex or pressure == -1.0)
    if not convex:
        seen = known.tips[known.tips.any(axis=1)]  # no stress stands for what is not known
        assert len(seen) > 100 and (g(*seen.T, np.full(len(seen), pressure)) < 0.0).all()
