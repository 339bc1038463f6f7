"""Estimates: recovery without noise, efficiency with noise, outliers, uncertainty."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import optimize, stats

import duhem
from duhem import InputError
from duhem.identification import Points
from duhem.identification.surface import AnyFormula, QuarterEllipses
from duhem.law.domain import Domain
from tests.identification.limit_points import PAPER, design, information, on_boundary, table, values
from tests.long import mostly_long

TAIL = 1e-4


@pytest.mark.slow
@pytest.mark.parametrize("laws", mostly_long([15, 200], 15))
def test_exact_points_give_back_their_law_in_every_quadrant(laws):
    draw = np.random.default_rng(20)
    for _ in range(laws):
        mu = 10.0 ** draw.uniform(-2.0, 0.5, 4)
        angle = np.concatenate([q * np.pi / 2 + draw.uniform(0.1, 1.4, 3) for q in range(4)])
        pressure = -(10.0 ** draw.uniform(-3, 9)) * draw.uniform(0.5, 2.0, 12)
        done = duhem.identify(np.column_stack([on_boundary(mu, angle, pressure), pressure]))
        assert np.allclose(values(done), mu, rtol=1e-8, atol=0.0)
        assert not done.outliers and done.verification.generalized_standard


@pytest.mark.slow
@pytest.mark.parametrize("repeats", mostly_long([16, 80], 16))
def test_estimates_have_the_covariance_of_cramer_and_rao(repeats):
    """R whitened errors of an efficient unbiased fit: their squares add up to a chi^2 on 4 R degrees of freedom."""
    m, scatter = 32, 400.0  # 0.2 to 0.5 % of the half-axes
    angle, pressure = design(m, 3)
    truth = information(PAPER, angle, pressure, np.full(m, scatter))
    draw, errors, reported, named = np.random.default_rng(4), [], [], 0
    for _ in range(repeats):
        forces = on_boundary(PAPER, angle, pressure) + scatter * draw.standard_normal((m, 2))
        done = duhem.identify(np.column_stack([forces, pressure]))
        errors.append(values(done) - PAPER)
        reported.append(done.covariance)
        named += bool(done.outliers)
    whitened = np.array(errors) @ np.linalg.cholesky(truth)
    for z in (whitened, *whitened.T[:, :, None]):
        low, high = stats.chi2.ppf([TAIL, 1 - TAIL], z.size)
        assert low < np.sum(np.square(z)) < high
    # each reported covariance is the true one times chi^2(m - 4)/(m - 4)
    ratio = np.mean([np.trace(c @ truth) / 4 for c in reported])
    low, high = stats.chi2.ppf([TAIL, 1 - TAIL], repeats * (m - 4)) / (repeats * (m - 4))
    assert low - 0.01 < ratio < high + 0.01  # 1 % for what is of second order in the scatter
    assert named <= stats.binom.ppf(1 - TAIL, repeats, 0.02)  # a sound table is called unsound with chance about 1 %


def test_information_agrees_with_the_parametric_form():
    given = table(PAPER, noise=1e-9)
    done = duhem.identify({"sigma_a": given[:, 0], "sigma_b": given[:, 1], "sigma_n": given[:, 2], "scatter": np.full(32, 250.0)})
    expected = information(PAPER, *design(32, 0), np.full(32, 250.0))
    assert np.allclose(done.fisher, expected, rtol=1e-6, atol=1e-6 * expected.max())
    assert np.allclose(done.covariance @ expected, np.eye(4), atol=1e-6)


def test_fit_is_the_maximum_likelihood_fit():
    """Against orthogonal distances with the unknown place of every point fitted too."""
    given = table(PAPER, m=24, seed=8, noise=500.0)
    done = duhem.identify(given)
    angle, pressure = design(24, 8)

    def residual(x):
        return (on_boundary(np.exp(x[:4]), x[4:], pressure) - given[:, :2]).ravel()

    full = optimize.least_squares(residual, np.concatenate([np.log(PAPER), angle]), xtol=1e-14, ftol=1e-14)
    error = np.sqrt(np.diag(done.covariance))
    assert np.all(np.abs(values(done) - np.exp(full.x[:4])) < 0.03 * error)
    assert np.sum(np.square(done.residual)) == pytest.approx(2.0 * full.cost, rel=0.02)


@pytest.mark.long
def test_distance_by_the_shape_and_by_the_formula_agree():
    given = table(PAPER, noise=2000.0)
    law = duhem.load("antoni2007")
    shape, plain = QuarterEllipses.of(law, given[:, 2]), AnyFormula(law, given[:, 2])
    assert shape is not None
    for one, other in zip(shape.distance(given[:, :2], PAPER), plain.distance(given[:, :2], PAPER), strict=True):
        assert np.allclose(one, other, rtol=1e-9, atol=1e-9)
    slopes = shape.slope(given[:, :2], PAPER), plain.slope(given[:, :2], PAPER)
    assert np.allclose(*slopes, rtol=1e-7, atol=1e-7 * np.abs(slopes[0]).max())
    once, again = duhem.identify(given), duhem.identify(given, replace(law, closed_form=None))
    assert np.allclose(values(once), values(again), rtol=1e-9)


@pytest.mark.parametrize("robust", [False, True])
def test_weights_and_scatter_say_the_same(robust):
    given = table(PAPER, noise=600.0)
    scatter = np.where(given[:, 0] > 0, 300.0, 900.0)
    columns = {"sigma_a": given[:, 0], "sigma_b": given[:, 1], "sigma_n": given[:, 2]}
    first = duhem.identify(columns | {"weight": scatter**-2.0}, robust=robust)
    assert first.chi_squared is None and first.level > 0
    if not robust:  # Huber's corner depends on the level, which only weights leave open
        second = duhem.identify(columns | {"scatter": scatter})
        assert np.allclose(values(first), values(second), rtol=1e-9)
        assert second.level == 1.0 and second.chi_squared == pytest.approx(np.sum(np.square(second.residual)))


def test_a_weight_is_so_many_points():
    given = table(PAPER, noise=600.0)
    columns = {n: given[:, i] for i, n in enumerate(("sigma_a", "sigma_b", "sigma_n"))}
    weight = np.ones(32)
    weight[5], weight[6] = 3.0, 0.0
    repeated = np.concatenate([np.delete(given, 6, axis=0), given[[5, 5]]])
    assert np.allclose(values(duhem.identify(columns | {"weight": weight})), values(duhem.identify(repeated)), rtol=1e-9)


def test_outliers_are_named_and_the_robust_fit_resists_them():
    given = table(PAPER, m=40, seed=5, noise=400.0)
    wrong = [3, 17, 30]
    given[wrong, :2] *= [[1.4], [0.7], [1.5]]
    plain, robust = duhem.identify(given), duhem.identify(given, robust=True)
    for done in (plain, robust):
        assert sorted(o.row for o in done.outliers) == [i + 1 for i in wrong]
        assert all(abs(o.standardised) > done.bound for o in done.outliers)
        assert {o.row: np.sign(o.distance) for o in done.outliers} == {4: 1.0, 18: -1.0, 31: 1.0}
    clean = duhem.identify(np.delete(given, wrong, axis=0))
    off = [np.abs(values(d) - values(clean)) / np.sqrt(np.diag(clean.covariance)) for d in (plain, robust)]
    assert off[0].max() > 5.0 and off[1].max() < 1.5
    assert robust.level < 2.0 * 400.0 < plain.level


def test_huber_stays_put_however_far_an_outlier_goes():
    given = table(PAPER, m=40, seed=5, noise=400.0)
    seen = []
    for factor in (1.5, 15.0, 1500.0):
        given[3, :2] = factor * table(PAPER, m=40, seed=5)[3, :2]
        seen.append(values(duhem.identify(given, robust=True)))
    assert np.allclose(seen[0], seen[1], rtol=2e-4) and np.allclose(seen[0], seen[2], rtol=2e-4)


@pytest.mark.slow
@pytest.mark.parametrize("draws", mostly_long([150, 400], 150))
def test_bootstrap_is_seeded_and_has_the_size_of_the_covariance(draws):
    given = table(PAPER, m=24, seed=2, noise=400.0)
    columns = {n: given[:, i] for i, n in enumerate(("sigma_a", "sigma_b", "sigma_n"))} | {"scatter": np.full(24, 400.0)}
    done, again, other = (duhem.identify(columns, bootstrap=draws, seed=s) for s in (7, 7, 8))
    assert np.array_equal(done.draws, again.draws) and not np.array_equal(done.draws, other.draws)
    low, high = stats.chi2.ppf([TAIL, 1 - TAIL], draws - 1) / (draws - 1)
    ratio = np.var(done.draws, axis=0, ddof=1) / np.diag(done.covariance)
    assert np.all((low < ratio) & (ratio < high))
    for i, name in enumerate(done.fitted):
        assert done[name].interval == pytest.approx(tuple(np.quantile(done.draws[:, i], [0.025, 0.975])))


@pytest.mark.long
def test_residual_bootstrap_without_a_scatter():
    given = table(PAPER, m=60, seed=2, noise=400.0)
    for robust in (False, True):
        done = duhem.identify(given, bootstrap=200, robust=robust)
        ratio = done.draws.std(axis=0, ddof=1) / np.sqrt(np.diag(done.covariance))
        assert np.all((ratio > 0.6) & (ratio < 1.6))
        assert all(e.interval[0] < e.value < e.interval[1] for e in done.estimates)


def test_a_sense_without_points_is_named_and_left_open():
    given = table(PAPER)
    done = duhem.identify(given[given[:, 0] > 0])
    assert done.open == ("mu_a_minus",) and "sigma_a < 0" in done["mu_a_minus"].remark
    assert done.law.parameters["mu_a_minus"] == Domain.between(0, None) or done.law.parameters["mu_a_minus"].positive
    assert [done.coefficients[n] for n in done.fitted] == pytest.approx([0.2, 0.12, 0.15], rel=1e-9)
    assert done.verification.generalized_standard
    fixed = duhem.identify(given[given[:, 0] > 0], parameters={"mu_a_minus": "0.08"})
    assert not fixed.open and fixed["mu_a_minus"].state == "given" and fixed["mu_a_minus"].value == 0.08


def test_one_direction_settles_only_a_combination():
    angle, pressure = np.full(9, 0.7), -np.linspace(1.0, 2.0, 9)
    with pytest.raises(InputError, match="only a combination of mu_a and mu_b"):
        duhem.identify(np.column_stack([on_boundary(PAPER, angle, pressure), pressure]), "orthotropic")


def test_as_many_points_as_unknowns_leave_no_scatter_to_estimate():
    given = table(PAPER, m=4)
    done = duhem.identify(given)
    assert values(done) == pytest.approx(PAPER, rel=1e-8)
    assert done["mu_a_plus"].standard_error is None and done["mu_a_plus"].interval is None and not done.outliers
    told = duhem.identify(Points(given[:, :2], given[:, 2], np.full(4, 300.0), True, (1, 2, 3, 4), "points"))
    assert told["mu_a_plus"].standard_error > 0.0


def test_a_fit_that_has_not_come_to_rest_is_refused():
    """One reading with its decimal point three places off has no first-order distance: squares cannot use it, Huber can."""
    given = table(PAPER, m=40, seed=5, noise=400.0)
    given[5, :2] *= 1500.0
    with pytest.raises(duhem.DuhemError, match=r"not converged.*--robust"):
        duhem.identify(given)
    assert [o.row for o in duhem.identify(given, robust=True).outliers] == [6]
