"""A case: increments of one law at one set of parameters, and what the checks compare them with."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from duhem.law.formula_law import Criterion
from duhem.projection.result import Array

__all__ = ["Case", "vector"]


@dataclass(frozen=True, eq=False)
class Case:
    """N increments; a case of one prints as Python that builds it again to the last bit.

    ``parameters`` by name; ``stiffness`` (d, d) in Pa/m; ``pressure`` (N,), None for a law without; ``trial``, ``other`` and
    ``third`` (N, d) trial stresses under that pressure; ``inside`` and ``beside`` (N, d) stresses of K; ``stretch`` (N,) >= 0,
    a share of the way from stress to trial; ``factor`` > 0, a change of units; ``path`` (N, m, d) k u along a loading path
    and ``loads`` (N, m) its pressures.  Stresses in Pa.
    """

    parameters: Mapping[str, float]
    stiffness: Array
    pressure: Array | None
    trial: Array
    other: Array
    third: Array
    inside: Array
    beside: Array
    stretch: Array
    factor: float
    path: Array
    loads: Array | None

    def __post_init__(self) -> None:
        for field in fields(self)[1:]:
            value = getattr(self, field.name)
            if value is not None and field.name != "factor":
                object.__setattr__(self, field.name, np.asarray(value, dtype=np.float64))

    def __len__(self) -> int:
        return len(self.trial)

    def row(self, i: int) -> Case:
        """Return the case of one increment alone."""
        return self.rows(slice(i, i + 1))

    def rows(self, which: slice | NDArray[np.intp]) -> Case:
        """Return the case of some of the increments."""
        whole = ("parameters", "stiffness", "factor")
        parts = {f.name: getattr(self, f.name) for f in fields(self) if f.name not in whole}
        rows: dict[str, Any] = {name: None if part is None else part[which] for name, part in parts.items()}
        return replace(self, **rows)

    def longest(self, inverse: Array) -> Array:
        """The length |L^-1 s| of the longest stress of each increment (N,), ``inverse`` that of L; inf where its square overflows."""
        stresses = np.stack([self.trial, self.other, self.third, self.inside, self.beside], axis=1)
        with np.errstate(all="ignore"):
            return np.asarray(np.linalg.norm(np.concatenate([stresses, self.path], axis=1) @ inverse.T, axis=2).max(axis=1))

    def fits(self, law: Criterion) -> bool:
        """Whether its parameters, forces and pressure are those of a law, and the values in its domains."""
        domains, values = law.parameters, self.parameters
        named = {*values} == {*domains} and (self.pressure is None) == (law.pressure is None)
        return named and self.trial.shape[1] == len(law.forces) and all(value in domains[name] for name, value in values.items())

    def __repr__(self) -> str:
        if len(self) > 1:
            return f"<Case of {len(self)} increments, parameters {dict(self.parameters)}>"
        return f"Case({', '.join(self.arguments())})"

    def plain(self) -> dict[str, Any]:
        """Return the fields as numbers, lists and dictionaries, from which the case is built again to the last bit."""
        parts = {f.name: getattr(self, f.name) for f in fields(self)} | {"parameters": dict(self.parameters)}
        return {name: part.tolist() if isinstance(part, np.ndarray) else part for name, part in parts.items()}

    def arguments(self) -> list[str]:
        """Return the arguments that build the case again to the last bit, each as ``name=value``."""
        return [f"{name}={part!r}" for name, part in self.plain().items()]

    def _repr_pretty_(self, printer: Any, cycle: bool) -> None:
        """As Hypothesis and IPython print: by the representation above, not field by field."""
        printer.text(repr(self))


def vector(values: Iterable[float]) -> str:
    """Numbers in six digits."""
    return f"[{', '.join(f'{x:.6g}' for x in values)}]"
