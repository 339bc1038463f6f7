"""Error against run time: one increment by every method and solver, a path by every integrator, and cost a point at scale."""

from duhem.benchmark.work_precision.bench import SCENES, bench
from duhem.benchmark.work_precision.result import WorkPrecision

__all__ = ["SCENES", "WorkPrecision", "bench"]
