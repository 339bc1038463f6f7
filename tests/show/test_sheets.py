"""What a notebook shows of a result: tags that close, text that stays text, plain values, short lines."""

import json
from dataclasses import replace
from html.parser import HTMLParser
from typing import Any

import numpy as np
import pytest

import duhem
from duhem import Criterion, Domain, ParametricCriterion, Verdict, Verification, Witness
from duhem.omitted import LeftOut
from duhem.proof.verification import ClaimResult
from duhem.show.printing import sheet
from duhem.testing.failures.report import Report

HOSTILE = '<script>alert("1")</script> & $x$ \\(y\\) | *z*'
TAGS = {"div", "p", "strong", "table", "thead", "tbody", "tr", "th", "td", "ul", "li", "span", "code"}
LAW = Criterion(
    HOSTILE, "norm(sigma_a, where(sigma_a < 0, 2, 1)*sigma_b) + mu*sigma_n", {"mu": Domain.fixed("3/5")}, summary=HOSTILE, source=HOSTILE
)
CURVE = ParametricCriterion("ellipse", ("mu*cos(phi)", "sin(phi)/3"), {"mu": Domain.between("1/2", 1)}, constraints=("mu < 2/3",))
WITNESS = Witness({"mu": "3/5"}, {HOSTILE: {"sigma_a": "1/3"}}, {"g": ("-2", "-1")}, HOSTILE)
VERIFICATION = Verification(
    LAW,
    (
        ClaimResult("origin", Verdict.PROVED, "evaluation", "mu = 3/5", 0.25, HOSTILE),
        ClaimResult("convexity", Verdict.REFUTED, "a chord", "mu = 3/5", 0.5, "a chord leaves K", WITNESS),
    ),
    (LeftOut("thermal", HOSTILE),),
    (HOSTILE,),
)
SHOWN = {"law": LAW, "curve": CURVE, "verification": VERIFICATION}


