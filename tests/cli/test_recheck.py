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
    law, table, last = done.stdout.rstrip().split("\n\n")
    rows = [line.split()[1:] for line in table.splitlines()[2:]]
    assert rows == [["proved", "checked", "confirmed"]] * 6 + [["proved", "checked", "by", "construction"]]
    assert last == "confirmed: 6 of 6 proofs; by construction: state_laws"
    assert [" ".join(line.split()) for line in law.splitlines()] == [
        "disc",
        "criterion norm(sigma_a, sigma_b) - mu*abs(sigma_n) <= 0",
        "slip normal to the boundary (associated)",
        "forces sigma_a, sigma_b; pressure sigma_n <= 0, held fixed",
        "parameters 0 < mu",
    ]


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
    assert told({}, smoothness=unruled, state_laws=unruled) == (3, "confirmed: 5 of 7 proofs; without a rule here: 2")
    assert told({}, state_laws={"rule": "symbolic"}) == (0, "confirmed: 6 of 6 proofs; by construction: state_laws")
    code, last = told({"g": "mu*abs(sigma_n) - norm(sigma_a, sigma_b)"}, smoothness=unruled)
    assert code == 1 and "without a rule here: 1; failed: " in last
    none = {"verdict": "undecided", "trust": None, "rule": None, "evidence": {}}
    assert told({}, **dict.fromkeys((row["claim"] for row in made["claims"]), none)) == (0, "the certificate contains no proof")


def forged(made: dict[str, Any], law: dict[str, Any] | None = None, every: dict[str, Any] | None = None, **changes: Any) -> dict[str, Any]:
    """The certificate with some of its law, of every claim and of single claims changed, and the hash that goes with it."""
    from duhem.proof.kernel.certificate import digest

    claims = [row | (every or {}) | changes.get(row["claim"], {}) for row in made["claims"]]
    document = made | {"law": made["law"] | (law or {}), "claims": claims}
    return document | {"sha256": digest(document)}


TURNED = {"g": "mu*abs(sigma_n) - norm(sigma_a, sigma_b)"}  # outside of the disc: nothing but the state laws holds
UNRULED = {"rule": None, "evidence": {}}


@pytest.mark.parametrize("trust", ["prover", "solver"])
def test_a_false_proof_does_not_pass_under_another_label(folder: Path, tmp_path: Path, trust: str) -> None:
    made = json.loads((folder / "disc.json").read_text("utf-8"))
    for every, code in (({"trust": trust}, 1), ({"trust": trust, **UNRULED}, 3)):
        document = forged(made, TURNED, every)
        (tmp_path / "labelled.json").write_text(json.dumps(document), "utf-8")
        done = run("recheck", tmp_path / "labelled.json")
        assert done.return_value == code and " mu*abs(sigma_n) - norm(sigma_a, sigma_b) <= 0" in done.stdout
        found = duhem.recheck(document)
        assert not found.ok and not found.to_dict()["ok"] and not found["convexity"].confirmed
        assert ("convexity" in found.failed, "convexity" in found.without_rule) == (code == 1, code == 3)


@pytest.mark.parametrize(
    "change",
    [
        *({"verdict": verdict} for verdict in ("proved ", "Proved", "PROVED", "prov\u0435d", "true", True, None, ["proved"])),
        *({"verdict": verdict} for verdict in ("tested", "refuted")),
        *({"trust": trust} for trust in ("", "kernel", "Checked", "checked ", None, True, ["checked"], {})),
        *({"method": method} for method in (None, 1, ["composition"], {})),
        *({"claim": claim} for claim in ("convexity ", "Convexity", "", None, "origin", ["convexity"])),
        *({"rule": rule} for rule in (None, 1, True, ["composition"])),
        *({"evidence": evidence} for evidence in (None, [], "x", {"surplus": "1"}, {"potential ": "mu"})),
        {"trust": "prover", "rule": None, "evidence": {"inside": {}, "share": "1"}}, {"surplus": 1}, {"witness": None}, {"seconds": 0.1},
    ],
    ids=repr,
)  # fmt: skip
def test_a_label_that_means_nothing_is_one_clear_error(folder: Path, change: dict[str, Any]) -> None:
    made = json.loads((folder / "disc.json").read_text("utf-8"))
    with pytest.raises(InputError, match=r"cannot be checked: .*make a new one with: duhem verify LAW --certificate FILE"):
        duhem.recheck(forged(made, convexity=change))


@pytest.mark.parametrize(
    ("schema", "words"),
    [
        ("duhem certificate 1", "it is written in version 1 of its form, and version 2 is read here"),
        ("duhem certificate 3", "it is written in version 3 of its form"), ("duhem certificate 2 ", "its schema is not"),
        ("duhem certificate 02", "it is written in version 02"), ("Duhem certificate 2", "its schema is not"), (2, "its schema is not"),
        (None, "its schema is not"), (["duhem certificate 2"], "its schema is not"), ("duhem certificate \u0662", "its schema is not"),
    ],
)  # fmt: skip
def test_another_version_is_refused_with_the_remedy(folder: Path, schema: Any, words: str) -> None:
    made = json.loads((folder / "disc.json").read_text("utf-8")) | {"schema": schema}
    with pytest.raises(InputError, match=f"{words}.*make a new one with: duhem verify LAW --certificate FILE"):
        duhem.recheck(forged(made))


