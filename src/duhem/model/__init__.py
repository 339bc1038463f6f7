"""A law made ready for reasoning: stated over positive pressure magnitude, then brought to its simplest equivalent form."""

from duhem.model.problem import Problem, state
from duhem.model.star import Star, star_form

__all__ = ["Problem", "Star", "star_form", "state"]
