"""How good an exported C routine is: python -m tests.campaigns.export

    python -m tests.campaigns.export                    the built-in laws
    python -m tests.campaigns.export coulomb hill48     these, of the atlas too
    python -m tests.campaigns.export --group metals     a group of the atlas
    python -m tests.campaigns.export --no-suite         without the property tests
    python -m tests.campaigns.export --points 100000    of all laws, the atlas's too: so many increments held against duhem.project

A row a law, at the simplest admitted values of its parameters; exit code 1 where an answer is wrong.

unsolved   how many of the trial stresses, 1.05 to 10 times beyond K, with three stiffnesses, have the status 2; the status 5, no tangent
apart      how far the stresses are from those of duhem.project, relative to the trial, and the tangents from differences
suite      the checks of duhem.testing over the whole domain of the parameters but for exponents, with the share that is not solved

With --points: at how many increments the routine and duhem.project both have an answer, and both a tangent; how far the stresses lie
apart at most, relative to the trial, and the tangents, relative to the stiffness, but where the stress has no derivative and the tangent
is one of several; how many either alone has an answer to, and how many either alone has a tangent to; that nothing slips, where the
simplest parameters leave K no end; and the routine's processor time an increment, of the quickest block.
"""

from __future__ import annotations

import argparse
import ctypes
import sys
import time
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import sympy as sp

import duhem
from duhem.errors import DuhemError
from duhem.export.c_file import c_file, identifier
from duhem.export.routine import routine
from duhem.law import catalogue
from duhem.law.atlas.entry import entries
from duhem.law.formula_law import Criterion
from duhem.projection.result import Array, Status
from duhem.proof.verification import verify
from duhem.testing import checks_for, conformance, pressures
from tests.campaigns.increments import at_simplest, pressure_of, trials
from tests.export.shared_library import OPTIMISED, Compiled, compiled, compiler, shared

__all__ = ["agreement", "measured"]

_STRESS, _TANGENT, _BLOCK = 1e-12, 1e-9, 10_000
_MANY = """
void many(long count, const double *trial, double pressure, const double *stiffness, double *stress, double *tangent, int *status);

void many(long count, const double *trial, double pressure, const double *stiffness, double *stress, double *tangent, int *status)
{{
    double slip[{d}], dissipation;
    for (long i = 0; i < count; i++)
        status[i] = {name}_increment(
            trial + {d} * i, pressure, stiffness, 0, stress + {d} * i, slip, &dissipation, tangent + {d} * {d} * i);
}}
"""
_WRONG, _SETTLED, _TURNED = 1e-7, 1e-3, 5e-3


def stiffnesses(d: int) -> list[Array]:
    """One number, one a force, and coupled."""
    apart = np.geomspace(1.0, 10.0, d)
    return [np.eye(d), np.diag(apart), np.diag(apart) + 0.3 * (np.ones((d, d)) - np.eye(d))]


def measured(name: str, suite: bool) -> tuple[list[str], bool]:
    """The cells of a law, and whether something in them is wrong."""
    try:
        law = at_simplest(name)
        routine(law)
        run = compiled(law, options=OPTIMISED)
    except DuhemError as reason:
        return [str(reason).partition(";")[0], "-", "-"], False
    asked, pressure = trials(law), pressure_of(law)
    unsolved = unknown = far = turned = 0.0
    for k in stiffnesses(asked.shape[1]):
        known = duhem.project(law, asked, pressure, k)
        given = [run.one(trial, pressure or 0.0, k, ()) for trial in asked]
        state, stress = (np.array([row[i] for row in given]) for i in (0, 1))
        unsolved += float(((state > 1) & (state < 5)).sum()) / (3 * len(asked))
        unknown += float((state == 5).sum()) / (3 * len(asked))
        off = np.abs(stress - known.stress).max(axis=1) / np.abs(asked).max(axis=1)
        far = max(far, float(off[(known.status <= Status.SLIP) & ((state <= 1) | (state == 5))].max(initial=0.0)))
        turned = max(
            turned, *(_turned(run, trial, pressure or 0.0, k, row[4]) for trial, row in zip(asked, given, strict=True) if row[0] == 1), 0.0
        )
    cells = [f"{100 * unsolved:.1f} %, {100 * unknown:.1f} %", f"{far:.0e}, {turned:.0e}", _suite(name) if suite else "-"]
    return cells, far > _WRONG or turned > _TURNED or cells[2].startswith("FAILS")


