"""What stands where in the package, counted from its source alone: nothing of it is imported.

    python -m tests.structure [ROOT]

prints every count of the checkout at ROOT (this one, if left out).  What syntax cannot tell is counted by a stand-in,
which the printed line names: a table printer is a module that pads cells to a width it has computed, a recorder is a function
that appends steps to a program.
"""

from __future__ import annotations

import ast
import sys
import tomllib
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

__all__ = ["HERE", "ROOT", "Module", "Package", "circles"]

ROOT = Path(__file__).parents[1]
PACKAGE = "duhem"


@dataclass(frozen=True)
class Module:
    """One file: its dotted name without the package's own, and its text."""

    name: str
    path: Path

    @cached_property
    def text(self) -> str:
        return self.path.read_text("utf-8")

    @cached_property
    def tree(self) -> ast.Module:
        return ast.parse(self.text)

    @property
    def room(self) -> str:
        """The package or module at the top that holds it."""
        return self.name.partition(".")[0]

    @cached_property
    def _by_kind(self) -> Mapping[type[ast.AST], list[ast.AST]]:
        found: dict[type[ast.AST], list[ast.AST]] = defaultdict(list)
        for node in ast.walk(self.tree):
            found[type(node)].append(node)
        return found

    def nodes(self, *kinds: type[ast.AST]) -> Iterator[ast.AST]:
        return (node for kind in kinds for node in self._by_kind.get(kind, ()))

    def calls(self, *names: str) -> list[ast.Call]:
        """Calls of a function or method with one of these names."""
        return [call for call in self.nodes(ast.Call) if isinstance(call, ast.Call) and _last(call.func) in names]

    def classes(self) -> list[str]:
        return [node.name for node in self.tree.body if isinstance(node, ast.ClassDef)]

    def packages(self) -> set[str]:
        """The packages of others that it imports anywhere, by the first word of their name."""
        found = {alias.name for node in self.nodes(ast.Import) for alias in node.names}  # type: ignore[attr-defined]
        found |= {node.module for node in self.nodes(ast.ImportFrom) if node.module}  # type: ignore[attr-defined]
        return {name.partition(".")[0] for name in found}

    def code_lines(self) -> int:
        """Lines that hold more than a comment, a docstring or nothing."""
        held = {n for n, line in enumerate(self.text.splitlines(), 1) if (code := line.strip()) and not code.startswith("#")}
        for text in self.nodes(ast.Constant, ast.JoinedStr):  # over several lines it may look like comments, or have empty ones
            held |= set(range(text.lineno, text.end_lineno + 1))  # type: ignore[attr-defined]
        return len(held - self._docstring_lines())

    def _docstring_lines(self) -> set[int]:
        lines: set[int] = set()
        for node in self.nodes(ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef):
            first = node.body[0] if node.body else None  # type: ignore[attr-defined]
            if isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant) and isinstance(first.value.value, str):
                lines |= set(range(first.lineno, (first.end_lineno or first.lineno) + 1))
        return lines


def _last(node: ast.AST) -> str:
    """The last word of a dotted name."""
    return node.attr if isinstance(node, ast.Attribute) else node.id if isinstance(node, ast.Name) else ""


