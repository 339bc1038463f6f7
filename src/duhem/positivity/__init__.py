"""Deciders of one question: is an expression >= 0 wherever some relations hold?"""

from duhem.positivity.decide import decide
from duhem.positivity.question import Answer, Question, Sense

__all__ = ["Answer", "Question", "Sense", "decide"]
