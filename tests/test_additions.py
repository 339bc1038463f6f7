"""What the layout promises: a law, a word, a decider, a rule of the kernel, a method of projection, a check and a verb are each one new
file or one row a table.

Each is added to a copy of the checkout in which nothing else is edited, and must be taken up everywhere.
"""

from __future__ import annotations

import json
import math
import re
from pathlib import Path

import pytest

from tests.copied_tree import Tree

pytestmark = pytest.mark.slow

# -- a law: one file ---------------------------------------------------------------------------------------------------

LAW = """\
# Friction with tilted axes: g = |(sigma_a + tilt sigma_b, sigma_b)|/mu - |sigma_n|.
#
# Forces: two tangential stresses; pressure sigma_n <= 0 in compression.  Verdicts: every claim holds.  Source: made up.

[criterion]
name = "tilted-ellipse"
summary = "Friction with tilted axes"
source = "made up"
g = "norm(sigma_a + tilt*sigma_b, sigma_b)/mu - abs(sigma_n)"

[parameters]
mu = { positive = true }
tilt = { min = 0, max = 0.5 }
"""


@pytest.fixture(scope="module")
def with_law(tmp_path_factory: pytest.TempPathFactory) -> Tree:
    tree = Tree.copied(tmp_path_factory.mktemp("law"))
    tree.write("src/duhem/law/builtin/tilted-ellipse.toml", LAW)
    return tree


def test_a_law_is_one_file_of_at_most_fifteen_lines() -> None:
    assert len(LAW.splitlines()) <= 15


@pytest.mark.long
def test_a_law_is_listed_and_derived(with_law: Tree) -> None:
    assert "tilted-ellipse" in with_law.run("-m", "duhem", "list")
    assert "tilt" in with_law.run("-m", "duhem", "derive", "tilted-ellipse")


def test_a_law_is_verified(with_law: Tree) -> None:
    report = json.loads(with_law.run("-m", "duhem", "verify", "tilted-ellipse", "--format", "json"))
    assert report["generalized_standard"] is True
    assert report["dissipative"] is True


def test_the_tests_over_all_laws_take_it_up_and_pass(with_law: Tree) -> None:
    said = with_law.run("-m", "pytest", "-p", "no:cacheprovider", "-q", "-k", "tilted-ellipse", "tests/law/test_laws.py")
    passed = re.search(r"(\d+) passed", said)
    assert passed and int(passed[1]) >= 2, said


# -- a word: one entry, and what the kernel is to know of it -----------------------------------------------------------

ERF = """\
_word(
        sp.erf, "error function", "1.1283791670955126 * exp(-{x} * {x})", "-2.0 * {x} * {s}", "1.13 * {e}",
        far=(-1.0, 1.0), increasing=True,
    ),"""
ROWS = {  # file: the row it comes after, the row
    "src/duhem/expression/elementary.py": ('_arc(sp.acos, "arc cosine', ERF),
    "src/duhem/proof/kernel/term.py": ('"abs", "sign", "sqrt"', '"erf",'),  # what the kernel knows of it is what is proved
    "src/duhem/proof/kernel/curvature.py": ('"tanh", "atan",', '"erf",'),
    "tests/expression/by_hand.py": ("sp.tanh:", "sp.erf: (sp.erf(x), -0.9999779095030014),"),
}
LAW_WITH_WORD = """\
[criterion]
name = "disc"
g = "norm(sigma_a, sigma_b) - mu*erf(1 + e)*abs(sigma_n)"

[parameters]
mu = { positive = true }
e = { min = 0, max = 1 }
"""


@pytest.fixture(scope="module")
def with_word(tmp_path_factory: pytest.TempPathFactory) -> Tree:
    tree = Tree.copied(tmp_path_factory.mktemp("word"))
    for file, (after, row) in ROWS.items():
        tree.insert(file, after, row)
    tree.write("disc.toml", LAW_WITH_WORD)
    return tree


def test_a_word_is_given_its_meaning_by_every_interpreter(with_word: Tree) -> None:
    """The tests over all tables find it: a row in each, the value by hand, derivatives against differences."""
    said = with_word.run("-m", "pytest", "-p", "no:cacheprovider", "-q", "tests/expression/test_tables.py", "-k", "erf or table or word")
    passed = re.search(r"(\d+) passed", said)
    assert passed and int(passed[1]) >= 30, said


@pytest.mark.long
def test_a_word_is_read_verified_and_projected(with_word: Tree) -> None:
    report = json.loads(with_word.run("-m", "duhem", "verify", "disc.toml", "--format", "json", "--claims", "origin,convexity"))
    assert {claim["verdict"] for claim in report["claims"]} == {"proved"}
    asked = ("--set", "mu=0.1", "--set", "e=0.5", "--trial", "1", "0", "--pressure", "-1", "--method", "newton", "--format", "json")
    found = json.loads(with_word.run("-m", "duhem", "project", "disc.toml", *asked))
    assert found["stress"] == pytest.approx([0.1 * math.erf(1.5), 0.0], abs=1e-12)


