"""What is drawn of a law is what its formula says: boundary, corners, normals, slips, witnesses; and a reader can read it."""

from __future__ import annotations

import re
from fractions import Fraction
from itertools import combinations
from math import cos, pi, sin, sqrt

import numpy as np
import pytest

import duhem
from duhem.errors import InputError, MissingExtraError
from duhem.law import catalogue
from duhem.law.atlas.entry import groups
from duhem.portrait.lines import _turns, traced
from duhem.portrait.pictures import step
from duhem.portrait.plane import named, usual
from duhem.portrait.section import Numbered, View, numbered, section

pytest.importorskip("matplotlib")

from duhem.portrait.pictures import _around, _refuted, cut, plot, stated, violation
from tests.oracles.legible import faults

MU = {"mu_a_plus": 0.2, "mu_a_minus": 0.08, "mu_b_plus": 0.12, "mu_b_minus": 0.15}
VISCOUS = ("bingham", "garofalo", "norton-hoff", "perzyna", "rate-and-state")  # they have no K
EVERY = [*catalogue.names(), *(name for group in groups().values() for name in group if name not in VISCOUS)]


EMPTY = duhem.Criterion(name="empty", g="norm(sigma_a, sigma_b) + 1 - 0*sigma_n")


def given(law: str | duhem.Criterion, **numbers: float) -> Numbered:
    return numbered(catalogue.load(law), numbers)


def seen(law: str | duhem.Criterion, plane: str, pressure: float | None = None, **numbers: float) -> View:
    at = given(law, **numbers)
    return section(at, named(at.law, plane, pressure)[0])


def points(found: View) -> np.ndarray:
    return np.vstack([line.points for line in found.lines])


def tensor(g: str, **more: object) -> duhem.Criterion:
    return duhem.Criterion(name="t", g=g, pressure=None, stress={"name": "s", "kind": "3d"}, **more)


def test_numbers_that_nobody_gives_satisfy_the_constraints() -> None:
    def law(*constraints: str) -> duhem.Criterion:
        return duhem.Criterion(
            name="bound", g="norm(sigma_a, sigma_b) + b*sigma_n", parameters={"b": duhem.POSITIVE}, constraints=constraints
        )

    for least, constraint in ((2, "b > 4/b"), (1000, "b > 1000")):
        at = given(law(constraint))
        assert at.chosen == ("b",) and at.values()["b"] > least
    with pytest.raises(InputError, match="duhem found no numbers for b"):
        given(law("exp(b) < 1"))


# ---- the boundary


def test_the_boundary_is_that_of_the_quarter_ellipses_to_the_last_digits() -> None:
    a, b = points(seen("antoni2007", "sigma_a,sigma_b", -3.0, **MU)).T / 3.0
    assert len(a) > 300
    assert np.hypot(a / np.where(a > 0, 0.2, 0.08), b / np.where(b > 0, 0.12, 0.15)) == pytest.approx(1.0, abs=1e-12)
    assert a.min() == pytest.approx(-0.08, rel=1e-3) and b.max() == pytest.approx(0.12, rel=1e-3)


def test_corners_are_where_they_are_with_the_normals_of_both_sides() -> None:
    corners = seen("box", "sigma_a,sigma_b", mu_a=0.3, mu_b=0.7).corners
    assert {tuple(np.sign(c.point)) for c in corners} == {(1, 1), (1, -1), (-1, 1), (-1, -1)} and len(corners) == 4
    for corner in corners:
        assert np.abs(corner.point) == pytest.approx([0.3, 0.7], abs=1e-9) and corner.convex
        x, y = np.sign(corner.point)
        wanted = {(x, 0.0), (0.0, y)}
        assert {tuple(np.round(normal, 6) + 0.0) for normal in (corner.before, corner.after)} == wanted


@pytest.mark.slow
@pytest.mark.parametrize(
    ("law", "count"), [("polygon", 12), ("tresca", 6), ("plesha", 1), ("coulomb", 0), ("antoni2007", 0), ("superellipse", 0)]
)
def test_nothing_round_has_a_corner_and_no_corner_is_missed(law: str, count: int) -> None:
    at = given(law)
    found = section(at, usual(at.law, None)[0])
    assert len(found.corners) == count
    turns = [np.degrees(np.abs(_turns(line.points))).max() for line in found.lines]
    assert max(turns) < 135.0  # no line runs back and forth


