"""Formulas: the vocabulary, the safe parser, and the interpreters, each a fold over one SymPy tree."""

from duhem.expression.fold import Table, fold
from duhem.expression.vocabulary import NODES, UNDEFINED, WORDS, Atan2, EigMax, Neg, Norm, Pos, Where, Word, defined_at, holds_at, symbol

__all__ = [
    "NODES", "UNDEFINED", "WORDS", "Atan2", "EigMax", "Neg", "Norm", "Pos", "Table", "Where", "Word", "defined_at", "fold", "holds_at",
    "symbol",
]  # fmt: skip
