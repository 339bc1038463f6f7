"""Laws by name: a file of the folder ``builtin`` each, the atlas, what other distributions add, files, ``module:attribute``.

The names are read from the file system and from entry points; only the law that is asked for is imported.
Other distributions add laws by the entry point group ``duhem.criteria``.
"""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Mapping
from dataclasses import replace
from difflib import get_close_matches
from functools import cache, reduce
from importlib import import_module
from itertools import chain, takewhile
from os.path import exists
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

from duhem.errors import InputError
from duhem.law.atlas.entry import file_of, groups
from duhem.law.registry import registered

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

    from duhem.law.curve_law import Law, ParametricCriterion
    from duhem.law.formula_law import Criterion

__all__ = [
    "attribute", "description", "file_read", "installed", "load", "load_formula", "load_named", "names", "shipped", "summary", "template",
]  # fmt: skip

_BUILT_IN = Path(__file__).with_name("builtin")
_GROUP = "duhem.criteria"


def names() -> tuple[str, ...]:
    """Return the names of laws, sorted, without those of the atlas, which :mod:`duhem.law.atlas.entry` lists."""
    return tuple(sorted({*_built_in(), *_added(), *registered()}))


def shipped(name: str) -> bool:
    """Return whether duhem has a law of that name in every process, whatever was registered in this one."""
    return name in _built_in() or file_of(name) is not None


def installed(name: str) -> bool:
    """Return whether another process has the same law by that name: a law of duhem or of a distribution that no other one replaces."""
    if (known := registered().get(name)) is None:
        return shipped(name) or name in _added()
    own = _built_in().get(name)
    module = _module(own) if own else _added()[name].value.partition(":")[0] if name in _added() else ""
    return module in sys.modules and any(each is known for each in vars(sys.modules[module]).values())


@overload
def load(law: Criterion) -> Criterion: ...
@overload
def load(law: ParametricCriterion) -> ParametricCriterion: ...
@overload
def load(law: str | Path | Law) -> Any: ...  # a name decides between the kinds of law, which no type can say


def load(law: str | Path | Law) -> Law:
    """Return a law by its name, the path of its criterion file, or ``module:attribute``; a law itself is returned unchanged.

    Raises InputError for an unknown name or a file that cannot be used.
    """
    from duhem.law.curve_law import Law

    if isinstance(law, Law):
        return law
    if isinstance(law, Path):
        return _from_file(law)
    if not isinstance(law, str):
        raise InputError(f"{type(law).__name__} is no law", remedy="give a name, the path of a criterion file, or a Criterion")
    if not law.endswith(".toml") and (known := _of_name(law)) is not None:
        return known
    if law.endswith(".toml") or exists(law):
        return _from_file(law)
    if ":" in law:
        return _attribute(law, law)
    raise _unknown(law)


def file_read(law: str) -> Path | None:
    """Return the criterion file that :func:`load` reads for a path or a name of the atlas; None for any other law."""
    if not law.endswith(".toml") and _of_name(law) is not None:
        name = law.strip().replace("_", "-")
        return None if name in registered() else file_of(name)
    return Path(law) if law.endswith(".toml") or exists(law) else None


def load_named(name: str) -> Law:
    """Return the law of a name in a document; never import code or read a path for it.  Raise InputError for an unknown name."""
    if (known := _of_name(name)) is not None:
        return known
    if ":" in name:
        remedy = "write the name of a law, or a criterion file's"
        raise InputError(f"{name[:60]!r} would import code, which a file cannot do", remedy=remedy)
    raise _unknown(name)


def _of_name(given: str) -> Law | None:
    name = given.strip().replace("_", "-")
    if name in registered():
        return registered()[name]
    if (own := _built_in().get(name)) is not None:
        return _read_once(name, own)
    if (published := file_of(name)) is not None:
        return _from_file(published)
    if name in (points := _added()):
        return _attribute(points[name].value, name)
    return None


def _unknown(law: str) -> InputError:
    near = get_close_matches(law.strip().replace("_", "-"), (*names(), *chain.from_iterable(groups().values())), n=3, cutoff=0.5)
    remedy = f"did you mean {' or '.join(near)}?" if near else "duhem list and duhem atlas name the laws; files end in .toml"
    return InputError(f"unknown law {law[:60]!r}", remedy=remedy)


