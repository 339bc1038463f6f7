"""For which parameters? The values of one or several parameters for which a claim about a law holds."""

from __future__ import annotations

from duhem.regions.asked import MOST_STEPS
from duhem.regions.entry import region, shape_parameters, told
from duhem.regions.result import FoundRegion, ParameterRegion, PavedRegion, RegionCell, RegionEnd

__all__ = ["MOST_STEPS", "FoundRegion", "ParameterRegion", "PavedRegion", "RegionCell", "RegionEnd", "region", "shape_parameters", "told"]
