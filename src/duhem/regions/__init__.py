"""For which parameters? The exact set of values of a parameter for which a claim about a law holds."""

from __future__ import annotations

from duhem.regions.entry import region, shape_parameters
from duhem.regions.result import Region, RegionCell, RegionEnd

__all__ = ["Region", "RegionCell", "RegionEnd", "region", "shape_parameters"]
