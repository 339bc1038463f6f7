"""Figures of the source paper (Antoni et al. 2007) and one beyond it, each a value computed from the model.

``FIGURES[name](**settings)`` gives a :class:`Figure` or a :class:`Table`: arrays, labels, units and the numbers to read off.
:func:`duhem.micromodel.figures.value.save` draws a figure; nothing else here needs matplotlib.
"""

from duhem.micromodel.figures.paper import FIGURES
from duhem.micromodel.figures.value import Figure, Recipe, Table, unknown

__all__ = ["FIGURES", "Figure", "Recipe", "Table", "unknown"]
