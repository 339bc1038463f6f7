"""Laws of other shapes are fitted and proved, or refused with the reason; a fitted law is written down and read back."""

from dataclasses import replace

import numpy as np
import pytest

import duhem
from duhem import InputError
from duhem.identification import estimation
from duhem.law.criterion_file import criterion_text, reads
from duhem.law.domain import Domain
from tests.identification.limit_points import PAPER, rays, table
from tests.long import long_but


@pytest.mark.slow
@pytest.mark.parametrize(
    "name, parameters",
    long_but(
        [*range(3), 8, 10, 11, 13],
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
    ),
)
def test_other_laws_are_recovered_and_proved(name, parameters):
    law = duhem.load(name)
    done = duhem.identify(rays(law, parameters, 30, 6), name)
    assert dict(done.coefficients) == pytest.approx(parameters, rel=1e-8)
    assert done.verification.generalized_standard
    assert all(domain.value is not None for domain in done.law.parameters.values())


@pytest.mark.parametrize("name, parameters, over", [("cohesive", {"mu": 0.3, "cohesion": 0.5}, None), ("coulomb", {"mu": 0.3}, 1.0)])
def test_points_on_the_boundary_are_drawn_on_it_whatever_pressure_they_have(name, parameters, over):
    pytest.importorskip("matplotlib")
    points = rays(duhem.load(name), parameters, 30, 6)
    axes = duhem.identify(points, name).plot()
    places = next(line.get_xydata() for line in axes.lines if line.get_label().startswith("limit points"))
    line = next(line.get_xydata() for line in axes.lines if line.get_label().startswith("boundary"))
    size = 0.3 * (over or np.median(-points[:, 2])) + parameters.get("cohesion", 0.0)
    assert np.ptp(points[:, 2]) > 1
    assert np.hypot(*places.T) == pytest.approx(size, rel=1e-7) and np.hypot(*line.T) == pytest.approx(size, rel=1e-3)
    assert axes.get_xlabel() == (r"$\sigma_{a}\,/\,|\sigma_{n}|$ [–]" if over else r"$\sigma_{a}$ [unit of the points]")
    assert places[:, 0] * points[:, 1] == pytest.approx(places[:, 1] * points[:, 0], abs=1e-9)  # no point leaves its ray


@pytest.mark.parametrize(("least", "most", "end"), [(0, "2/5", "greatest"), ("4/5", "9/10", "least"), (0, "9/10", "")])
def test_a_parameter_that_ends_on_its_bound_is_said(least, most, end):
    law = duhem.Criterion(
        name="oval",
        g="norm(sigma_a, sigma_b)**2 - mu*abs(sigma_n)*(norm(sigma_a, sigma_b) + e*sigma_a)",
        parameters={"mu": duhem.POSITIVE, "e": duhem.Domain.between(least, most)},
    )
    points = rays(duhem.load("limacon"), {"mu": 0.3, "e": 0.6}, 30, 6)
    done = duhem.identify(points, law, convex="assume")
    said = f"e is on the {end} value of its domain; a better fit may exist beyond it"
    assert (said in done.to_text()) == (said in done.to_html()) == bool(end) == bool(done.to_dict()["parameters"]["e"]["remark"])
    assert ("on its bound" in done.to_text()) == bool(end) and not done["mu"].remark


@pytest.mark.parametrize(
    "name, reason",
    [("box", "corners"), ("tresca", "corners"), ("radial-flow", "slip direction"), ("rotated-flow", "slip direction")],
)
def test_laws_that_are_not_suited_say_why(name, reason):
    with pytest.raises(InputError, match=reason):
        duhem.identify(table(PAPER), name)


@pytest.mark.slow
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


@pytest.mark.slow
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
    with pytest.raises(InputError, match="not proved convex: convexity is undecided"):
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


def test_an_exponent_is_written_with_few_digits_and_the_law_still_fits():
    points = rays(duhem.load("superellipse"), {"mu_a": 0.3, "mu_b": 0.2, "p": 2.61803398875}, 30, 6)
    done = duhem.identify(points, "superellipse")
    assert done.coefficients["p"] == pytest.approx(2.61803398875, rel=1e-8)
    written = {n: float(d.value) for n, d in done.law.parameters.items()}
    assert written["p"] == 2.618 and written["mu_a"] == pytest.approx(0.3, abs=1e-5)
