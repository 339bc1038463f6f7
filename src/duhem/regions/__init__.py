"""For which parameters? The exact set of values of a parameter for which a claim about a law holds."""

from __future__ import annotations

from duhem.regions.entry import region, shape_parameters, told
from duhem.regions.result import ParameterRegion, RegionCell, RegionEnd

__all__ = ["ParameterRegion", "RegionCell", "RegionEnd", "region", "shape_parameters", "told"]