def test_a_line_goes_round_a_polygon_without_going_back() -> None:
    draw = np.random.default_rng(1)
    for sides in (3, 4, 5, 6) * 4:
        ways = (np.arange(sides) + draw.uniform(0.0, 0.45, sides)) * 2.0 * pi / sides
        normals, reach = np.column_stack([np.cos(ways), np.sin(ways)]), draw.uniform(0.4, 1.0, sides)
        (line,), _ = traced(lambda at, n=normals, r=reach: (at @ n.T - r).max(axis=-1), (-5.0, 5.1, -5.0, 5.1))
        assert np.diff(np.unwrap(np.arctan2(*line.points.T[::-1]))).min() > 0.0


@pytest.mark.parametrize("power", [1.5, 2.0, 4.0])
def test_a_corner_that_leans_has_the_normals_of_its_sides(power: float) -> None:
    """|sigma_b| <= sigma_a^p up to sigma_a = 1: sharp at (1, ±1); at 0 the ray sigma_a < 0 of K begins, and no corner is."""
    law = duhem.Criterion(name="thorn", g=f"max(abs(sigma_b) - pos(sigma_a)**{power}, sigma_a - 1)", pressure=None)
    sharp = sorted(seen(law, "sigma_a,sigma_b").corners, key=lambda c: c.point[1])
    for corner, side in zip(sharp, (-1, 1), strict=True):
        assert corner.point == pytest.approx([1.0, side], abs=1e-6)
        leaning = np.array([-power, side]) / np.hypot(power, 1.0)
        assert [corner.before, corner.after][::-side] == [pytest.approx(leaning, abs=1e-3), pytest.approx([1.0, 0.0], abs=1e-9)]


def test_where_normals_still_turn_however_close_one_looks_there_is_no_corner() -> None:
    """q = M p log(p/pc) leaves p = 0 upright, and p = pc in a corner."""
    (corner,) = seen("original-cam-clay", "meridian").corners
    assert corner.point == pytest.approx([-1.0, 0.0], abs=1e-9)


def test_a_wedge_too_thin_to_be_followed_has_no_corner_beside_its_tip() -> None:
    thin = duhem.Criterion(name="thin", g="max(abs(sigma_b) - 0.02*sigma_a, sigma_a - 1)", pressure=None)
    found = seen(thin, "sigma_a,sigma_b")
    assert [c.point[0] for c in found.corners] == pytest.approx([1.0, 1.0], abs=1e-9) and "may be missing" in found.remark
    assert len(found.points) > 0 and np.abs(found.points).max() < 0.2  # where the lines show K, no points are needed


def test_a_dent_has_no_normal_cone() -> None:
    """Two disks that meet at (0, ±0.6), where K is re-entrant."""
    law = duhem.Criterion(name="two", g="min(norm(sigma_a - 0.8, sigma_b), norm(sigma_a + 0.8, sigma_b)) - 1", pressure=None)
    corners = seen(law, "sigma_a,sigma_b").corners
    assert sorted(tuple(np.round(c.point, 6) + 0.0) for c in corners) == [(0.0, -0.6), (0.0, 0.6)]
    assert not any(c.convex for c in corners)


def test_what_is_undefined_is_not_in_the_set() -> None:
    law = duhem.Criterion(name="half", g="norm(sigma_a, sigma_b) - 1 + 0*sqrt(sigma_a + 0.25) + 0.01*sqrt(sigma_a + 0.25)", pressure=None)
    assert points(seen(law, "sigma_a,sigma_b"))[:, 0].min() == pytest.approx(-0.25, abs=1e-9)


def test_the_pressure_is_not_above_zero() -> None:
    law = duhem.Criterion(name="cap", g="norm(sigma_a, sigma_b) - 1 - 0.5*abs(sigma_n)")
    found = seen(law, "sigma_n,sigma_a")
    assert found.window[1] == 0.0 and points(found)[:, 0].max() <= 0.0 and not found.plane.slips and found.normals == ()


