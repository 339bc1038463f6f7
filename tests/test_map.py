"""The map is true: rows and arrows of ARCHITECTURE.md are the contract and the imports; every place a document names exists."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest

from tests.structure import HERE as PACKAGE

ROOT = Path(__file__).parents[1]
ARCHITECTURE = (ROOT / "ARCHITECTURE.md").read_text("utf-8")
CONTRIBUTING = (ROOT / "CONTRIBUTING.md").read_text("utf-8")


def rows(text: str, title: str) -> list[list[str]]:
    """The names in the first column of the first table under a title, row by row."""
    section = text.split(f"\n## {title}\n")[1].split("\n## ")[0]
    cells = re.findall(r"^\| (.*?) \|", section, flags=re.M)
    return [re.findall(r"`(\w+)`", cell) for cell in cells[1:] if not cell.startswith("---")]


def arrows() -> set[tuple[str, str]]:
    """(from, to) of every arrow in the picture."""
    (picture,) = re.findall(r"^```mermaid\n(.*?)^```$", ARCHITECTURE, flags=re.M | re.S)
    found = set()
    for line in picture.splitlines()[1:]:
        ends = [re.findall(r"\w+", side) for side in line.split("-->")]
        assert len(ends) == 2, line
        found |= {(a, b) for a in ends[0] for b in ends[1]}
    return found


def contract(container: str) -> list[list[str]]:
    said = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["tool"]["importlinter"]["contracts"]
    layers = next(c["layers"] for c in said if c.get("containers") == [container])
    return [sorted(room.strip(" ()") for room in row.split("|")) for row in layers]


@pytest.mark.parametrize(
    ("title", "container"), [("Rooms", "duhem"), *((f"Inside `{room}`", f"duhem.{room}") for room in ("proof", "testing"))]
)
def test_the_rows_are_those_of_the_contract(title: str, container: str) -> None:
    assert [sorted(row) for row in rows(ARCHITECTURE, title)] == contract(container)


@pytest.mark.slow
def test_the_arrows_are_the_imports_between_rooms() -> None:
    """All but those that the text leaves out: of `show`, `expression` and the row below, and those of `cli`."""
    ground = {room for row in PACKAGE.contract()[-2:] for room in row}
    imports = PACKAGE.room_imports()
    met = {(below, room) for room, found in imports.items() for below in found if below not in ground}
    assert arrows() == {(below, room) for below, room in met if room not in ("cli", "__main__")}
    assert {room for arrow in arrows() for room in arrow} == set(PACKAGE.rooms()) - ground - {"cli"}


PLACE = r"`([\w./]*/[\w.]*\w)`"


@pytest.mark.parametrize("text", [ARCHITECTURE, CONTRIBUTING], ids=["architecture", "contributing"])
def test_every_place_named_exists(text: str) -> None:
    named = re.findall(PLACE, text)
    assert named
    assert [name for name in named if not any((folder / name).exists() for folder in (ROOT, ROOT / "src" / "duhem"))] == []


def test_every_dotted_name_exists() -> None:
    """`room.module`, `module.name`: what stands before the dot is a folder or file, and has what stands after it."""
    folder = ROOT / "src" / "duhem"
    named = [tuple(name.split(".")) for name in re.findall(r"`([a-z_]+(?:\.\w+)+)`", ARCHITECTURE)]
    ours = [(holder, name) for *_, holder, name in named if holder != "duhem" and [*folder.rglob(holder), *folder.rglob(f"{holder}.py")]]
    assert len(ours) >= 10
    for holder, name in ours:
        within = any((room / f"{name}.py").exists() or (room / name).is_dir() for room in folder.rglob(holder))
        texts = (file.read_text("utf-8") for file in folder.rglob(f"{holder}.py"))
        assert within or any(re.search(rf"^(?:def|class) {name}\b|^{name}\b.*=", text, re.M) for text in texts), f"{holder}.{name}"


def test_every_table_named_is_in_the_file_named_with_it() -> None:
    """`TABLE` … `file`: a row of the page names a table before or after the file that holds it."""
    page = CONTRIBUTING.split("## Where do I change what")[1].split("\n## ")[0]
    lines = [line for line in page.splitlines() if line.startswith("| ")][2:]
    assert len(lines) >= 10
    for line in lines:
        files = [path for name in re.findall(PLACE, line) for path in (ROOT / "src" / "duhem" / name, ROOT / name) if path.is_file()]
        text = "".join(path.read_text("utf-8") for path in files)
        assert [table for table in re.findall(r"`(_?[A-Z]{4,}[A-Z_]*)`", line) if not re.search(rf"\b{table}\b", text)] == [], line


def test_each_campaign_runs_as_its_docstring_says() -> None:
    """A file that has a main part says how to start it, by its place."""
    scripts = [path for path in (ROOT / "tests").rglob("*.py") if '\nif __name__ == "__main__":' in path.read_text("utf-8")]
    assert len(scripts) >= 5
    for path in scripts:
        module = ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__main__")
        assert f"python -m {module}" in path.read_text("utf-8").split('"""')[1], path
