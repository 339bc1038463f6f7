"""Identification: recovery without noise, efficiency with noise, outliers, uncertainty, and tables that cannot be used."""

import json
import sys
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner
from scipy import optimize, stats

import duhem
from duhem import InputError
from duhem.__main__ import main
from duhem.cli import cli
from duhem.expression.numpy_ import compiled
from duhem.identification import Points, estimation
from duhem.identification.criterion_text import criterion_text
from duhem.identification.surface import AnyFormula, QuarterEllipses
from duhem.law.criterion_file import reads
from duhem.law.domain import Domain

NAMES = ("mu_a_plus", "mu_a_minus", "mu_b_plus", "mu_b_minus")
PAPER = np.array([0.2, 0.08, 0.12, 0.15])
TAIL = 1e-4


def quarters(mu, angle):
    """Half-axes (m, 2) of the quarter ellipses that the eccentric angles (m,) lie on, and which coefficients they are."""
    which = np.stack([np.where(np.cos(angle) >= 0, 0, 1), np.where(np.sin(angle) >= 0, 2, 3)], axis=1)
    return np.asarray(mu)[which], which


def on_boundary(mu, angle, pressure):
    """Limit points (m, 2) of Eq. (35) at eccentric angles."""
    axes, _ = quarters(mu, angle)
    return axes * np.stack([np.cos(angle), np.sin(angle)], axis=1) * np.abs(pressure)[:, None]


def information(mu, angle, pressure, scatter):
    """Fisher information from the parametric form: moving mu_k moves the point, and only what is normal to the curve tells."""
    axes, which = quarters(mu, angle)
    direction = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    normal = direction / axes
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    rows = np.zeros((len(angle), 4))
    for i in range(2):
        rows[np.arange(len(angle)), which[:, i]] = normal[:, i] * direction[:, i] * np.abs(pressure)
    return (rows / np.square(scatter)[:, None]).T @ rows


def design(m, seed):
    draw = np.random.default_rng(seed)
    return np.linspace(0.0, 2.0 * np.pi, m, endpoint=False) + 0.03, -draw.uniform(0.5e6, 2e6, m)


def table(mu, m=32, seed=0, noise=0.0):
    angle, pressure = design(m, seed)
    errors = noise * np.random.default_rng(seed + 1).standard_normal((m, 2))
    return np.column_stack([on_boundary(mu, angle, pressure) + errors, pressure])


def values(done):
    return np.array([done.coefficients[n] for n in NAMES])


@pytest.mark.slow
def test_exact_points_give_back_their_law_in_every_quadrant():
    draw = np.random.default_rng(20)
    for _ in range(200):
        mu = 10.0 ** draw.uniform(-2.0, 0.5, 4)
        angle = np.concatenate([q * np.pi / 2 + draw.uniform(0.1, 1.4, 3) for q in range(4)])
        pressure = -(10.0 ** draw.uniform(-3, 9)) * draw.uniform(0.5, 2.0, 12)
        done = duhem.identify(np.column_stack([on_boundary(mu, angle, pressure), pressure]))
        assert np.allclose(values(done), mu, rtol=1e-8, atol=0.0)
        assert not done.outliers and done.verification.generalized_standard


@pytest.mark.slow
def test_estimates_have_the_covariance_of_cramer_and_rao():
    """R whitened errors of an efficient unbiased fit: their squares add up to a chi^2 on 4 R degrees of freedom."""
    repeats, m, scatter = 80, 32, 400.0  # 0.2 to 0.5 % of the half-axes
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
def test_bootstrap_is_seeded_and_has_the_size_of_the_covariance():
    given = table(PAPER, m=24, seed=2, noise=400.0)
    columns = {n: given[:, i] for i, n in enumerate(("sigma_a", "sigma_b", "sigma_n"))} | {"scatter": np.full(24, 400.0)}
    draws = 400
    done, again, other = (duhem.identify(columns, bootstrap=draws, seed=s) for s in (7, 7, 8))
    assert np.array_equal(done.draws, again.draws) and not np.array_equal(done.draws, other.draws)
    low, high = stats.chi2.ppf([TAIL, 1 - TAIL], draws - 1) / (draws - 1)
    ratio = np.var(done.draws, axis=0, ddof=1) / np.diag(done.covariance)
    assert np.all((low < ratio) & (ratio < high))
    for i, name in enumerate(done.fitted):
        assert done[name].interval == pytest.approx(tuple(np.quantile(done.draws[:, i], [0.025, 0.975])))


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


