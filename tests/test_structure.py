"""The house stands straight: few rooms and rows, no circle, one word for one thing, and what is one idea is written once."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

from tests.structure import HERE as PACKAGE
from tests.structure import ROOT, Package, circles


def test_few_rooms_and_few_rows() -> None:
    assert len(PACKAGE.rooms()) <= 17
    assert len(PACKAGE.contract()) <= 8
    assert {room for row in PACKAGE.contract() for room in row} == {*PACKAGE.rooms(), *PACKAGE.single_modules()}
    assert set(PACKAGE.single_modules()) <= {"__main__", *PACKAGE.contract()[-1]}  # without a room only what stands below all


@pytest.mark.slow
def test_no_module_is_long() -> None:
    assert {name: size for name, size in PACKAGE.sizes().items() if size > 800} == {}


@pytest.mark.slow
def test_no_circles() -> None:
    assert circles(PACKAGE.imports()) == []


@pytest.mark.slow
def test_a_class_for_everybody_has_a_name_of_its_own() -> None:
    assert PACKAGE.homonyms() == {}


@pytest.mark.slow
def test_tables_are_printed_and_figures_saved_in_one_place() -> None:
    assert PACKAGE.calling("savefig") == ["show.figure"]
    assert PACKAGE.line_widths() == ["show.page"]
    assert PACKAGE.table_printers() == ["show.page"]


@pytest.mark.slow
def test_formulas_and_files_are_read_in_one_place() -> None:
    assert [name for name in PACKAGE.importing("tomllib") if PACKAGE.modules[name].calls("load", "loads")] == ["law.placed_toml"]
    assert PACKAGE.calling("RealVal") == ["expression.smt"]
    assert PACKAGE.recorders() == ["expression.fold", "proof.kernel.curve"]  # the kernel shares nothing with anybody
    assert PACKAGE.composed_imports() == [""]  # the front door imports a public name when it is asked for


# -- tests mirror the rooms ---------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("room", PACKAGE.rooms())
def test_every_room_has_tests_and_quick_ones_among_them(room: str) -> None:
    found = [
        [ast.unparse(mark) for mark in node.decorator_list]
        for path in (ROOT / "tests" / room).glob("test_*.py")
        if not re.search(r"^pytestmark = .*slow", text := path.read_text("utf-8"), flags=re.M)
        for node in ast.parse(text).body
        if isinstance(node, ast.FunctionDef) and node.name.startswith("test_")
    ]
    assert len([marks for marks in found if not any("pytest.mark.slow" in mark for mark in marks)]) >= 3


# -- the counts themselves, on a house that is crooked in every way ----------------------------------------------------

CROOKED = {
    "__init__.py": "",
    "a/__init__.py": "",
    "a/one.py": '''\
        """A docstring, that is no code."""
        from typing import TYPE_CHECKING

        # a comment
        if TYPE_CHECKING:
            from duhem.b.two import Shape

        class Line:
            """Another."""
            size = """not a
            docstring"""
        class _Own: ...
        def said(x: "Shape", width):
            return f"{x:<{width}}" + x.ljust(width)
        ''',
    "b/__init__.py": "",
    "b/two.py": """\
        def late():
            from duhem.a import one
            import duhem.b.three
        class Line: ...
        class _Own: ...
        def root(low, high):
            while high - low > 1e-9:
                middle = low + 0.5 * (high - low)
        """,
    "b/three.py": """\
        from importlib import import_module
        import tomllib, z3, mpmath
        def save(figure, name, steps):
            figure.savefig(name)
            tomllib.loads(name)
            z3.RealVal(1)
            steps.append((name, ()))
            import_module(f"duhem.{name}")
            low, high = 0, 1
            for _ in range(9):
                def inner(): return (low + high) / 2
        WIDTH = 96
        PADDED = "x".ljust(9) + f"{WIDTH:>9}" + f"{WIDTH:.{WIDTH}g}"
        HALF = (WIDTH + WIDTH) / 2
        """,
}


@pytest.fixture
def crooked(tmp_path: Path) -> Package:
    for name, text in CROOKED.items():
        path = tmp_path / "src" / "duhem" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("\n".join(line[8:] for line in text.splitlines()) + "\n", "utf-8")
    layers = '[[tool.importlinter.contracts]]\ntype = "layers"\ncontainers = ["duhem"]\nlayers = ["(a)", "b | c"]\n'
    (tmp_path / "pyproject.toml").write_text(layers, "utf-8")
    return Package(tmp_path)


def test_every_count_sees_what_is_crooked(crooked: Package) -> None:
    assert (crooked.rooms(), crooked.single_modules(), crooked.contract()) == (["a", "b"], [], [["a"], ["b", "c"]])
    assert circles(crooked.imports()) == [["a.one", "b.two"]]  # one import is lazy, the other for the type checker alone
    assert crooked.room_imports() == {"a": {"b"}, "b": {"a"}}
    assert crooked.homonyms() == {"Line": ["a.one", "b.two"]}
    assert crooked.table_printers() == ["a.one"]
    assert crooked.line_widths() == crooked.calling("savefig") == crooked.importing("tomllib") == ["b.three"]
    assert crooked.calling("RealVal") == crooked.recorders() == crooked.composed_imports() == ["b.three"]
    assert crooked.sizes() == {"b.three": 14, "a.one": 9, "b.two": 8, "": 0, "a": 0, "b": 0}


def test_circles() -> None:
    assert circles({"a": {"b"}, "b": {"c"}, "c": set()}) == []
    assert circles({"a": {"b"}, "b": {"c"}, "c": {"a", "d"}, "d": {"e"}, "e": {"d"}, "f": {"a"}}) == [["a", "b", "c"], ["d", "e"]]
