"""Bad input to the command: exit code 2, one line with place and remedy, no traceback, quickly, nothing executed."""

import os
import re
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

import duhem
from tests.long import mostly_long

SOURCE = Path(duhem.__path__[0]).parent
HEAD = '[criterion]\nname = "x"\n'
G = 'g = "norm(sigma_a/mu_a, sigma_b/mu_b) - abs(sigma_n)"\n'
P = "[parameters]\nmu_a = { positive = true }\nmu_b = { positive = true }\n"
TOUCH = "__import__('pathlib').Path('sentinel').touch()"


def with_g(formula: str) -> str:
    return f'{HEAD}g = """{formula}"""\n{P}'


# name of the case: (content of law.toml, place, words of the message)
FILES: dict[str, tuple[str | bytes, str, str]] = {
    "unknown name": (with_g("norm(sigma_a, sigma_b) - nu*abs(sigma_n)"), "3:33", "unknown name 'nu'"),
    "missing parameter": (HEAD + G + "[parameters]\nmu_a = {}\n", "3:33", "unknown name 'mu_b'"),
    "empty domain": (HEAD + G + "[parameters]\nmu_a = { min = 2, max = 1 }\n", "5:1", "is empty"),
    "contradictory constraints": (HEAD + G + 'constraints = ["mu_a < mu_b", "mu_b < mu_a"]\n' + P, "4:1", "no parameter values"),
    "import": (with_g("__import__('os')"), "3:8", "'__import__' is not a function"),
    "import that acts": (with_g(TOUCH), "3:8", "'__import__' is not a function"),
    "acting constraint": (HEAD + G + f'constraints = ["{TOUCH}"]\n' + P, "4:17", "not a function"),
    "acting flow": (HEAD + G + P + f'[flow]\ndirection = ["sigma_a", "{TOUCH}"]\n', "8:26", "not a function"),
    "attribute": (with_g("sigma_a.__class__.__mro__"), "3:15", "attributes are not part"),
    "literal attribute": (with_g("(1).__class__"), "3:11", "attributes are not part"),
    "tower of powers": (with_g("9**9**9"), "3:8", "exponent is too large"),
    "tower of powers, brackets": (with_g("sigma_a + (9**9)**(9**9)"), "3:18", "exponent is too large"),
    "nested parentheses": (with_g("(" * 100_000 + "sigma_a" + ")" * 100_000), "3:8", "characters"),
    "huge decimal": (with_g("sigma_a - 1e999999999"), "3:18", "too large"),
    "binary file": (bytes(range(256)), "2", "UTF-8"),
    "empty file": ("", "", "empty"),
    "duplicate keys": (HEAD + G + P + "mu_a = {}\n", "7:10", "overwrite"),
    "g without the forces": (HEAD + 'g = "mu_a - abs(sigma_n)"\n' + P, "3:1", "does not depend on any force"),
    "flow of wrong length": (HEAD + G + P + '[flow]\ndirection = ["sigma_a"]\n', "8:1", "1 components for 2 forces"),
    "complex value": (with_g("sqrt(-1)*sigma_a"), "3:8", "not real"),
    "control characters": (with_g("sigma_a + \x7f").replace("\x7f", "\\u001b[31m"), "3:18", "unexpected"),
}  # fmt: skip

