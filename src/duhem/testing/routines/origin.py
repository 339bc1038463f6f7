"""Where a routine and a law come from: the Python by which another file has them again, where they have names it can import."""

from __future__ import annotations

import sys
import sysconfig
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from duhem.errors import InputError
from duhem.expression.text import formula
from duhem.law.catalogue import file_read, installed, load, load_named, shipped
from duhem.law.domain import Domain
from duhem.law.formula_law import Criterion
from duhem.law.registry import registered

__all__ = ["Origin", "law_as_written", "made_by", "named", "origin"]


@dataclass(frozen=True)
class Origin:
    """Where a replay finds what it tests: lines of Python that bind ``update``, the folder they need on the path, and the law.

    ``making`` is empty where the routine has no name that a file can import, ``law`` where the law has none.
    """

    making: str = ""
    folder: str = ""
    law: str = ""


def origin(update: Any, law: Criterion | None, given: Any) -> Origin:
    """That of a routine and of the law it was tested with, as it was ``given``."""
    return Origin(made_by(update), _folder(_defined(update)), "None" if law is None else law_as_written(law, given))


def made_by(update: Any) -> str:
    """Lines of Python that bind ``update`` to the routine: what it carries as ``__duhem_import__``, or an import by name, or ''."""
    said = getattr(update, "__duhem_import__", None)
    if said is not None:
        return str(said)
    module, name = getattr(_called(update), "__module__", None), getattr(update, "__qualname__", "")
    if not module or module == "__main__" or module not in sys.modules:
        return ""
    found: Any = sys.modules[module]
    for part in name.split("."):
        found = getattr(found, part, None)
    if name and found is update:
        first, _, rest = name.partition(".")
        return f"from {module} import {first}\n\nupdate = {name}" if rest else f"from {module} import {name} as update"
    bound = (name for name, value in vars(sys.modules[module]).items() if value is update and name.isidentifier())
    return next((f"from {module} import {name} as update" for name in bound), "")


def _called(update: Any) -> Any:
    """What a partial application calls; else the routine itself."""
    while isinstance(update, partial):
        update = update.func
    return update


def _defined(update: Any) -> Any:
    """The routine inside, where it is wrapped or partly applied."""
    while hasattr(inner := _called(update), "__wrapped__"):
        update = inner.__wrapped__
    return inner


def _folder(update: Any) -> str:
    """The folder that has to be on the path to import the routine's module; '' where the module is installed."""
    module = sys.modules.get(getattr(update, "__module__", None) or "")
    file = getattr(module, "__file__", None)
    if module is None or file is None or module.__name__ == "__main__":
        return ""
    top = Path(file).resolve().parents[module.__name__.count(".") + (Path(file).name == "__init__.py")]
    installed = {Path(sysconfig.get_path(name)).resolve() for name in ("purelib", "platlib", "stdlib")}
    return "" if top in installed else str(top)


def law_as_written(law: Criterion, given: Any = None) -> str:
    """Python for a law: its name or file, with the values it fixes, or its formula where that reads as the same law; else ''."""
    with suppress(InputError):
        if (known_by := _known_by(given)) is not None:
            return _fixed(known_by, load(known_by), law)
        if shipped(law.name) and installed(law.name) and _same(known := load_named(law.name), law):
            return _fixed(law.name, known, law)
    with suppress(InputError):
        said = law.written or formula(law.g)
        again = Criterion(name=law.name, g=said, forces=law.forces, pressure=law.pressure, parameters=law.parameters)
        if _same(again, law) and law.closed_form is None:
            domains = ", ".join(f"{name!r}: {_domain(domain)}" for name, domain in law.parameters.items())
            return f"Criterion({law.name!r}, {again.written!r}, {{{domains}}}, {law.forces!r}, {law.pressure!r})"
    return ""


def _known_by(given: Any) -> str | None:
    """What another process loads a law by: a name, ``module:attribute``, or the whole path of a file; None where there is no such thing."""
    if isinstance(given, Path):
        return str(given.resolve())
    if not isinstance(given, str):
        return None
    name = given.strip().replace("_", "-")
    if not given.endswith(".toml") and (installed(name) or name in registered()):
        return given if installed(name) else None  # else this process alone knows the name
    file = file_read(given)
    return given if file is None else str(file.resolve())


def _fixed(name: str, known: Any, law: Criterion) -> str:
    """The known law, with the parameters fixed that the other one fixes."""
    values = {n: str(d.value) for n, d in law.parameters.items() if d.value is not None and known.parameters[n].value is None}
    return f"load({name!r}).fix({values!r})" if values else repr(name)


def _domain(domain: Domain) -> str:
    if domain.positive:
        return "Domain(positive=True)"  # a case lies below a greatest value
    return f"Domain.between({', '.join('None' if end is None else repr(str(end)) for end in (domain.low, domain.high))})"


def _same(known: Any, law: Criterion) -> bool:
    same = isinstance(known, Criterion) and (known.forces, known.pressure) == (law.forces, law.pressure)
    own, other = law.parameters, known.parameters
    same = same and all(getattr(known, part) == getattr(law, part) for part in ("variables", "unforced", "rates", "energy", "flow"))
    return same and str(known.g) == str(law.g) and {*own} == {*other} and all(other[n].value in (None, own[n].value) for n in own)


def named(update: Any) -> str:
    """Module and name of a routine, as it says itself; of the routine inside, where it is wrapped."""
    update = _defined(update)
    name = getattr(update, "__qualname__", type(update).__qualname__)
    return f"{getattr(update, '__module__', '')}.{name}"
