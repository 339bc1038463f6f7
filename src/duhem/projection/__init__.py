"""Slip increments: the closest point of K to a trial stress, and proof by residuals that it is."""

from duhem.projection.project import Projector, project, projector
from duhem.projection.result import Projection, Residuals, Status

__all__ = ["Projection", "Projector", "Residuals", "Status", "project", "projector"]
