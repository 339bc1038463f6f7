"""What is asked of a law and a loading path, as one value."""

from __future__ import annotations

import pathlib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from numpy.typing import ArrayLike

from duhem.law.formula_law import Criterion
from duhem.path.loading import Path
from duhem.path.paths import Paths
from duhem.projection.increment import Convexity

__all__ = ["Run"]


@dataclass(frozen=True, eq=False)
class Run:
    """The arguments of :func:`duhem.simulate` that determine numbers, as given and not yet checked; ``threads``, which do not, too.

    ``convexity`` is what is known of K where somebody has asked, None where nobody has.
    """

    law: Criterion | str | pathlib.Path
    path: Path | Paths
    stiffness: ArrayLike
    parameters: Mapping[str, Any] | None = None
    method: str = "implicit"
    projection: str = "auto"
    substeps: int = 1
    stress: ArrayLike | None = None
    keep: int | str = 1
    threads: int = 1
    compiled: bool = False
    convexity: Convexity | None = None
