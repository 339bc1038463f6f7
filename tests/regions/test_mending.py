"""The nearest admissible law: distances held to those worked out by other means, and what may not be called admissible."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sympy as sp
from click.testing import CliRunner
from scipy.spatial import ConvexHull

import duhem
from duhem.cli import cli
from duhem.law.builtin.lobes import lobe_law
from duhem.law.formula_law import Criterion
from duhem.proof.verdict import Verdict
from duhem.proof.verification import verdict_within
from duhem.regions.mending import entry
from duhem.regions.mending.by_hull import by_hull, by_sections, polygon
from duhem.regions.mending.by_least_squares import _monomials, by_coefficients, by_harmonics
from duhem.regions.mending.formulas import decimal, linear
from duhem.regions.mending.limit_load import distance, limit_loads, plain_values, scale_of, ways_of
from duhem.show.printing import text
from tests.long import long_at, mostly_long

TILTED = duhem.Criterion(  # a dent about no axis of coordinates, and no symmetry
    "tilted", "norm(x, y)**3 - c*(norm(x, y)**2*1.2 + 0.7*norm(x, y)*(0.8*x + 0.6*y) + 0.1*x*y)", {"c": duhem.POSITIVE},
    forces=("x", "y"), pressure=None,
)  # fmt: skip
LAWS: dict[str, Criterion] = {
    "limacon": duhem.load("limacon").fix({"e": "4/5"}),
    "limacon 5/8": duhem.load("limacon").fix({"e": "5/8"}),
    "matchstick": duhem.load("matchstick").fix({"mu_a": 1, "mu_b": "1/2"}),
    "two lobes": lobe_law(2).fix({"e": "2/5"}),
    "three lobes": lobe_law(3).fix({"e": "3/10"}),
    "five lobes": lobe_law(5).fix({"e": "-1/10"}),
    "tilted": TILTED,
}
EXACT = ("limacon", "limacon 5/8", "matchstick", "two lobes")


def made(law: Criterion, g: str) -> Criterion:
    free = {name: own for name, own in law.parameters.items() if own.value is None}
    return Criterion("made", g, free, law.forces, law.pressure)


def fine_hull(law: Criterion, ways: Any) -> Any:
    """How far the hull of 10,000 points of the boundary reaches."""
    angles = np.linspace(0.0, 2.0 * np.pi, 10_000, endpoint=False)
    around = np.column_stack([np.cos(angles), np.sin(angles)])
    faces = ConvexHull(around * limit_loads(law, plain_values(law), around)[:, None]).equations
    return 1.0 / (ways @ (faces[:, :2] / -faces[:, 2:]).T).max(axis=1)


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(LAWS, "limacon"))
def test_hulls_are_those_of_many_points_and_proved(name: str) -> None:
    law = LAWS[name]
    ways, found = ways_of(law), list(by_hull(scale_of(law)))
    hull, size = fine_hull(law, ways), limit_loads(law, plain_values(law), ways).mean()
    assert len(found) > 1 if name in EXACT else [told.startswith("a polygon") for _, told in found] == [True]
    for g, told in (found[0], found[-1]):
        other = made(law, g)
        reached = limit_loads(other, plain_values(law), ways)
        exact = not told.startswith("a polygon")
        assert np.abs(reached - hull).max() < (1e-6 if exact else 0.01) * size
        assert exact or ((reached > hull).all() and told.endswith("enclosures of g on it show"))
        assert verdict_within(other, "convexity", 2_000_000) is Verdict.PROVED


@pytest.mark.slow
def test_a_polygon_that_does_not_enclose_is_not_said_to(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("duhem.regions.mending.by_hull._OUTWARD", ())
    _, told = polygon(scale_of(LAWS["limacon"]), far=-1e-2)  # its sides a thousandth inside
    assert told.startswith("a polygon of") and told.endswith("which may cut off some of K")


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(LAWS, "three lobes"))
def test_gauges_of_harmonics_are_proved_and_keep_symmetries(name: str) -> None:
    law = LAWS[name]
    ((g, _),) = by_harmonics(scale_of(law), 8)
    other, ways, values = made(law, g), ways_of(law), plain_values(law)
    before, after = (limit_loads(x, values, ways).reshape(2880) for x in (law, other))
    for turned in (lambda r: np.roll(r, 960), lambda r: np.roll(r, 1440), lambda r: np.roll(r[::-1], 1), lambda r: np.roll(r[::-1], 1441)):
        assert not np.allclose(turned(before), before) or np.allclose(turned(after), after, rtol=1e-9)
    assert distance(scale_of(law), other).largest < 0.2
    assert verdict_within(other, "convexity", 2_000_000) is Verdict.PROVED


@pytest.mark.slow
@pytest.mark.parametrize(
    ("by", "mean", "largest"), long_at([1, 2], [("parameters", 0.191, 0.300), ("hull", 0.018, 0.113), ("harmonics", 0.020, 0.102)])
)
def test_the_limacon_is_mended(by: str, mean: float, largest: float) -> None:
    done = duhem.mend("limacon", by, {"e": "0.8"})
    assert done.by == by and done.admissible
    assert done.distance.mean == pytest.approx(mean, abs=5e-4) and done.distance.largest == pytest.approx(largest, abs=5.1e-4)
    assert done.to_dict()["parameters"] == ({"e": "1/2"} if by == "parameters" else None)


@pytest.mark.long
def test_the_way_that_changes_least_is_taken() -> None:
    done = duhem.mend("limacon", parameters={"e": "0.8"})
    assert [one.by for one in done.tried] == list(entry.WAYS)
    made = [one for one in done.tried if one.law is not None]
    assert done.by == "harmonics" and len(made) == 3 and done.distance.largest == min(one.distance.largest for one in made)
    assert all(one.convex for one in made) and "hull" in text(done)


@pytest.mark.long
@pytest.mark.parametrize("name", ["poly6-aa6016-t4", "hu"])
def test_published_polynomials_that_are_not_convex_are_mended(name: str) -> None:
    done = duhem.mend(name, "coefficients")
    assert done.admissible and done.distance.largest < 0.025
    assert duhem.verify(done.criterion, claims=["convexity"])["convexity"].verdict is Verdict.REFUTED


@pytest.mark.slow
@pytest.mark.parametrize("seed", mostly_long(range(6), 0))
def test_drawn_quartics_are_mended_by_coefficients(seed: int) -> None:
    rng = np.random.default_rng(seed)
    a, b, c = rng.uniform(-2.5, -0.5), rng.uniform(-0.9, 3.0), rng.uniform(-1.5, 1.5)
    law = Criterion(
        "quartic", f"x**4 + {a:.3f}*x**3*y + {b + 2:.3f}*x**2*y**2 + {c:.3f}*x*y**3 + y**4 - 1", forces=("x", "y"), pressure=None
    )
    g, _ = next(by_coefficients(scale_of(law)))
    assert verdict_within(made(law, g), "convexity", 2_000_000) is Verdict.PROVED
    if verdict_within(law, "convexity", 500_000) is Verdict.PROVED:
        assert distance(scale_of(law), made(law, g)).largest < 1e-3


@pytest.mark.slow
@pytest.mark.parametrize(
    ("g", "forces", "left_out"),
    long_at([1], [("x**4 + y**4 + 3*x**3*y - 1", "xy", (3, 1)), ("x**4 + y**4 + z**4 - 3*x*y*z**2 + 4*x**2*y**2 - 1", "xyz", (1, 1, 2))]),
)
def test_terms_that_no_convex_polynomial_has_are_left_out(g: str, forces: str, left_out: tuple[int, ...]) -> None:
    done = duhem.mend(Criterion("odd", g, {}, tuple(forces), None), "coefficients")
    assert done.admissible and left_out not in sp.Poly(done.law.g, *done.law.force_symbols()).monoms()


@pytest.mark.slow
def test_what_is_written_is_what_was_verified(tmp_path: Path) -> None:
    file, picture = tmp_path / "mended.toml", tmp_path / "k.png"
    done = CliRunner().invoke(
        cli, ["mend", "limacon", "--set", "e=0.8", "--by", "hull", "--out", str(file), "--plot", str(picture), "--format", "json"]
    )
    assert done.exit_code == 0, done.output
    said = json.loads(done.stdout)
    assert said["file"] == str(file) and said["admissible"] and said["by"] == "hull" and picture.stat().st_size > 1000
    assert {c["claim"]: c["verdict"] for c in said["verification"]["claims"]}["convexity"] == "proved"
    read = duhem.load(file)
    assert set(read.parameters) == {"mu"} and distance(scale_of(LAWS["limacon"]), read).largest == pytest.approx(said["largest_distance"])


def test_a_convex_law_is_left_alone() -> None:
    done = duhem.mend("coulomb")
    assert done.by == "" and done.law == done.criterion and done.distance.largest == 0.0 and done.admissible
    assert "nothing to mend" in repr(done) and "nothing to mend" in text(done)


@pytest.mark.slow
def test_what_is_not_proved_is_never_called_admissible(monkeypatch: pytest.MonkeyPatch) -> None:
    law = LAWS["limacon"]
    monkeypatch.setattr(entry, "_candidates", lambda way, *_: iter([(replace(law, name="same"), "the same again")]))
    done = duhem.mend(law, "hull")
    assert not done.admissible and not done.tried[0].convex and "not proved admissible" in repr(done) and "not proved" in text(done)
    assert not done.to_dict()["admissible"]
    command = ["mend", "limacon", "--set", "e=0.8", "--by", "hull", "--strict"]
    assert CliRunner().invoke(cli, command, standalone_mode=False).return_value == 3


@pytest.mark.parametrize(
    ("law", "by", "values", "said"),
    [
        ("limacon", "hul", {"e": "0.8"}, "did you mean 'hull'"),
        ("limacon", "hull", {}, "the shape of K depends on e"),
        ("matchstick", "hull", {"mu_a": 1}, "the shape of K depends on mu_b"),
        ("limacon", "coefficients", {"e": "0.8"}, "g is no polynomial"),
        ("rotated-flow", "hull", {}, "a flow of its own"),
        ("matchstick", "hull", {}, "depends on mu_a, mu_b, without a value; give one: --set mu_a=VALUE --set mu_b=VALUE"),
    ],
)
def test_what_cannot_be_mended_is_one_error(law: str, by: str, values: dict[str, Any], said: str) -> None:
    with pytest.raises(duhem.InputError, match=said):
        duhem.mend(law, by, values)


def test_more_forces_no_end_and_zero_outside_are_errors() -> None:
    cube = Criterion("cube", "x**4 + y**4 + z**4 - 6*x**2*y**2 + 9*x**2*y**2*z**2 - 1", forces=("x", "y", "z"), pressure=None)
    with pytest.raises(duhem.InputError, match="two forces"):
        duhem.mend(cube, "hull")
    with pytest.raises(duhem.InputError, match="harmonics are asked for"):
        duhem.mend(cube, harmonics=3.0)  # type: ignore[arg-type]
    cross = Criterion("cross", "abs(x*y) - 1", forces=("x", "y"), pressure=None)
    with pytest.raises(duhem.InputError, match="a K that ends"):
        duhem.mend(cross, "harmonics")
    away = Criterion("away", "1 - norm(x, y) + norm(x, y)**4/10", forces=("x", "y"), pressure=None)
    with pytest.raises(duhem.InputError, match="zero force lies outside K"):
        duhem.mend(away, "hull")
    wedge = Criterion("wedge", "sqrt(x**2 + y**2 + 3*x*y) - 1", forces=("x", "y"), pressure=None)  # no value in 27 % of the directions
    with pytest.raises(duhem.InputError, match="K ends at zero force in 27% of the directions"):
        duhem.mend(wedge)


@pytest.mark.slow
def test_a_law_of_more_forces_that_is_no_polynomial_gets_the_nearest_quartic() -> None:
    """Hill's criterion of 1990 has a dent at pure shear; its symmetry about sigma_xy = 0 is kept."""
    done = duhem.mend("hill90", "coefficients")
    assert done.admissible and done.before is Verdict.REFUTED and done.distance.largest < 0.005
    poly = sp.Poly(done.law.g, *done.law.force_symbols())
    assert {sum(m) for m in poly.monoms()} == {0, 4} and all(m[2] % 2 == 0 for m in poly.monoms())


