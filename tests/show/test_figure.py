"""Every picture duhem draws, looked at as a reader would: nothing overlaps, nothing is cut off, every axis says its unit."""

import io
import math
import os
import re
import warnings
from collections.abc import Callable, Iterator
from contextlib import suppress
from typing import Any

import numpy as np
import pytest

import duhem
from duhem import Criterion, Path, simulate
from duhem.benchmark.extreme_cases import AXES, ExtremeCases, Tally
from duhem.benchmark.measurement import Measurement, Spread, WorkPrecision
from duhem.errors import InputError, MissingExtraError
from duhem.micromodel.figures import FIGURES, Figure
from duhem.path.picture import stress_path, trajectory
from duhem.show import figure
from duhem.show.printing import draw

pytest.importorskip("matplotlib")

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure as Sheet
from matplotlib.patches import Rectangle

from tests.long import mostly_long
from tests.oracles.legible import faults

MU = {"mu_a_plus": 0.2, "mu_a_minus": 0.08, "mu_b_plus": 0.12, "mu_b_minus": 0.15}
LONG = "a law with a name that nobody would ever want to read to its very end, " * 3
WORD = "w" * 150


def scene(scale: float = 1.0, **options):
    """README's scene, its stresses multiplied."""
    points = [[0, 0], [3e-4, 0], [3e-4, 2e-4], [0, 0]]
    given = {"stiffness": np.array([1e9, 2e9]) * scale, "parameters": MU, "method": "exact"}
    return simulate("antoni2007", Path.linear(points, pressure=-1e6 * scale), **(given | options))


def line(**options):
    path = Path.cycle(6e-6, cycles=2, pressure=-1e6)
    return simulate("antoni2007-1d", path, stiffness=1e11, parameters={"mu_plus": 0.2, "mu_minus": 0.08}, **options)


def line_from(time: float) -> duhem.History:
    path = Path.linear([0, 1, -1], pressure=-1.0, time=time + np.arange(3.0))
    return simulate("antoni2007-1d", path, stiffness=1.0, parameters={"mu_plus": 0.2, "mu_minus": 0.08}, substeps=3)


def renamed(name: str, forces: tuple[str, ...], points) -> duhem.History:
    """A disk, or a ball, in forces of other names."""
    law = Criterion(name=name, g=f"norm({', '.join(forces)}) - 0.3*abs(sigma_n)", forces=forces)
    return simulate(law, Path.linear(points, pressure=-1.0), stiffness=1.0, substeps=5)


def flat() -> duhem.History:
    return simulate("antoni2007", Path.linear([[0, 0], [0, 0]], pressure=-1.0), stiffness=1.0, parameters=MU)


def unpressed() -> duhem.History:
    """Without friction's pressure, and far inside K."""
    law = Criterion(name="free", g="norm(sigma_a, sigma_b) - 1000000", pressure=None)
    return simulate(law, Path.linear([[0, 0], [1, 0.5]]), stiffness=1.0)


RUNS: dict[str, Callable[[], duhem.History]] = {
    "README": scene,
    "one force": lambda: line(method="exact"),
    "one force, steps": lambda: line(substeps=7),
    "three forces": lambda: renamed("ball", ("sigma_a", "sigma_b", "sigma_c"), [[0, 0, 0], [1, 0.5, 0.2], [-1, 0.5, 0.1]]),
    "six forces": lambda: renamed("six", tuple(f"sigma_{i}" for i in range(1, 7)), np.eye(6)),
    "long names": lambda: renamed(LONG, ("sigma_longitudinal_to_the_ridge", "tau_x_of_the_other__one_minus"), [[0, 0], [1, 1]]),
    "long word": lambda: renamed(WORD, ("s", "t"), [[0, 0], [1, 1]]),
    "dollars": lambda: renamed("$100 \\frac{ $5 %s", ("s", "t"), [[0, 0], [1, 1]]),
    "1e9": lambda: scene(1e9),
    "1e-15": lambda: scene(1e-15),
    "1e-300": lambda: scene(1e-306),
    "1e290": lambda: scene(1e284, method="implicit"),
    "changing pressure": lambda: simulate(
        "antoni2007", Path.random(seed=3, points=300, scale=0.3, pressure=(-2.0, -0.5)), stiffness=1.0, parameters=MU
    ),
    "late": lambda: line_from(1e9),
    "nothing happens": flat,
    "far inside": unpressed,
    "prescribed stress": lambda: simulate(
        "antoni2007", Path.linear([[0, 0], [0.1, 0]], pressure=-1.0, control="stress"), stiffness=1.0, parameters=MU
    ),
}