def load_formula(law: str | Path | Law) -> Criterion:
    """Return a law that has a formula g, as :func:`load` does; raise InputError where the law has no formula, or no K."""
    from duhem.law.formula_law import Criterion
    from duhem.law.state import check_has_k

    found = load(law)
    if isinstance(found, Criterion):
        check_has_k(found)
        return found
    other = f"such as {found.instead}" if found.instead else "such as antoni2007"
    raise InputError(f"{found.name} has no formula g, only a boundary curve", remedy=f"choose a law with a formula, {other}")


def summary(name: str) -> str:
    """Return one line about a law of :func:`names`; for a built-in law it is the first line of its file."""
    if (law := registered().get(name)) is not None:
        return law.summary
    if name in _built_in():
        return description(name).split("\n", 1)[0]
    point = _added().get(name)
    return f"from {point.dist.name}" if point and point.dist else ""


def description(name: str) -> str:
    """Return what the file of a built-in law says in words: formula, units, verdicts and source.  The file is not run.

    Raise InputError for a name that is not built in.
    """
    if (file := _built_in().get(name)) is None:
        raise _unknown(name)
    text = file.read_text("utf-8")
    if file.suffix == ".py":
        return ast.get_docstring(ast.parse(text)) or ""
    return "\n".join(line[1:].removeprefix(" ") for line in takewhile(lambda line: line.startswith("#"), text.splitlines()))


def template(name: str, kind: str = "law", of: str = __file__) -> str:
    """Return the text of a file to start from, with every key explained: it loads and verifies unchanged.

    The file stands beside the module ``of``.  Raise InputError for text that cannot name a ``kind``.
    """
    if not re.fullmatch(r"[A-Za-z0-9][\w.-]{0,60}", name):
        raise InputError(f"{name[:60]!r} cannot name a {kind}", remedy="use letters, digits, hyphens and underscores")
    return Path(of).with_name("template.toml").read_text("utf-8").replace("NAME", name)


def _built_in() -> Mapping[str, Path]:
    """Return the file of each law: a criterion file, or a Python module for a law that such a file cannot state."""
    found = (file for file in _BUILT_IN.iterdir() if file.suffix in (".toml", ".py") and not file.stem.startswith("_"))
    return {file.stem.replace("_", "-"): file for file in found}


def _module(file: Path) -> str:
    """Return the module of a law that is Python."""
    return f"duhem.law.builtin.{file.stem}"


@cache
def _read_once(name: str, file: Path) -> Law:
    if file.suffix == ".py":
        law: Law = getattr(import_module(_module(file)), file.stem)
        return law
    from duhem.law.formula_law import Criterion
    from duhem.law.shapes import BUILT_IN

    read, shape = _from_file(file), BUILT_IN.get(name)
    return replace(read, closed_form=shape) if shape and isinstance(read, Criterion) else read


def _added() -> Mapping[str, EntryPoint]:
    from importlib.metadata import entry_points  # takes long, and most laws are found before

    return {point.name.replace("_", "-"): point for point in entry_points(group=_GROUP)}


def _from_file(path: str | Path) -> Law:
    from duhem.law.criterion_file import read

    return read(path)


def _attribute(reference: str, shown: str) -> Law:
    """Return the law ``module:attribute``."""
    from duhem.law.curve_law import Law

    found = attribute(reference, shown)
    if not isinstance(found, Law):
        raise InputError(f"{shown[:60]} is a {type(found).__name__}, not a Criterion", remedy="decorate the function with @duhem.criterion")
    return found


def attribute(reference: str, shown: str) -> Any:
    """Return the object ``module:attribute``; this imports, and so runs, the module.  Raise InputError if there is no such object."""
    module, _, path = reference.partition(":")
    if not all(part.isidentifier() for part in (*module.split("."), *path.split("."))):
        raise InputError(f"{shown[:60]!r} is not of the form module:attribute", remedy="write for example mylaws:ellipse")
    try:
        return reduce(getattr, path.split("."), import_module(module))
    except (Exception, SystemExit) as fault:  # whatever the module does on import is the caller's, and so is its error
        reason = f"{type(fault).__name__}: {' '.join(str(fault).split())}"
        what = f"{shown[:60]} cannot be imported ({reason})"
        raise InputError(what, remedy="check its name and that its folder is on the path") from fault
