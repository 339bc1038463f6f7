"""``duhem verify --certificate`` and ``duhem recheck``: proofs that travel as a file and are checked by the kernel alone."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner, Result

import duhem
from duhem import InputError
from duhem.cli import cli
from tests.cli.test_imports import imported

LAW = """\
[criterion]
name = "disc"
g = "norm(sigma_a, sigma_b) - mu*abs(sigma_n)"
[parameters]
mu = { positive = true }
"""


def run(*arguments: object) -> Result:
    return CliRunner().invoke(cli, [str(a) for a in arguments], standalone_mode=False)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A law and its certificate."""
    here = tmp_path_factory.mktemp("certified")
    (here / "disc.toml").write_text(LAW, "utf-8")
    assert run("verify", here / "disc.toml", "--certificate", here / "disc.json").return_value == 0
    return here


def test_every_proof_of_the_law_is_confirmed(folder: Path) -> None:
    done = run("recheck", folder / "disc.json", "--law", folder / "disc.toml")
    assert done.return_value == 0
    *rows, empty, last = done.stdout.splitlines()[2:]
    assert [line.split()[1:] for line in rows] == [["proved", "confirmed"]] * 7
    assert (empty, last) == ("", "confirmed: 7 of 7 proofs")


def test_the_last_line_counts_what_is_confirmed_what_has_no_rule_and_what_fails(folder: Path, tmp_path: Path) -> None:
    from duhem.proof.kernel.certificate import digest

    made = json.loads((folder / "disc.json").read_text("utf-8"))

    def told(law: dict[str, Any], **changes: dict[str, Any]) -> tuple[int, str]:
        claims = [row | changes.get(row["claim"], {}) for row in made["claims"]]
        document = made | {"law": made["law"] | law, "claims": claims}
        (tmp_path / "other.json").write_text(json.dumps(document | {"sha256": digest(document)}), "utf-8")
        done = run("recheck", tmp_path / "other.json")
        return done.return_value, done.stdout.splitlines()[-1]

    unruled = {"trust": "prover", "rule": None, "evidence": {}}
    assert told({}, smoothness=unruled, state_laws=unruled) == (0, "confirmed: 5 of 7 proofs; without a rule here: 2")
    code, last = told({"g": "mu*abs(sigma_n) - norm(sigma_a, sigma_b)"}, smoothness=unruled)
    assert code == 1 and "without a rule here: 1; failed: " in last
    none = {"verdict": "undecided", "trust": None, "rule": None, "evidence": {}}
    assert told({}, **dict.fromkeys((row["claim"] for row in made["claims"]), none)) == (0, "there is no proof in it")


def test_the_formula_in_it_is_the_one_that_was_written(folder: Path) -> None:
    assert json.loads((folder / "disc.json").read_text("utf-8"))["law"]["g"] == "norm(sigma_a, sigma_b) - mu*abs(sigma_n)"


def test_another_law_or_other_values_are_told(folder: Path) -> None:
    for other in (("coulomb",), (folder / "disc.toml", "--set", "mu=0.3")):
        done = run("recheck", folder / "disc.json", "--law", *other)
        assert done.return_value == 1
        assert "another law" in done.stdout


def test_a_proof_that_is_called_checked_and_is_not_ends_with_1(folder: Path, tmp_path: Path) -> None:
    from duhem.proof.kernel.certificate import digest

    document = json.loads((folder / "disc.json").read_text("utf-8"))
    document["law"]["g"] = "mu*abs(sigma_n) - norm(sigma_a, sigma_b)"
    (tmp_path / "turned.json").write_text(json.dumps(document | {"sha256": digest(document)}), "utf-8")
    done = run("recheck", tmp_path / "turned.json")
    assert done.return_value == 1
    assert "composition" in done.stdout


@pytest.mark.parametrize(
    ("content", "message"),
    [("", "no JSON"), ("[]", "no certificate"), ("{}", "no certificate"), ("[" * 100_000, "no JSON"), ('{"schema": 1}', "schema")],
)
def test_what_is_no_certificate_is_an_error(tmp_path: Path, content: str, message: str) -> None:
    (tmp_path / "file.json").write_text(content, "utf-8")
    found = run("recheck", tmp_path / "file.json").exception
    assert isinstance(found, InputError) and message in str(found)


def test_a_changed_byte_is_an_error(folder: Path, tmp_path: Path) -> None:
    text = (folder / "disc.json").read_text("utf-8").replace('"positive": true', '"positive": false')
    (tmp_path / "changed.json").write_text(text, "utf-8")
    found = run("recheck", tmp_path / "changed.json").exception
    assert isinstance(found, InputError) and "hash" in str(found) and "schema" not in str(found)


@pytest.mark.parametrize("claims", [[], {}, ""], ids=repr)
def test_a_certificate_of_nothing_is_none(folder: Path, tmp_path: Path, claims: object) -> None:
    from duhem.proof.kernel.certificate import digest

    document = json.loads((folder / "disc.json").read_text("utf-8")) | {"claims": claims}
    (tmp_path / "empty.json").write_text(json.dumps(document | {"sha256": digest(document)}), "utf-8")
    found = run("recheck", tmp_path / "empty.json").exception
    assert isinstance(found, InputError) and "no list of claims" in str(found)


