"""Laws driven along loading paths: implicit, second-order and exact integration, and the history they leave."""

from duhem.path import picture  # noqa: F401 (how a history is shown)
from duhem.path.history import History
from duhem.path.loading import Path
from duhem.path.simulate import Interrupted, simulate

__all__ = ["History", "Interrupted", "Path", "simulate"]