@pytest.mark.parametrize(
    ("g", "sides"),
    [
        ("norm(sigma_a, 1000*sigma_b) - 1", (-1, 1, -1e-3, 1e-3)),
        ("norm(sigma_a, sigma_b) - 1e-12", (-1e-12, 1e-12, -1e-12, 1e-12)),
        ("norm(sigma_a, sigma_b) - 1e12", (-1e12, 1e12, -1e12, 1e12)),
        ("norm(sigma_a - 100, sigma_b - 50) - 1", (99, 101, 49, 51)),
    ],
)
def test_k_is_found_thin_small_large_and_away_from_zero(g: str, sides: tuple[float, ...]) -> None:
    found = seen(duhem.Criterion(name="k", g=g, pressure=None), "sigma_a,sigma_b")
    low, high = points(found).min(axis=0), points(found).max(axis=0)
    assert [low[0], high[0], low[1], high[1]] == pytest.approx(sides, rel=1e-3) and not found.remark and not found.corners


@pytest.mark.slow
@pytest.mark.parametrize(
    ("g", "said"),
    [
        ("norm(sigma_a, sigma_b)", "too thin for this picture"),
        pytest.param("norm(sigma_a, sigma_b) + sigma_a", "too thin for this picture", marks=pytest.mark.long),
        pytest.param("min(norm(sigma_a, sigma_b) - 1, norm(sigma_a - 10, 1000*sigma_b) - 5)", "may be missing", marks=pytest.mark.long),
        ("min(norm(sigma_a, sigma_b), 1) - 2", "fills the whole picture"),
    ],
)
def test_what_a_section_does_not_show_is_said(g: str, said: str) -> None:
    remarks: list[str] = []
    (axes,) = plot(duhem.Criterion(name="k", g=g, pressure=None), on_remark=remarks.append)
    assert len(remarks) == 1 and said in remarks[0] and said in axes.get_title() and faults(axes.figure) == []


@pytest.mark.parametrize(
    ("g", "along"),
    [
        ("max(abs(sigma_a) - 1, abs(sigma_b))", (1, 0)),
        ("abs(sigma_a)", (0, 1)),
        ("abs(sigma_a + sigma_b)", (1, -1)),
        ("norm(sigma_a/2e-9, sigma_b/5) - 1", (0, 1)),
    ],
)
def test_a_segment_and_a_line_are_met_on_both_sides(g: str, along: tuple[int, int]) -> None:
    found = seen(duhem.Criterion(name="k", g=g, pressure=None), "sigma_a,sigma_b")
    assert not found.lines and "the points are some points of" in found.remark
    far = found.points @ along
    assert len(far) > 20 and sorted(far) == sorted(-far) and not (found.points @ (-along[1], along[0])).any()
    a, b, c, d = found.window
    assert (a, c) == (-b, -d)


def test_the_window_of_one_force_is_that_of_all_its_pieces() -> None:
    law = duhem.Criterion(name="two", g="(a - 1)*(a - 2)*(a + 1)*(a + 3)", forces=("a",), pressure=None)
    found = section(given(law), usual(law, None)[0])
    assert -5 < found.window[0] < -3 and 2 < found.window[1] < 4 and len(found.lines) == 4


@pytest.mark.parametrize("g", ["a - 4/5", "-a - 4/5", "a - 1/1000", "-a - 3000", "a"])
def test_the_window_of_one_force_shows_zero_where_k_has_one_end(g: str) -> None:
    low, high, *_ = section(given(law := duhem.Criterion(name="half", g=g, forces=("a",), pressure=None)), usual(law, None)[0]).window
    assert low <= 0.0 <= high


# ---- planes


def test_the_deviatoric_plane_shows_von_mises_as_a_circle_and_tresca_as_a_hexagon() -> None:
    found = seen(tensor("sqrt(3*J2) - 2"), "deviatoric")
    assert np.hypot(*points(found).T) == pytest.approx(2.0 * sqrt(2.0 / 3.0), abs=1e-9)
    corners = seen(tensor("principal(1) - principal(3) - 2"), "deviatoric").corners
    assert len(corners) == 6 and [np.hypot(*c.point) for c in corners] == pytest.approx([2.0 * sqrt(2.0 / 3.0)] * 6, abs=1e-6)


