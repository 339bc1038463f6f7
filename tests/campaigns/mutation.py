"""Small faults in the program's own text, a sample of them: which do the tests of proofs let live?

    pip install "duhem[mutation]"
    python -m tests.campaigns.mutation 200
    python -m tests.campaigns.mutation 60 --room kernel --seed 2 --slow
    python -m tests.campaigns.mutation 20 --room kernel --module deviatoric

Cosmic Ray makes the mutants, one in each of so many places drawn at random, in a copy of the tree.  Asked are the tests that
run the place (coverage tells), the quickest first; a mutant is killed where one fails or uses up its processor time.  Who
survives is printed, to be judged: the same program, a weaker one that is sound, or a hole in the tests.
"""

from __future__ import annotations

import argparse
import ast
import difflib
import json
import os
import random
import resource
import shutil
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from importlib.util import cache_from_source
from pathlib import Path
from typing import NamedTuple

from tests.campaigns.in_forks import InForks, Question
from tests.campaigns.tests_of_lines import TestsOfLines, in_a_process, recorded

HERE = Path(__file__).resolve().parents[2]
TESTS: Mapping[str, str] = {
    "kernel": "test_kernel_facts test_kernel_reading test_kernel_polynomials test_kernel_enclosures test_kernel_identities"
    " test_kernel_rules test_kernel_boundary test_kernel_pieces test_kernel_edges test_kernel_*"
    " test_homogeneity test_power_share test_smooth_sections test_regions test_kernel test_composition_rules test_tampering test_fan"
    " test_states* test_potentials_of_rates test_forces_of_rates test_heat* test_coupled*"
    " test_false_proofs test_undefined_parts test_product_bounds test_spectrum test_smooth_roots test_profiles test_isotropy"
    " test_concave_profiles test_graphs test_normal_form test_parameter_cells test_smooth_regions test_sect* test_obligations"
    " test_one_domain test_settled_parts test_restrictions test_surfaces regions/test_*",
    "decide": "decide/test_clearing decide/test_rays decide/test_exact_signs"
    " decide/test_degenerate_sets decide/test_deciders decide/test_* test_budget test_cells",
    "methods": "test_methods_formula test_methods_implicit test_methods_flow test_methods_neighbours test_open_answers test_curve_methods"
    " test_homogeneity test_power_share",
}


class Mutant(NamedTuple):
    """A module with one place changed."""

    module: Path
    line: int
    before: str
    after: str

    def diff(self) -> str:
        """The change, line by line."""
        lines = difflib.unified_diff(self.before.splitlines(), self.after.splitlines(), str(self.module), "", lineterm="", n=1)
        return "\n".join(line for line in lines if not line.startswith("+++"))

    def killed(self, tests: TestsOfLines, fails: Question) -> bool | None:
        """Whether one of the tests that run the place fails, or uses up twice its processor time and half a minute.

        None where a run that has begun cannot tell: more differs than the body of functions, or what was made on import stays.
        """
        chosen = tests.of(self.module, self.line)
        if not chosen or (died := fails(self.module, self.after, chosen, self._seconds(chosen, tests))):
            return bool(chosen)
        return None if died is None or tests.run_on_import(self.module, self.line) else False

    def killed_anew(self, tests: TestsOfLines, mark: str) -> bool:
        """The same in a process that starts with the mutant."""
        chosen = tests.of(self.module, self.line)
        self._write(self.after)
        died = in_a_process(chosen, mark, self._seconds(chosen, tests)) != 0
        self._write(self.before)
        return died

    def _seconds(self, chosen: Sequence[str], tests: TestsOfLines) -> int:
        return 30 + 2 * round(sum(tests.seconds[test] for test in chosen))

    def _write(self, text: str) -> None:
        """What was compiled goes: two texts of one size and one second look alike."""
        self.module.write_text(text, encoding="utf-8")
        Path(cache_from_source(self.module)).unlink(missing_ok=True)


def places(modules: Sequence[Path]) -> dict[tuple[Path, tuple[int, int]], list[tuple[str, int]]]:
    """Where Cosmic Ray can change something: by place, the operators and the number of the place among theirs."""
    from cosmic_ray.commands import init
    from cosmic_ray.work_db import WorkDB

    work = WorkDB(":memory:", WorkDB.Mode.create)
    init(modules, work, {})
    found: dict[tuple[Path, tuple[int, int]], list[tuple[str, int]]] = {}
    for item in work.work_items:
        for m in item.mutations:
            found.setdefault((m.module_path, m.start_pos), []).append((m.operator_name, m.occurrence))
    return found