@pytest.mark.parametrize("key", ["g", "claims", "positive"])
def test_a_key_that_is_there_twice_is_an_error(folder: Path, tmp_path: Path, key: str) -> None:
    """A reader may see the first of two values, the check the last."""
    text = (folder / "disc.json").read_text("utf-8")
    assert f'"{key}":' in text
    (tmp_path / "twice.json").write_text(text.replace(f'"{key}":', f'"{key}": "another", "{key}":', 1), "utf-8")
    found = run("recheck", tmp_path / "twice.json").exception
    assert isinstance(found, InputError) and f"'{key}' is there twice" in str(found)


@pytest.mark.parametrize("law", ["coulomb", "wedge"])
def test_a_place_that_does_not_exist_is_told_before_the_work(law: str, tmp_path: Path, monkeypatch: Any) -> None:
    from duhem.proof import verification

    monkeypatch.setattr(verification, "verify", lambda *_, **__: pytest.fail("the work began"))
    found = run("verify", law, "--certificate", tmp_path / "no/such/c.json").exception
    assert isinstance(found, InputError) and "directory" in str(found)


@pytest.mark.slow
def test_a_boundary_curve_has_a_certificate_too(tmp_path: Path) -> None:
    file = tmp_path / "wedge.json"
    settings = [part for name in ("tan_alpha=1", "tan_beta=1/4", "mu_alpha=1/4", "mu_beta=1/4") for part in ("--set", name)]
    assert run("verify", "wedge", *settings, "--claims", "convexity,dissipation", "--certificate", file).return_value == 0
    found = run("recheck", file, "--law", "wedge", *settings)
    assert found.return_value == 0 and found.stdout.count(" confirmed") == 3  # the origin too, which dissipation may rest on
    assert run("recheck", file, "--law", "wedge").return_value == 1


def test_the_checker_imports_nothing_heavy(folder: Path) -> None:
    assert imported("recheck", str(folder / "disc.json")) == set()


def test_python_says_what_the_command_prints(folder: Path) -> None:
    file = folder / "disc.json"
    text = file.read_text("utf-8")
    for given in (file, str(file), text, json.loads(text)):
        done = duhem.recheck(given)
        assert done.ok and done["convexity"].confirmed and done.law["g"] == "norm(sigma_a, sigma_b) - mu*abs(sigma_n)"
        assert run("recheck", file).stdout == done.to_text() + "\n"
    assert repr(done) == "<Recheck: confirmed: 7 of 7 proofs>"
    assert json.loads(json.dumps(done.to_dict())) == done.to_dict() and done.to_dict()["claims"][0]["confirmed"]
    made = duhem.verify(folder / "disc.toml").certificate(folder / "again.json")
    assert (folder / "again.json").read_bytes() == file.read_bytes() and json.loads(json.dumps(made)) == json.loads(text)


def test_python_sees_what_does_not_hold(folder: Path) -> None:
    from duhem.proof.kernel.certificate import digest

    made = json.loads((folder / "disc.json").read_text("utf-8"))
    forged = made | {"law": made["law"] | {"g": "mu*abs(sigma_n) - norm(sigma_a, sigma_b)"}}
    done = duhem.recheck(forged | {"sha256": digest(forged)})
    assert not done.ok and not done["convexity"].confirmed and done["convexity"].reason
    assert done["state_laws"].confirmed


@pytest.mark.parametrize(
    ("given", "what"),
    [
        ("{", "certificate: this is no JSON; make one with"),
        ({}, "certificate: the certificate cannot be checked"),
        ({"law": {1, 2}}, "certificate: this is no certificate"),
        (7, "certificate: int is no certificate; give a file"),
        ("absent.json", "absent.json: the file cannot be read"),
        ('{"a": 1, "a": 2}', "certificate: the key 'a' is there twice"),
    ],
)
def test_what_is_no_certificate_is_one_error(given: Any, what: str) -> None:
    with pytest.raises(InputError) as fault:
        duhem.recheck(given)
    assert str(fault.value).startswith(what)


def test_python_rechecks_with_the_kernel_alone(folder: Path) -> None:
    heavy = "{'sympy', 'numpy', 'mpmath', 'flint', 'z3', 'scipy', 'duhem.law', 'duhem.expression'}"
    asked = f"import sys, duhem; assert duhem.recheck({str(folder / 'disc.json')!r}).ok; print({heavy} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", asked], capture_output=True, text=True, timeout=60)
    assert (done.stdout, done.stderr) == ("set()\n", "")


@pytest.mark.parametrize("name", ["", "  "])
def test_no_name_of_a_file_is_said_to_be_none(name: str) -> None:
    with pytest.raises(InputError, match="no file is named"):
        duhem.recheck(name)
    with pytest.raises(InputError, match="no file is named"):
        CliRunner().invoke(cli, ["recheck", name], standalone_mode=False, catch_exceptions=False)