def names(many: int, long: str = "") -> list[str]:
    return [f"cvxpy SOLVER{i}{long}" for i in range(many)]


def said(law: str) -> dict[str, Any]:
    """The head of a study."""
    return {"law": law, "subject": "mu = 0.2; stiffness 1", "machine": {}, "left_out": (), "interrupted": False}


def bench(methods: list[str], error: Callable[[int, int], float], law: str = "antoni2007", failing: int = 0) -> WorkPrecision:
    rows = [
        Measurement("increment", m, f"tolerance 1e-{k}", {"stress": error(i, k)}, Spread(1e-3 * 2**i, 1.1e-3 * 2**i, 2e-3 * 2**i, 5))
        for i, m in enumerate(methods)
        for k in range(2, 9, 2)
    ]
    rows += [Measurement("increment", m, "tolerance 1e-12", failure="SolverError: infeasible") for m in methods[:failing]]
    rows += [Measurement("path", m, "n = 4", {"stress": error(i, 3)}, Spread(1.0, 2.0, 3.0, 1)) for i, m in enumerate(methods[:3])]
    return WorkPrecision(**said(law), repeats=5, rows=tuple(rows), targets=(), reference={"increment": 1e-60, "path": 0.0})


def stress(methods: list[str], law: str = "antoni2007") -> ExtremeCases:
    labels = {axis: [f"1e{e}" for e in range(-290, 291, 29)] for axis in AXES}
    labels["special values"] = ["trial +-0", "sigma_n = -5e-324", "sigma_n = -1e-300", "all denormal", "trial 1e300", "both 0"]
    labels["boundary distance"] = [*(f"1e-{j}" for j in range(16)), "1 ulp", "0 by doubles"]
    rows = [
        Tally(axis, label, 0.0, m, 2, 2, 2, 0, 16.0 - i, 16.0 * math.exp(-i * at), 0, int(i == 1), None)
        for axis in AXES
        for at, label in enumerate(labels[axis])
        for i, m in enumerate(methods)
    ]
    return ExtremeCases(**said(law), rows=tuple(rows), refusals=(), reference=1e-50)


BENCHES: dict[str, Callable[[], object]] = {
    "bench": lambda: bench(names(4), lambda i, k: 10.0 ** -(k + i)),
    "bench, nine methods": lambda: bench(names(9), lambda i, k: 10.0 ** -(k + i / 2), failing=9),
    "bench, long names": lambda: bench(names(9, " with every option that there is to be set"), lambda i, k: 10.0**-k, LONG, 3),
    "bench, one error": lambda: bench(names(3), lambda i, k: 5.6e-17),
    "bench, no error": lambda: bench(names(3), lambda i, k: 0.0),
    "bench, nothing": lambda: bench([], lambda i, k: 0.0),
    "stress": lambda: stress(names(4)),
    "stress, nine methods": lambda: stress(names(9, " with every option"), LONG),
    "stress, nothing": lambda: stress([]),
}


def points(m: int, load: float = 1e6, wrong: tuple[int, ...] = ()) -> np.ndarray:
    """Limit points of Figure 5's criterion under the pressures around ``load``."""
    draw = np.random.default_rng(5)
    angle, pressure = np.sort(draw.uniform(0.0, 2.0 * np.pi, m)), load * draw.uniform(0.5, 2.0, m)
    c, s = np.cos(angle), np.sin(angle)
    size = pressure / np.hypot(c / np.where(c > 0, 0.2, 0.08), s / np.where(s > 0, 0.12, 0.15)) * draw.normal(1.0, 1e-3, m)
    size[list(wrong)] *= 1.5
    return np.column_stack([size * c, size * s, -pressure])


POINTS = {
    "few": lambda: duhem.identify(points(8)),
    "outliers side by side": lambda: duhem.identify(points(60, wrong=(10, 11, 12, 13)), robust=True),
    "small": lambda: duhem.identify(points(40, 1e-90)),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(RUNS, "six forces"))