ARGUMENTS: dict[str, tuple[list[str], str]] = {
    "unknown parameter": (["verify", "coulomb", "--set", "nu=0.1"], "--set nu=0.1: unknown parameter 'nu'"),
    "value outside the domain": (["verify", "coulomb", "--set", "mu=-1"], "--set mu=-1: mu = -1 lies outside its domain"),
    "value against a constraint": (["verify", "limacon", "--set", "e=1"], "--set e=1: no parameter values"),
    "value that is no number": (["verify", "coulomb", "--set", "mu=__import__('os')"], "is not a number"),
    "setting without a value": (["verify", "coulomb", "--set", "mu"], "not of the form NAME=VALUE"),
    "parameter set twice": (["verify", "coulomb", "--set", "mu=1", "--set", "mu=2"], "mu is set twice"),
    "unknown claim": (["verify", "coulomb", "--claims", "convexity,beauty"], "unknown claim 'beauty'"),
    "no claim": (["verify", "coulomb", "--claims", ","], "no claim is named"),
    "unknown axis": (["stress", "coulomb", "--set", "mu=0.3", "--axis", "lod"], "--axis: unknown axis 'lod'; did you mean 'load'?"),
    "unlike any axis": (["stress", "coulomb", "--set", "mu=0.3", "--axis", "qq"], "--axis: unknown axis 'qq'; axes are: load, "),
    "unknown law": (["verify", "colomb"], "unknown law 'colomb'; did you mean coulomb"),
    "file that is not there": (["verify", "none.toml"], "none.toml: there is no such file"),
    "directory": (["verify", "."], "this is a directory"),
    "unknown law to derive": (["derive", "colomb"], "unknown law 'colomb'"),
    "unknown claim to explain": (["explain", "beauty"], "unknown claim 'beauty'"),
    "name that is no name": (["init", "a/b"], "cannot name a law"),
}


Run = Callable[..., tuple[int, str, str]]
Refused = Callable[..., str]
PROCESSES = ("import that acts", "binary file", "unknown law")  # these through a process of their own too: its start, its streams


def checked(code: int, out: str, message: str) -> str:
    """The one line on standard error of a command that must be refused."""
    assert (code, out) == (2, "")
    assert re.fullmatch(r"duhem: [^\n]+\n", message), message
    assert message[:-1].isprintable()
    assert "; " in message, "no remedy"
    return message


@pytest.fixture
def complaint(run: Run, monkeypatch: pytest.MonkeyPatch) -> Refused:
    """What the command says, run in a folder, within two seconds of processor time."""

    def call(folder: Path, *arguments: str) -> str:
        monkeypatch.chdir(folder)
        start = time.process_time()  # unlike wall time it does not depend on what else runs
        done = run(*arguments)
        assert time.process_time() - start < 2
        return checked(*done)

    return call


def complaint_of_a_process(folder: Path, *arguments: str) -> str:
    """The same of a process of its own, start included."""
    before = children_seconds()
    command, environment = [sys.executable, "-m", "duhem", *arguments], os.environ | {"PYTHONPATH": str(SOURCE)}
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=60)
    assert children_seconds() - before < 2
    return checked(done.returncode, done.stdout, done.stderr)


def children_seconds() -> float:
    """Processor time of the processes that have ended."""
    times = os.times()
    return times.children_user + times.children_system


def refused_file(case: str, folder: Path, complaint: Refused) -> None:
    content, place, words = FILES[case]
    (folder / "law.toml").write_bytes(content if isinstance(content, bytes) else content.encode())
    message = complaint(folder, "verify", "law.toml")
    assert message.startswith(f"duhem: law.toml:{place}: " if place else "duhem: law.toml: ")
    assert words in message
    assert os.listdir(folder) == ["law.toml"], "something was executed"


def refused_arguments(case: str, folder: Path, complaint: Refused) -> None:
    arguments, words = ARGUMENTS[case]
    assert words in complaint(folder, *arguments)
    assert os.listdir(folder) == [], "something was executed"


@pytest.mark.parametrize("case", FILES)
def test_file(case: str, tmp_path: Path, complaint: Refused) -> None:
    refused_file(case, tmp_path, complaint)


@pytest.mark.parametrize("case", ARGUMENTS)
def test_arguments(case: str, tmp_path: Path, complaint: Refused) -> None:
    refused_arguments(case, tmp_path, complaint)


@pytest.mark.long
@pytest.mark.parametrize("case", mostly_long(PROCESSES, "import that acts"))
def test_in_a_process_of_its_own(case: str, tmp_path: Path) -> None:
    (refused_file if case in FILES else refused_arguments)(case, tmp_path, complaint_of_a_process)


def test_the_sentinel_would_show_an_execution(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    eval(TOUCH)
    assert os.listdir(tmp_path) == ["sentinel"]
