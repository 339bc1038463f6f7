"""The campaign of changed inputs, a small part of it, and that it sees what must not be."""

import os
import subprocess
import sys
from pathlib import Path
from random import Random

import pytest

from tests.campaigns import inputs
from tests.long import mostly_long

ROOT = Path(__file__).parents[2]
KINDS = ("files", "scenes", "tables", "settings")
WRONG = {  # what a command might do: what is said of it
    "4": "it ended with 4",
    "0 if open('law.toml', 'w').close() else 1": "law.toml was written",
    "0 if open('new.csv', 'w').close() else 1": "new.csv was written",
    "0 if open(WHERE, 'w').close() else 1": "for writing",
    "0 if (sys.path.insert(0, '.'), __import__('acts')) else 1": "it imported acts",
    "os.system('true')": "it called os.system",
    "os.kill(os.getpid(), 9)": "it died of -9",
    "len(bytearray(600_000_000)) * 0": "MB",
    "2": "it says nothing",
    "2 if sys.stderr.write('Traceback\\n') else 0": "more than its own lines",
}


def process(*arguments: str) -> str:
    """What a process of its own prints: forking is for one that has no threads."""
    environment = os.environ | {"PYTHONPATH": os.pathsep.join((str(ROOT / "src"), str(ROOT)))}
    done = subprocess.run([sys.executable, *arguments], cwd=ROOT, env=environment, capture_output=True, text=True, timeout=300)
    assert not done.stderr, done.stderr
    return done.stdout


def test_the_same_seed_makes_the_same_cases() -> None:
    counts = {"file": 20, "scene": 20, "table": 20, "setting": 20}
    first, second = (list(inputs.cases(counts, Random(7))) for _ in range(2))
    assert first == second
    assert len({(case.arguments, tuple(case.files.items())) for case in first}) > 70


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(os, "fork"), reason="processes are forked")
@pytest.mark.parametrize("count", mostly_long(["3", "10"], "3"))
def test_changed_inputs_are_answered_or_refused(count: str) -> None:
    found = process("-m", "tests.campaigns.inputs", *(x for k in KINDS for x in (f"--{k}", count)), "--seed", "5")
    assert found.endswith("nothing that must not be\n"), found


@pytest.mark.long
@pytest.mark.skipif(not hasattr(os, "fork"), reason="processes are forked")
def test_what_must_not_be_is_seen(tmp_path: Path) -> None:
    lines = [f"show(lambda: {deed})" for deed in WRONG]
    code = (
        "import os, sys\nfrom tests.campaigns.inputs import Case, outcome, prepare\nprepare()\n"
        f"WHERE = {str(tmp_path / 'outside')!r}\n"
        "def show(command):\n"
        "    print('; '.join(outcome(Case('file', ('verify',), {'law.toml': b'x'}), command=command).faults).replace('\\n', ' '))\n"
    )
    found = process("-c", code + "\n".join(lines)).splitlines()
    for said, (deed, words) in zip(found, WRONG.items(), strict=True):
        assert words in said, (deed, said)