def mutants(modules: Sequence[Path], seed: int) -> Iterator[Mutant]:
    """Mutants in all places, in a random order, one a place; what changes only annotations and docstrings is none."""
    from cosmic_ray.mutating import mutate_code
    from cosmic_ray.plugins import get_operator

    rng, found = random.Random(seed), places(modules)
    for module, start in rng.sample(sorted(found), len(found)):
        operator, occurrence = rng.choice(found[module, start])
        before = module.read_text(encoding="utf-8")
        after = mutate_code(before, get_operator(operator)(), occurrence)
        with suppress(SyntaxError):  # some are no program
            if after is not None and meaning(after) != meaning(before):
                yield Mutant(module, start[0], before, after)


def meaning(code: str) -> str:
    """The program without what it does not do."""
    tree = ast.parse(code)
    for node in ast.walk(tree):
        if isinstance(node, ast.arg | ast.AnnAssign):
            node.annotation = ast.Constant(None)
        if isinstance(node, ast.FunctionDef):
            node.returns = None
    return ast.dump(tree)


def files(room: str) -> list[str]:
    """The test files of a room."""
    found = ([*Path("tests/proof").glob(f"{name}.py"), *Path("tests").glob(f"{name}.py")] for name in TESTS[room].split())
    return list(dict.fromkeys(str(f) for some in found for f in sorted(some)))


def main() -> int:
    """Run the sample; 1 if fewer than 85 % are killed."""
    parser = argparse.ArgumentParser(prog="python -m tests.campaigns.mutation", description=(__doc__ or "").split("\n", 1)[0])
    parser.add_argument("count", type=int, nargs="?", default=200)
    parser.add_argument("--room", action="append", choices=tuple(TESTS), help="only this one; may be repeated")
    parser.add_argument("--module", default="", help="only modules with this in their names")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--slow", action="store_true", help="ask the tests marked slow as well, those of the ordinary run")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as copy:
        for part in ("src", "tests", "pyproject.toml"):
            (shutil.copytree if (HERE / part).is_dir() else shutil.copy)(HERE / part, Path(copy) / part)
        os.chdir(copy)
        sys.path[:0] = [f"{copy}/src", copy]
        sys.dont_write_bytecode = True
        return sample(asked.room or list(TESTS), asked.count, asked.seed, "not long" if asked.slow else "not slow", asked.module)


def sample(rooms: Sequence[str], count: int, seed: int, mark: str, module: str = "") -> int:
    """``count`` mutants, the rooms in turn, of modules with ``module`` in their names."""
    import numpy  # noqa: F401 - what every run needs is imported once, before it forks
    import sympy  # noqa: F401

    paths = {room: [p for p in sorted(Path("src/duhem/proof", room).glob("*.py")) if module in p.stem] for room in rooms}
    drawn = {room: mutants(paths[room], seed) for room in rooms}
    asked = [(r, mutant) for i in range(count) if (mutant := next(drawn[r := rooms[i % len(rooms)]], None)) is not None]
    tests = {room: recorded(files(room), mark, f"src/duhem/proof/{room}", Path(room)) for room in rooms}
    found, out = Path("found.json"), os.fdopen(os.dup(1), "w")  # who runs tests writes elsewhere

    def work(fails: Question) -> None:
        died = list[bool | None]()
        for room, mutant in asked:
            died.append(mutant.killed(tests[room], fails))
            told(room, mutant, died)
        found.write_text(json.dumps(died))

    def told(room: str, mutant: Mutant, died: Sequence[bool | None]) -> None:
        if died[-1:] == [False]:
            print(f"SURVIVED {room}\n{mutant.diff()}\n", file=out, flush=True)
        if died and len(died) % 20 == 0:
            print(f"{died.count(True)} killed, {died.count(False)} not, {died.count(None)} to be asked anew", file=out, flush=True)

    in_a_process([f for room in rooms for f in files(room)], mark, resource.RLIM_INFINITY, lambda: InForks(work))
    dead = list[bool]()
    for (room, mutant), died in zip(asked, json.loads(found.read_text()), strict=True):
        dead.append(mutant.killed_anew(tests[room], mark) if died is None else died)
        told(room, mutant, dead if died is None else ())
    for room in rooms:
        own = [died for (r, _), died in zip(asked, dead, strict=True) if r == room]
        print(f"{room}: {own.count(True)} of {len(own)} killed")
    return int(sum(dead) < 0.85 * len(dead))


if __name__ == "__main__":
    sys.exit(main())