class Package:
    """All modules of the checkout at ``root``."""

    def __init__(self, root: Path = ROOT) -> None:
        self.root = root
        source = root / "src" / PACKAGE
        self.modules: dict[str, Module] = {}
        for path in sorted(source.rglob("*.py")):
            parts = [*path.relative_to(source).with_suffix("").parts]
            name = ".".join(parts[:-1] if parts[-1] == "__init__" else parts)
            self.modules[name] = Module(name, path)

    # -- rooms and imports --------------------------------------------------------------------------------------------

    def rooms(self) -> list[str]:
        """The packages at the top, each a room."""
        return [name for name, module in self.modules.items() if name and "." not in name and module.path.name == "__init__.py"]

    def single_modules(self) -> list[str]:
        """The modules that stand at the top without a room."""
        return [name for name, module in self.modules.items() if name and "." not in name and module.path.name != "__init__.py"]

    def contract(self) -> list[list[str]]:
        """The rows of the layers contract of the whole package, top first, each with its rooms."""
        said = tomllib.loads((self.root / "pyproject.toml").read_text("utf-8"))["tool"]["importlinter"]["contracts"]
        rows = next(c["layers"] for c in said if c["type"] == "layers" and c.get("containers") == [PACKAGE])
        return [[room.strip(" ()") for room in row.split("|")] for row in rows]

    def imports(self) -> dict[str, set[str]]:
        """Module -> the modules it imports, at the top, inside functions, or for the type checker alone."""
        edges: dict[str, set[str]] = defaultdict(set)
        for name, module in self.modules.items():
            for node in module.nodes(ast.Import, ast.ImportFrom):
                if isinstance(node, ast.ImportFrom):
                    assert node.level == 0, f"{name} imports relatively"
                    asked = [f"{node.module}.{alias.name}" for alias in node.names]
                else:
                    asked = [alias.name for alias in node.names]  # type: ignore[attr-defined]
                edges[name] |= {self._known(a) for a in asked if a.partition(".")[0] == PACKAGE}
            edges[name].discard(name)
        return edges

    def _known(self, asked: str) -> str:
        """The module that a dotted name is, or is in."""
        name = asked.partition(".")[2]
        while name and name not in self.modules:
            name = name.rpartition(".")[0]
        return name

    def room_imports(self) -> dict[str, set[str]]:
        """Room -> the rooms it imports; what the package shows of them at its front door is left out."""
        rooms: dict[str, set[str]] = defaultdict(set)
        for name, met in self.imports().items():
            if name:
                rooms[self.modules[name].room] |= {self.modules[m].room for m in met if m} - {self.modules[name].room}
        return rooms

    # -- one word, one thing ------------------------------------------------------------------------------------------

    def homonyms(self) -> dict[str, list[str]]:
        """Names of classes for everybody that stand in more than one module, with the modules."""
        where: dict[str, list[str]] = defaultdict(list)
        for name, module in self.modules.items():
            for word in module.classes():
                if not word.startswith("_"):
                    where[word].append(name)
        return {word: places for word, places in sorted(where.items()) if len(places) > 1}

    # -- what is written once -----------------------------------------------------------------------------------------

    def calling(self, *names: str) -> list[str]:
        return [name for name, module in self.modules.items() if module.calls(*names)]

    def importing(self, package: str) -> list[str]:
        return [name for name, module in self.modules.items() if package in module.packages()]

    def table_printers(self) -> list[str]:
        """Modules that pad text to a width which is no constant: by ljust, rjust or center, or in a format."""
        return [name for name, module in self.modules.items() if any(_pads(node) for node in module.nodes(ast.Call, ast.FormattedValue))]

    def recorders(self) -> list[str]:
        """Modules that append a step, a tuple, to a list of steps."""
        return [name for name, module in self.modules.items() if any(_records(call) for call in module.calls("append"))]

    def composed_imports(self) -> list[str]:
        """Modules that import a module of the package by a name put together at run time."""
        return [
            name
            for name, module in self.modules.items()
            if any(call.args and isinstance(call.args[0], ast.JoinedStr) for call in module.calls("import_module"))
        ]

    def line_widths(self) -> list[str]:
        """Modules with a line width of their own: a constant whose name ends in WIDTH, in columns."""
        return [
            name
            for name, module in self.modules.items()
            for node in module.tree.body
            if isinstance(node, ast.Assign)
            and any(_last(target).endswith("WIDTH") for target in node.targets)
            and isinstance(node.value, ast.Constant)
            and isinstance(node.value.value, int)
        ]

    def sizes(self) -> dict[str, int]:
        """Code lines of every module, the longest first."""
        return dict(sorted(((name, module.code_lines()) for name, module in self.modules.items()), key=lambda entry: -entry[1]))


HERE = Package()  # read once, for all tests that count in it


def _pads(node: ast.AST) -> bool:
    if isinstance(node, ast.FormattedValue):
        parts = node.format_spec.values if isinstance(node.format_spec, ast.JoinedStr) else []
        dots = [isinstance(part, ast.Constant) and str(part.value).endswith(".") for part in parts]  # then digits follow, no width
        return any(isinstance(part, ast.FormattedValue) and not dot for part, dot in zip(parts, [False, *dots], strict=False))
    assert isinstance(node, ast.Call)
    return _last(node.func) in ("ljust", "rjust", "center") and len(node.args) == 1 and not isinstance(node.args[0], ast.Constant)