def test_the_monomials_of_a_quartic_are_those_of_the_symmetries_of_k() -> None:
    forces = {"forces": ("x", "y", "z"), "pressure": None}
    even = Criterion("even", "norm(x, y, z)**(5/2) + abs(x)**(5/2) - 1", {}, **forces)
    shifted = Criterion("shifted", "norm(x - 1/5, y, z)**3 + abs(x)**3 - 1", {}, **forces)
    assert {sum(m) for m in _monomials(scale_of(even))} == {4} and len(_monomials(scale_of(even))) == 6
    found = _monomials(scale_of(shifted))
    assert {sum(m) for m in found} == {1, 2, 3, 4} and (1, 0, 0) in found and not any(m[1] % 2 or m[2] % 2 for m in found)


def test_the_distance_is_that_in_the_ranges_of_the_forces() -> None:
    law = Criterion("dented", "(x**2 + y**2)**2 - 4*x**2 - y**2 - 1/50", {}, ("x", "y"), None)
    ranged = replace(law, domain={"x": duhem.Domain.between(-1, 1)})
    other = made(law, "x**2 + y**2 - 4")
    ways = ways_of(law)
    most = 1 / np.maximum(np.abs(ways[:, 0]), 1e-300)
    own, new = (np.minimum(limit_loads(one, {}, ways), most) for one in (law, other))
    assert distance(scale_of(ranged), other) == pytest.approx((np.abs(new - own).mean() / own.mean(), np.abs(new - own).max() / own.mean()))
    half = replace(law, domain={"x": duhem.Domain.between(0, None), "y": duhem.Domain.between(-2, 3)})
    assert 0 < distance(scale_of(half), other).mean < np.inf
    with pytest.raises(duhem.InputError, match="forces without ranges"):
        duhem.mend(ranged, "hull")