def test_runs_are_legible(name: str) -> None:
    places = RUNS[name]().plot()
    assert len(places) == 3 and faults(places[0].figure) == []


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(BENCHES, "stress, nine methods"))
def test_benchmarks_are_legible(name: str) -> None:
    assert faults(draw(BENCHES[name]())[0].figure) == []


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(POINTS, *list(POINTS)[:1]))
def test_identifications_are_legible(name: str) -> None:
    assert faults(POINTS[name]().plot().figure) == []


SETTINGS = [
    *((name, {}) for name, recipe in FIGURES.items() if recipe.drawn),
    ("1", {"pressure": -2e9, "mu_minus": 0.001}),
    ("4", {"height_over_period": 0.3, "mu_high": 0.21}),
    ("5", {"mu_a_plus": 0.9, "mu_b_plus": 0.01, "mu_isotropic": 0.001}),
    ("9", {"mu": 0.2}),
    ("oblique", {"tan_alpha": 3.0, "tan_beta": 0.1}),
]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "settings"), mostly_long(SETTINGS, *SETTINGS[::6]))
def test_the_figures_of_the_paper_are_legible(name: str, settings: dict[str, float]) -> None:
    from duhem.micromodel.figures.value import draw as drawn

    made = FIGURES[name](**settings)
    assert isinstance(made, Figure)
    assert faults(drawn(made)) == []


# ---- the reader can fail


def spoiled() -> Iterator[tuple[str, Callable[[Sheet], object]]]:
    def first(sheet: Sheet):
        return sheet.axes[0]

    yield "overlaps", lambda s: first(s).set_xticks(np.linspace(*first(s).get_xlim(), 60), [f"{i}00000" for i in range(60)])
    yield "overlaps", lambda s: [first(s).text(0.5, y, "words", transform=first(s).transAxes) for y in (0.5, 0.51)]
    yield "cut off", lambda s: first(s).text(0.9, 0.5, "words " * 60, transform=first(s).transAxes).set_in_layout(False)
    yield "cut off", lambda s: s.suptitle("words " * 60)
    yield "says ''", lambda s: first(s).set_xlabel("")
    yield "no quantity with a unit", lambda s: first(s).set_ylabel("stress")
    yield "outside", lambda s: s.axes[1].set_xlim(1e-4, 2e-4)
    yield "legend covers", lambda s: first(s).legend(loc="center", framealpha=1.0, labelspacing=8.0)


SPOILED = [*spoiled()]


@pytest.mark.slow
@pytest.mark.parametrize(("said", "spoil"), mostly_long(SPOILED, SPOILED[4]))
def test_a_spoiled_picture_is_caught(said: str, spoil: Callable[[Sheet], object]) -> None:
    sheet = scene().plot()[0].figure
    spoil(sheet)
    assert any(said in fault for fault in faults(sheet))


@pytest.mark.slow
def test_turned_words_are_judged_as_they_stand() -> None:
    """Turned labels side by side have boxes that overlap, and are legible; the same labels level are not."""
    for turn, clean in ((40, True), (0, False)):
        sheet = Sheet(figsize=(6, 4), layout="constrained")
        FigureCanvasAgg(sheet)
        axes = sheet.subplots()
        axes.set_xticks(range(12), ["a label of some length"] * 12, rotation=turn, ha="right" if turn else "center", rotation_mode="anchor")
        axes.set(xlabel="case", ylabel="digits [–]")
        assert (faults(sheet) == []) == clean


# ---- what is drawn is what was computed


@pytest.mark.parametrize(
    ("unit", "size", "said"),
    [
        ("Pa", 2e3, "kPa"),
        ("m", 3e-6, "µm"),
        ("Pa", 1e20, "$10^{18}$ Pa"),
        ("MPa", 2e3, "MPa"),
        ("MPa", 2e7, "$10^{6}$ MPa"),
        ("unit of stress", 2e-9, "$10^{-9}$ unit of stress"),
    ],
)
def test_an_axis_counts_a_unit_by_its_prefixes_and_what_takes_none_by_powers_of_ten(unit: str, size: float, said: str) -> None:
    axis = Sheet().subplots().xaxis
    figure.measure(axis, "x", unit, size)
    assert axis.get_label_text() == f"x [{said}]"