def test_the_meridian_shows_mean_and_equivalent_stress_with_the_slip_that_does_work_on_them() -> None:
    """Drucker and Prager: |q| = 1 - 3 p/10, whose normal is (3/10, ±1)."""
    found = seen(tensor("sqrt(3*J2) + I1/10 - 1"), "meridian")
    p, q = points(found).T
    assert np.abs(q) + 0.3 * p == pytest.approx(1.0, abs=1e-9)
    for arrow in found.normals:
        assert arrow.along == pytest.approx(np.array([0.3, np.sign(arrow.at[1])]) / sqrt(1.09), abs=1e-6)


def test_where_k_begins_at_zero_force_the_plane_moves() -> None:
    at = given("hjiaj")
    found = cut(at, named(at.law, "t_1,t_2", None)[0])
    assert found.lines and "t_{n} = -1" in found.plane.caption
    at = given("modified-cam-clay")
    assert cut(at, named(at.law, "deviatoric", None)[0]).lines


# ---- normals and slips


def test_normals_are_the_gradient_of_an_ellipse() -> None:
    found = seen("orthotropic", "sigma_a,sigma_b", mu_a=0.3, mu_b=0.1)
    assert len(found.normals) >= 12
    for arrow in found.normals:
        slope = arrow.at / np.array([0.09, 0.01])
        assert arrow.along == pytest.approx(slope / np.hypot(*slope), abs=2e-3)


def test_where_a_line_turns_back_before_a_tip_it_has_no_normal() -> None:
    """sqrt|sigma_a| + sqrt|sigma_b| = 1: its four tips are thinner than the picture follows."""
    found = seen(duhem.Criterion(name="star", g="sqrt(abs(sigma_a)) + sqrt(abs(sigma_b)) - 1", pressure=None), "sigma_a,sigma_b")
    assert len(found.normals) >= 12
    for arrow in found.normals:
        slope = np.sign(arrow.at) / np.sqrt(np.abs(arrow.at))
        assert arrow.along == pytest.approx(slope / np.hypot(*slope), abs=0.02)


def test_a_flow_of_its_own_is_drawn_as_it_is() -> None:
    """On the disk the normal is along the stress; the slip is turned by the law's angle to the left."""
    found = seen("rotated-flow", "sigma_a,sigma_b", mu=0.5, delta=0.25)
    assert len(found.slips) == len(found.normals) >= 12
    for arrow in found.slips:
        x, y = arrow.at / np.hypot(*arrow.at)
        assert arrow.along == pytest.approx([x * cos(0.25) - y * sin(0.25), x * sin(0.25) + y * cos(0.25)], abs=1e-9)
    assert seen("coulomb", "sigma_a,sigma_b").slips == ()


def test_a_boundary_curve_is_drawn_with_its_own_slip() -> None:
    at = given("wedge")
    found = section(at, usual(at.law, -2.0)[0])
    assert len(usual(at.law, None)) == 1 and len(found.slips) == len(found.normals) >= 12
    turned = [normal.along @ slip.along for normal, slip in zip(found.normals, found.slips, strict=True)]
    assert 0.9 < min(turned) < 1.0 - 1e-4 and max(turned) <= 1.0 + 1e-9
    values = {at.law.symbols()[name]: value for name, value in at.values().items()}
    turn = at.law.symbols()["phi"]
    here = [float(part.xreplace(values).subs(turn, pi / 3)) * 2.0 for part in at.law.boundary]
    assert np.hypot(*(points(found) - here).T).min() < 1e-9