def rays(law, parameters, m, seed):
    """Limit points of any law by bisection of g along random rays."""
    draw, table_ = np.random.default_rng(seed), law.symbols()
    g = compiled(law.g, list(table_.values()))
    u = draw.standard_normal((m, len(law.forces)))
    u -= u.mean(axis=1, keepdims=True) if len(law.forces) == 3 else 0.0
    u /= np.linalg.norm(u, axis=1)[:, None]
    pressure = [-draw.uniform(1.0, 3.0, m)] if law.pressure else []
    low, high = np.full(m, 1e-6), np.full(m, 50.0)
    for _ in range(80):
        middle = 0.5 * (low + high)
        inside = g(*(u * middle[:, None]).T, *pressure, *(np.full(m, parameters[n]) for n in law.parameters)) <= 0
        low, high = np.where(inside, middle, low), np.where(inside, high, middle)
    return np.column_stack([u * low[:, None], *pressure])


@pytest.mark.slow
@pytest.mark.parametrize(
    "name, parameters",
    [
        ("antoni2007-1d", {"mu_plus": 0.33, "mu_minus": 0.29}),
        ("coulomb", {"mu": 0.3}),
        ("orthotropic", {"mu_a": 0.3, "mu_b": 0.1}),
        ("superellipse", {"mu_a": 0.3, "mu_b": 0.2, "p": 2.6}),
        ("shifted-ellipse", {"mu_a": 0.3, "mu_b": 0.2, "shift": 0.05}),
        ("limacon", {"mu": 0.3, "e": 0.4}),
        ("lobes", {"mu": 0.3, "e": -0.05}),
        ("matchstick", {"mu_a": 0.3, "mu_b": 0.25}),
        ("quartic", {"mu": 0.3, "c": 3.0}),
        ("hosford", {"yield_stress": 2.0, "m": 6.0}),
        ("capped", {"mu": 0.3, "tau_max": 0.6}),
        ("cohesive", {"mu": 0.3, "cohesion": 0.2}),
        ("regularised", {"mu": 0.3, "c": 0.2}),
        ("von-mises", {"yield_stress": 3.0}),
    ],
)
def test_other_laws_are_recovered_and_proved(name, parameters):
    law = duhem.load(name)
    done = duhem.identify(rays(law, parameters, 30, 6), name)
    assert dict(done.coefficients) == pytest.approx(parameters, rel=1e-8)
    assert done.verification.generalized_standard
    assert all(domain.value is not None for domain in done.law.parameters.values())


@pytest.mark.parametrize(
    "name, reason",
    [("box", "corners"), ("tresca", "corners"), ("radial-flow", "slip direction"), ("rotated-flow", "slip direction")],
)
def test_laws_that_are_not_suited_say_why(name, reason):
    with pytest.raises(InputError, match=reason):
        duhem.identify(table(PAPER), name)


def test_a_best_fit_that_is_not_admissible_is_refused():
    points = rays(duhem.load("limacon"), {"mu": 0.3, "e": 0.7}, 30, 6)
    with pytest.raises(InputError, match="not admissible: convexity is refuted"):
        duhem.identify(points, "limacon")
    law = duhem.load("limacon")
    narrow = replace(law, parameters=dict(law.parameters) | {"e": Domain.between(0, "1/2")})
    done = duhem.identify(points, narrow)
    assert done.coefficients["e"] == 0.5 and done.verification.generalized_standard
    with pytest.raises(InputError, match="not admissible: convexity is refuted"):
        duhem.identify(points, "limacon", convex="require")
    taken = duhem.identify(points, "limacon", convex="assume")
    assert taken.coefficients["e"] == pytest.approx(0.7) and taken.verification["convexity"].verdict is duhem.Verdict.REFUTED


def test_a_best_fit_that_is_not_proved_convex_is_refused_where_that_is_required(monkeypatch):
    law, verify = duhem.load("limacon"), estimation.verify

    def open_(*given, **named):
        done = verify(*given, **named)
        return replace(
            done, results=tuple(replace(r, verdict=duhem.Verdict.UNDECIDED) if r.claim == "convexity" else r for r in done.results)
        )

    points = rays(law, {"mu": 0.3, "e": 0.4}, 30, 6)
    assert duhem.identify(points, law, convex="require").verification.generalized_standard
    monkeypatch.setattr(estimation, "verify", open_)
    assert duhem.identify(points, law).verification["convexity"].verdict is duhem.Verdict.UNDECIDED
    with pytest.raises(InputError, match="not shown to be convex: convexity is undecided"):
        duhem.identify(points, law, convex="require")
    with pytest.raises(InputError, match="choose ask, require, assume"):
        duhem.identify(points, law, convex="maybe")