@pytest.mark.slow
def test_a_run_is_drawn_along_its_own_curve_with_marks_at_its_knots() -> None:
    history = scene()
    axes = history.plot()[0]
    drawn = [line for line in axes.lines if line.get_color() == figure.palette(0) and len(line.get_xdata())]
    lines = {(line.get_linestyle(), line.get_marker()): line for line in drawn}
    sticks, slips, knots = lines["--", "None"], lines["-", "None"], lines["None", figure.pen(0)["marker"]]
    assert np.array_equal(np.column_stack(knots.get_data()), history.stress)

    def gauge(line) -> np.ndarray:
        a, b = np.column_stack(line.get_data())[np.isfinite(line.get_xdata())].T / 1e6
        return np.hypot(a / np.where(a > 0, 0.2, 0.08), b / np.where(b > 0, 0.12, 0.15))

    assert gauge(slips) == pytest.approx(1.0, abs=1e-12) and len(gauge(slips)) > 50
    assert gauge(sticks).max() <= 1.0 + 1e-12 and gauge(sticks).min() < 1e-12
    edge = next(line for line in axes.lines if line.get_label().startswith("boundary"))
    assert gauge(edge) == pytest.approx(1.0, abs=1e-3)


@pytest.mark.slow
def test_steps_whose_way_is_not_known_look_otherwise() -> None:
    def slips(history: duhem.History):
        (line,) = (line for line in history.plot(ax=Sheet().subplots()).lines if line.get_label().startswith("slips"))
        return line.get_label(), line.get_linewidth()

    (curve, thick), (joined, thin) = slips(scene()), slips(scene(method="implicit"))
    assert curve != joined and thick > thin


def test_heads_on_a_path_point_where_time_goes() -> None:
    axes, seen = Sheet().subplots(), trajectory(scene())
    stress_path(axes, seen)
    way = seen.states.stress
    assert len(axes.texts) == 7
    for head in axes.texts:
        tail, tip = np.array(head.xyann), np.array(head.xy)
        here = int(np.argmin(np.hypot(*(way - tip).T)))
        ahead = way[min(here + 1, len(way) - 1)] - way[max(here - 1, 0)]
        assert ahead @ (tip - tail) > 0.9 * np.hypot(*ahead) * np.hypot(*(tip - tail))


@pytest.mark.slow
def test_axes_of_ones_own_are_drawn_on_and_returned(tmp_path) -> None:
    sheet = Sheet()
    FigureCanvasAgg(sheet)
    own = sheet.subplots(1, 3)
    history = scene()
    assert history.plot(axes=own) == tuple(own)
    assert history.plot(ax=own[0]) is own[0]
    fit = POINTS["few"]()
    assert fit.plot(ax=own[1]) is own[1] and all(axes.figure is sheet for axes in own)
    history.plot(tmp_path / "own.png", axes=own)
    assert (tmp_path / "own.png").read_bytes().startswith(b"\x89PNG")
    with pytest.raises(InputError, match="has 3 axes, 2 are given"):
        history.plot(axes=own[:2])
    with pytest.raises(InputError, match="both ax and axes"):
        history.plot(ax=own[0], axes=own)
    stress_path(own[2], trajectory(history))


@pytest.mark.slow
def test_a_notebook_shows_a_new_sheet_and_not_one_that_its_reader_holds() -> None:
    new = figure.drawn(lambda axes: axes.plot([0, 1]), size=(2.0, 1.0))
    assert int.from_bytes(new._repr_png_()[16:20], "big") == 200  # its width in points
    held = Sheet().subplots()
    assert not hasattr(figure.drawn(lambda axes: axes.plot([0, 1]), None, [held]), "_repr_png_")


@pytest.mark.slow
def test_nothing_of_the_readers_settings_changes_and_none_of_them_matters(tmp_path) -> None:
    import matplotlib

    scene().plot(tmp_path / "plain.svg")
    with matplotlib.rc_context({"font.size": 30.0, "axes.facecolor": "black", "lines.linewidth": 9.0}):
        before = dict(matplotlib.rcParams)
        scene().plot(tmp_path / "odd.svg")
        assert dict(matplotlib.rcParams) == before
    assert (tmp_path / "odd.svg").read_bytes() == (tmp_path / "plain.svg").read_bytes()