def test_seams_of_a_maximum_are_drawn_where_its_pieces_meet_alone() -> None:
    """tresca in the plane s_3 = 0: inside K every seam goes through 0 or along an axis or a diagonal."""
    found = seen("antoni2007", "sigma_a,sigma_b", **MU)
    assert len(found.seams) == 2
    assert all(np.abs(seam).min(axis=1) == pytest.approx(0.0, abs=1e-12) for seam in found.seams)
    law = duhem.Criterion(name="three", g="max(sigma_a, sigma_b, -sigma_a - sigma_b) - 1", pressure=None)
    for seam in seen(law, "sigma_a,sigma_b").seams:
        a, b = seam.T
        greatest = np.max([a, b, -a - b], axis=0)
        assert (np.sort([a, b, -a - b], axis=0)[1] > greatest - 0.03).all()


# ---- numbers, witnesses, increments


def test_numbers_that_nobody_gave_are_said_to_be_taken() -> None:
    assert "mu_a = 1/3, mu_b = 2/3 (chosen for the picture)" in stated(given("box"))
    assert "(chosen for the picture: mu_b)" in stated(given("box", mu_a=0.5))
    assert "chosen" not in stated(given("box", mu_a=0.5, mu_b=0.5))


def test_a_witness_is_drawn_where_it_is() -> None:
    found = duhem.verify("quartic", claims="convexity")
    shown = violation(found.criterion, found["convexity"])
    drawn = {role: tuple(place) for role, place in shown.points.items()}
    stress = {role: tuple(float(Fraction(at[x])) for x in found.criterion.forces) for role, at in found["convexity"].witness.points.items()}
    assert drawn == stress and np.array_equal(shown.way, [stress["p"], stress["q"]])


def test_a_flat_dent_is_drawn_deeper_than_it_is() -> None:
    found = duhem.verify("quartic", claims="convexity")
    shown = violation(found.criterion, found["convexity"])
    a, b, c, d = shown.section.window
    depth = min(np.hypot(*(line.points - shown.points["midpoint"]).T).min() for line in shown.section.lines)
    assert 0.05 * (b - a) < depth < 0.01 * (d - c)
    assert all(a < x < b and c < y < d for x, y in shown.points.values())


@pytest.mark.long
@pytest.mark.slow
def test_sections_beside_a_witness_are_at_its_numbers() -> None:
    law = duhem.Criterion(
        name="dented",
        g="max(sigma_a - c - mu*sigma_b**2, -sigma_a - c, abs(sigma_b) - c)",
        parameters={"mu": duhem.Domain(positive=True), "c": duhem.Domain(positive=True)},
        pressure=None,
    )
    witness = duhem.verify(law, {"c": 1}, claims="convexity")["convexity"].witness
    said = plot(law, parameters={"c": 1}, witness=True)[0].figure.get_suptitle()
    assert f"mu = {witness.parameters['mu']}, c = 1" in said and "chosen" not in said


def test_a_witness_at_other_numbers_than_its_sheet_says_them() -> None:
    found = duhem.verify("quartic", claims="convexity")
    shown = violation(found.criterion, found["convexity"])
    assert _refuted(shown, shown.numbered) == "convexity refuted"
    c = shown.numbered.values()["c"]
    assert _refuted(shown, given("quartic", mu=7, c=c)) == f"convexity refuted at mu = {shown.numbered.values()['mu']}"


@pytest.mark.slow
def test_a_witness_in_rays_of_k_is_not_said_to_lie_where_k_is_not() -> None:
    found = duhem.verify("matsuoka-nakai", claims="convexity", effort="quick")
    shown = violation(found.criterion, found["convexity"]).section
    assert shown.lines == () and "only the points of the counterexample" in shown.remark


@pytest.mark.slow
def test_an_increment_is_drawn_where_it_goes() -> None:
    (axes,) = plot("box", parameters={"mu_a": 0.3, "mu_b": 0.5}, planes="sigma_a,sigma_b", trial=[0.9, 0.1], pressure=-1.0)
    places = {line.get_label(): line.get_xydata() for line in axes.lines}
    assert places["stress at the end (slip)"] == pytest.approx(np.array([[0.3, 0.1]]), abs=1e-9)
    assert faults(axes.figure) == []