def test_a_surplus_key_is_refused_at_every_level(folder: Path) -> None:
    made = json.loads((folder / "disc.json").read_text("utf-8"))
    law = made["law"]
    several = {key: value for key, value in law.items() if key not in ("g", "flow")}
    others = [
        {**made, "more": 1},
        {**made, "law": {**law, "more": 1}},
        {**made, "law": {**law, "parameters": {"mu": {"positive": True, "more": None}}}},
        {**made, "law": {**law, "flow": {"potential": law["g"], "more": 1}}},
        {**made, "law": {**law, "domain": {"sigma_n": {"min": "-1", "more": None}}}},
        {**made, "law": {**several, "surfaces": [{"g": law["g"], "flow": None, "more": 1}]}},
        {**made, "inhabited": {"mu": "1", "more": "1"}},
        {**made, "law": {**law, "name": 1}},
    ]
    for other in others:
        with pytest.raises(InputError, match="cannot be checked"):
            duhem.recheck(forged(other))


def test_everything_that_the_law_states_is_shown(folder: Path) -> None:
    made = json.loads((folder / "disc.json").read_text("utf-8"))
    law = {
        "name": "disc\x1b[2J", "constraints": ["mu <\n  2"],
        "parameters": {"mu": {"positive": True, "max": "3/2"}, "k": {"min": None, "max": "1"}},
        "flow": {"potential": "sigma_a**2 + 3*sigma_b**2"}, "domain": {"sigma_n": {"min": "-100", "max": None}},
    }  # fmt: skip
    said = duhem.recheck(forged(made | {"inhabited": {"mu": "1", "k": "0"}}, law)).to_text()
    for part in ("0 < mu <= 3/2; k <= 1", "mu < 2", "gradient of sigma_a**2 + 3*sigma_b**2", "-100 <= sigma_n", r"disc\x1b[2J"):
        assert part in said
    assert "\x1b" not in said


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
    assert isinstance(found, InputError) and f"'{key}' occurs twice" in str(found)


@pytest.mark.parametrize("law", ["coulomb", "wedge"])
def test_a_place_that_does_not_exist_is_told_before_the_work(law: str, tmp_path: Path, monkeypatch: Any) -> None:
    from duhem.proof import verification

    monkeypatch.setattr(verification, "verify", lambda *_, **__: pytest.fail("the work began"))
    found = run("verify", law, "--certificate", tmp_path / "no/such/c.json").exception
    assert isinstance(found, InputError) and "directory" in str(found)


def test_a_boundary_curve_has_a_certificate_too(tmp_path: Path) -> None:
    law, file = tmp_path / "oval.toml", tmp_path / "oval.json"
    law.write_text(
        '[criterion]\nname = "oval"\n[boundary]\nT = ["2*cos(phi)", "m*sin(phi)"]\ndirection = ["cos(phi)", "sin(phi)"]\n'
        "[parameters]\nm = { min = 1, max = 3 }\n",
        "utf-8",
    )
    settings = ("--set", "m=3/2")
    assert run("verify", law, *settings, "--claims", "dissipation", "--certificate", file).return_value == 0
    found = run("recheck", file, "--law", law, *settings)
    assert found.return_value == 0 and found.stdout.count(" confirmed") == 3  # the origin and convexity too, which dissipation may rest on
    assert run("recheck", file, "--law", law).return_value == 1


def test_the_checker_imports_nothing_heavy(folder: Path) -> None:
    assert imported("recheck", str(folder / "disc.json")) == set()


def test_python_says_what_the_command_prints(folder: Path) -> None:
    file = folder / "disc.json"
    text = file.read_text("utf-8")
    for given in (file, str(file), text, json.loads(text)):
        done = duhem.recheck(given)
        assert done.ok and done["convexity"].confirmed and done.law["g"] == "norm(sigma_a, sigma_b) - mu*abs(sigma_n)"
        assert run("recheck", file).stdout == done.to_text() + "\n"
    assert repr(done) == "<Recheck: confirmed: 6 of 6 proofs; by construction: state_laws>"
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
        ("{", "certificate: this is no JSON; make a new one with"),
        ({}, "certificate: the certificate cannot be checked"),
        ({"law": {1, 2}}, "certificate: this is no certificate"),
        (7, "certificate: int is no certificate; give a file"),
        ("absent.json", "absent.json: the file cannot be read"),
        ('{"a": 1, "a": 2}', "certificate: the key 'a' occurs twice"),
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