@pytest.mark.slow
@pytest.mark.parametrize("limit", mostly_long(["0.0000001", "150", "1000000000"], "0.0000001"))
def test_the_unit_of_stress_does_not_matter(limit: str) -> None:
    law = Criterion("unit", f"norm(x, y)**2 - {limit}*(norm(x, y) + 4*x/5)", {}, ("x", "y"), None)
    scaled = scale_of(law)
    (g, told), ((wave, _),) = list(by_hull(scaled))[-1], by_harmonics(scaled, 8)
    assert told.endswith("show") and distance(scaled, made(law, g)).largest == pytest.approx(0.1127, abs=1e-4)
    assert distance(scaled, made(law, wave)).largest == pytest.approx(0.102, abs=2e-3)


def test_a_corner_between_two_directions_is_not_cut_off() -> None:
    law = Criterion("angle", "max(abs(x) - 2, abs(y) - 2, min(x, y) - 1)", {}, ("x", "y"), None)
    *_, (g, told) = by_hull(scale_of(law))
    assert told == "a polygon of 5 sides around K, as enclosures of g on it show"
    corners = np.array([(2.0, 1.0), (1.0, 2.0), (-2.0, 2.0), (2.0, -2.0), (-2.0, -2.0)])
    assert (limit_loads(made(law, g), {}, corners) > 1.0).all()


