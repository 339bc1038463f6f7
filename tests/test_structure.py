"""The house stands straight: few rooms and rows, no circle, one word for one thing, and what is one idea is written once."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.structure import Package, circles

PACKAGE = Package()


def test_few_rooms_and_few_rows() -> None:
    assert len(PACKAGE.rooms()) <= 15
    assert set(PACKAGE.single_modules()) == {"__main__", "errors", "left_out", "version"}
    assert len(PACKAGE.contract()) <= 8
    assert {room for row in PACKAGE.contract() for room in row} == {*PACKAGE.rooms(), *PACKAGE.single_modules()}


def test_no_module_is_long() -> None:
    assert {name: size for name, size in PACKAGE.sizes().items() if size > 300} == {}


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
    assert crooked.homonyms(private=True) == {"_Own": ["a.one", "b.two"]}
    assert crooked.table_printers() == ["a.one"]
    assert crooked.line_widths() == crooked.calling("savefig") == crooked.importing("tomllib") == ["b.three"]
    assert crooked.calling("RealVal") == crooked.recorders() == crooked.composed_imports() == ["b.three"]
    assert crooked.halvings() == [("b.three", "save", "digits"), ("b.two", "root", "doubles")]
    assert crooked.sizes() == {"b.three": 14, "a.one": 9, "b.two": 8, "": 0, "a": 0, "b": 0}


def test_circles() -> None:
    assert circles({"a": {"b"}, "b": {"c"}, "c": set()}) == []
    assert circles({"a": {"b"}, "b": {"c"}, "c": {"a", "d"}, "d": {"e"}, "e": {"d"}, "f": {"a"}}) == [["a", "b", "c"], ["d", "e"]]