# -- a rule of the kernel: one file and one row ------------------------------------------------------------------------

RULE = '''\
"""K is a ball where g is the length of all forces and something in which there is no force."""

from collections.abc import Mapping
from typing import Any

from duhem.proof.kernel.stated_law import StatedLaw

__all__ = ["ball"]


def ball(law: StatedLaw, _: Mapping[str, Any]) -> bool:
    """Whether g is the sum of norm(f1, ..., fn), with each force once, and of terms without a force."""
    forces = {*law.forces}
    parts = law.g.args if law.g.op == "+" else (law.g,)
    moving = [part for part in parts if part.names() & forces]
    return len(moving) == 1 and moving[0].op == "norm" and sorted(x.name for x in moving[0].args) == sorted(forces)
'''
ROW = '("convexity", "ball"): RuleRow(_NONE, ball, obligations.formula, "K is a ball: g is the length of the forces and a constant"),'


@pytest.mark.long
def test_a_rule_of_the_kernel_proves_is_reported_and_rechecked(tmp_path: Path) -> None:
    tree, claims = Tree.copied(tmp_path), "src/duhem/proof/kernel/claims.py"
    tree.write("src/duhem/proof/kernel/ball.py", RULE)
    tree.insert(claims, "from duhem.proof.kernel import boundary, obligations", "from duhem.proof.kernel.ball import ball")
    tree.insert(claims, "RULES: Mapping", ROW)
    said = tree.run("-m", "duhem", "verify", "coulomb", "--claims", "convexity", "--format", "json", "--certificate", "made.json")
    (found,) = json.loads(said)["claims"]
    assert (found["verdict"], found["trust"], found["method"]) == ("proved", "checked", "ball") and "K is a ball" in found["detail"]
    assert "confirmed" in tree.run("-m", "duhem", "recheck", "made.json")
    (found,) = json.loads(tree.run("-m", "duhem", "verify", "orthotropic", "--claims", "convexity", "--format", "json"))["claims"]
    assert (found["trust"], found["method"]) == ("checked", "composition")


# -- a method of projection: one file and one row ----------------------------------------------------------------------

METHOD = '''\
"""The closest point of a law with one force: where the way from 0 to the trial stress leaves K, by halving."""

import numpy as np

from duhem.expression.jets import formula
from duhem.projection.increment import Increment
from duhem.projection.method import Method, Options
from duhem.projection.result import Solution

__all__ = ["HALVING"]


def applies(question: Increment) -> str | None:
    return None if question.trial.shape[1] == 1 else "it takes laws with one force"


def solve(question: Increment, options: Options) -> Solution:
    law = question.law
    g = formula(question.g, law.force_symbols(), [law.symbols()[law.pressure]] if law.pressure else [])
    given = [question.pressure] if law.pressure else []
    low, high = np.zeros_like(question.trial), np.array(question.trial)
    for _ in range(1100):
        middle = 0.5 * (low + high)
        within = g(middle, given)[0].value[:, None] <= 0
        low, high = np.where(within, middle, low), np.where(within, high, middle)
    stick = g(question.trial, given)[0].value[:, None] <= 0
    stress = np.where(stick, question.trial, low)
    slip = (question.trial - stress) / question.stiffness[0, 0]
    multiplier = (slip / g(stress, given)[0].gradient)[:, 0]
    return Solution(stress, slip, multiplier, np.zeros(len(slip), dtype=bool))


HALVING = Method("halving", applies, solve, Options)
'''
LOADER = """

def _halving() -> Method[Any]:
    from duhem.projection.halving import HALVING

    return HALVING
"""
LINE = ("--set", "mu_plus=0.2", "--set", "mu_minus=0.1")


@pytest.fixture(scope="module")
def with_method(tmp_path_factory: pytest.TempPathFactory) -> Tree:
    tree = Tree.copied(tmp_path_factory.mktemp("method"))
    tree.write("src/duhem/projection/halving.py", METHOD)
    tree.insert("src/duhem/projection/methods.py", "from duhem.projection.method import Method", LOADER)
    tree.insert("src/duhem/projection/methods.py", '"newton": _newton,', '"halving": _halving,')
    return tree


def test_a_method_of_projection_projects(with_method: Tree) -> None:
    asked = ("antoni2007-1d", *LINE, "--trial", "0.7", "--pressure", "-2", "--method", "halving", "--format", "json")
    found = json.loads(with_method.run("-m", "duhem", "project", *asked))
    assert (found["method"], found["status"]) == ("halving", "slip")
    assert found["stress"] == pytest.approx([0.4], rel=1e-15)