def sums_of_squares(points: Any) -> Any:
    """K of Tsai and Hill by the sign of the stress, through its support function: h^2 = h(s1, s2)^2 + (S t)^2."""
    law = duhem.load("tsai-hill-signed")
    plane = Criterion("plane", law.g.xreplace({**law.settled(), law.force_symbols()[2]: sp.S.Zero}), {}, ("s1", "s2"), None)
    angles = np.linspace(0.0, 2.0 * np.pi, 20_000, endpoint=False)
    ways = np.column_stack([2280.0 * np.cos(angles), 100.0 * np.sin(angles)])
    faces = ConvexHull(ways * limit_loads(plane, {}, ways)[:, None] / [2280.0, 100.0]).equations
    gauge = (points[:, :2] / [2280.0, 100.0] @ (faces[:, :2] / -faces[:, 2:]).T).max(axis=1)
    return 1.0 / np.hypot(gauge, points[:, 2] / 71.0)


def cones(points: Any) -> Any:
    """K of Mogi and Coulomb: in each section across the axis all it has is in proportion to 1 + I1/6, and so is the hull."""
    plane = np.linalg.qr(np.column_stack([np.ones(3), [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]))[0][:, 1:]
    angles = np.linspace(0.0, 2.0 * np.pi, 20_000, endpoint=False)
    deviators = np.column_stack([np.cos(angles), np.sin(angles)]) @ plane.T
    gauge = np.linalg.norm(deviators, axis=1) / np.sqrt(3.0) + np.median(deviators, axis=1) / 4.0
    faces = ConvexHull(np.column_stack([np.cos(angles), np.sin(angles)]) / gauge[:, None]).equations
    slope = (points @ plane @ (faces[:, :2] / -faces[:, 2:]).T).max(axis=1) - points.sum(axis=1) / 6.0
    return np.where(slope > 0.0, 1.0 / np.where(slope > 0.0, slope, 1.0), np.inf)


HULLS: dict[str, Callable[[Any], Any]] = {"tsai-hill-signed": sums_of_squares, "mogi-coulomb": cones}


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(HULLS, "mogi-coulomb"))
def test_hulls_that_follow_from_a_section(name: str) -> None:
    law = duhem.load(name)
    scaled = scale_of(law)
    g, told = by_sections(scaled)
    other = Criterion("made", g, {}, law.forces, None, stress=law.stress)
    own, reached, exact = scaled.loads, limit_loads(other, {}, scaled.ways), HULLS[name](scaled.ways)
    near = exact < 3.0 * np.median(own)  # where a cone has an end far away, a small change of its opening moves that much
    assert "as enclosures of g on it show" in told and (reached >= np.minimum(own, exact) * (1 - 1e-9)).all()
    assert np.abs(reached[near] - exact[near]).max() < 0.01 * own[np.isfinite(own)].mean()
    assert verdict_within(other, "convexity", 4_000_000) is Verdict.PROVED


