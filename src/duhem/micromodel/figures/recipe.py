"""How a figure is made: a function of named numbers, each with a default."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from difflib import get_close_matches

from duhem.errors import InputError
from duhem.micromodel.figures.value import Figure, Table

__all__ = ["Recipe", "unknown"]


@dataclass(frozen=True)
class Recipe:
    """The figure ``name``; its parameters and their defaults are those of ``function``; ``drawn`` unless it is a table."""

    name: str
    title: str
    function: Callable[..., Figure | Table]
    drawn: bool = True

    @property
    def parameters(self) -> Mapping[str, float]:
        """Name and default of each parameter, in order."""
        return {name: float(p.default) for name, p in inspect.signature(self.function).parameters.items()}

    def __call__(self, **settings: float) -> Figure | Table:
        """The figure, computed from its defaults and ``settings``.  InputError for an unknown name or what is no finite number."""
        known = self.parameters
        for name, value in settings.items():
            if name not in known:
                raise unknown(f"parameter of figure {self.name}", name, known)
            if not math.isfinite(value):
                raise InputError(f"{name} is {value}", where=f"figure {self.name}", remedy="give a finite number")
        return self.function(**{**known, **settings})


def unknown(what: str, name: str, known: Mapping[str, object]) -> InputError:
    """The error for a name that is not among ``known``, with the nearest of them."""
    near = get_close_matches(name[:40], list(known), n=1)
    hint = f"did you mean {near[0]}? " if near else ""
    return InputError(f"unknown {what} {name[:60]!r}", remedy=f"{hint}there are: {', '.join(known)}")