def test_lines_over_an_area_are_as_faint_in_a_file_as_on_the_screen() -> None:
    def paint(axes: Any) -> None:
        figure.hatched(axes, Rectangle((0.2, 0.2), 0.5, 0.5, alpha=0.3, label="area"), "xx", "black")
        figure.legend_below((axes,))

    svg = figure.as_svg(figure.drawn(paint))
    assert svg.count("fill: url(#") == 2 and 'stroke-opacity: 0.3"' in svg  # in the picture and in its one entry of the legend
    assert svg.count("<!-- area -->") == 1
    assert not re.search(r"fill: url\(#\w+\)[^\"]*opacity", svg)


def test_colours_differ_in_grey_or_by_their_marks() -> None:
    looks = {(pen["color"], pen["marker"]) for pen in map(figure.pen, range(56))}
    assert len(looks) == 56
    assert len({str((figure.pen(i)["marker"], figure.pen(i)["linestyle"])) for i in range(8)}) == 8


# ---- before the work


@pytest.mark.parametrize(
    ("place", "said"),
    [
        ("p.xyz", "xyz is no format of a figure; end the name in .png, .pdf, .svg"),
        ("p", "no ending is no format"),
        ("no/where/p.png", "there is no such directory"),
        ("folder.png", "this is a directory"),
        ("locked/p.png", "you have no permission to write it"),
    ],
)
def test_a_place_that_cannot_be_written_to_is_said_before_the_work(place: str, said: str, tmp_path, monkeypatch) -> None:
    (tmp_path / "folder.png").mkdir()
    (tmp_path / "locked").mkdir()
    allowed = os.access
    monkeypatch.setattr(os, "access", lambda file, mode: "locked" not in str(file) and allowed(file, mode))  # root may do anything
    for asked in (figure.check, lambda file: figure.drawn(pytest.fail, file), lambda file: figure.save(Sheet(), file)):
        with pytest.raises(InputError) as fault:
            asked(tmp_path / place)
        assert said in str(fault.value) and str(tmp_path / place) in str(fault.value)


def test_the_formats_that_are_named_are_those_that_are_taken(tmp_path) -> None:
    with pytest.raises(InputError) as fault:
        figure.check(tmp_path / "p.xyz")
    named = {word.strip(".,") for word in fault.value.remedy.split() if word.startswith(".")}
    every = {*FigureCanvasAgg.get_supported_filetypes(), "bmp", "doc", "csv", "html"}
    taken = set()
    for ending in every:
        with suppress(InputError):
            figure.check(tmp_path / f"p.{ending}")
            taken.add(ending)
    assert named == taken >= {"png", "pdf", "svg", "jpg"}


def test_a_failure_leaves_no_half_picture(tmp_path, monkeypatch) -> None:
    (tmp_path / "p.png").write_bytes(b"before")

    def full(self, file, **_: object) -> None:
        with open(file, "wb") as stream:
            stream.write(b"half")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Sheet, "savefig", full)
    with pytest.raises(InputError, match="No space left on device"):
        figure.save(Sheet(), tmp_path / "p.png")
    assert {file.name: file.read_bytes() for file in tmp_path.iterdir()} == {"p.png": b"before"}


def test_without_matplotlib_the_extra_is_named(monkeypatch) -> None:
    import sys

    for name in ("matplotlib", "matplotlib.style", "matplotlib.backends.backend_agg"):
        monkeypatch.setitem(sys.modules, name, None)
    for asked in (lambda: figure.check("p.png"), lambda: scene().plot(), lambda: draw(BENCHES["bench"]())):
        with pytest.raises(MissingExtraError, match=r"duhem\[plot\]"):
            asked()


