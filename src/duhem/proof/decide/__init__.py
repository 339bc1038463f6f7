"""Deciders of one question: is an expression >= 0 wherever some relations hold?"""

from duhem.proof.decide.deciders import decide
from duhem.proof.decide.question import ANY_STEPS, EFFORTS, Answer, Budget, Question, Sense

__all__ = ["ANY_STEPS", "EFFORTS", "Answer", "Budget", "Question", "Sense", "decide"]