@pytest.mark.long
def test_a_method_of_projection_is_measured(with_method: Tree) -> None:
    with_method.run("-m", "duhem", "bench", "antoni2007-1d", *LINE, "--scene", "increment", "--repeats", "1", "--json", "bench.json")
    rows = json.loads((with_method.path / "bench.json").read_text("utf-8"))["rows"]
    assert {row["method"] for row in rows} >= {"closed-form", "halving", "newton"}
    (mine,) = (row for row in rows if row["method"] == "halving")
    assert mine["failure"] is None and mine["error"]["stress"] < 1e-15


# -- a check of the testing kit: one file and one row ------------------------------------------------------------------

CHECK = '''\
"""A slip never needs more stress than the trial: |stress| <= |trial| where zero force is in K."""

import numpy as np

from duhem.testing.checks.query import Query
from duhem.testing.checks.registry import Finding, register

__all__: list[str] = []


@register(
    statement="the stress is no longer than the trial stress",
    formula="|stress| <= |trial|",
    source="made up",
    tolerance="a thousandth of the trial",
)
def nearer(q: Query) -> Finding:
    """The lengths of both."""
    stress, trial = (np.linalg.norm(x, axis=1) for x in (q.here.stress, q.case.trial))
    return Finding(stress, 1.001 * trial)
'''
ROUTINES = """\
import duhem

law = duhem.load("coulomb").fix({"mu": "1/2"})


def right(trial, pressure, stiffness):
    return duhem.project(law, trial, pressure, stiffness).stress


def too_long(trial, pressure, stiffness):
    return 2 * duhem.project(law, trial, pressure, stiffness).stress
"""
RUN = """\
import sys
sys.path.insert(0, ".")
import routines
from duhem.testing import conformance
for each in (routines.right, routines.too_long):
    report = conformance(routines.law, each, checks=["nearer"], max_examples=20)
    print(report.ok, report if not report.ok else "")
"""


@pytest.mark.long
def test_a_check_is_run_of_every_routine_and_told(tmp_path: Path) -> None:
    tree = Tree.copied(tmp_path)
    tree.write("src/duhem/testing/checks/nearer_checks.py", CHECK)
    tree.insert(
        "src/duhem/testing/conformance.py",
        "from duhem.testing.checks import law_checks",
        "from duhem.testing.checks import nearer_checks  # noqa: F401 (it registers)",
    )
    tree.write("routines.py", ROUTINES)
    right, _, wrong = tree.run("-c", RUN).partition("\n")
    assert right == "True " and wrong.startswith("False ") and "the stress is no longer than the trial stress" in wrong


# -- a verb of the command line: one file ------------------------------------------------------------------------------

VERB = '''\
"""``duhem hello``: a law's name."""

from __future__ import annotations

import click

from duhem.cli.arguments import law_argument, read_law
from duhem.cli.output import say

__all__ = ["hello"]


@click.command()
@law_argument
def hello(law: str) -> None:
    """Print the name of LAW."""
    say(read_law(law).name)
'''
TEST_OF_VERB = '''\
"""The name of a law is printed, and what is no law is an error."""

import pytest

from duhem.cli import cli
from duhem.errors import InputError


def test_it_prints_the_name(capsys):
    cli.main(["hello", "orthotropic"], standalone_mode=False)
    assert capsys.readouterr().out == "orthotropic\\n"


def test_what_is_no_law_is_an_error():
    with pytest.raises(InputError, match="no-such-law"):
        cli.main(["hello", "no-such-law"], standalone_mode=False)
'''


def test_a_verb_is_run_listed_completed_and_tested(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    tree = Tree.copied(tmp_path)
    before = tree.run("-m", "duhem", "--help")
    tree.write("src/duhem/cli/verbs/hello.py", VERB)
    tree.write("tests/cli/test_hello.py", TEST_OF_VERB)
    assert tree.run("-m", "duhem", "hello", "coulomb") == "coulomb\n"
    assert "Usage: duhem hello [OPTIONS] LAW\n\n  Print the name of LAW." in tree.run("-m", "duhem", "hello", "--help")
    said = tree.run("-m", "duhem", "--help")
    row = "  hello     Print the name of LAW.\n"
    assert row in said and said.replace(row, "") == before
    passed = re.search(r"(\d+) passed", tree.run("-m", "pytest", "-p", "no:cacheprovider", "-q", "tests/cli/test_hello.py"))
    assert passed and passed[1] == "2"
    for words, offered in (("duhem he", "plain,hello\n"), ("duhem hello ortho", "plain,orthotropic\n")):
        for name, value in {"_DUHEM_COMPLETE": "bash_complete", "COMP_WORDS": words, "COMP_CWORD": str(words.count(" "))}.items():
            monkeypatch.setenv(name, value)
        assert tree.run("-m", "duhem").startswith(offered)