@pytest.mark.parametrize("name", ["hill90", "zhang-zhu"])
def test_other_hulls_of_more_forces_are_an_error(name: str) -> None:
    with pytest.raises(duhem.InputError, match="of more than two forces, the hull is known of"):
        by_sections(scale_of(duhem.load(name)))


def test_scales_stay_free() -> None:
    scale = scale_of(
        Criterion("s", "norm(x, y)**2 - m**3*abs(p)*sqrt(k)*norm(x, y)/k", {"m": duhem.POSITIVE, "k": duhem.POSITIVE}, ("x", "y"), "p")
    )
    assert scale.text == "m**(3)*k**(-1/2)*abs(p)"
    assert "p" not in scale_of(Criterion("c", "norm(x, y) - 1 + p/2", {}, ("x", "y"), "p")).powers


def test_numbers_are_written_without_exponents() -> None:
    assert [decimal(x) for x in (1e-7, -0.00125, 1234567.0, 2.0)] == ["0.0000001", "-0.00125", "1234570", "2"]
    assert linear((1.0, -2.5), ("x", "y")) == "1*x - 2.5*y" and linear((0.0, 1.0), ("x", "y")) == "1*y"


def test_a_parameter_that_is_fixed_is_asked_for_its_sign_and_that_is_said() -> None:
    """x^4 + c x^2 y^2 + y^4 is convex for 0 <= c <= 6, and c < 0 is not looked at where it is 9."""
    law = Criterion("quartic", "x**4 + c*x**2*y**2 + y**4 - 1", {"c": duhem.Domain.fixed(9)}, ("x", "y"), None)
    assert duhem.mend(law, by="parameters").told == "c from 9 to 6; where c > 0, convexity holds exactly for c <= 6"
