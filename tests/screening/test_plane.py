"""The plane of a campaign: every line where its parameters are, none left out unsaid, and nothing that cannot be drawn is asked for."""

import json
from collections import Counter

import pytest
from click.testing import CliRunner

from duhem import InputError
from duhem.cli import cli
from duhem.screening import file
from duhem.screening.campaign import VerdictLine
from duhem.screening.plane import _LOOKS, NO_VERDICT, chosen, plane, plot_table, varying
from duhem.screening.summary import Counts
from duhem.screening.table import read_lines, write_table

CAMPAIGN = """\
[campaign]
claims = ["origin", "convexity"]
[[rows]]
laws = ["coulomb"]
[[rows]]
law = "limacon"
grid = { mu = [0.1, 0.2, 0.3], e = [0.1, 0.6] }
[[rows]]
laws = ["coulomb"]
"""


def line(row, claim, verdict, law="limacon", **values):
    return VerdictLine(row, law, json.dumps(values), claim, verdict, "m", None, None, 1, 0.5, None if verdict else "crashed, and why")


def table():
    """By hand: refuted where e = 3/5, open at (3/10, 1/10), failed at (1/5, 1/10), a row without parameters, one without a number."""
    lines = [line(1, "convexity", "proved", law="coulomb"), line(1, "origin", "proved", law="coulomb")]
    verdicts = {(2, 1): None, (3, 1): "undecided"}
    for row, (mu, e) in enumerate([(1, 1), (1, 6), (2, 1), (2, 6), (3, 1), (3, 6)], 2):
        values = {"mu": f"{mu}/10", "e": f"{e}/10"}
        verdict = verdicts.get((mu, e), "refuted" if e == 6 else "proved")
        lines += [line(row, "convexity", verdict, **values), line(row, "origin", verdict and "proved", **values)]
    return [*lines, line(8, "convexity", None, mu="x", e="1/10"), line(8, "origin", None, mu="x", e="1/10")]


def seen(lines, axes=None):
    found = varying((each.law, json.loads(each.parameters)) for each in lines)
    return plane(lines, chosen(axes, found), found)


def points(panel):
    return {verdict: sorted(zip(x, y, strict=True)) for verdict, (x, y) in panel.points.items()}


def test_every_line_is_where_its_parameters_are():
    found = seen(table())
    assert (found.axes, found.beside, found.unplaced, found.rows) == (("mu", "e"), (), 2, 8)
    convexity, origin = found.panels
    assert convexity.title == "limacon: convexity"
    assert points(convexity) == {
        "proved": [(0.1, 0.1)],
        "refuted": [(0.1, 0.6), (0.2, 0.6), (0.3, 0.6)],
        "undecided": [(0.3, 0.1)],
        NO_VERDICT: [(0.2, 0.1)],
    }
    assert {verdict: len(at) for verdict, at in points(origin).items()} == {"proved": 5, NO_VERDICT: 1}


def test_over_one_parameter_each_claim_has_a_line():
    found = seen(table(), ["e"])
    assert (found.claims, found.beside, found.unplaced) == (("convexity", "origin"), ("mu",), 1)
    (panel,) = found.panels  # the row without a number for mu has one for e
    assert Counter(points(panel)[NO_VERDICT]) == {(0.1, 0.0): 2, (0.1, 1.0): 2}


@pytest.mark.parametrize(
    ("axes", "word"),
    [(["mu", "mu"], "mu,mu"), ([], "nothing"), (["mu", "e", "a"], "mu,e,a"), (["nu"], "'nu'"), (None, "mu, e, a vary")],
)
def test_axes_that_are_none(axes, word):
    with pytest.raises(InputError, match=word):
        chosen(axes, {"mu": True, "e": True, "a": True, "b": False})


def test_a_plane_needs_numbers_that_differ():
    for lines, word in (
        ([line(1, "origin", "proved", mu="1/10")], "no parameter has two values"),
        ([line(1, "origin", "proved", mu="\u0661"), line(2, "origin", "proved", mu="y")], "no row has a number for mu"),
        ([line(1, "origin", "proved", mu="x"), line(2, "origin", "proved", mu="1/0")], "no row has a number for mu"),
        ([line(1, "origin", "proved", mu="1" + "0" * 400), line(2, "origin", "proved", mu="y")], "no row has a number for mu"),
    ):
        with pytest.raises(InputError, match=word):
            seen(lines)