def _records(call: ast.Call) -> bool:
    target = call.func
    appended = bool(call.args) and isinstance(call.args[0], ast.Tuple)
    return appended and isinstance(target, ast.Attribute) and _last(target.value).lstrip("_") == "steps"


def _longest(edges: Mapping[str, set[str]]) -> int:
    """How many modules stand in the longest chain in which each imports the next; there are no circles."""
    known: dict[str, int] = {}

    def length(name: str) -> int:
        if name not in known:
            known[name] = 1 + max((length(other) for other in edges.get(name, ())), default=0)
        return known[name]

    return max(map(length, edges), default=0)


def circles(edges: Mapping[str, set[str]]) -> list[list[str]]:
    """Modules that import each other round about: the strongly connected components of more than one (Tarjan 1972)."""
    number: dict[str, int] = {}
    lowest: dict[str, int] = {}
    path: list[str] = []
    found: list[list[str]] = []

    def visit(node: str) -> None:
        number[node] = lowest[node] = len(number)
        path.append(node)
        for met in edges.get(node, ()):
            if met not in number:
                visit(met)
            if met in path:
                lowest[node] = min(lowest[node], lowest[met])
        if lowest[node] == number[node]:
            at = path.index(node)
            if len(path) - at > 1:
                found.append(sorted(path[at:]))
            del path[at:]

    for node in sorted(edges):
        if node not in number:
            visit(node)
    return sorted(found)


def report(package: Package) -> Iterator[str]:
    """A line a count, with the places where there are few enough to read."""

    def line(count: int, what: str, places: object = "") -> str:
        return f"{count:6}  {what}" + (f": {places}" if places else "")

    def places(names: list[str]) -> str:
        return ", ".join(name or PACKAGE for name in names)

    rooms, singles, sizes = package.rooms(), package.single_modules(), package.sizes()
    yield line(len(rooms), "rooms at the top", places(rooms))
    yield line(len(singles), "single modules beside them", places(singles))
    yield line(len(package.contract()), "rows of the import contract")
    round_about = circles(package.imports())
    shown = "; ".join(" <-> ".join(name or PACKAGE for name in circle) for circle in round_about)
    yield line(len(round_about), "circles of imports between modules, lazy and type-only ones too", shown)
    twice = package.homonyms()
    yield line(len(twice), "public class names used more than once", "; ".join(f"{w} ({places(p)})" for w, p in twice.items()))
    files = Counter(module.path.name for module in package.modules.values() if module.path.name != "__init__.py")
    repeated = {name: n for name, n in sorted(files.items()) if n > 1}
    yield line(len(repeated), "file names used more than once", places([f"{name} x{n}" for name, n in repeated.items()]))
    for what, found in (
        ("table printers (modules that pad cells to a computed width)", package.table_printers()),
        ("modules that wrap prose (textwrap)", package.importing("textwrap")),
        ("line widths (constants named WIDTH)", package.line_widths()),
        ("figure savers (modules that call savefig)", package.calling("savefig")),
        ("modules that import matplotlib", package.importing("matplotlib")),
        (
            "TOML readers (modules that call tomllib)",
            [n for n in package.importing("tomllib") if package.modules[n].calls("loads", "load")],
        ),
        ("z3 translations (modules that call z3.RealVal)", package.calling("RealVal")),
        ("program recorders (modules that append steps)", package.recorders()),
        ("modules that import one of a composed name", package.composed_imports()),
    ):
        yield line(len(found), what, places(found))
    edges = package.imports()
    users = Counter(name for met in edges.values() for name in met)
    yield line(sum(count == 1 for count in users.values()), "modules that one other imports")
    yield line(_longest(edges), "modules in the longest chain of imports")
    lines = list(sizes.values())
    yield line(len(sizes), "modules")
    yield line(sum(lines), "code lines (no blank lines, comments, docstrings)")
    yield line(sorted(lines)[len(lines) // 2], "code lines of the median module")
    yield line(lines[0], "code lines of the longest; the ten longest", places([f"{n} {k}" for n, k in list(sizes.items())[:10]]))


if __name__ == "__main__":
    print("\n".join(report(Package(Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT))))