# ---- what plot takes


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(["x.png", b"x.png", "stream"], "stream"))
def test_a_picture_goes_into_a_name_in_bytes_or_letters_and_into_a_stream(name: str | bytes, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    stream = io.BytesIO()
    scene().plot(stream if name == "stream" else name)
    written = stream.getvalue() if name == "stream" else (tmp_path / "x.png").read_bytes()
    assert written.startswith(b"\x89PNG") and len(written) > 10_000


@pytest.mark.slow
@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"titel": "x"}, "titel.*it takes"),
        ({"mu_a_plus": 0.5}, "mu_a_plus.*it takes"),
        ({"law": "coulomb"}, "needs mu|the forces"),
        ({"law": "coulomb", "mu": -1.0}, "mu|the forces"),
        ({"law": "antoni2007", "titel": 1.0}, "titel"),
        ({"law": "antoni2007", "mu_a_plus": -1.0}, "mu_a_plus"),
        ({"law": "antoni2007-1d", "mu_plus": 0.1, "mu_minus": 0.1}, "the forces"),
        ({"law": "wedge"}, "no formula"),
        ({"law": "no-such-law"}, "no-such-law"),
        ({"ax": 3}, "int is not"),
        ({"ax": "x"}, "str is not"),
        ({"axes": 3}, "3 axes, 1"),
        ({"axes": [1, 2, 3]}, "int is not"),
        ({"axes": []}, "3 axes, 0"),
        ({"file": 3}, "int is no file"),
    ],
)
def test_options_that_do_not_fit_are_named(options: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        scene().plot(**options)


@pytest.mark.slow
def test_a_law_given_by_its_name_is_drawn() -> None:
    axes = scene().plot(law="antoni2007", mu_a_plus=0.4, mu_a_minus=0.4, mu_b_plus=0.4, mu_b_minus=0.4)[0]
    edge = next(line for line in axes.lines if line.get_label().startswith("boundary"))
    assert np.hypot(*edge.get_data()) == pytest.approx(0.4e6, rel=1e-3)


def test_a_title_breaks_between_values_and_not_within_one() -> None:
    said = figure.wrapped("law: mu_a_plus = 0.2, mu_a_minus = 0.08, mu_b_plus = 0.12", 2.4)
    assert said.replace("\n", " ") == "law: mu_a_plus = 0.2, mu_a_minus = 0.08, mu_b_plus = 0.12"
    assert len(said.splitlines()) > 1 and all(line.count("=") == line.count(" = ") for line in said.splitlines())


@pytest.mark.long
def test_lines_of_many_knots_are_told_apart_without_colour() -> None:
    run = scene(method="implicit", substeps=100)
    assert len(run) > 200
    path, _, energy = draw(run)
    marks = {line.get_marker() for line in energy.lines if len(line.get_xdata()) > 1 and line.get_marker() != "None"}
    assert len(marks) == 4 and faults(energy.figure) == []
    assert all(len(line.get_xdata()) < 20 for line in energy.lines if line.get_marker() in marks)
    assert not [line for line in path.lines if line.get_marker() != "None" and len(line.get_xdata()) > 1]


@pytest.mark.long
def test_where_the_pressure_varies_both_boundaries_are_seen_over_the_path() -> None:
    path = Path.linear([[0, 0], [3, 0], [3, 3]], pressure=[-1.0, -3.0, -2.0])
    run = simulate("coulomb", path, stiffness=1.0, parameters={"mu": 0.5}, substeps=4)
    axes = draw(run)[0]
    edges = [line for line in axes.lines if line.get_color() == "black" and len(line.get_xdata()) > 100]
    assert sorted(round(float(np.abs(line.get_xdata()).max()), 2) for line in edges) == [0.5, 1.5]
    assert all(line.get_zorder() > other.get_zorder() for line in edges for other in axes.lines if other.get_color() == figure.palette(0))
    assert faults(axes.figure) == []


@pytest.mark.slow
@pytest.mark.parametrize("form", ["png", *(pytest.param(form, marks=pytest.mark.long) for form in ("pdf", "svg"))])
def test_a_name_in_letters_that_the_font_lacks_is_drawn_without_a_warning(form: str, tmp_path) -> None:
    law = Criterion(name="naïve 摩擦 \N{GRINNING FACE} \N{EGYPTIAN HIEROGLYPH A001}", g="abs(摩)-1", forces=("摩",), pressure=None)
    before = list(warnings.filters)
    duhem.plot(law, tmp_path / f"k.{form}")
    assert warnings.filters == before
