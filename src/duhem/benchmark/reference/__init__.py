"""High-precision references: the slip increment and the loading path from the law's formula alone, with their own errors.

Nothing here is shared with the methods that are measured against it: neither their derivatives nor their shapes.
"""

from duhem.benchmark.reference.closest import Closest, ReferenceIncrement, distance
from duhem.benchmark.reference.formula import NoReference
from duhem.benchmark.reference.path import Drive, Driven

__all__ = ["Closest", "Drive", "Driven", "NoReference", "ReferenceIncrement", "distance"]
