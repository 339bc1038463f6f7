"""What increments the laws of the atlas have, and why the others have none: python -m tests.campaigns.increments

    python -m tests.campaigns.increments                     all laws; exit code 1 where an answer is wrong
    python -m tests.campaigns.increments hill48 orowan       these
    python -m tests.campaigns.increments --group soils       a group
    python -m tests.campaigns.increments --no-suite          without the property tests, which take most of the time

A row a law, at the simplest admitted values of its parameters:

project    how many of the trial stresses beyond K end in slip, of all; how many are flagged, and as what; and how far an
           independent closest point lies from the answers, relative to the stress: that of CVXPY where it takes the law, else
           of SciPy's SLSQP
tangent    at how many of these it is the slope of the answers, by differences at h and h/16 that agree; how many are unsure,
           since these do not; how many have none
path       which integrators go once around in the space of the forces
properties how many checks of duhem.testing duhem's own routine passes, and which it is not put to
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from hypothesis import Phase, find, settings
from scipy.optimize import minimize

import duhem
from duhem.errors import DuhemError
from duhem.law.atlas.entry import AtlasEntry, entries, entry
from duhem.law.formula_law import Criterion
from duhem.path.integrators import INTEGRATORS
from duhem.projection.result import Array, Projection, Status
from duhem.testing import checks_for, conformance, parameters, projection
from duhem.testing.drawn.case import Region

__all__ = ["Row", "at_simplest", "left_out", "measured", "trials"]

_RAYS, _REFERENCES = 16, 12
_STRETCHES = (1.05, 2.0, 10.0)
_APART = 1e-4  # of a reference's stress: solvers of general problems have some five digits
_NONE = "more normals meet than there are pieces"
_WRONG = 1e-6  # by how much an answer may be farther than a feasible point that another finds


@dataclass(frozen=True)
class Row:
    """The cells of a law, and what in them is wrong."""

    project: str
    tangent: str
    path: str
    properties: str
    wrong: tuple[str, ...]


def at_simplest(name: str) -> Criterion:
    """The law at the simplest admitted values of its parameters."""
    law = duhem.load(name)
    simplest = settings(database=None, deadline=None, phases=(Phase.generate, Phase.shrink))  # nobody asks what explains it
    values = find(parameters(law), lambda _: True, settings=simplest)
    return law.fix(values)


def pressure_of(law: Criterion) -> float | None:
    return -1.0 if law.pressure else None


def trials(law: Criterion, rays: int = _RAYS) -> Array:
    """Stresses beyond K, on rays through the origin: by chance, along the axes and the hydrostatic one."""
    d = len(law.forces)
    region = Region(law, {n: float(x.value) for n, x in law.parameters.items() if x.value is not None})
    ways = np.vstack([np.random.default_rng(1).standard_normal((rays, d)), np.eye(d), -np.eye(d)])
    if law.stress is not None:
        mean = np.where(law.stress.shears, 0.0, 1.0)
        ways = np.vstack([ways, mean, -mean])
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    with np.errstate(all="ignore"):
        reach = region.reach(ways, np.full(len(ways), pressure_of(law) or 0.0))
    known = (reach > 1e-9) & (reach < 1e9)
    size = np.where(known, reach, np.median(reach[known]) if known.any() else 1.0)
    return np.vstack([stretch * size[:, None] * ways for stretch in _STRETCHES])


def left_out(said: AtlasEntry) -> set[str]:
    """Checks that a law is not put to: an apex has more normals than there are pieces, and the closest point no tangent there."""
    smooth, origin = (said.verdicts[claim] == "proved" for claim in ("smoothness", "origin"))
    return {*(() if smooth else ("tangent", "slope")), *(() if origin else ("origin",))}


def measured(said: AtlasEntry, suite: bool = True) -> Row:
    """The row of a law."""
    law = at_simplest(said.name)
    asked, wrong = trials(law), list[str]()
    try:
        done = duhem.project(law, asked, pressure_of(law), np.ones(asked.shape[1]), tangent=True)
    except DuhemError as reason:
        return Row(str(reason).partition(";")[0], "-", _path(law), _suite(law, set()) if suite else "-", ())
    solved = done.status <= Status.SLIP
    cell = f"{done.method}: {int((done.status == Status.SLIP).sum())}/{len(asked)} slip"
    for remark, count in Counter(done.remark(int(i)) for i in np.flatnonzero(~solved)).items():
        cell += f", {count} flagged ({remark})"
    who = np.flatnonzero(done.status == Status.SLIP)
    who = who[:: 1 + len(who) // _REFERENCES]
    if who.size:
        by, away, farther = _reference(law, asked[who], done.stress[who])
        cell += f"; {by} within {away:.0e}" if np.isfinite(away) else f"; {by} finds none"
        if farther > _WRONG:
            wrong.append(f"{by} finds a stress of K that is closer by {farther:.1e}")
    tangent = _tangent(law, asked, done, solved, wrong)
    path = _path(law)
    report = _suite(law, left_out(said)) if suite else "-"
    if report.startswith("FAILS") and said.verdicts["convexity"] != "refuted":
        wrong.append(report)
    return Row(cell, tangent, path, report, tuple(wrong))


def _reference(law: Criterion, asked: Array, found: Array) -> tuple[str, float, float]:
    """By which other way; how far its stresses are, where they are in K and no farther; and by how much one is closer at most."""
    region = Region(law, {n: float(x.value) for n, x in law.parameters.items() if x.value is not None})
    loads = np.full(len(asked), pressure_of(law) or 0.0)
    by, other = _other(law, asked, region, loads)
    size = np.maximum(np.abs(asked).max(axis=1), 1e-300)
    with np.errstate(all="ignore"):
        slope = np.linalg.norm(region.slope(other, loads)[0], axis=1)
        level = region.level(other, loads)
    admitted = (level <= 0.0) | (level <= 1e-9 * slope * size)
    ours, theirs = (np.linalg.norm(asked - stress, axis=1) for stress in (found, other))
    away = np.linalg.norm(found - other, axis=1) / np.maximum(np.linalg.norm(found, axis=1), 1e-3 * size)
    close = admitted & (theirs <= ours * (1.0 + 1e-6)) & (away <= _APART)
    return by, float(away[close].max(initial=0.0)) if close.any() else np.inf, float(((ours - theirs) / ours)[admitted].max(initial=0.0))


def _other(law: Criterion, asked: Array, region: Region, loads: Array) -> tuple[str, Array]:
    try:
        return "cvxpy", duhem.project(law, asked, pressure_of(law), np.ones(asked.shape[1]), method="cvxpy").stress
    except DuhemError:
        pass

    def nearest(trial: Array, load: Array) -> Array:
        def inside(stress: Array) -> float:
            return -float(np.nan_to_num(region.level(stress[None], load)[0], nan=1e3))

        starts = [share * trial for share in (0.0, 0.3)]
        rules = [{"type": "ineq", "fun": inside}]
        ends = [minimize(lambda s: float(((s - trial) ** 2).sum()), s, constraints=rules, options={"ftol": 1e-14}).x for s in starts]
        return min(ends, key=lambda s: (inside(s) < -1e-9, float(((s - trial) ** 2).sum())))

    with np.errstate(all="ignore"):
        return "slsqp", np.array([nearest(trial, load[None]) for trial, load in zip(asked, loads, strict=True)])


def _tangent(law: Criterion, asked: Array, done: Projection, solved: Array, wrong: list[str]) -> str:
    assert done.tangent is not None
    d = asked.shape[1]
    scale = 1e-5 * np.abs(done.stress).max(axis=1).clip(1e-3 * np.abs(asked).max(axis=1))
    shares = np.array([1.0, 1 / 16, -1.0, -1 / 16])
    steps = [scale[:, None] * share * np.eye(d)[i] for i in range(d) for share in shares]
    every = duhem.project(law, np.concatenate([asked + s for s in steps]), pressure_of(law), np.ones(d))
    ends, good = every.stress.reshape(d, 4, *asked.shape), (every.status <= Status.SLIP).reshape(4 * d, -1).all(axis=0)
    rates = (ends - done.stress) / (shares[:, None] * scale)[..., None]
    slopes = rates[:, 1::2].mean(axis=1)
    spread = np.abs(rates - slopes[:, None]).max(axis=(0, 1, 3))
    told = np.isfinite(done.tangent).all(axis=(1, 2))
    off = np.abs(np.moveaxis(slopes, 0, -1) - done.tangent).max(axis=(1, 2))
    sure = solved & good & (spread <= 1e-3)
    if (bad := sure & told & (off > 2e-3)).any():
        wrong.append(f"the tangent is off by {off[bad].max():.1e} at {asked[bad][0].tolist()}")
    counts = {"unsure": int((solved & told & ~sure).sum()), f"none: {_NONE}": int((solved & ~told).sum())}
    said = [f", {count} {what}" for what, count in counts.items() if count]
    return f"{int((sure & told & ~bad).sum())}/{int(solved.sum())}" + "".join(said)


def _path(law: Criterion) -> str:
    """The integrators that go around, and why the others do not."""
    d = len(law.forces)
    path = duhem.Path.linear(np.vstack([np.zeros(d), np.eye(d), -np.eye(d)]), pressure=pressure_of(law))
    ways, reasons = [], dict[str, str]()
    for method in INTEGRATORS:
        try:
            history = duhem.simulate(law, path, stiffness=1.0, method=method)
        except (DuhemError, ArithmeticError) as reason:
            said = str(reason).partition(";")[0]
            reasons[said] = f"{reasons[said]}, {method}" if said in reasons else method
            continue
        lost = (np.diff(history.dissipation) < -1e-9).any()
        ways.append(f"{method}{' LOSES DISSIPATION' if lost else ''}")
    return ", ".join([*ways, *(f"not {method}: {reason}" for reason, method in reasons.items())])


def _suite(law: Criterion, without: set[str]) -> str:
    try:
        asked = [check for check in checks_for(law) if check.name not in without]
        options = {"max_examples": 2, "rows": 8, "stiffness": np.eye(len(law.forces)), "pressure": pressure_of(law)}
        report = conformance(law, projection(law, tangent=True), checks=asked, **options)
    except DuhemError as reason:
        return str(reason).partition(";")[0]
    if not report.ok:
        return f"FAILS {', '.join(failure.check.name for failure in report.failures)}"
    return f"{len(report.passed)} pass" + (f"; without {', '.join(sorted(without))}" if without else "")


def main(arguments: Sequence[str]) -> int:
    """Run the campaign; 1 where an answer is wrong."""
    parser = argparse.ArgumentParser(prog="python -m tests.campaigns.increments", description="the increments of the atlas")
    parser.add_argument("names", nargs="*", help="laws of the atlas (left out: all)")
    parser.add_argument("--group", help="the laws of one group")
    parser.add_argument("--no-suite", action="store_true", help="leave the property tests out")
    given = parser.parse_args(arguments)
    laws = tuple(map(entry, given.names)) or entries(given.group)
    code = 0
    print("| law | forces | project | tangent | path | properties |\n|---|---|---|---|---|---|")
    start = time.process_time()
    for said in laws:
        row = measured(said, not given.no_suite)
        forces = len(duhem.load(said.name).forces)
        print(f"| {said.name} | {forces} | {row.project} | {row.tangent} | {row.path} | {row.properties} |", flush=True)
        for fault in row.wrong:
            print(f"WRONG {said.name}: {fault}", flush=True)
            code = 1
    print(f"{len(laws)} laws, {time.process_time() - start:.0f} s")
    return code


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
