"""How good the tests for a routine of your own are: python -m tests.campaigns.routines mutants|alarms|cost

mutants [NAME ...]           each wrong routine of tests/oracles/mutant_routines.py (those whose name contains NAME): what is
                             named as its cause, by which case it is found; 1 where one is not found, or not for its cause
alarms [METHOD ...]          every admissible law and every method, or those named, with --seeds 3 of --increments 2000 each; 1 where
                             a right one is refused.  --part 3/40: of forty parts the third; --to F keeps what is done, and a second
                             start goes on there; right routines in C, Fortran and JAX are among the first part
cost [NAME ...]              processor time of all checks over that of a bare Hypothesis test, which draws the same cases and
                             calls the routine once a case: by hand, and duhem's own by closed form and by Newton's method, of the
                             laws named or of all, and the examples in C and Fortran; each in a process of its own, of cases that
                             are new there and of the same again, near three the least of four; 1 where one is more than three.
                             Of the same again duhem's routines find what they have kept of K at the pressures of a bare test,
                             and at fewer of those that the checks ask under, where these are more than are kept
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
from hypothesis import HealthCheck, Phase, find, settings
from hypothesis.errors import NoSuchExample

import duhem
from duhem.errors import InputError
from duhem.law.formula_law import Criterion
from duhem.projection.methods import METHODS
from duhem.projection.result import Array
from duhem.testing import Case, Report, Update, cases, conformance, projection
from duhem.testing.drawn.strategies import histories
from duhem.testing.drawn.values import Strategy, decades
from duhem.testing.foreign import shared_library
from duhem.testing.routines import Material, Unfinished, stateless
from tests.campaigns.foreign import right
from tests.oracles.mutant_routines import MUTANTS, Mutant
from tests.testing.examples import BUGS, EXAMPLES, written
from tests.testing.test_foreign import BATCHED, CLOBBERS, SPOILT
from tests.testing.test_properties import ACCURACY, ALWAYS, AT_VALUES, of, without_reason

__all__ = ["first_cause", "found"]

_CASES, _ROWS = 7, 28  # 196 increments
_A_CASE = 40  # increments
_COST_CASES, _COST_ROWS, _COST_SEEDS = 10, 30, (1, 2, 3)
_MOST, _NEAR = 3.0, 2.4  # times the cost of a bare test; from where a line is timed again, since one time alone scatters by a third

_Seeded = Callable[[int], object]


def found(mutant: Mutant, routine: Update | None = None) -> Report:
    """What the suite says of a wrong routine, or of another in its place, on fewer than 200 increments."""
    options = {"max_examples": _CASES, "rows": _ROWS, "seed": 0, **mutant.options}
    return conformance(mutant.law, routine or mutant.routine(), mutant.values, **options)


def first_cause(report: Report) -> str:
    """The check that is told first."""
    return report.failures[0].check.name if report.failures else "-"


def mutants(names: Sequence[str]) -> int:
    """The table; 1 where a mutant is not found, or not for its cause."""
    chosen = [m for m in MUTANTS if not names or any(name in m.name for name in names)]
    missed: Counter[str] = Counter()
    print("| kind | mutant | cause | first | of failures | seconds |\n|---|---|---|---|---|---|")
    for mutant in chosen:
        start = time.process_time()
        report = found(mutant)
        cause = first_cause(report)
        verdict = "" if cause in mutant.roots else " NOT FOUND" if cause == "-" else " ANOTHER"
        missed[verdict.strip()] += 1
        cells = [mutant.kind, mutant.name, " or ".join(sorted(mutant.roots)), cause + verdict, len(report.failures)]
        print(f"| {' | '.join(map(str, cells))} | {time.process_time() - start:.1f} |", flush=True)
    for kind, name, bug, root in compiled(names):
        start = time.process_time()
        report = conformance(None, **EXAMPLES[name](bug), max_examples=3, rows=12, seed=1)
        cause = first_cause(report)
        verdict = "" if cause == root else " NOT FOUND" if cause == "-" else " ANOTHER"
        missed[verdict.strip()] += 1
        cells = [kind, f"{name}, bug {bug}", root, cause + verdict, len(report.failures)]
        print(f"| {' | '.join(map(str, cells))} | {time.process_time() - start:.1f} |", flush=True)
    for name, update, options, root in careless(names):
        start = time.process_time()
        try:
            cause, failures = (
                first_cause(report := conformance(None, update, max_examples=3, rows=12, seed=1, **options)),
                len(report.failures),
            )
        except Unfinished as fault:
            cause, failures = "no answer" if fault.failure is not None else "-", 0
        verdict = "" if cause == root else " NOT FOUND" if cause == "-" else " ANOTHER"
        missed[verdict.strip()] += 1
        print(f"| C | {name} | {root} | {cause + verdict} | {failures} | {time.process_time() - start:.1f} |", flush=True)
    print(f"{missed.total()} mutants; not found: {missed['NOT FOUND']}, found for another cause: {missed['ANOTHER']}")
    return int(missed[""] < missed.total())


def compiled(names: Sequence[str]) -> Iterator[tuple[str, str, int, str]]:
    """The shipped examples in C and Fortran with each of their bugs: language, name, number, cause."""
    for name, roots in BUGS.items():
        if not names or any(part in name for part in names):
            yield from (("Fortran" if name == "interface" else "C", name, bug, root) for bug, root in enumerate(roots, 1))


def careless(names: Sequence[str]) -> Iterator[tuple[str, Update, dict[str, Any], str]]:
    """Routines in C that overwrite what they are given, or never come back: name, routine, options, cause."""
    source = written(BATCHED)
    for number, said in SPOILT[1:]:
        if not names or any(part in f"overwrites {said}" for part in names):
            options = {"parameters": {"mu": float(number)}, "stiffness": [2.0, 3.0], "pressure": -1.0, "checks": ["answers", "inputs"]}
            yield f"overwrites {said}", shared_library(source, CLOBBERS), options, "inputs"
    if not names or any(part in "endless" for part in names):
        endless = shared_library(source, "void endless(const double *trial, double *stress)", isolated=True, seconds=2.0)
        yield "endless", endless, {"stiffness": [1.0]}, "no answer"


def questions(methods: Sequence[str], seeds: int) -> Iterator[tuple[str, dict[str, str], str, int]]:
    """Law, values, method, seed."""
    laws = [*ALWAYS, *AT_VALUES]
    yield from ((*law, method, seed) for seed in range(seeds) for law in laws for method in methods or METHODS)


def alarms(methods: Sequence[str], part: str, seeds: int, increments: int, place: Path | None) -> int:
    """One line a question; 1 where a right routine is refused."""
    index, of_ = map(int, part.split("/"))
    done = dict(line.split("\t", 1) for line in place.read_text("utf-8").splitlines()) if place and place.exists() else {}
    asked = list(questions(methods, seeds))
    chosen = asked[index - 1 :: of_]
    refused = 0
    for (name, count, _, _, said), fine in right(seeds, max(1, increments // 200)) if index == 1 else ():
        refused += not fine
        print(f"{name}: {'' if fine else 'REFUSED '}{said or f'accepted, {count} increments'}", flush=True)
    for name, values, method, seed in chosen:
        key = f"{name} {values} {method} {seed} {increments}"
        if key not in done:
            done[key] = _alarm(duhem.load(name).fix(values), method, seed, increments)
            if place is not None:
                with place.open("a", encoding="utf-8") as file:
                    file.write(f"{key}\t{done[key]}\n")
        print(f"{key}: {done[key]}", flush=True)
        refused += done[key].startswith("REFUSED")
    print(f"{len(chosen)} of {len(asked)} questions, {refused} refused")
    return int(refused > 0)


def _alarm(law: Criterion, method: str, seed: int, increments: int) -> str:
    """What the suite says of duhem's own routine."""
    if (reason := without_reason(law, method)) is not None:
        return f"left out: {reason.partition(';')[0]}"
    start, rows = time.process_time(), min(_A_CASE, increments)
    options = {"accuracy": of(ACCURACY, method), "rows": rows, "max_examples": increments // rows, "seed": seed}
    report = conformance(law, projection(law, method), **options)  # type: ignore[arg-type]
    if not report.ok:
        return f"REFUSED {first_cause(report)}: {report.failures[0].reproducer()!r}"
    seconds = time.process_time() - start
    return f"{len(report.passed)} pass, {report.points} increments asked, {report.flagged} flagged, {seconds:.1f} s"


def coulomb(trial: Array, pressure: Array, stiffness: Array, mu: float) -> Array:
    """The closest point of a disk for a stiffness of one number, by hand: what a light routine costs."""
    size, limit = np.hypot(*trial.T), -mu * pressure
    with np.errstate(all="ignore"):
        return np.where((size > limit)[:, None], trial / size[:, None] * limit[:, None], trial)


def box(trial: Array, pressure: Array, stiffness: Array, mu_a: float, mu_b: float) -> Array:
    """The closest point of a box for a diagonal stiffness, by hand."""
    ends = np.stack([-mu_a * pressure, -mu_b * pressure], axis=1)
    return np.clip(trial, -ends, ends)


def cost(names: Sequence[str]) -> int:
    """A line each; 1 where one costs more than ``_MOST`` bare tests."""
    most = 0.0
    for title, whole, bare in _costly(names):
        suite, alone = _seconds(whole), _seconds(bare)
        for _ in range(3 * int((suite / alone).max() > _NEAR)):
            suite, alone = np.minimum(suite, _seconds(whole)), np.minimum(alone, _seconds(bare))
        new, met = suite / alone
        print(f"{title}: {suite[0]:.1f} ms a case, bare {alone[0]:.1f} ms, ratio {new:.2f}; ", end="")
        print(f"the same cases again {suite[1]:.1f} ms, bare {alone[1]:.1f} ms, ratio {met:.2f}", flush=True)
        most = max(most, new, met)
    return int(most > _MOST)


def _seconds(run: _Seeded) -> Array:
    """Milliseconds a case of the processor, of cases that are new and of the same again; in a process of its own that has met none."""
    fork = get_context("fork")
    here, there = fork.Pipe(duplex=False)

    def timed() -> None:
        run(0)  # what is made once a process
        ends = [time.process_time()]
        for _ in range(2):
            for seed in _COST_SEEDS:
                run(seed)
            ends.append(time.process_time())
        there.send(ends)

    child = fork.Process(target=timed)
    child.start()
    there.close()
    ends: list[float] = here.recv()
    child.join()
    return 1000.0 * np.diff(ends) / (len(_COST_SEEDS) * _COST_CASES)


def _costly(names: Sequence[str]) -> Iterator[tuple[str, _Seeded, _Seeded]]:
    """What it is, all its checks, and the bare test."""
    for name, update in {"coulomb": coulomb, "box": box}.items():
        if not names or name in names:
            yield _of_law(duhem.load(name), "by hand", update, decades(-3, 3))
    known = [*ALWAYS, *AT_VALUES]
    others = set(names) - {*EXAMPLES, *(name for name, _ in known)}
    for name, values in [*(law for law in known if not names or law[0] in names), *((name, {}) for name in sorted(others))]:
        law = duhem.load(name).fix(values)
        for method in ("closed-form", "newton"):
            if without_reason(law, method) is None:
                yield _of_law(law, ", ".join([*(f"{k} = {v}" for k, v in values.items()), method]), projection(law, method), None)
    for name, made in EXAMPLES.items():
        if not names or name in names:
            yield f"{name}, without a law", partial(_suite, None, **made()), partial(_bare_history, **made())


def _of_law(law: Criterion, title: str, update: Update, stiffness: Strategy | None) -> tuple[str, _Seeded, _Seeded]:
    whole = partial(_suite, law, update=update, stiffness=stiffness)
    return f"{law.name}, {title}", whole, partial(_bare, law, update, stiffness)


def _suite(law: Criterion | None, seed: int, **given: Any) -> None:
    conformance(law, **given, max_examples=_COST_CASES, rows=_COST_ROWS, seed=seed)


def _bare(law: Criterion, update: Update, stiffness: Strategy | None, seed: int) -> None:
    open_ = [name for name, domain in law.parameters.items() if domain.value is None]

    def once(case: Case) -> object:
        return update(case.trial, case.pressure, case.stiffness, **{name: case.parameters[name] for name in open_})

    _drawn(cases(law, stiffness=stiffness, rows=_COST_ROWS), once, seed)


def _bare_history(
    seed: int, update: Update | Material, parameters: Any = None, stiffness: Any = None, pressure: float | None = None
) -> None:
    values = parameters or {}

    def made(given: Mapping[str, float], k: Array) -> Material:
        return update if isinstance(update, Material) else stateless(update, k, given)

    def once(case: Case) -> object:
        if not isinstance(update, Material):
            return update(case.trial, case.pressure, case.stiffness, **case.parameters)
        increment = np.linalg.solve(update.elastic, case.trial.T).T
        return update.advance(update.virgin(len(case)), increment, case.pressure, 1.0)

    _drawn(histories(made, values, update.elastic if isinstance(update, Material) else stiffness, pressure, _COST_ROWS), once, seed)


def _drawn(drawn: Strategy, once: Callable[[Case], object], seed: int) -> None:
    """A bare test: as many cases, each put to the routine ``once``."""
    options: dict[str, Any] = {"database": None, "deadline": None, "suppress_health_check": list(HealthCheck)}
    bare = settings(max_examples=_COST_CASES, phases=(Phase.generate,), **options)

    def asked(case: Case) -> bool:
        once(case)
        return False

    with suppress(NoSuchExample):
        find(drawn, asked, settings=bare, random=Random(seed))


def main(arguments: Sequence[str]) -> int:
    """Run a part of the campaign."""
    parser = argparse.ArgumentParser(prog="python -m tests.campaigns.routines", description="the tests for a routine of your own")
    parser.add_argument("what", choices=["mutants", "alarms", "cost"])
    parser.add_argument("names", nargs="*")
    parser.add_argument("--part", default="1/1")
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--increments", type=int, default=2000)
    parser.add_argument("--to", type=Path)
    asked = parser.parse_args(arguments)
    try:
        if asked.what == "alarms":
            return alarms(asked.names, asked.part, asked.seeds, asked.increments, asked.to)
        return {"mutants": mutants, "cost": cost}[asked.what](asked.names)
    except InputError as fault:
        print(fault)
        return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
