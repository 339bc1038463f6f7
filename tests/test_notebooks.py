"""Every notebook of the course has the parts a student needs, runs from top to bottom, asserts what it says and shows what is kept."""

import ast
import importlib
import re
from pathlib import Path

import nbformat
import pytest
from nbformat.v4 import new_code_cell, new_notebook, new_output

from tests.course import NOTEBOOKS, ROOT, departures, executed, main, pictures, texts
from tests.long import mostly_long

SHORTEST = ROOT / "notebooks" / "01_coulombs_cone.ipynb"
PLACES = re.compile(r"(?:^|[\s\"'(=])/(?:home|mnt|opt|root|srv|tmp|usr|var|work|Users)/\S*", flags=re.M)


def test_the_contents_name_every_part() -> None:
    listed = re.findall(r"\]\((.+?\.ipynb)\)", (ROOT / "notebooks" / "README.md").read_text("utf-8"))
    assert listed == [path.name for path in NOTEBOOKS]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_its_links_lead_to_parts_that_are_there(path: Path) -> None:
    led_to = {link for cell in nbformat.read(path, as_version=4).cells for link in re.findall(r"\]\(([^):]+)\)", cell.source)}
    assert not [link for link in led_to if link.endswith(".ipynb") and not (path.parent / link).is_file()]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_what_it_imports_of_the_project_is_there(path: Path) -> None:
    """Runs of whole parts are long, and a module that moved is seen without them."""
    cells = (cell for cell in nbformat.read(path, as_version=4).cells if cell.cell_type == "code")
    trees = (ast.parse(re.sub(r"^\s*[%!].*$", "", cell.source, flags=re.M)) for cell in cells)
    taken = [
        node for tree in trees for node in ast.walk(tree) if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("duhem")
    ]
    assert not [
        (node.module, x.name) for node in taken for x in node.names if not hasattr(importlib.import_module(str(node.module)), x.name)
    ]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_kept_with_light_outputs_that_name_no_place_of_a_machine(path: Path) -> None:
    book = nbformat.read(path, as_version=4)
    nbformat.validate(book)
    code = [cell for cell in book.cells if cell.cell_type == "code"]
    assert any(cell.outputs for cell in code), "kept without outputs: python -m tests.course --write"
    assert not [cell.source for cell in code if cell.execution_count]
    assert not [text for cell in code for text in texts(cell) if PLACES.search(text) or text.startswith("stderr")]
    assert not [cell.source for cell in book.cells if PLACES.search(cell.source)]
    assert max(map(len, pictures(book))) < 60_000
    assert path.stat().st_size < 300_000


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_has_what_a_student_needs(path: Path) -> None:
    book = nbformat.read(path, as_version=4)
    first = book.cells[0].source
    assert re.match(r"# .+", first)
    for part in ("**Goals**", "**Prerequisites**", "**Duration**"):
        assert part in first
    headings = [line for cell in book.cells if cell.cell_type == "markdown" for line in cell.source.splitlines() if line.startswith("## ")]
    places = [headings.index(f"## {part}") for part in ("Exercises", "Solutions", "Read more")]
    assert places == sorted(places)
    starts = next(i for i, cell in enumerate(book.cells) if "## Solutions" in cell.source)
    assert sum("assert " in cell.source for cell in book.cells[starts:] if cell.cell_type == "code") >= 2


@pytest.mark.parametrize(
    ("kept", "now", "told"),
    [
        ("proved  0.25 at e = 1/2", "proved 0.25 at e = 1/2", False),
        ("convexity  proved  0.01 s", "convexity  proved  12.34 s", False),
        ("off by 1.2e-16", "off by 0.0e+00", False),
        ("0.25000001", "0.25", False),
        ("0.2501", "0.25", True),
        ("proved", "refuted", True),
        ("0.25", "-0.25", True),
        ("0.25", "0.25 0.25", True),
        ("0.25", "", True),
    ],
)
def test_what_is_shown_otherwise_than_kept_is_told(kept: str, now: str, told: bool) -> None:
    def book(text: str, **metadata: list[str]) -> nbformat.NotebookNode:
        outputs = [new_output("stream", name="stdout", text=text)] if text else []
        return new_notebook(cells=[new_code_cell("print(x)", outputs=outputs, metadata=metadata)])

    assert bool(departures(book(kept), book(now))) == told
    assert not departures(book(kept, tags=["varies"]), book(now))


def test_the_command_writes_only_where_it_is_asked_to(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def book(text: str) -> nbformat.NotebookNode:
        return new_notebook(cells=[new_code_cell("print(x)", id="one", outputs=[new_output("stream", name="stdout", text=text)])])

    file = tmp_path / "part.ipynb"
    nbformat.write(book("proved"), file)
    kept = file.read_bytes()
    for shown, code, said in (("proved", 0, "shows what is kept"), ("refuted", 1, "--- now\nrefuted")):
        monkeypatch.setattr("tests.course.executed", lambda path, shown=shown: book(shown))
        assert main([str(file)]) == code and said in capsys.readouterr().out and file.read_bytes() == kept
    assert main(["--write", str(file)]) == 0 and capsys.readouterr().out == f"wrote {file}\n"
    assert nbformat.read(file, as_version=4).cells[0].outputs[0].text == "refuted"


@pytest.mark.slow(6)
@pytest.mark.parametrize("path", mostly_long(NOTEBOOKS, SHORTEST), ids=lambda path: path.stem)
def test_runs_asserts_and_shows_what_is_kept(path: Path) -> None:
    assert not departures(nbformat.read(path, as_version=4), executed(path))