def agreement(name: str, points: int) -> tuple[str, bool]:
    """The row of a law whose routine and duhem.project answer the same ``points`` increments, and whether they are too far apart."""
    try:
        law = at_simplest(name)
        text = c_file(verify(law, claims=["convexity"]))
    except DuhemError as reason:
        return f"not exported: {str(reason).partition(';')[0]}", False
    d, pressure, ways, own = len(law.forces), pressure_of(law), stiffnesses(len(law.forces)), identifier(law.name)
    with TemporaryDirectory() as folder:
        file = Path(folder) / f"{own}.c"
        file.write_text(text + _MANY.format(d=d, name=own), "utf-8")
        many = shared([file], *OPTIMISED, with_=compiler("CC", "cc", "gcc", "clang")).many
    place = ctypes.c_void_p
    many.argtypes, many.restype = [ctypes.c_long, place, ctypes.c_double, *[place] * 4], None
    every = trials(law, -(-points // 9))[: points // 3]
    counts, stresses, tangents, quickest, slips = Counter[str](), 0.0, 0.0, np.inf, False
    for k in ways:
        for start in range(0, len(every), _BLOCK):
            asked = np.ascontiguousarray(every[start : start + _BLOCK])
            stress, tangent, status = np.empty_like(asked), np.empty((len(asked), d, d)), np.empty(len(asked), np.int32)
            began = time.thread_time()
            many(len(asked), asked.ctypes.data, pressure or 0.0, *(x.ctypes.data for x in (k, stress, tangent, status)))
            quickest = min(quickest, (time.thread_time() - began) / len(asked))
            known = duhem.project(law, asked, pressure, k, tangent=True)
            assert known.tangent is not None
            here, there = (status < 2) | (status > 3), (known.status <= Status.SLIP) | (known.status == Status.OUTSIDE)
            far = np.abs(stress - known.stress).max(axis=1) / np.abs(asked).max(axis=1)
            turned = np.abs(tangent - known.tangent).max(axis=(1, 2)) / np.abs(k).max()
            known_here, known_there = np.isfinite(tangent).all(axis=(1, 2)), np.isfinite(known.tangent).all(axis=(1, 2))
            both = here & there
            told = {"both": both, "tangents": both & known_here & known_there, "C alone": here & ~there, "Python alone": there & ~here}
            told |= {"tangent of C alone": both & known_here & ~known_there, "tangent of Python alone": both & known_there & ~known_here}
            told["one of several"] = told["tangents"] & (turned > _TANGENT)
            for row in np.flatnonzero(told["one of several"]):
                told["one of several"][row] = _several(law, asked[row], pressure, k)
            slips |= bool((known.slip[both] != 0.0).any())
            stresses = max(stresses, float(far[both].max(initial=0.0)))
            tangents = max(tangents, float(turned[told["tangents"] & ~told["one of several"]].max(initial=0.0)))
            counts.update({said: int(rows.sum()) for said, rows in told.items() if rows.any()})
    said = ", ".join([f"{counts[what]} {what}" for what in sorted(counts)] + ["nothing slips"] * (not slips))
    return f"{stresses:.0e}, {tangents:.0e}  {1e9 * quickest:5.0f} ns  {said}", stresses > _STRESS or tangents > _TANGENT


def _several(law: Criterion, trial: Array, pressure: float | None, k: Array) -> bool:
    """Whether the tangents beside a trial are not one: the stress has no derivative there."""
    axes = 1e-6 * np.abs(trial).max() * np.eye(len(trial))
    beside = duhem.project(law, trial + np.vstack([axes, -axes]), pressure, k, tangent=True).tangent
    return bool(np.nanmax(np.ptp(beside, axis=0)) > _SETTLED * np.abs(k).max())


def _turned(run: Compiled, trial: Array, pressure: float, k: Array, tangent: Array) -> float:
    """How far the tangent is from the slope of the answers, over the stiffness, where differences at h and h/2, either way, agree."""
    h, shares = 1e-5 * np.abs(trial).max(), np.array([1.0, 0.5, -1.0, -0.5])
    inverse, off = np.linalg.inv(k), 0.0
    here = run.one(trial, pressure, k, ())[1]
    for i, axis in enumerate(np.eye(len(trial))):
        slopes = np.array([(run.one(trial + s * h * axis, pressure, k, ())[1] - here) / (s * h) for s in shares])
        middle = slopes.mean(axis=0)
        if np.abs(slopes - middle).max() <= _SETTLED:
            off = max(off, float(np.nan_to_num(np.abs((tangent @ inverse)[:, i] - middle).max(), nan=9.0)))
    return off


def _suite(name: str) -> str:
    """Every check, of the tangent those that duhem's own are put to: with a pressure, the slope where differences resolve it."""
    law = _open(name)
    try:
        run = compiled(law, options=OPTIMISED)
    except DuhemError as reason:
        return str(reason).partition(";")[0]
    rest = [check for check in checks_for(law) if check.name not in ("slope", "multiplier")]
    reports = [conformance(law, run, checks=rest, max_examples=20)]
    pressed = pressures().filter(bool) if law.pressure else None
    reports.append(conformance(law, run, checks=["slope"], pressure=pressed, max_examples=2, rows=40))
    failed = [failure.check.name for report in reports for failure in report.failures]
    flagged = f"{100 * sum(r.flagged for r in reports) / sum(r.points for r in reports):.1f} % unsolved"
    return f"FAILS {', '.join(failed)}; {flagged}" if failed else f"{sum(len(r.passed) for r in reports)} pass; {flagged}"


def _open(name: str) -> Criterion:
    """The law with as many parameters left as can be arguments."""
    law, simple = catalogue.load_formula(duhem.load(name)), at_simplest(name)
    try:
        routine(law)
    except DuhemError:
        powers = {str(x) for power in law.g.atoms(sp.Pow) for x in power.exp.free_symbols}
        return law.fix({n: simple.parameters[n].value for n in powers if n in law.parameters})
    return law


def main(arguments: Sequence[str]) -> int:
    """Run the campaign; 1 where an answer is wrong."""
    parser = argparse.ArgumentParser(prog="python -m tests.campaigns.export", description="exported routines, compiled and tested")
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--group")
    parser.add_argument("--no-suite", action="store_true")
    parser.add_argument("--points", type=int)
    asked = parser.parse_args(arguments)
    known = [] if asked.group else list(catalogue.names())
    names = asked.names or known + [each.name for each in entries(asked.group) if asked.group or asked.points]
    wrong = []
    for name in names:
        if asked.points:
            row, bad = agreement(name, asked.points)
            wrong += [name] * bad
            print(f"{name:<22} {row}{'  APART' * bad}", flush=True)
            continue
        cells, bad = measured(name, not asked.no_suite)
        wrong += [name] * bad
        print(f"{name:<22} {cells[0]:<15} {cells[1]:<16} {cells[2]}{'  WRONG' * bad}", flush=True)
    print(f"{len(names)} laws, wrong: {', '.join(wrong) or 'none'}")
    return bool(wrong)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
