"""Laws driven along loading paths: implicit, second-order and exact integration, and the histories they leave."""

from duhem.path import picture  # noqa: F401 (how a history is shown)
from duhem.path.history import Histories, History
from duhem.path.loading import Path, Paths
from duhem.path.simulate import Interrupted, simulate

__all__ = ["Histories", "History", "Interrupted", "Path", "Paths", "simulate"]
