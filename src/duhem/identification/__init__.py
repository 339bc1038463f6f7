"""Identification: from measured limit points to the admissible law that fits them best."""

from __future__ import annotations

from duhem.identification import printing  # noqa: F401 (how an identification is shown)
from duhem.identification.entry import identify
from duhem.identification.points import Points
from duhem.identification.result import Estimate, Identification, Outlier

__all__ = ["Estimate", "Identification", "Outlier", "Points", "identify"]