class Read(HTMLParser):
    """The text of a page whose tags close in order and carry nothing but ``scope``."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.said = ""
        self.typeset = ""  # what MathJax joins: text with nothing between
        self.feed(page)
        self.close()
        assert not self.open

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        assert tag in TAGS and {name for name, _ in attrs} <= {"scope"}
        self.open.append(tag)
        self.typeset += "\n"

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag
        self.typeset += "\n"

    def handle_data(self, data: str) -> None:
        self.said += data
        self.typeset += data


@pytest.mark.parametrize("name", SHOWN)
def test_html_closes_its_tags_and_text_stays_text(name: str) -> None:
    shown: Any = SHOWN[name]
    for page in (shown.to_html(), shown._repr_html_()):
        read = Read(page)
        for title, content in sheet(shown).fields:
            assert title in read.said and (content if isinstance(content, str) else "") in read.said
        for row in sheet(shown).rows:
            assert all(cell in read.said for cell in row)
        for _, sentences in sheet(shown).notes:
            assert all(sentence in read.said for sentence in sentences)
        assert "$x" not in read.typeset and "\\(y" not in read.typeset
    assert (HOSTILE in Read(shown.to_html()).said) == (name != "curve")


@pytest.mark.parametrize("name", SHOWN)
def test_markdown_has_no_tag_and_no_mark_of_the_users(name: str) -> None:
    shown: Any = SHOWN[name]
    said = shown._repr_markdown_()
    assert "<" not in said.replace(" < ", "") and "$x$" not in said and "*z*" not in said.replace("\\*", "")
    table = [line.replace("\\|", "") for line in said.splitlines() if line.startswith("|")]
    assert len({line.count("|") for line in table}) == (name == "verification")
    assert len(table) == (4 if name == "verification" else 0)


@pytest.mark.parametrize("name", SHOWN)
def test_values_are_plain(name: str) -> None:
    shown: Any = SHOWN[name]
    plain = shown.to_dict()
    assert json.loads(json.dumps(plain, allow_nan=False)) == plain
    assert plain["parameters"] == {"mu": "[1/2, 1]" if name == "curve" else "3/5"}


def test_a_law_can_be_made_again_of_its_plain_values() -> None:
    for law in (LAW, CURVE, duhem.load("antoni2007")):
        plain = law.to_dict()
        formulas = {name: plain[name] for name in ("g", "boundary", "constraints", "flow") if name in plain}
        same = type(law)(name=law.name, parameters=law.parameters, **formulas)
        assert (same, same.parameters) == (law, law.parameters) or same.to_dict() == plain | {"summary": "", "source": ""}


def test_formulas_are_latex_of_sympy() -> None:
    law = Criterion("disk", "norm(sigma_a, sigma_b) + mu*sigma_n", {"mu": Domain.fixed("3/5")})
    written = r"\mu \sigma_{n} + \left\|\sigma_{a},\,\sigma_{b}\right\|_2 \leq 0"
    assert law._repr_latex_() == rf"$\displaystyle {written}$"
    assert written in law._repr_markdown_() and written in Read(law._repr_html_()).said
    assert written not in law.to_html() and "mu*sigma_n + norm(sigma_a, sigma_b) <= 0" in Read(law.to_html()).said
    word = Criterion("word", "abs(q) - strength", {"strength": Domain.fixed(1)}, ("q",), None)
    assert word._repr_latex_() == r"$\displaystyle - \mathrm{strength} + \left|{q}\right| \leq 0$"
    assert CURVE._repr_latex_() == (
        r"$\displaystyle \left(\sigma_{a}, \sigma_{b}\right) = \left|\sigma_{n}\right| "
        r"\left(\mu \cos{\left(\phi \right)}, \frac{\sin{\left(\phi \right)}}{3}\right)$"
    )


def test_one_line_says_what_it_is() -> None:
    assert repr(CURVE) == "<ParametricCriterion ellipse: sigma_a, sigma_b; mu in [1/2, 1]>"
    assert repr(duhem.load("antoni2007")).endswith("mu_b_minus positive>")
    assert repr(VERIFICATION) == f"<Verification of {HOSTILE}: origin proved, convexity refuted>"
    many = Criterion("many", "a*b*c*d*e*abs(q) + p", dict.fromkeys("abcde", Domain.fixed(1)), ("q",), "p")
    assert repr(many) == "<Criterion many: q; a = 1, b = 1, c = 1, d = 1, and 1 more>"


def test_text_is_that_of_the_command_line() -> None:
    said = VERIFICATION.to_text()
    assert "Conclusion\n  generalized standard: no (convexity refuted)" in said
    assert "parameters  mu = 0.6 = 3/5" in said and LAW.to_text() in said.replace("\N{NO-BREAK SPACE}", " ")


def test_an_increment_has_a_row_a_point_and_plain_numbers() -> None:
    done = duhem.project("coulomb", [[0.1, 0.0], [3.0, 4.0]], -1.0, 2.0, {"mu": 0.5}, tangent=True)
    assert repr(done) == "<Projection of 2 points: 1 stick, 1 slip; closed-form>"
    rows = sheet(done).rows
    assert rows[0] == ("0", "stick", "0.1", "0", "0", "0", "0", "0", "0.0e+00")
    assert rows[1][:8] == ("1", "slip", "0.3", "0.4", "1.35", "1.8", "2.25", "1.125")  # mu |sigma_n| (3, 4)/5; (trial - stress)/2
    assert sheet(done).head[2:6] == ("sigma_a", "sigma_b", "slip along sigma_a", "slip along sigma_b")
    for page in (done.to_html(), done._repr_html_()):
        assert all(cell in Read(page).said for row in rows for cell in row)
    assert done._repr_markdown_().count("\n| ") == 4
    plain = done.to_dict()
    assert json.loads(json.dumps(plain, allow_nan=False)) == plain
    assert plain["status"] == ["stick", "slip"] and plain["stress"] == done.stress.tolist() and plain["tangent"] == done.tangent.tolist()


def test_of_many_points_the_first_are_shown_and_none_is_a_number_that_is_not() -> None:
    done = duhem.project("coulomb", np.full((30, 2), 0.1), -1.0, 1.0, {"mu": 0.5})
    assert len(sheet(done).rows) == 12 and "the first 12 of 30 points" in done.to_text()
    broken = replace(done, status=np.full(30, duhem.Status.FAILED, dtype=np.int8), slip=np.full((30, 2), np.nan))
    assert (
        repr(broken).startswith("<Projection of 30 points: 30 failed") and "point 0: method closed-form found no stress" in broken.to_text()
    )
    assert broken.to_dict()["slip"] == [[None, None]] * 30 and len(broken.to_dict()["remarks"]) == 30
    json.dumps(broken.to_dict(), allow_nan=False)


@pytest.mark.slow
def test_a_history_shows_its_ends_and_what_it_left_out() -> None:
    path = duhem.Path.linear(np.outer(np.arange(41), [3.0, 4.0]), pressure=-1.0)
    done = duhem.simulate("coulomb", path, stiffness=1.0, parameters={"mu": 0.5})
    rows = sheet(done).rows
    assert len(rows) == 12 and [row[0] for row in rows[:: len(rows) - 1]] == ["0", str(len(done) - 1)]
    assert rows[-1][1:] == tuple(f"{x:.6g}" for x in done.to_array()[-1])
    assert all(cell in Read(done.to_html()).said for row in [sheet(done).head, *rows] for cell in row)
    assert f"12 of {len(done)} knots" in done._repr_markdown_() and repr(done).startswith(f"<History of coulomb: {len(done)} knots")
    assert done.to_text().startswith("time,")


def test_a_report_of_a_routine_says_how_each_check_came_out() -> None:
    report = Report(HOSTILE, ("one",), (), {"two": HOSTILE}, 7, 1, expected={"three": "known"}, unexpected={"one": "mended"})
    assert dict(sheet(report).rows) == {"one": "passed, but was expected to fail", "two": "skipped", "three": "failed, as expected"}
    read = Read(report._repr_html_())
    assert f"two: {HOSTILE}" in read.said and "$x" not in read.typeset
    assert repr(report) == f"<Report of {HOSTILE}: 1 checks passed, 1 failed, 1 skipped; 7 increments, 1 flagged>"
    assert report.to_text() == str(report) and json.loads(json.dumps(report.to_dict()))["left_out"] == {"two": HOSTILE}


def test_many_histories_show_where_each_point_ended() -> None:
    steps = np.linspace(0.0, 1.0, 5)[None, :, None] * np.array([[1.0, 0.0], [0.6, 0.8], [0.0, -2.0]])[:, None, :]
    found = duhem.simulate("coulomb", duhem.Paths.linear(steps, pressure=-np.ones((3, 5))), stiffness=1.0, parameters={"mu": 0.5})
    assert repr(found).startswith("<Histories of coulomb: 3 points, ") and "array" not in repr(found)
    rows, table = sheet(found).rows, found.to_dict()
    assert [row[:2] for row in rows] == [("0", "slip"), ("1", "slip"), ("2", "slip")]
    for i, row in enumerate(rows):
        last = {name: column[table["point"] == i][-1] for name, column in table.items()}
        assert row[2:] == tuple(f"{last[name]:.6g}" for name in list(table)[1:])
    assert all(cell in Read(found._repr_html_()).said for row in rows for cell in row)


def test_an_identification_is_a_table_of_its_parameters() -> None:
    angle = np.linspace(0.0, 2.0 * np.pi, 12, endpoint=False)
    done = duhem.identify(np.column_stack([0.5 * np.cos(angle), 0.5 * np.sin(angle), -np.ones(12)]), "coulomb")
    assert repr(done) == "<Identification of coulomb from 12 points: mu = 0.5>"
    (row,) = sheet(done).rows
    assert row[:2] == ("mu", "0.5") and row[1] in done.to_text()
    assert all(cell in Read(done._repr_html_()).said for cell in row) and "| mu | 0.5 |" in done._repr_markdown_()
