"""Figures of the source paper (Antoni et al. 2007) and one beyond it, each a value computed from the model.

``FIGURES[name](**settings)`` gives a :class:`Figure` or a :class:`Table`: arrays, labels, units and the numbers to read off.
:func:`duhem.micromodel.figures.drawing.save` draws a figure; nothing else here needs matplotlib.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from duhem.micromodel.figures import asymmetry, coefficients, law_1d, loads, oblique, plane_criterion
from duhem.micromodel.figures.recipe import Recipe, unknown
from duhem.micromodel.figures.value import Figure, Table

__all__ = ["FIGURES", "Figure", "Recipe", "Table", "unknown"]

_RECIPES = (law_1d.RECIPE, asymmetry.RECIPE, plane_criterion.RECIPE, loads.RECIPE, coefficients.RECIPE, oblique.RECIPE)
FIGURES: Mapping[str, Recipe] = MappingProxyType({recipe.name: recipe for recipe in _RECIPES})