@pytest.mark.slow
@pytest.mark.parametrize("ending", ["csv", "parquet"])
def test_a_finished_table_is_read_and_drawn(tmp_path, ending):
    if ending == "parquet":
        pytest.importorskip("pyarrow", reason="the extra parquet is not installed")
    name = str(tmp_path / f"table.{ending}")
    write_table(name, iter(table()), file.reads(CAMPAIGN))
    assert list(read_lines(name)) == table()
    done = CliRunner().invoke(cli, ["campaign", name, "--plot", str(tmp_path / "plane.svg")], standalone_mode=False)
    assert done.return_value == 0
    drawn = (tmp_path / "plane.svg").read_text("utf-8")
    assert drawn.startswith("<?xml") and all(f"<!-- {word} -->" in drawn for word in ("no verdict", "refuted", "undecided"))


TOGETHER = {
    "claims": {"proved", "refuted", "tested", "undecided", "not_applicable", NO_VERDICT},
    "increments": {"ok", "flagged", NO_VERDICT},
    "checks": {"passed", "failed", "xfailed", "xpassed", "not_applicable", NO_VERDICT},
    "stress": {"ok", "flagged", "wrong", "undecided", "not_applicable", NO_VERDICT},
}


@pytest.mark.parametrize("verdicts", TOGETHER.values(), ids=TOGETHER)
def test_marks_and_hues_tell_verdicts_apart(verdicts):
    """Those that one campaign may have."""
    looks = [_LOOKS[verdict] for verdict in verdicts]
    assert len({look.mark for look in looks}) == len({look.colour for look in looks}) == len(looks)
    assert set(_LOOKS) == set().union(*TOGETHER.values())


@pytest.mark.slow
def test_a_summary_draws_as_many_marks_as_there_are_verdicts():
    counts = Counts(file.reads(CAMPAIGN))
    axes = counts.summary(lines=tuple(counts.passing(iter(table())))).plot()
    drawn = {one.get_label(): len(one.get_xdata()) for one in axes[0].lines}
    assert drawn == {"proved": 1, "refuted": 3, "undecided": 1, "no verdict": 1}


@pytest.mark.slow
def test_axes_have_the_units_of_the_parameters():
    def labels(law, *names):
        rows = [
            VerdictLine(i, law, json.dumps({name: str(i) for name in names}), "origin", "proved", "m", None, None, 0, 0.0, None)
            for i in (1, 2, 3)
        ]
        axes = Counts(file.reads(CAMPAIGN)).summary(lines=tuple(rows)).plot(axes=names)[0]
        return axes.get_xlabel(), axes.get_ylabel()

    assert labels("cohesive", "mu", "cohesion") == (r"$\mu$ [–]", "$\\mathrm{cohesion}$ [unit of stress]")
    assert labels("rotated-flow", "mu", "delta") == (r"$\mu$ [–]", r"$\delta$")
    assert labels("not-here.toml", "mu", "c") == (r"$\mu$", "$c$") == labels("os:path", "mu", "c")


def test_on_the_line_of_a_claim_no_verdict_hides_another():
    counts = Counts(file.reads(CAMPAIGN))
    axes = counts.summary(lines=tuple(counts.passing(iter(table())))).plot(axes=("mu",))
    marks = [{*zip(one.get_xdata(), one.get_ydata(), strict=True)} for one in axes[0].lines]
    assert len(set().union(*marks)) == sum(map(len, marks))


def test_what_has_no_plane_is_not_asked_first(tmp_path):
    place = tmp_path / "campaign.toml"
    for text, options, word in (
        (CAMPAIGN, ["--axes", "nu"], "nu"),
        (CAMPAIGN, ["--axes", "mu", "--plot", ""], "format"),
        (CAMPAIGN.split("[[rows]]\nlaw =")[0], [], "no parameter has two values"),
    ):
        place.write_text(text)
        command = ["campaign", str(place), "--out", str(tmp_path / "table.csv"), "--plot", str(tmp_path / "plane.png"), *options]
        done = CliRunner().invoke(cli, command, standalone_mode=False)
        assert isinstance(done.exception, InputError) and word in str(done.exception)
        assert not (tmp_path / "table.csv").exists()
    for text in ("", "row,law\n1,coulomb\n", "\0"):
        (tmp_path / "no.csv").write_text(text)
        with pytest.raises(InputError, match=r"not the table of a campaign|no parameter"):
            plot_table(str(tmp_path / "no.csv"))
