"""The pytest plugin as its users meet it: small projects, each run in this process as pytest would run it."""

from __future__ import annotations

import json
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest

import duhem_pytest
from duhem.api import histories, increments
from duhem.cli.verbs.test import test as command
from duhem.testing import in_pytest  # what a run imports and would forget at its end
from duhem.testing.in_pytest import PROFILES

pytest_plugins = ["pytester"]
IMPORTED = (duhem_pytest, in_pytest, histories, increments)

HEAD = """\
import numpy as np
import pytest

MARK = {"law": "coulomb", "parameters": {"mu": 0.5}, "pressure": -1.0, "stiffness": 1.0, "max_examples": 2, "rows": 5, "tries": 20}

def right(trial, pressure, stiffness):
    size = np.hypot(*trial.T)
    return trial / np.maximum(size / 0.5, 1.0)[:, None]

"""


def tried(pytester: pytest.Pytester, *arguments: str) -> pytest.RunResult:
    """As an installed plugin is, whether it is installed or not."""
    given = ("-p", "no:duhem", "-W", "error", "--strict-markers", "-q", "-rA", *arguments)
    return pytester.runpytest_inprocess(*given, plugins=[duhem_pytest])


@pytest.mark.slow
def test_a_routine_is_a_node_a_check(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(
        test_friction=HEAD
        + """
CHECKS = ["answers", "feasibility", "idempotence", "variational-inequality", "slip"]
KNOWN = {"variational-inequality": "the slip is reversed on purpose", "feasibility": "thought to fail"}

@pytest.mark.duhem(checks=CHECKS, expected_failed_checks=KNOWN, **MARK)
def update(trial, pressure, stiffness):
    return right(trial, pressure, stiffness)[:, ::-1] * 0.5

@pytest.mark.duhem(checks="feasibility", **MARK)
def stick(trial, pressure, stiffness):
    return trial

@pytest.fixture
def made():
    return right

@pytest.mark.parametrize("number", [3, 4])
@pytest.mark.duhem(checks=["feasibility", "slip"], **MARK)
def test_made(duhem_check, made, number):
    assert duhem_check(made).ok

@pytest.mark.duhem(checks="feasibility", **MARK)
@pytest.mark.skip("not today")
def later(trial, pressure, stiffness):
    raise AssertionError

@pytest.mark.duhem(law=None, checks=["dissipation", "vacuity"], pressure=-1.0, stiffness=np.eye(2), max_examples=2, rows=5)
def lawless(trial, pressure, stiffness):
    return right(trial, pressure, stiffness)

class TestMethods:
    @staticmethod
    @pytest.mark.duhem(checks="feasibility", **MARK)
    def plain(trial, pressure, stiffness):
        return right(trial, pressure, stiffness)

    @pytest.mark.duhem(checks="feasibility", **MARK)
    def bound(self, trial, pressure, stiffness):
        return right(trial, pressure, stiffness)
"""
    )
    done = tried(pytester, "--junitxml=junit.xml")
    done.assert_outcomes(passed=14, failed=3, skipped=5, xfailed=1)
    name = "test_friction.py::"
    done.stdout.fnmatch_lines_random(
        [
            f"PASSED {name}update[[]answers]",
            f"FAILED {name}update[[]idempotence]*",
            f"XFAIL {name}update[[]variational-inequality] - *the slip is reversed on purpose",
            f"FAILED {name}update[[]feasibility]*",
            "*feasibility passes, but was expected to fail: thought to fail; remove it from expected_failed_checks",
            f"PASSED {name}update[[]flagged]",
            f"FAILED {name}stick[[]feasibility]*",
            f"PASSED {name}test_made[[]feasibility-3]",
            f"PASSED {name}lawless[[]dissipation]",
            f"PASSED {name}TestMethods::bound[[]feasibility]",
            f"PASSED {name}TestMethods::plain[[]flagged]",
        ]
    )
    found = properties(pytester.path / "junit.xml")
    assert found["update[answers]"]["duhem_verdict"] == "tested"  # drawn cases never prove
    assert found["stick[feasibility]"]["duhem_verdict"] == "refuted"
    witness = json.loads(found["stick[feasibility]"]["duhem_witness"])
    assert sum(x * x for x in witness["trial"][0]) > 0.25 * (1.0 + 1e-9)


def properties(file: Path) -> dict[str, dict[str, str]]:
    """Of each test by its name, as JUnit has them."""
    cases = ElementTree.parse(file).iter("testcase")
    return {case.get("name", ""): {p.get("name", ""): p.get("value", "") for p in case.iter("property")} for case in cases}


def test_a_routine_that_does_not_come_back_fails_and_stops_no_other_test(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(
        test_friction=HEAD
        + """
from duhem.testing.routines import Unfinished

@pytest.mark.duhem(law=None, checks=["dissipation", "vacuity"], pressure=-1.0, stiffness=np.eye(2), max_examples=2, rows=5)
def endless(trial, pressure, stiffness):
    raise Unfinished("it has not answered", where="endless", remedy="end its loop")

def test_after():
    pass
"""
    )
    done = tried(pytester)
    done.assert_outcomes(failed=3, passed=1)
    done.stdout.fnmatch_lines(["*it has not answered*"])


def test_what_an_expected_failure_explains_is_expected_whatever_is_selected(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(
        test_friction=HEAD
        + """
@pytest.mark.duhem(checks=["feasibility", "variational-inequality"], expected_failed_checks={"feasibility": "no return"}, **MARK)
def update(trial, pressure, stiffness):
    return trial * 2.0
"""
    )
    done = tried(pytester, "-k", "inequality")
    done.assert_outcomes(xfailed=1, deselected=2)
    done.stdout.fnmatch_lines(["XFAIL *update[[]variational-inequality] - likely for the same reason as [[]feasibility]"])


@pytest.mark.slow
def test_a_routine_expected_to_fail_fails_one_check_at_least(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(
        test_friction=HEAD
        + """
def marked(mark, factor):
    def update(trial, pressure, stiffness):
        return factor * right(trial, pressure, stiffness)
    return mark(pytest.mark.duhem(checks=["answers", "feasibility"], **MARK)(update))

wrong = marked(pytest.mark.xfail(reason="too strong"), 2.0)
strict = marked(pytest.mark.xfail(reason="too strong", strict=True), 2.0)
right_after_all = marked(pytest.mark.xfail(reason="too strong"), 1.0)
told = marked(pytest.mark.xfail(reason="too strong", strict=True), 1.0)
elsewhere = marked(pytest.mark.xfail(False, reason="too strong"), 2.0)
never = marked(pytest.mark.xfail(reason="too slow", run=False), 2.0)
"""
    )
    done = tried(pytester)
    done.assert_outcomes(passed=6, failed=4, xfailed=5, xpassed=3)
    done.stdout.fnmatch_lines_random(
        ["XFAIL *wrong[[]feasibility]*", "PASSED *strict[[]flagged]", "XPASS *right_after_all[[]flagged]*", "FAILED *told[[]answers]*"]
    )


def test_the_cases_are_drawn_once_and_only_for_what_is_selected(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(
        HEAD
        + """
from hypothesis.strategies import just

@pytest.mark.duhem(checks=["feasibility", "idempotence", "stiffness-scale"], every=1, **{**MARK, "stiffness": just(np.eye(2))})
def update(trial, pressure, stiffness):
    with open("calls", "a") as stream:
        stream.write("x" if stiffness[0, 0] == 1.0 else "s")
    return right(trial, pressure, stiffness)
"""
    )
    pytester.makeconftest(  # what --dist loadgroup goes by
        """
def pytest_collection_modifyitems(items):
    assert {mark.args for item in items for mark in item.iter_markers("xdist_group")} == {(items[0].nodeid.split("[")[0],)}
"""
    )
    tried(pytester, "-k", "feasibility").assert_outcomes(passed=1, deselected=3)
    alone = (pytester.path / "calls").read_text("utf-8")
    (pytester.path / "calls").unlink()
    tried(pytester).assert_outcomes(passed=4)
    together = (pytester.path / "calls").read_text("utf-8")
    assert "s" not in alone and together.count("s") >= 2
    assert together.count("x") <= 2 * len(alone) + 2  # the answers to a case serve feasibility and idempotence, which asks one more


@pytest.mark.slow
def test_what_failed_is_kept_and_tried_first(pytester: pytest.Pytester) -> None:
    routine = """
from pathlib import Path

@pytest.mark.duhem(checks="feasibility", **MARK)
def update(trial, pressure, stiffness):
    if not Path("NAME.npy").exists():
        np.save("NAME.npy", trial)
    return ANSWER
"""
    wrong = routine.replace("ANSWER", "trial")
    pytester.makepyfile(test_it=HEAD + wrong.replace("NAME", "before"))
    tried(pytester).assert_outcomes(passed=1, failed=1)
    (kept,) = (pytester.path / ".pytest_cache" / "v" / "duhem" / "cases").iterdir()
    case = json.loads(kept.read_text("utf-8"))["feasibility"]
    pytester.makepyfile(test_it=HEAD + wrong.replace("NAME", "after"))
    tried(pytester, "--lf").assert_outcomes(failed=1)
    before, after = (np.load(pytester.path / f"{name}.npy") for name in ("before", "after"))
    rows = [*case["trial"], *case["other"], *case["third"]]  # the case is asked first, with what belongs to it and without any other
    assert len(before) > len(after) and after.tolist()[: len(rows)] == rows
    pytester.makepyfile(test_it=HEAD + routine.replace("ANSWER", "right(trial, pressure, stiffness)"))
    tried(pytester).assert_outcomes(passed=2)
    assert json.loads(kept.read_text("utf-8")) == {}


def test_a_routine_that_flags_too_much(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(
        HEAD
        + """
from duhem.testing import Step

@pytest.mark.duhem(checks="feasibility", **MARK)
@pytest.mark.duhem(checks="feasibility", most_flagged=1.0, **(MARK | {"law": "orthotropic", "parameters": {"mu_a": 0.5, "mu_b": 0.5}}))
def update(trial, pressure, stiffness):
    return Step(trial, solved=np.zeros(len(trial), dtype=bool))
"""
    )
    done = tried(pytester, "-p", "no:cacheprovider", "--junitxml=junit.xml")
    done.assert_outcomes(passed=1, failed=1, skipped=2)
    found = properties(pytester.path / "junit.xml")
    bounded = {name: (case["duhem_verdict"], case["duhem_most_flagged"]) for name, case in found.items() if name.endswith("-flagged]")}
    assert bounded == {"update[coulomb-flagged]": ("refuted", "0"), "update[orthotropic-flagged]": ("tested", "1")}
    many = found["update[coulomb-flagged]"]["duhem_flagged"].split(" of ")
    assert many[0] == many[1] != "0"
    done.stdout.fnmatch_lines_random(["PASSED *::update[[]orthotropic-flagged]", "FAILED *::update[[]coulomb-flagged]*"])
    done.stdout.fnmatch_lines(["*update[[]coulomb] flags * increments as not solved, more than the allowed fraction 0"])


WRONG = {
    "": "the marker duhem names no law; write for example @pytest.mark.duhem(law=",
    'law="coulom"': "unknown law 'coulom'; did you mean coulomb?",
    'law="coulomb", checks="feasible"': "unknown check 'feasible'; did you mean 'feasibility'[?] choose one of *",
    'law="coulomb", tolerance=1': "the marker duhem takes no 'tolerance'; it takes law, *",
    'law="coulomb", parameters={"nu": 1}': "*nu*",
    'law="coulomb", checks="slip", expected_failed_checks={"ray": "?"}': "ray is expected to fail, but is not selected; name it in checks",
    'law="coulomb", checks=[]': "checks: no check is selected; *",
    'law="coulomb", checks=[3]': "checks: 3 is no check; *",
    'law="coulomb", expected_failed_checks=["slope"]': "expected_failed_checks: [[]'slope'[]] does not map checks to reasons; *",
    'law="coulomb", most_flagged="all"': "most_flagged: 'all' is not a fraction; give a number from 0 to 1, *",
    'law="coulomb", pressure=1.0': "pressure: sigma_n = 1.0 is positive; sigma_n <= 0 in compression: *",
    "law=None, stiffness=[[1.0, 2.0], [2.0, 1.0]]": "stiffness: the matrix is not positive definite; *",
    'law="coulomb"': "it takes (), but an update routine takes (trial, pressure, stiffness); use the fixture duhem_check *",
}


@pytest.mark.slow
@pytest.mark.parametrize("given", WRONG)
def test_a_marker_that_cannot_be_used_is_one_line(pytester: pytest.Pytester, given: str) -> None:
    pytester.makepyfile(test_it=f"import pytest\n\n@pytest.mark.duhem({given})\ndef update(): ...\n")
    done = tried(pytester)
    done.assert_outcomes(errors=1)
    lines = done.stdout.lines
    (at,) = (i for i, line in enumerate(lines) if line.startswith("___"))
    assert pytest.LineMatcher(lines[at + 1 : at + 2]).fnmatch_lines([f"test_it.py::update: {WRONG[given]}*"]) is None
    assert lines[at + 2].startswith("===")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("routine", "said"),
    [
        ("async def update(trial, pressure, stiffness): ...", "it is async, *"),
        ("def update(trial, pressure, stiffness, made): ...", "there is no value for its argument 'made'; *"),
        ("class TestIt:\n    @MARK\n    def update(self, made, pressure): ...", "it takes (made, pressure), but *"),
        ("@pytest.mark.parametrize('mu', [1, 2])\ndef update(trial, pressure, stiffness, mu): ...", "it is parametrised, *"),
    ],
)
def test_a_marked_routine_that_only_a_test_could_call_is_one_line(pytester: pytest.Pytester, routine: str, said: str) -> None:
    head = "import pytest\nMARK = pytest.mark.duhem(law='coulomb')\n"
    pytester.makepyfile(test_it=f"{head}{'' if routine.startswith('class') else '@MARK'}\n{routine}\n")
    done = tried(pytester)
    done.assert_outcomes(errors=1)
    done.stdout.fnmatch_lines([f"test_it.py::*update: {said}use the fixture duhem_check in a test that makes the routine: *"])


def test_a_marked_routine_with_open_parameters_is_called(pytester: pytest.Pytester) -> None:
    pytester.makepyfile("import pytest\n\n@pytest.mark.duhem(law='coulomb')\ndef update(trial, pressure, stiffness, mu): ...\n")
    tried(pytester, "--collect-only").assert_outcomes(errors=0)


def test_what_cannot_be_asked_hides_nothing(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(
        test_it=HEAD
        + """
FEW = MARK | {"checks": "feasibility"}

@pytest.mark.duhem(**(FEW | {"law": "coulom"}))
@pytest.mark.duhem(**FEW)
@pytest.mark.duhem(**(FEW | {"law": "nowhere.toml"}))
def update(trial, pressure, stiffness):
    return right(trial, pressure, stiffness)

@pytest.mark.skip("not today")
@pytest.mark.duhem(law="coulom")
def later(trial, pressure, stiffness): ...

@pytest.mark.duhem(law="coulom")
def test_handed_over(duhem_check):
    duhem_check(right)

def test_else(): ...
""",
        test_other="def test_other(): ...",
    )
    written(pytester, {"a.duhem": LIMACON.replace("norm(", "nrm(")})
    done = tried(pytester)
    done.assert_outcomes(passed=4, skipped=1, errors=4)
    assert done.ret == pytest.ExitCode.TESTS_FAILED
    there = ["test_it.py::update", "test_it.py::update[[]2]", "test_it.py::test_handed_over[[]marker]", "a.duhem.toml::read"]
    done.stdout.fnmatch_lines_random([f"ERROR {node}*" for node in there])


def test_the_fixture_needs_the_marker(pytester: pytest.Pytester) -> None:
    pytester.makepyfile("def test_it(duhem_check): ...")
    done = tried(pytester)
    done.assert_outcomes(errors=1)
    done.stdout.fnmatch_lines(["*::test_it: the fixture duhem_check needs the marker duhem; write for example @pytest.mark.duhem(law=*"])


# -- files -------------------------------------------------------------------------------------------------------------

LIMACON = """\
[criterion]
name = "oval"
g = "norm(sigma_a, sigma_b)**2 - abs(sigma_n)*(norm(sigma_a, sigma_b) + 4/5*sigma_a)"
"""
SCENE = """\
law = "coulomb"
stiffness = 1e9
[parameters]
mu = 0.2
[path]
kind = "linear"
points = [[0, 0], [3e-4, 0]]
pressure = PRESSURE
"""


def written(pytester: pytest.Pytester, files: dict[str, str]) -> None:
    for name, text in files.items():
        (pytester.path / f"{name}.toml").write_text(text, "utf-8")


def test_files_are_nodes_of_claims_and_runs(pytester: pytest.Pytester) -> None:
    written(pytester, {"oval.duhem": LIMACON, "slide": SCENE.replace("PRESSURE", "-1e6"), "other": "[tool]\nx = 1\n"})
    pytester.makeini("[pytest]\nduhem_files = sl*.toml\n")
    done = tried(pytester, "--duhem-claims", "origin,convexity,duality", "--junitxml=junit.xml")
    done.assert_outcomes(passed=2, failed=1, skipped=1)
    done.stdout.fnmatch_lines_random(
        [
            "PASSED oval.duhem.toml::origin",
            "FAILED oval.duhem.toml::convexity*",
            "PASSED slide.toml::simulate",
            "oval: convexity is refuted: *",
            "  p: sigma_a = *, sigma_b = *, sigma_n = -1",
        ]
    )
    found = {case["duhem_verdict"]: case for case in properties(pytester.path / "junit.xml").values() if "duhem_verdict" in case}
    assert found["proved"]["duhem_trust"] == "checked" and found["proved"]["duhem_method"]
    assert set(json.loads(found["refuted"]["duhem_witness"])["points"]) == {"p", "q", "midpoint"}


@pytest.mark.slow
def test_an_undecided_claim_fails_or_is_expected_to(pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch) -> None:
    from dataclasses import replace

    from duhem.proof.verdict import Verdict
    from duhem.proof.verification import verify

    def undecided(*given: Any, **more: Any) -> Any:
        done = verify(*given, **more)
        return replace(done, results=tuple(replace(r, verdict=Verdict.UNDECIDED, trust=None, detail="nobody knows") for r in done.results))

    monkeypatch.setattr(in_pytest, "verify", undecided)
    written(pytester, {"oval.duhem": LIMACON})
    asked = ("--duhem-claims", "origin")
    tried(pytester, *asked).assert_outcomes(failed=1)
    tried(pytester, *asked, "--duhem-undecided", "xfail").assert_outcomes(xfailed=1)
    pytester.makeini("[pytest]\nduhem_undecided = xfail\n")
    done = tried(pytester, *asked)
    done.assert_outcomes(xfailed=1)
    done.stdout.fnmatch_lines(["XFAIL oval.duhem.toml::origin - *oval: origin is undecided: nobody knows*"])  # an old pytest says reason:


@pytest.mark.slow
def test_files_that_cannot_be_used_and_a_run_that_is_stopped(pytester: pytest.Pytester) -> None:
    broken = {"a.duhem": LIMACON.replace("norm(", "nrm("), "b.duhem": "[tool]\n", "c.duhem": SCENE.replace("PRESSURE", "1.0")}
    written(pytester, broken)
    done = tried(pytester)
    done.assert_outcomes(errors=3)
    done.stdout.fnmatch_lines_random(["*a.duhem.toml:3:*nrm*", "*b.duhem.toml: this is neither a criterion file nor a scene; *"])
    for name in broken:
        (pytester.path / f"{name}.toml").unlink()
    ranged = LIMACON.replace("4/5", "1/5") + "[domain]\nsigma_a = { max = 0.25 }\n"
    far = SCENE.replace("PRESSURE", "-1").replace("coulomb", "ranged.toml").replace("mu = 0.2\n", "")
    written(pytester, {"ranged": ranged, "far.duhem": far})
    done = tried(pytester)
    done.assert_outcomes(failed=1)
    done.stdout.fnmatch_lines(["*sigma_a*"])


# -- snapshots ---------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_snapshot_is_kept_beside_the_test_and_compared(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(test_it='def test_law(duhem_snapshot):\n    duhem_snapshot("coulomb", {"mu": 0.5}, claims=["origin"])\n')
    done = tried(pytester)
    done.assert_outcomes(failed=1)
    done.stdout.fnmatch_lines(
        ["coulomb, mu = 0.5, claims origin: snapshots/test_it/test_law.json: there is no such file; * store them with --duhem-update"]
    )
    done.stdout.no_fnmatch_line("* --update*")  # an option of the command, not of pytest
    tried(pytester, "--duhem-update").assert_outcomes(passed=1)
    tried(pytester).assert_outcomes(passed=1)
    file = pytester.path / "snapshots" / "test_it" / "test_law.json"
    file.write_text(file.read_text("utf-8").replace('"proved"', '"refuted"'), "utf-8")
    done = tried(pytester)
    done.assert_outcomes(failed=1)
    done.stdout.fnmatch_lines(
        ["coulomb, mu = 0.5, claims origin is not as snapshots/test_it/test_law.json has it; *", "  origin: refuted → proved"]
    )


SHARED = """
class TestX:
    def test_law(self, duhem_snapshot):
        duhem_snapshot("coulomb", {"mu": 0.5}, claims=["origin"])
        duhem_snapshot("coulomb", {"mu": 0.25}, claims=["origin"])

class TestY:
    def test_law(self, duhem_snapshot):
        duhem_snapshot("coulomb", {"mu": 0.75}, claims=["origin"])
        duhem_snapshot("coulomb", {"mu": 0.75}, claims=(each for each in ("state_laws", "origin")))

def test_law(duhem_snapshot):
    duhem_snapshot("coulomb", {"mu": 1}, claims=["origin"])
"""


@pytest.mark.slow
def test_snapshots_of_one_name_and_of_one_law_stay_apart(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(test_it=SHARED)
    tried(pytester, "--duhem-update").assert_outcomes(passed=3)
    tried(pytester).assert_outcomes(passed=3)
    folder = pytester.path / "snapshots" / "test_it"
    kept = {file.stem: {*json.loads(file.read_text("utf-8"))["laws"]} for file in folder.iterdir()}
    values = {"TestX.test_law": (0.5, 0.25), "TestY.test_law": (0.75,), "test_law": (1.0,)}
    apart = {name: {f"coulomb, mu = {mu}, claims origin" for mu in each} for name, each in values.items()}
    assert kept == apart | {"TestY.test_law": {*apart["TestY.test_law"], "coulomb, mu = 0.75, claims origin state_laws"}}


def test_the_tolerance_of_a_snapshot_is_its_owners(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(test_it="def test_law(duhem_snapshot):\n    duhem_snapshot('coulomb', {'mu': 0.5}, ['origin'])\n")
    tried(pytester, "--duhem-update").assert_outcomes(passed=1)
    file = pytester.path / "snapshots" / "test_it" / "test_law.json"
    whole = json.loads(file.read_text("utf-8"))
    assert whole["tolerance"] == 1e-9
    file.write_text(json.dumps(whole | {"tolerance": 1e-6}), "utf-8")
    tried(pytester, "--duhem-update").assert_outcomes(passed=1)
    assert json.loads(file.read_text("utf-8"))["tolerance"] == 1e-6


# -- what it costs, and how it is shipped ------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_run_that_does_not_use_it_imports_nothing_of_it(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(
        test_it="""
import sys

def test_nothing():
    assert not [m for m in sys.modules if m.partition(".")[0] in ("duhem", "numpy", "sympy")]
"""
    )
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:duhem", "-p", "duhem_pytest", "-p", "no:hypothesispytest"]
    done = subprocess.run(command, cwd=pytester.path, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout


def test_profiles_are_those_of_the_command() -> None:
    (option,) = (o for o in command.params if o.name == "profile")
    assert {*option.type.choices} == {*PROFILES}  # type: ignore[attr-defined]
    assert all(f"{asked['max_examples']}" in str(option.help) for asked in PROFILES.values())  # type: ignore[attr-defined]


def test_it_is_found_by_pytest_and_shipped() -> None:
    project = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text("utf-8"))
    assert project["project"]["entry-points"]["pytest11"] == {"duhem": duhem_pytest.__name__}
    assert "src/duhem_pytest.py" in project["tool"]["hatch"]["build"]["targets"]["wheel"]["packages"]
    assert "Framework :: Pytest" in project["project"]["classifiers"]


@pytest.mark.long
@pytest.mark.parametrize("dist", ["load", "loadgroup"])
def test_workers_agree_however_nodes_are_shared_out(pytester: pytest.Pytester, dist: str) -> None:
    pytester.makepyfile(
        test_it=HEAD
        + """
@pytest.mark.duhem(checks=["feasibility", "idempotence", "ray"], **MARK)
def update(trial, pressure, stiffness):
    return trial
"""
    )
    written(pytester, {"oval.duhem": LIMACON})
    given = ("-p", "no:duhem", "-p", "duhem_pytest", "-n", "2", "--dist", dist, "--duhem-claims", "origin,smoothness", "test_it.py")
    pytester.runpytest_subprocess(*given, "oval.duhem.toml").assert_outcomes(passed=5, failed=1)
