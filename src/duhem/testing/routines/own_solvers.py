"""duhem's own methods as routines under test: each that takes a law, and why the others do not."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from duhem.errors import InputError
from duhem.law.formula_law import Criterion
from duhem.law.parameter_domain import simple_points
from duhem.projection.methods import METHODS
from duhem.projection.projector import Projector
from duhem.projection.result import Array
from duhem.projection.validation import check_associated
from duhem.testing.routines.routine import Step, Update, projection

__all__ = ["PROMISED", "own_solvers"]

PROMISED = {"cvxpy": 1e-6}  # relative errors in stress of methods that are less accurate than others: the root of a solver's gap


def own_solvers(law: Criterion) -> Iterator[tuple[str, Update | str]]:
    """Methods by name, with their routine, or the reason why they do not take the law.

    InputError for a law with a flow of its own, which none takes.
    """
    check_associated(law)
    point = {str(symbol): value for symbol, value in next(iter(simple_points(law)), {}).items()}
    values = {name: point[name] for name, domain in law.parameters.items() if domain.value is None and name in point}
    for method in METHODS:
        try:
            Projector.of(law, 1.0, values, method)
        except InputError as reason:
            yield method, str(reason)
        else:
            yield method, _answering(projection(law, method))


def _answering(routine: Update) -> Update:
    """The routine, which says of parameters at which its method does not apply that they are not solved."""

    def update(trial: Array, pressure: Array | None, stiffness: Array, **parameters: float) -> object:
        try:
            return routine(trial, pressure, stiffness, **parameters)
        except InputError:
            return Step(np.full_like(trial, np.nan), solved=np.zeros(len(trial), dtype=np.bool_))

    update.__wrapped__ = routine  # type: ignore[attr-defined]
    update.__duhem_import__ = getattr(routine, "__duhem_import__", "")  # type: ignore[attr-defined]
    return update  # type: ignore[return-value]
