"""A derivation as text, LaTeX and Markdown."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from duhem import POSITIVE, Criterion
from duhem.derivation.derive import derive
from duhem.law.atlas.entry import groups
from tests.derivation.derived import EVERY_RUN, LAWS, derived
from tests.long import mostly_long


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(LAWS, *EVERY_RUN))
def test_numbers_and_names_are_unique_and_what_is_missing_has_a_reason(name: str) -> None:
    d = derived(name)
    assert len({e.number for e in d}) == len({e.name for e in d}) == len(d)
    assert all(e.note and e.section for e in d)
    assert any("isothermal" in reason for _, reason in d.left_out)
    assert ("dissipation_potential" in d) != any(part == "dissipation potential" for part, _ in d.left_out)


def test_the_numbers_of_the_paper_are_there() -> None:
    wanted = {"21", "22", "23", "24", "25", "26", "28", "30", "31", "32", "33", "34", "35", "36"}
    assert wanted <= {e.number for e in derived("antoni2007")}


def test_a_notebook_shows_it_as_markdown_and_a_console_in_one_line() -> None:
    d = derived("coulomb")
    assert d._repr_markdown_() == d.markdown()
    assert repr(d) == f"<Derivation of coulomb: {len(d)} equations>"


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(LAWS, *EVERY_RUN))
def test_latex_is_balanced(name: str) -> None:
    source = derived(name).latex()
    opened: list[str] = []
    for kind, environment in re.findall(r"\\(begin|end)\{([a-z*]+)\}", source):
        if kind == "begin":
            opened.append(environment)
        else:
            assert opened.pop() == environment
    assert opened == []
    braces = re.sub(r"\\[{}]", "", source)
    assert braces.count("{") == braces.count("}")
    assert source.count(r"\left") == source.count(r"\right")
    assert source.count(r"\tag{") == len(derived(name))
    assert set(re.findall(r"\\usepackage\{(\w+)\}", source)) == {"amsmath"}


EVERY_LAW = (*LAWS, *(law for group in groups().values() for law in group), "wedge")


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("pdflatex") is None, reason="pdflatex is not installed")
@pytest.mark.parametrize("name", mostly_long(EVERY_LAW, "antoni2007", "tresca", "rotated-flow"))
def test_latex_compiles_and_fits_the_page(name: str, tmp_path: Path) -> None:
    (tmp_path / "derivation.tex").write_text(derived(name).latex(), encoding="utf-8")
    done = subprocess.run(["pdflatex", "-halt-on-error", "-interaction=nonstopmode", "derivation.tex"], cwd=tmp_path, capture_output=True)
    assert done.returncode == 0, done.stdout[-800:]
    log = (tmp_path / "derivation.log").read_text("utf-8", errors="replace")
    assert [float(pt) for pt in re.findall(r"Overfull \\[hv]box \(([\d.]+)pt", log) if float(pt) > 5] == []


def test_latex_writes_the_symbols_of_the_paper() -> None:
    source = derived("antoni2007").latex()
    assert r"\mu_{a}^{+}" in source and r"\left|\sigma_{n}\right|" in source and r"\dot u^{\mathrm{in}}_{a}" in source


def test_markdown_has_every_equation() -> None:
    d = derived("antoni2007")
    assert d.markdown().count("$$") == 2 * len(d)


def test_the_words_of_a_formula_are_those_of_its_file() -> None:
    """A sign stands as one, and what holds on the line alone, where it is 0, is no piece."""
    law = Criterion("signs", "sign(sigma_a)*sigma_a/mu + abs(sigma_b)*cosh(atan2(sigma_b, sigma_a)) - abs(sigma_n)", {"mu": POSITIVE})
    written = derive(law).text()
    assert "sign(sigma_a)" in written and "atan2(sigma_b, sigma_a)" in written
    assert "where(" not in written and "if sigma_a = 0" not in written