def test_a_slip_does_not_hide_the_way_from_the_trial() -> None:
    box = given("box", mu_a=0.3, mu_b=0.5)
    (plane,) = named(box.law, "sigma_a,sigma_b", -1.0)
    lengths = [np.hypot(*step(box, [trial, 0.1], 1.0, plane, 0.2).slip) for trial in (0.301, 0.5, 9.0)]
    assert lengths == pytest.approx([0.35 * 0.2, 0.6 * 0.2, 0.2])  # never so short that it has no direction


@pytest.mark.slow
def test_sections_along_the_pressure_reach_past_the_one_that_is_given_in_one_unit() -> None:
    first, *along = plot("coulomb", parameters={"mu": "3/10"}, pressure=-2e6, unit="Pa")
    assert first.get_title().endswith("10^{6}$ Pa") and all(place.get_title().endswith(" = 0$") for place in along)
    for place in along:
        assert place.get_xlim()[0] < -2e6 and place.get_ylim()[1] > 6e5
    assert all("[MPa]" in axis.label.get_text() for place in (first, *along) for axis in (place.xaxis, place.yaxis))


@pytest.mark.parametrize(("slope", "high"), [(1.1, 2.75), (1.9, 4.75)])
def test_a_cone_is_not_cut_off_along_its_axis(slope: float, high: float) -> None:
    law = duhem.Criterion(name="l", g=f"norm(sigma_a, sigma_b) - {slope}*abs(sigma_n)")
    window = seen(law, "sigma_n,sigma_a").window
    assert window[:2] == (-2.5, 0.0) and window[2] < -high and high < window[3] < 1.5 * high


@pytest.mark.long
def test_axes_that_are_given_take_the_first_sections() -> None:
    from matplotlib.figure import Figure

    numbers = {"mu_a": 0.3, "mu_b": 0.5}
    usual_titles = [axes.get_title() for axes in plot("box", parameters=numbers)]
    assert len(usual_titles) == 3
    for count in (1, 3):
        places = Figure().subplots(1, count, squeeze=False)[0]
        assert [axes.get_title() for axes in plot("box", parameters=numbers, axes=places)] == usual_titles[:count]
    alone = Figure().subplots()
    assert plot("box", parameters=numbers, axes=alone) == (alone,)
    with pytest.raises(InputError, match="3 axes, 4 are given"):
        plot("box", parameters=numbers, axes=Figure().subplots(1, 4))


@pytest.mark.slow
def test_points_of_a_witness_that_are_close_together_are_told_apart() -> None:
    found = duhem.verify("tresca", claims="smoothness")
    shown = violation(found.criterion, found["smoothness"])
    assert set(shown.points) == {"corner", "inside", "outside", "opposite"}
    apart = [np.hypot(*(a - b)) for a, b in combinations(shown.points.values(), 2)]
    assert min(apart) > 0.05 * shown.section.size


def test_an_increment_of_one_force_is_drawn_at_its_pressure() -> None:
    law = duhem.Criterion(name="one", g="abs(sigma_a) + sigma_n/2", forces=("sigma_a",))
    at = given(law)
    plane = usual(law, -2.0)[0]
    taken = step(at, [3.0], 1.0, plane, 0.25, -2.0)
    assert taken.trial == pytest.approx([-2.0, 3.0]) and taken.stress == pytest.approx([-2.0, 1.0])
    assert taken.slip == pytest.approx([0.0, 0.25]) and taken.status == "slip"


def test_a_witness_in_a_thin_section_is_seen_beside_its_width() -> None:
    found = duhem.verify("radial-flow", claims="normality")
    shown = violation(found.criterion, found["normality"]).section
    a, b, c, d = shown.window
    assert shown.slender and not shown.remark and (b - a) / (d - c) == pytest.approx(1e-3, rel=0.2)


def test_a_witness_in_a_narrow_section_has_room_for_numbers_and_notes() -> None:
    narrow = seen(duhem.Criterion(name="k", g="norm(6*sigma_a, sigma_b) - 1", pressure=None), "sigma_a,sigma_b")
    a, b, c, d = narrow.window
    assert b - a < 0.5 * (d - c) and not narrow.slender
    wide = _around(narrow, np.array([[0.0, -1.0], [0.0, 1.0]]), None)
    assert wide is not None and wide[1] - wide[0] == pytest.approx(0.6 * (wide[3] - wide[2])) and abs(wide[0] + wide[1]) < 1e-6