def test_criterion_text_is_read_back_as_the_same_law():
    for name in ("antoni2007", "shifted-ellipse", "superellipse", "rotated-flow", "von-mises", "drucker1949"):
        law = duhem.load(name)
        back = reads(criterion_text(law))
        assert (back.g, back.parameters, back.constraints, back.flow) == (law.g, law.parameters, law.constraints, law.flow)
    assert (
        reads(criterion_text(duhem.load("coulomb").fix({"mu": "0.00012345678901234567"}))).parameters["mu"].value * 10**20
        == 12345678901234567
    )
    with pytest.raises(InputError, match="no finite decimal"):
        criterion_text(duhem.load("coulomb").fix({"mu": "1/3"}))


# -- the command -----------------------------------------------------------------------------------------------------


def write(path, rows, header="sigma_a,sigma_b,sigma_n"):
    path.write_text(header + "\n" + "".join(",".join(map(repr, map(float, row))) + "\n" for row in rows))
    return path


def run(*arguments):
    return CliRunner().invoke(cli, list(map(str, arguments)), standalone_mode=False)


def test_command_writes_a_law_that_verify_proves(tmp_path):
    points = write(tmp_path / "points.csv", table(PAPER, noise=300.0))
    law = tmp_path / "law.toml"
    done = run("identify", points, "--out", law, "--bootstrap", 20, "--seed", 3)
    assert done.return_value == 0 and "mu_b_minus" in done.output and "bootstrap, 20 draws, seed 3" in done.output
    assert run("verify", law, "--claims", "origin,convexity,normality,dissipation").return_value == 0
    direct = duhem.identify(points)
    read = duhem.load(str(law))
    assert {n: d.value for n, d in read.parameters.items()} == {n: d.value for n, d in direct.law.parameters.items()}
    assert duhem.verify(read, claims=["origin", "convexity", "normality"]).generalized_standard


def test_command_prints_one_json_object_and_names_lines(tmp_path):
    rows = table(PAPER, m=40, seed=5, noise=400.0)
    rows[3, :2] *= 1.4
    points = write(tmp_path / "points.csv", rows, "# stresses in Pa\nsigma_a,sigma_b,sigma_n")
    done = run("identify", points, "--format", "json", "--robust")
    report = json.loads(done.output)
    assert [(o["row"], o["line"]) for o in report["outliers"]] == [(4, 6)]
    assert report["parameters"]["mu_a_plus"]["value"] == duhem.identify(points, robust=True).coefficients["mu_a_plus"]
    assert report["generalized_standard"] is True


def test_command_draws(tmp_path):
    pytest.importorskip("matplotlib")
    rows = table(PAPER, m=40, seed=5, noise=400.0)
    rows[3, :2] *= 1.4
    points = write(tmp_path / "points.csv", rows)
    assert run("identify", points, "--plot", tmp_path / "fit.svg").return_value == 0
    assert "<svg" in (tmp_path / "fit.svg").read_text()
    with pytest.raises(InputError, match=r"end the name in \.png"):
        duhem.identify(points).plot(tmp_path / "fit.nothing")


GOOD = "0.2,0.01,-1\n-0.08,0.01,-1\n0.01,0.12,-1\n0.01,-0.15,-1\n"
HEAD = "sigma_a,sigma_b,sigma_n\n"


