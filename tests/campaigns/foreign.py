"""The shipped examples in C and Fortran without a law: each bug by the right check first, and nothing said of what is right.

    python -m tests.campaigns.foreign --seeds 3 --cases 200

A case is thirty histories, against a law 200 increments.  A function of JAX is put to its law and to none where JAX is installed.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Iterator
from importlib.util import find_spec
from typing import Any

import numpy as np

from duhem.show.page import table
from duhem.testing import Report, conformance, decades
from duhem.testing.foreign import jax_routine
from tests.testing.examples import BUGS, EXAMPLES, friction, interface, mises

__all__ = ["GOOD", "mutants", "right"]

GOOD: dict[str, Callable[[], dict[str, Any]]] = {
    "friction": friction,
    "mises": mises,
    "mises, perfectly plastic": lambda: mises(H=0.0),
    "mises, hardening as stiff as it is elastic": lambda: mises(H=2e11),
    "mises, softening": lambda: mises(H=-1e8),
    "interface": interface,
    "interface, cohesive alone": lambda: interface(mu=0.0),
    "interface, much friction": lambda: interface(mu=3.0),
    "interface without cohesion": lambda: interface(c=0.0) | {"scale": 1.0},  # it slips at once: no elastic range is found
}


def mutants(seeds: int, cases: int) -> Iterator[tuple[list[str], bool]]:
    """A row for each bug, and whether each seed has told it by the right check first."""
    for name, firsts in BUGS.items():
        for bug, first in enumerate(firsts, start=1):
            found = [conformance(None, max_examples=cases, seed=seed, **EXAMPLES[name](bug)) for seed in range(seeds)]
            told = [report.failures[0].check.name if report.failures else "nothing" for report in found]
            explained = sorted({check for report in found for check in (report.failures[0].explains if report.failures else ())})
            others = sorted({f.check.name for report in found for f in report.failures[1:]})
            yield [name, str(bug), first, ", ".join(sorted(set(told))), ", ".join(explained), ", ".join(others)], set(told) == {first}


def right(seeds: int, cases: int) -> Iterator[tuple[list[str], bool]]:
    """A row for each routine without a bug, and whether nothing was said of it."""

    def row(name: str, reports: list[Report], start: float) -> tuple[list[str], bool]:
        failed = sorted({check for report in reports for check in report.failed})
        count = sum(report.points for report in reports)
        slip = sum(report.visited["slip"] for report in reports) / len(reports)
        said = [name, f"{count:,}", f"{slip:.2f}", f"{time.process_time() - start:.0f}", ", ".join(failed)]
        return said, not failed

    for name, made in GOOD.items():
        start = time.process_time()
        yield row(name, [conformance(None, max_examples=cases, seed=seed, **made()) for seed in range(seeds)], start)
    if find_spec("jax") is None:
        yield ["JAX", "-", "-", "-", "left out: jax is not installed; pip install jax"], True
    else:
        import jax.numpy as jnp

        def step(trial: Any, pressure: Any, stiffness: Any, mu: Any) -> Any:
            size = jnp.sqrt(jnp.maximum(trial @ trial, 1e-300))
            return trial * jnp.minimum(1.0, -mu * pressure / size)

        scalar = decades(-3, 3).map(lambda k: k * np.eye(2))
        start = time.process_time()
        against = {"stiffness": scalar, "rows": 200, "max_examples": cases}
        laws = [conformance("coulomb", jax_routine(step), seed=seed, **against) for seed in range(seeds)]
        yield row("JAX, against coulomb", laws, start)
        start, given = time.process_time(), {"stiffness": [2.0, 2.0], "pressure": -1.0, "max_examples": cases}
        yield row("JAX", [conformance(None, jax_routine(step), {"mu": 0.3}, seed=seed, **given) for seed in range(seeds)], start)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--cases", type=int, default=200)
    asked = parser.parse_args()
    bad = 0
    for title, head, align, rows in (
        ("bugs", ["example", "bug", "right", "told first", "explains", "also"], "lrllll", mutants(asked.seeds, asked.cases)),
        ("right", ["routine", "increments", "slip", "s", "failed"], "lrrrl", right(asked.seeds, asked.cases)),
    ):
        every = list(rows)
        bad += sum(not good for _, good in every)
        print(f"{title}: {sum(good for _, good in every)} of {len(every)} as they should be", flush=True)
        print("\n".join(table([head, *(said for said, _ in every)], align, "  ")), flush=True)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
