"""Deciders of one question: is an expression >= 0 wherever some relations hold?"""

from duhem.proof.decide.budget import EFFORTS, Budget
from duhem.proof.decide.deciders import decide
from duhem.proof.decide.needs import Sense
from duhem.proof.decide.question import Answer, Question

__all__ = ["EFFORTS", "Answer", "Budget", "Question", "Sense", "decide"]
