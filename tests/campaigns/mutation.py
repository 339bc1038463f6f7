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
import os
import random
import shutil
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from tests.campaigns.tests_of_lines import TestsOfLines, in_a_process, recorded

HERE = Path(__file__).resolve().parents[2]
TESTS: Mapping[str, str] = {
    "kernel": "test_kernel_facts test_kernel_reading test_kernel_polynomials test_kernel_enclosures test_kernel_identities"
    " test_kernel_rules test_kernel_boundary test_kernel_pieces test_kernel_edges test_kernel_*"
    " test_homogeneity test_power_share test_smooth_sections test_regions test_kernel test_composition_rules test_tampering test_fan"
    " test_states* test_potentials_of_rates test_heat* test_coupled*"
    " test_false_proofs test_undefined_parts test_product_bounds test_spectrum test_smooth_roots test_profiles test_isotropy"
    " test_concave_profiles test_graphs test_normal_form test_parameter_cells",
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

    def killed(self, tests: TestsOfLines, marks: str) -> bool:
        """Whether one of the tests that run the place fails, or uses up twice its processor time and half a minute."""
        chosen = tests.of(self.module, self.line)
        limit = 30 + 2 * round(sum(tests.seconds[test] for test in chosen))
        self.module.write_text(self.after, encoding="utf-8")
        died = bool(chosen) and in_a_process(chosen, marks, limit) != 0
        self.module.write_text(self.before, encoding="utf-8")
        return died


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
    return list(dict.fromkeys(str(f) for name in TESTS[room].split() for f in sorted(Path("tests/proof").glob(f"{name}.py"))))


def main() -> int:
    """Run the sample; 1 if fewer than 85 % are killed."""
    parser = argparse.ArgumentParser(prog="python -m tests.campaigns.mutation", description=(__doc__ or "").split("\n", 1)[0])
    parser.add_argument("count", type=int, nargs="?", default=200)
    parser.add_argument("--room", action="append", choices=tuple(TESTS), help="only this one; may be repeated")
    parser.add_argument("--module", default="", help="only modules with this in their names")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument(
        "--slow", action="store_true", help="ask the tests marked slow as well, those of the ordinary run, where the others pass"
    )
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as copy:
        for part in ("src", "tests", "pyproject.toml"):
            (shutil.copytree if (HERE / part).is_dir() else shutil.copy)(HERE / part, Path(copy) / part)
        os.chdir(copy)
        sys.path[:0] = [f"{copy}/src", copy]
        sys.dont_write_bytecode = True
        marks = ("not slow", "slow and not long") if asked.slow else ("not slow",)
        return sample(asked.room or list(TESTS), asked.count, asked.seed, marks, asked.module)


def sample(rooms: Sequence[str], count: int, seed: int, marks: Sequence[str], module: str = "") -> int:
    """``count`` mutants, the rooms in turn, of modules with ``module`` in their names."""
    import numpy  # noqa: F401 - what every run needs is imported once, before it forks
    import sympy  # noqa: F401

    drawn = {room: mutants([p for p in sorted(Path("src/duhem/proof", room).glob("*.py")) if module in p.stem], seed) for room in rooms}
    tests = {
        (r, mark): recorded(files(r), mark, f"src/duhem/proof/{r}", Path(f"{r}-{mark}".replace(" ", "-"))) for r in rooms for mark in marks
    }
    dead = dict.fromkeys(rooms, 0)
    asked = dict.fromkeys(rooms, 0)
    for i in range(count):
        room = rooms[i % len(rooms)]
        if (mutant := next(drawn[room], None)) is None:
            continue
        died = any(mutant.killed(tests[room, mark], mark) for mark in marks)
        asked[room] += 1
        dead[room] += died
        if not died:
            print(f"SURVIVED {room}\n{mutant.diff()}\n", flush=True)
        if (i + 1) % 20 == 0:
            print(", ".join(f"{room}: {dead[room]} of {asked[room]} killed" for room in rooms), flush=True)
    for room in rooms:
        print(f"{room}: {dead[room]} of {asked[room]} killed")
    return int(sum(dead.values()) < 0.85 * sum(asked.values()))


if __name__ == "__main__":
    sys.exit(main())
