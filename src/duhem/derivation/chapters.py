"""A derivation as chapters of a page: a section a chapter, each relation with its number and its sentence."""

from __future__ import annotations

from itertools import groupby

from duhem.derivation.equation import Derivation
from duhem.derivation.printing import formulas, in_words
from duhem.show.document import Chapter, Display

__all__ = ["chapters"]


def chapters(derivation: Derivation) -> tuple[Chapter, ...]:
    """One chapter a section, in order."""
    return tuple(
        Chapter(section, tuple(Display(e.number, e.note, in_words(e, derivation.names), (*r.formula,), (*r.named,)) for e, r in group))
        for section, group in groupby(formulas(derivation), key=lambda pair: pair[0].section)
    )
