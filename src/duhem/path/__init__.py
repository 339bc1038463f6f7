"""Laws driven along loading paths: implicit, second-order and exact integration, and the histories they leave."""

from duhem.path import picture  # noqa: F401 (how a history is shown)
from duhem.path.history import Histories, History, Interrupted
from duhem.path.loading import Path, Paths
from duhem.path.simulate import simulate
from duhem.path.state_path import StateHistory

__all__ = ["Histories", "History", "Interrupted", "Path", "Paths", "StateHistory", "simulate"]