@pytest.mark.parametrize(
    "content, place, words",
    [
        ("", "", "empty"),
        ("\n \n", "", "empty"),
        (HEAD, "", "no row below the header"),
        ("sigma_a,sigma_n\n0.1,-1\n", ":1", "no column sigma_b"),
        ("sigma_a,sigma_b,sigma_n,sigma_a\n" + GOOD, ":1", "'sigma_a' is there twice"),
        ("sigma_a,sigma_b,sigma_n,wieght\n", ":1", "did you mean 'weight'"),
        ("sigma_a,sigma_b,sigma_n,weight,scatter\n", ":1", "both weight and scatter"),
        ("sigma_a;sigma_b;sigma_n\n0,1;0,2;-1\n", ":1", "separated by semicolons; separate them by commas"),
        ("sigma_n\tsigma_b\tsigma_a\n-1\t0.1\t0.2\n", ":1", "separated by tabs; separate them by commas"),
        ("note;sigma_a;sigma_b\nx;0.1;0.2\n", ":1", "separated by semicolons"),
        ("sigma_a sigma_b   sigma_n\n0.1 0.2 -1\n", ":1", "separated by blanks; separate them by commas"),
        ("sigma_a|sigma_b|sigma_n\n0.1|0.2|-1\n", ":1", "separated by bars"),
        (GOOD, ":1", "there is no header; write the names of the columns above, sigma_a,sigma_b,sigma_n"),
        (GOOD.replace(",", ";"), ":1", "separated by semicolons; separate them by commas, with points"),
        (GOOD.replace(",", "\t").replace(".", ","), ":1", "separated by tabs; separate them by commas, with points"),
        (HEAD + "0,2,0,01,-1\n", ":2", "5 cells under 3 columns; give one cell a column, and write decimals with points"),
        (HEAD + '"0,2",0,-1\n', ":2", "sigma_a is '0,2', not a number; write a number such as -1.5e6"),
        ("sigma_a [MPa],sigma_b,sigma_n\n" + GOOD, ":1", "no column sigma_a"),
        (HEAD + "0.2,0.01,-1\n", "", "there is only 1 point for the 4 unknowns"),
        (HEAD + "0.1,0.2\n", ":2", "2 cells under 3 columns"),
        (HEAD + GOOD + "0.1,abc,-1\n", ":6", "sigma_b is 'abc', not a number"),
        (HEAD + GOOD + "0.1,,-1\n", ":6", "sigma_b is empty"),
        (HEAD + GOOD + "nan,0.1,-1\n", ":6", "sigma_a is nan"),
        (HEAD + GOOD + "0.1,0.1,-inf\n", ":6", "sigma_n is -inf"),
        (HEAD + GOOD + "0.1,0.1,1\n", ":6", "sigma_n is not negative"),
        (HEAD + GOOD + "0.1,0.1,0\n", ":6", "sigma_n is not negative"),
        (HEAD + GOOD + "0,0,-1\n", ":6", "no limit point"),
        (HEAD + GOOD + "1e200,0,-1\n", ":6", "beyond"),
        (HEAD + "0.1,0.1,-1\n" * 5, "", "all 5 points are the same"),
        (HEAD + "0.2,0.01,-1\n-0.08,0.01,-1\n0.01,0.12,-1\n", "", "only 3 points for the 4 unknowns"),
        ("sigma_a,sigma_b,sigma_n,weight\n0.2,0.01,-1,-2\n0.1,0.1,-1,1\n", ":2", "weight is negative"),
        ("sigma_a,sigma_b,sigma_n,weight\n0.2,0.01,-1,0\n0.1,0.1,-1,0\n", "", "every weight is zero"),
        ("sigma_a,sigma_b,sigma_n,scatter\n0.2,0.01,-1,1\n0.1,0.1,-1,0\n", ":3", "scatter is not positive"),
        (b"\x89PNG\r\n\x1a\n\xff\xfe", ":1", "not text in UTF-8"),
        (b"sigma_a,sigma_b\x00,sigma_n\n", ":1", "binary"),
        (None, "", "cannot be read: No such file"),
    ],
)
def test_tables_that_cannot_be_used(content, place, words, tmp_path, monkeypatch, capsys):
    file = tmp_path / "points.csv"
    if content is not None:
        file.write_bytes(content if isinstance(content, bytes) else content.encode())
    monkeypatch.setattr(sys, "argv", ["duhem", "identify", str(file)])
    assert main() == 2
    complaint = capsys.readouterr().err
    assert complaint.startswith(f"duhem: {file}{place}: ") and words in complaint
    assert complaint.count("\n") == 1 and "; " in complaint  # one line, with a remedy


def test_arguments_that_cannot_be_used():
    with pytest.raises(InputError, match=r"shape \(4, 2\)"):
        duhem.identify(np.ones((4, 2)))
    with pytest.raises(InputError, match="bootstrap"):
        duhem.identify(table(PAPER), bootstrap=-1)
    with pytest.raises(InputError, match="no free parameter"):
        duhem.identify(table(PAPER), "coulomb", parameters={"mu": 0.3})
    with pytest.raises(InputError, match="no column sigma_n"):
        duhem.identify({"sigma_a": [1.0], "sigma_b": [1.0]})
    with pytest.raises(InputError, match="no formula"):
        duhem.identify(table(PAPER), "wedge")


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
    with pytest.raises(duhem.DuhemError, match=r"not come to rest.*--robust"):
        duhem.identify(given)
    assert [o.row for o in duhem.identify(given, robust=True).outliers] == [6]


def test_an_exponent_is_written_with_few_digits_and_the_law_still_fits():
    points = rays(duhem.load("superellipse"), {"mu_a": 0.3, "mu_b": 0.2, "p": 2.61803398875}, 30, 6)
    done = duhem.identify(points, "superellipse")
    assert done.coefficients["p"] == pytest.approx(2.61803398875, rel=1e-8)
    written = {n: float(d.value) for n, d in done.law.parameters.items()}
    assert written["p"] == 2.618 and written["mu_a"] == pytest.approx(0.3, abs=1e-5)