def test_a_section_lost_in_rounding_is_a_point_and_another_is_shown_if_none_was_asked() -> None:
    law = catalogue.load("murrell")
    lost = section(given(law), usual(law, 0.0)[0])
    assert lost.lines == () and len(lost.points) == 1 and "a single point" in lost.remark
    assert cut(given(law), usual(law, None)[0]).lines


# ---- what does not fit


@pytest.mark.parametrize(
    ("law", "options", "said"),
    [
        ("coulomb", {"planes": "sigma_a"}, "not a plane of the law.*sigma_a, sigma_b, sigma_n"),
        ("coulomb", {"planes": "sigma_a,sigma_a"}, "not a plane"),
        ("coulomb", {"planes": "deviatoric"}, "no stress tensor"),
        ("coulomb", {"pressure": 1.0}, "tension"),
        ("coulomb", {"pressure": float("nan")}, "finite"),
        ("tresca", {"pressure": -1.0}, "no pressure"),
        ("coulomb", {"parameters": {"mu": -1}}, "outside its domain"),
        ("coulomb", {"parameters": {"nu": 1}}, "unknown parameter"),
        ("no-such-law", {}, "no-such-law"),
        ("coulomb", {"planes": "sigma_n,sigma_a", "trial": [1, 1]}, "plane of forces"),
        ("wedge", {"trial": [1, 1]}, "no formula"),
        (
            EMPTY,
            {"pressure": -2.0},
            "duhem found no point of K on the plane of sigma_a, sigma_b at sigma_n = -2; it searched zero.*; choose another plane",
        ),
        ("coulomb", {"file": "p.xyz"}, "no format"),
    ],
)
def test_what_does_not_fit_is_said(law: str | duhem.Criterion, options: dict, said: str) -> None:
    with pytest.raises(InputError, match=said):
        plot(law, **options)


def test_without_matplotlib_the_extra_is_named(monkeypatch) -> None:
    import sys

    for name in ("matplotlib", "matplotlib.style", "matplotlib.backends.backend_agg"):
        monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(MissingExtraError, match=r"duhem\[plot\]"):
        plot("coulomb", "p.png")


def test_without_contours_the_extra_is_named_where_no_file_is_asked_for_either(monkeypatch) -> None:
    import sys

    monkeypatch.setitem(sys.modules, "contourpy", None)
    with pytest.raises(MissingExtraError, match=r"contourpy is not installed.*duhem\[plot\]"):
        plot("coulomb")


@pytest.mark.slow
def test_the_command_writes_where_it_says_and_never_over_what_it_reads(run, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.toml").write_text('[criterion]\nname = "a/../b law"\ng = "norm(sigma_a, sigma_b) - abs(sigma_n)"\n')
    asked = ("plot", "mine.toml", "--plane", "sigma_n,sigma_b")
    assert run(*asked) == (0, "a-b-law.png\n", "")
    assert (tmp_path / "a-b-law.png").read_bytes().startswith(b"\x89PNG")
    for options, said in (
        (("--to", "law.xyz"), "no format"),
        (("--pressure", "x"), "x"),
        (("--plane", "a,b"), "not a plane of the law"),
        (("--trial", "1", "2", "3"), "--trial|trial"),
    ):
        code, out, err = run("plot", "mine.toml", *options)
        assert (code, out) == (2, "") and len(err.splitlines()) == 1 and re.search(said, err)
    (tmp_path / "mine.toml").rename(tmp_path / "law.svg")
    code, _, err = run("plot", str(tmp_path / "law.svg"), "--to", "law.svg")
    assert code == 2 and "law.svg" in err and (tmp_path / "law.svg").read_text().startswith("[criterion]")


@pytest.mark.parametrize("law", VISCOUS)
def test_a_potential_of_rates_has_no_k_to_draw(law: str) -> None:
    with pytest.raises(InputError, match="no K to draw"):
        duhem.plot(law)
