"""The page of ``verify --report``: everything is on it, as text, in one file; a browser shows it, requests nothing and has no complaint."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from itertools import pairwise
from pathlib import Path

import pytest

import duhem
from duhem.cli import report
from duhem.cli.report import again, article, law_lines
from duhem.portrait import pictures
from duhem.proof.report import decided as decided_chapters
from duhem.show.document import Article, Chapter, Display, as_page
from duhem.version import __version__
from tests.oracles.browser import CHROMIUM, Browser, browser
from tests.oracles.strict_html import Strict

Run = Callable[..., tuple[int, str, str]]
pytest.importorskip("matplotlib")
pytest.importorskip("latex2mathml")

HOSTILE = "<script>alert(1)</script>"
LAW = f"""\
[criterion]
name = "{HOSTILE}"
summary = "</title><img src=x onerror=alert(2)>"
source = "</style><script>alert(3)</script> & $x$"
forces = ["sigma_a"]
g = "abs(sigma_a)/mu - e*sigma_a - abs(sigma_n)"  # </pre><script>alert(4)</script>
[parameters]
mu = {{ value = 0.5 }}
e = {{ value = 0.25 }}
"""


@pytest.fixture(scope="module")
def hostile(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page of a law whose every text is an attack, made by the command itself; the certificate is beside it."""
    place = tmp_path_factory.mktemp("report")
    law = place / "<b>&law.toml"
    law.write_text(LAW, "utf-8")
    command = [sys.executable, "-m", "duhem", "verify", law.name, "--report", "out.html", "--certificate", "out.json"]
    done = subprocess.run(command, cwd=place, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    assert {file.name for file in place.iterdir()} == {law.name, "out.html", "out.json"}
    return place / "out.html"


def read(file: Path) -> Strict:
    seen = Strict()
    seen.feed(file.read_text("utf-8"))
    seen.close()
    return seen


@pytest.mark.slow
def test_the_page_holds_everything_and_all_of_it_is_text(hostile: Path) -> None:
    seen = read(hostile)
    assert not {"script", "img", "link", "iframe", "b"} & seen.tags and {"math", "svg", "table"} <= seen.tags
    said = seen.said
    for each in (HOSTILE, "</title><img src=x onerror=alert(2)>", "</style><script>alert(3)</script> & $x$", LAW.rstrip("\n")):
        assert each in said, each
    assert "duhem verify '<b>&law.toml'" in said and __version__ in said
    certificate = json.loads(hostile.with_name("out.json").read_text("utf-8"))
    assert certificate["sha256"] in said
    rules = {claim["rule"] for claim in certificate["claims"] if claim["rule"]}
    assert rules <= {*said} and len(rules) > 3
    for title in ("The law", "Verdicts", "Why", "Pictures", "Omitted", "Derivation", "Certificate", "How to reproduce it"):
        assert title in said
    proved = [claim for claim in certificate["claims"] if claim["verdict"] == "proved"]
    assert said.count("proved") == 2 * len(proved) > 8  # in the table of verdicts, and in that of the certificate
    assert any("law is isothermal" in each for each in said)
    assert any(each.startswith("K in the plane of sigma_a, sigma_n; ") for each in said)
    assert "composition" in said and "all parameters" not in said


@pytest.fixture(scope="module")
def tab() -> Iterator[Browser]:
    if CHROMIUM is None:
        pytest.skip("there is no Chromium")
    with browser() as opened:
        yield opened


@pytest.mark.slow
@pytest.mark.parametrize("dark", [False, True], ids=["light", "dark"])
def test_a_browser_shows_it_and_asks_for_nothing(hostile: Path, tab: Browser, dark: bool) -> None:
    tab.emulate(390, dark=dark)
    tab.open(hostile)
    assert tab.complaints() == [] and tab.requests() == [hostile.as_uri()]
    assert tab.of("document.title").startswith(HOSTILE) and tab.of("document.querySelector('h1').innerText") == HOSTILE
    assert tab.of("document.documentElement.scrollWidth") <= 390  # nothing runs out of a phone
    drawn = "[...document.querySelectorAll('{}')].filter(e => e.getBoundingClientRect().height > {}).length"
    assert tab.of(drawn.format("figure svg", 200)) == tab.of("document.querySelectorAll('figure').length") >= 1
    assert tab.of(drawn.format("math", 8)) == tab.of("document.querySelectorAll('math').length") > 30
    names = tab.of("[...new Set([...document.querySelectorAll('math *')].map(e => e.namespaceURI))]")
    assert names == ["http://www.w3.org/1998/Math/MathML"]
    paper, ink = (tab.of(f"getComputedStyle(document.documentElement).{key}") for key in ("backgroundColor", "color"))
    brightness = [sum(map(int, re.findall(r"\d+", colour)[:3])) for colour in (paper, ink)]
    assert (brightness[0] < 120 and brightness[1] > 600) if dark else (brightness[0] == 765 and brightness[1] < 120)
    ticks = "[...document.querySelectorAll('figure svg use')].find(e => e.getAttribute('style')?.includes('stroke: color-mix'))"
    stroke = [float(part) for part in re.findall(r"[\d.]+", tab.of(f"getComputedStyle({ticks}).stroke"))[:3]]
    assert min(stroke) > 0.85 if dark else max(stroke) < 0.15  # of color(srgb r g b)


@pytest.mark.slow
def test_on_a_phone_no_formula_is_wider_than_its_line(tab: Browser, tmp_path: Path) -> None:
    side = r"\frac{\left\langle{\sigma_{a}}\right\rangle_{+}}{\mu_{a}^{+}}"
    norm = rf"\left\|{side} + {side}, {side} + {side}\right\|_{{2}}"
    rows = (
        rf"g = {norm} - \left|{{\sigma_{{n}}}}\right|",
        rf"K = \left\{{\left( \sigma_{{a}}, \  \sigma_{{b}}\right) : {norm} - \left|{{\sigma_{{n}}}}\right| \leq 0 \right\}}",
        r"\dot\lambda \left(" + norm + r"\right) = 0",
    )
    file = tmp_path / "page.html"
    file.write_text(
        as_page([Article("a", "", (Chapter("c", tuple(Display(f"D{i}", "", "", (row,)) for i, row in enumerate(rows))),))]), "utf-8"
    )
    tab.emulate(390)
    tab.open(file)
    lines = "[...document.querySelectorAll('.mathematics')]"
    assert tab.of(f"{lines}.length") == len(rows)
    assert tab.of(f"{lines}.filter(e => e.scrollWidth > e.clientWidth).map(e => e.textContent)") == []
    assert tab.of(f"Math.min(...{lines}.map(e => e.clientWidth))") > 0.9 * 390  # its number takes none of it


@pytest.mark.slow
def test_on_a_phone_no_row_of_a_formula_runs_into_the_row_above_it(tab: Browser, tmp_path: Path) -> None:
    row = " + ".join([r"\frac{s_{2}^{2}}{\mathrm{Yt}^{2}}"] * 30)
    file = tmp_path / "page.html"
    file.write_text(as_page([Article("a", "", (Chapter("c", (Display("D1", "", "", (row,)),)),))]), "utf-8")
    tab.emulate(390)
    tab.open(file)
    fractions = "[...document.querySelectorAll('.mathematics mfrac')].map(e => e.getBoundingClientRect())"
    places = tab.of(f"{fractions}.map(box => [box.top, box.bottom])")
    rows = sorted({(round(top), round(bottom)) for top, bottom in places})
    assert len(places) == 30 and len(rows) > 2
    assert min(below[0] - above[1] for above, below in pairwise(rows)) >= 2


def test_a_file_that_is_read_is_not_written_over(run: Run, tmp_path: Path) -> None:
    law = tmp_path / "law.toml"
    law.write_text(LAW, "utf-8")
    for place, said in ((law, "would be overwritten"), (tmp_path / "none" / "out.html", "no such directory"), (tmp_path, "a directory")):
        code, out, err = run("verify", str(law), "--report", str(place))
        assert code == 2 and out == "" and said in err
    code, _, err = run("verify", str(law), "--report", str(tmp_path / "a"), "--certificate", str(tmp_path / "a"))
    assert code == 2 and "two results have the same file" in err
    assert law.read_text("utf-8") == LAW and [*tmp_path.iterdir()] == [law]


@pytest.mark.long
def test_another_process_writes_the_same_bytes_but_for_times(hostile: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(hostile.parent)
    law = "<b>&law.toml"
    page = as_page([article(duhem.verify(law), again(law, [], None, "normal"), law_lines(law))])
    without_times = [re.sub(r">\d+\.\d\d s<", "><", text) for text in (page, hostile.read_text("utf-8"))]
    assert without_times[0] == without_times[1] != page


@pytest.mark.slow
def test_a_refuted_claim_shows_its_witness_and_without_matplotlib_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pictures, "usual", lambda law, pressure: ())
    found = duhem.verify("limacon", {"e": "3/5"}, claims=["convexity"])
    drawn, decided = report._pictures(found), decided_chapters(found)
    page = as_page([Article("limacon", "", (drawn, *decided))])
    assert "The counterexample for convexity; limacon with mu = 1, e = 0.6" in page
    seen = Strict()
    seen.feed(page)
    assert any(said.startswith("midpoint: sigma_a") for said in seen.said) and "refuted" in seen.said and "svg" in seen.tags
    monkeypatch.setitem(sys.modules, "matplotlib.style", None)
    bare = as_page([Article("limacon", "", (report._pictures(found), *decided))])
    assert "matplotlib is not installed; install it with: pip install" in bare and "<figure" not in bare


def test_without_the_extras_the_page_stands_and_one_line_says_what_to_install(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in [*sys.modules, "matplotlib", "contourpy", "latex2mathml"]:
        if name.partition(".")[0] in ("matplotlib", "contourpy", "latex2mathml"):
            monkeypatch.setitem(sys.modules, name, None)
    page = tmp_path / "z.html"
    code, out, err = run("verify", "coulomb", "--claims", "origin", "--report", str(page))
    assert code == 0 and "origin" in out
    assert err == (
        f"duhem: wrote the page to {page}\n"
        f"duhem: {page} is incomplete: it has no pictures and no typeset formulas: "
        "matplotlib is not installed, latex2mathml is not installed; "
        'install it with: pip install "duhem[report]"\n'
    )
    seen = read(page)
    assert "mu: pure numbers" in seen.said
    assert any("matplotlib is not installed; install it" in said for said in seen.said)
    assert any("latex2mathml is not installed; install it" in said for said in seen.said)
    assert not {"svg", "math"} & set(seen.tags) and "Derivation" in seen.said


@pytest.mark.slow
def test_the_law_on_the_page_is_the_law_that_was_verified(tmp_path: Path) -> None:
    for law in ("antoni2007", "limacon"):
        file = tmp_path / f"{law}.toml"
        file.write_text(law_lines(law), "utf-8")
        assert duhem.load(file).g == duhem.load(law).g and duhem.load(file).parameters == duhem.load(law).parameters
    assert "[atlas]" in law_lines("plesha") and law_lines(str(file)) == file.read_text("utf-8")
