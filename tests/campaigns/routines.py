"""How good the tests for a routine of your own are: python -m tests.campaigns.routines mutants|alarms|cost

mutants [NAME ...]           each wrong routine of tests/oracles/mutant_routines.py (those whose name contains NAME): what is
                             named as its cause, by which case it is found; 1 where one is not found, or not for its cause
alarms --part 3/40 [--to F]  every admissible law and every method, three seeds, 2,000 increments each; 1 where a right one is
                             refused.  Of the parts, the third of forty; --to keeps what is done, and a second start goes on there
cost [LAW ...]               processor time of all checks over that of a bare Hypothesis test, which draws the same cases and
                             calls the routine once a case
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from hypothesis import HealthCheck, given, settings

import duhem
from duhem.errors import InputError
from duhem.law.formula_law import Criterion
from duhem.projection.methods import METHODS
from duhem.testing import Case, Report, cases, conformance, projection
from tests.oracles.mutant_routines import MUTANTS, Mutant
from tests.testing.test_properties import ACCURACY, ALWAYS, AT_VALUES, of, without_reason

__all__ = ["first_cause", "found"]

_CASES, _ROWS = 7, 28  # 196 increments
_SEEDS, _INCREMENTS, _A_CASE = (0, 1, 2), 2000, 40


def found(mutant: Mutant) -> Report:
    """What the suite says of a wrong routine, on fewer than 200 increments."""
    options = {"max_examples": _CASES, "rows": _ROWS, "seconds": 0.05, "seed": 0, **mutant.options}
    return conformance(mutant.law, mutant.routine(), mutant.values, **options)


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
    print(f"{len(chosen)} mutants; not found: {missed['NOT FOUND']}, found for another cause: {missed['ANOTHER']}")
    return int(missed[""] < len(chosen))


def questions() -> Iterator[tuple[str, dict[str, str], str, int]]:
    """Law, values, method, seed."""
    yield from ((name, values, method, seed) for seed in _SEEDS for name, values in [*ALWAYS, *AT_VALUES] for method in METHODS)


def alarms(part: str, place: Path | None) -> int:
    """One line a question; 1 where a right routine is refused."""
    index, of_ = map(int, part.split("/"))
    done = dict(line.split("\t", 1) for line in place.read_text("utf-8").splitlines()) if place and place.exists() else {}
    asked = list(questions())
    chosen = asked[index - 1 :: of_]
    refused = 0
    for name, values, method, seed in chosen:
        key = f"{name} {values} {method} {seed}"
        if key not in done:
            done[key] = _alarm(duhem.load(name).fix(values), method, seed)
            if place is not None:
                with place.open("a", encoding="utf-8") as file:
                    file.write(f"{key}\t{done[key]}\n")
        print(f"{key}: {done[key]}", flush=True)
        refused += done[key].startswith("REFUSED")
    print(f"{len(chosen)} of {len(asked)} questions, {refused} refused")
    return int(refused > 0)


def _alarm(law: Criterion, method: str, seed: int) -> str:
    """What the suite says of duhem's own routine."""
    if (reason := without_reason(law, method)) is not None:
        return f"left out: {reason.partition(';')[0]}"
    options = {"accuracy": of(ACCURACY, method), "rows": _A_CASE, "max_examples": _INCREMENTS // _A_CASE, "seed": seed, "seconds": 1.0}
    report = conformance(law, projection(law, method), **options)  # type: ignore[arg-type]
    if not report.ok:
        return f"REFUSED {first_cause(report)}: {report.failures[0].reproducer()!r}"
    return f"{len(report.passed)} pass, {report.points} increments asked, {report.flagged} flagged"


def cost(names: Sequence[str]) -> int:
    """Least of three runs each, in one process."""
    for name in names or ("coulomb", "orthotropic", "antoni2007", "von-mises"):
        for title, update in {"duhem": projection(name), "nothing at all": lambda trial, *_, **__: trial}.items():
            checks = None if title == "duhem" else ["repeatability", "energy"]
            del checks
            suite, bare = _least(lambda u=update, n=name: _suite(n, u)), _least(lambda u=update, n=name: _bare(n, u))
            print(f"{name}, {title}: {100 * suite:.1f} ms a case, bare {100 * bare:.1f} ms, ratio {suite / bare:.2f}", flush=True)
    return 0


def _least(run: Callable[[], object]) -> float:
    times = []
    for _ in range(4):  # the first one warms
        start = time.process_time()
        run()
        times.append(time.process_time() - start)
    return min(times[1:])


def _suite(law: str, update: Callable[..., object]) -> None:
    conformance(law, update, max_examples=10, seed=0)  # type: ignore[arg-type]


def _bare(law: str, update: Callable[..., object]) -> None:
    @settings(max_examples=10, database=None, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
    @given(cases(law, rows=30))
    def test(case: Case) -> None:
        update(case.trial, case.pressure, case.stiffness, **case.parameters)

    test()


def main(arguments: Sequence[str]) -> int:
    """Run a part of the campaign."""
    parser = argparse.ArgumentParser(prog="python -m tests.campaigns.routines", description="the tests for a routine of your own")
    parser.add_argument("what", choices=["mutants", "alarms", "cost"])
    parser.add_argument("names", nargs="*")
    parser.add_argument("--part", default="1/1")
    parser.add_argument("--to", type=Path)
    asked = parser.parse_args(arguments)
    try:
        return alarms(asked.part, asked.to) if asked.what == "alarms" else {"mutants": mutants, "cost": cost}[asked.what](asked.names)
    except InputError as fault:
        print(fault)
        return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
