"""Extreme cases: they are what they say, answers are judged without mercy, and nothing poor passes in silence."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest

import duhem
from duhem.benchmark.contenders import Contender, Specimen
from duhem.benchmark.extreme_cases import AXES, ExtremeCases, Tally, aspect, cases, digits, refusals, stress
from duhem.errors import InputError
from duhem.law.formula_law import Criterion
from duhem.projection.closed_form import CLOSED_FORM, ClosedFormOptions
from duhem.projection.result import Projection, Status
from duhem.show.printing import text
from tests.long import mostly_long

FIGURE_5 = {"mu_a_plus": "0.2", "mu_a_minus": "0.08", "mu_b_plus": "0.12", "mu_b_minus": "0.15"}
Run = Callable[..., tuple[int, str, str]]


def formula(name: str, **values: str) -> Criterion:
    law = duhem.load(name)
    assert isinstance(law, Criterion)
    return law.fix(values)


def flagship() -> Criterion:
    return formula("antoni2007", **FIGURE_5)


class Doctored(Contender):
    """The closed form with its answer changed afterwards."""

    change: Callable[[Projection], Projection]

    @classmethod
    def made(cls, name: str, change: Callable[[Projection], Projection]) -> Doctored:
        found = cls(name, CLOSED_FORM, ClosedFormOptions())
        object.__setattr__(found, "change", change)
        return found

    def project(self, *arguments: Any) -> Projection:
        return self.change(super().project(*arguments))


def skewed(done: Projection) -> Projection:
    return replace(done, stress=done.stress * (1 + 1e-3))


def skewed_and_said(done: Projection) -> Projection:
    return replace(skewed(done), status=np.full_like(done.status, Status.INACCURATE))


def lost(done: Projection) -> Projection:
    return replace(done, stress=np.full_like(done.stress, np.nan))


def gone(done: Projection) -> Projection:
    raise ZeroDivisionError("no")


@pytest.fixture(scope="module")
def doctored() -> ExtremeCases:
    changes = {"skewed": skewed, "skewed and said": skewed_and_said, "lost": lost, "gone": gone}
    contenders = [Contender.of("closed-form", "closed-form"), *(Doctored.made(n, c) for n, c in changes.items())]
    return stress(flagship(), axes=("trial size",), contenders=contenders)


# -- the cases -------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_the_axes_span_what_they_say() -> None:
    found = list(cases(Specimen.of(flagship())))
    by_axis = {axis: [case for case in found if case.axis == axis] for axis in AXES}
    assert all(by_axis.values())
    loads = [abs(case.pressure) for case in by_axis["load"] if case.pressure is not None]
    assert (min(loads), max(loads)) == (1e-290, 1e290)
    ratios = [case.specimen.stiffness[1, 1] / case.specimen.stiffness[0, 0] for case in by_axis["stiffness ratio"]]
    assert (min(ratios), max(ratios)) == (1.0, pytest.approx(1e12))
    thin = by_axis["aspect of K"][-1].specimen
    up, down = thin.radius(np.array([0.0, 1.0]), -1.0), thin.radius(np.array([0.0, -1.0]), -1.0)
    assert (up, down) == (pytest.approx(0.12e-8), pytest.approx(0.15e-8))
    assert thin.radius(np.array([1.0, 0.0]), -1.0) == pytest.approx(0.2)
    assert {0.0, -0.0} <= set(by_axis["special values"][0].trial.ravel().tolist())
    assert any(0.0 < np.abs(case.trial).max() < 2.0**-1022 for case in by_axis["special values"])


def test_one_ulp_outside_is_just_that() -> None:
    """By exact arithmetic on the criterion: the next number outwards lies outside, the last inside does not."""
    named = {case.label: case for case in cases(Specimen.of(flagship()), ("boundary distance",))}
    mu = [Fraction(float(v)) for v in FIGURE_5.values()]

    def outside(point: list[float]) -> bool:
        a, b = (Fraction(x) for x in point)
        return (a / mu[0 if a > 0 else 1]) ** 2 + (b / mu[2 if b > 0 else 3]) ** 2 > 1

    assert all(outside(x) for x in named["1 ulp"].trial.tolist())
    assert not outside(named["0 by doubles"].trial[0].tolist())
    assert np.abs(named["1 ulp"].trial / named["0 by doubles"].trial - 1).max() <= 2.0**-52


def test_parameters_that_thin_the_set_are_found_by_trying() -> None:
    assert aspect(Specimen.of(flagship())) == ("mu_b_plus", "mu_b_minus")
    assert aspect(Specimen.of(formula("orthotropic", mu_a="0.2", mu_b="0.1"))) == ("mu_b",)
    assert aspect(Specimen.of(formula("coulomb", mu="0.25"))) == ()


# -- the judgement ---------------------------------------------------------------------------------------------------


def test_digits() -> None:
    one = mpmath.mpf(1)
    assert digits([1.0], [one], one) == 16.0
    assert digits([1.001], [one], one) == pytest.approx(3.0, abs=1e-3)
    assert digits([-1.0], [one], one) == 0.0
    assert digits([1e-9], [mpmath.mpf(0)], one) == pytest.approx(9.0)  # nothing due: relative to the trial
    assert digits([math.inf], [one], one) == 0.0
    assert digits([1e308], [mpmath.mpf("1e309")], one) == 0.0
    assert digits([0.0], [mpmath.mpf("1e-330")], one) == 16.0  # below what any double tells apart


@pytest.mark.slow
def test_poor_and_not_flagged_is_silently_wrong(doctored: ExtremeCases) -> None:
    points = sum(row.points for row in doctored.rows if row.method == "skewed")
    assert points > 0
    assert doctored.silently_wrong["skewed"] == (points, 0)
    assert doctored.silently_wrong["skewed and said"] == (0, 0)
    assert doctored.silently_wrong["closed-form"] == (0, 0)
    rows = [row for row in doctored.rows if row.method == "skewed"]
    assert all(row.stress_digits == pytest.approx(3.0, abs=0.01) and row.feasible == 0 and row.flagged == 0 for row in rows)
    said = [row for row in doctored.rows if row.method == "skewed and said"]
    assert all(row.flagged == row.points for row in said)


@pytest.mark.slow
def test_numbers_that_are_not_finite_and_errors(doctored: ExtremeCases) -> None:
    rows = [row for row in doctored.rows if row.method == "lost"]
    assert all((row.finite, row.stress_digits, row.wrong_stress) == (0, 0.0, row.points) for row in rows)
    rows = [row for row in doctored.rows if row.method == "gone"]
    assert all(row.failure == "ZeroDivisionError: no" and row.flagged == row.points and row.wrong_stress == 0 for row in rows)
    shown = text(doctored)
    assert "gone: ZeroDivisionError: no" in shown
    assert "silently wrong" in shown and " X !stress" in shown
    assert not doctored.failed


@pytest.mark.slow
@pytest.mark.parametrize("every", mostly_long([4, 1], 4))
def test_closed_form_and_newton_stay_right_or_say_so(every: int) -> None:
    contenders = [Contender.of("closed-form", "closed-form"), Contender.of("newton", "newton")]
    result = stress(flagship(), axes=("stiffness ratio", "special values"), contenders=contenders, every=every)
    assert result.silently_wrong["closed-form"] == (0, 0)
    assert result.silently_wrong["newton"][0] == 0
    assert min(row.stress_digits for row in result.rows if row.method == "closed-form") >= 15.0
    assert result.reference <= 1e-50


def test_refusals_name_argument_and_index() -> None:
    specimen = Specimen.of(flagship())
    found = list(refusals(specimen, Contender.of("closed-form", "closed-form")))
    assert len(found) == 10
    assert [r for r in found if not r.held] == []

    class Careless(Contender):
        def project(self, specimen: Specimen, trial: Any, pressure: Any, stiffness: Any = None) -> Projection:
            return super().project(specimen, np.ones((3, 2)), -1.0)

    careless = Careless("careless", CLOSED_FORM, ClosedFormOptions())
    found = list(refusals(specimen, careless))
    assert not any(r.held for r in found) and all(r.answer.startswith("answered") for r in found)


@pytest.mark.long
def test_metals_have_no_pressure_and_no_thin_axis() -> None:
    contenders = [Contender.of("newton", "newton")]
    result = stress(formula("tresca", yield_stress="1"), axes=("aspect of K", "boundary distance"), contenders=contenders)
    assert result.silently_wrong["newton"][0] == 0
    assert [part.reason for part in result.left_out if part.part == "axis aspect of K"] == [
        "no parameter of the law scales one axis of K alone"
    ]
    line = stress(formula("antoni2007-1d", mu_plus="0.2", mu_minus="0.1"), axes=("seam distance",), contenders=contenders)
    assert line.rows == () and any(part.part == "axis seam distance" for part in line.left_out)


@pytest.mark.slow
def test_an_interrupted_run_keeps_what_is_done() -> None:
    def stop(_: Tally) -> None:
        raise KeyboardInterrupt

    result = stress(flagship(), axes=("load",), on_row=stop)
    assert result.interrupted and len(result.rows) == 1
    assert "Interrupted" in text(result)


OPEN_CASES = [
    ("regularised", {"mu": "0.2", "c": "0.1"}, "load"),
    ("regularised", {"mu": "0.2", "c": "1"}, "load"),
    ("regularised", {"mu": "0.2", "c": "0.1"}, "special values"),
    ("capped", {"mu": "0.2", "c": "0.3"}, "special values"),
    ("cohesive", {"mu": "0.2", "c": "0.1"}, "load"),
    ("shifted-ellipse", {"mu_a": "0.1", "mu_b": "0.2", "shift": "0.05"}, "aspect of K"),
]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "values", "axis"), mostly_long(OPEN_CASES, OPEN_CASES[3]))
def test_a_case_without_reference_is_said_and_the_rest_is_kept(name: str, values: dict[str, str], axis: str) -> None:
    law = formula(name, **{key: value for key, value in values.items() if key in duhem.load(name).parameters})
    law = law.fix({key: "0.3" for key, domain in law.parameters.items() if domain.value is None})
    result = stress(law, axes=(axis,), contenders=[Doctored.made("as it is", lambda found: found)])
    place = [part for part in result.left_out if part.part.startswith(axis)]
    assert {row.label for row in result.rows}.isdisjoint(part.part.removeprefix(f"{axis} ") for part in place)
    assert all(part.reason.startswith("no reference: ") and len(part.reason) > 20 for part in place)
    assert {row.label for row in result.rows} or axis == "aspect of K"
    if name == "regularised":
        assert any("the gradient of g vanishes on the boundary" in part.reason for part in place)
    json.dumps(result.to_dict())


def test_input_that_cannot_be_used() -> None:
    with pytest.raises(InputError, match="unknown axis"):
        stress(flagship(), axes=("sideways",))
    with pytest.raises(InputError, match="every is 0"):
        stress(flagship(), every=0)
    law = duhem.load("antoni2007")
    assert isinstance(law, Criterion)
    with pytest.raises(InputError, match="--set mu_a_plus=VALUE"):
        stress(law)
    for name in ("prager", "perzyna"):
        own = duhem.load(name)
        assert isinstance(own, Criterion)
        with pytest.raises(InputError, match=f"an increment of {name} is more than a closest point of K, but a benchmark"):
            stress(own)


# -- command line ----------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("compiled", mostly_long([False, True], False))
def test_command(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, compiled: bool) -> None:
    if not compiled:  # to compile a loop takes thirty seconds
        monkeypatch.setattr("duhem.benchmark.contenders.find_spec", lambda name: None)
    file = tmp_path / "stress.json"
    code, out, err = run("stress", "limacon", "--set", "mu=0.25", "--set", "e=0.3", "--axis", "trial size", "--json", str(file))
    assert (code, err) == (0, f"duhem: wrote the results to {file}\n")
    assert "silently wrong: stress" in out and "trial size: " in out
    found = json.loads(file.read_text())
    assert set(found) == {
        "duhem", "law", "subject", "machine", "interrupted", "reference", "rows", "refusals", "silently_wrong", "left_out",
    }  # fmt: skip
    assert {row["method"] for row in found["rows"]} == {"newton", *["newton, numba"] * (compiled and find_spec("numba") is not None)}
    assert found["reference"] <= 1e-50
    row = found["rows"][0]
    assert row["points"] == row["finite"] == 2 and 0 <= row["slip_digits"] <= 16


@pytest.mark.slow
def test_command_draws(run: Run, tmp_path: Path) -> None:
    file = tmp_path / "stress.svg"
    code, out, err = run("stress", "--set", "mu_a_plus=0.3", "--axis", "seam distance", "--plot", str(file))
    if find_spec("matplotlib") is None:
        assert code == 2 and 'pip install "duhem[plot]"' in err
        return
    assert (code, err) == (0, f"duhem: wrote the picture to {file}\n")
    assert "mu_a_plus = 0.3, mu_a_minus = 0.08" in out and "svg" in file.read_text()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("stress", "coulomb"), "--set mu=VALUE"),
        (("stress", "--axis", "nowhere"), "unknown axis"),
        (("stress", "--plot", "figure.xyz"), "figure.xyz"),
        (("stress", "--set", "mu_a_plus=-1"), "mu_a_plus"),
    ],
)
def test_command_rejects(run: Run, arguments: tuple[str, ...], message: str) -> None:
    code, out, err = run(*arguments)
    assert code == 2 and out == "" and message in err
