"""The command line: what it prints, where, and the exit code of every ending."""

import json
import os
import re
import signal
import subprocess
import sys
import time
import tomllib
from collections.abc import Callable
from dataclasses import replace
from importlib.metadata import PackageNotFoundError
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
from click.shell_completion import ShellComplete

import duhem
from duhem.cli import cli, output
from duhem.cli.verbs.doctor import CORE, EXTRAS, PURPOSES
from duhem.errors import MissingExtraError
from duhem.law import catalogue
from duhem.law.atlas.entry import groups
from duhem.omitted import LeftOut
from duhem.proof import verification
from duhem.proof.claims import CLAIMS, asked_of
from duhem.proof.decide import Budget
from duhem.proof.remarks import not_needed
from duhem.proof.report import as_text
from duhem.proof.verdict import Trust, Verdict, Witness
from duhem.proof.verification import ClaimResult, Verification
from tests.long import long_but
from tests.oracles.junit_schema import read as junit_document

SOURCE = Path(duhem.__path__[0]).parent
Run = Callable[..., tuple[int, str, str]]


def result(claim: str, verdict: Verdict) -> ClaimResult:
    return ClaimResult(claim, verdict, "by hand", "all parameters", 0.25, "made up", None)


def made_up(*verdicts: Verdict) -> Callable[..., Verification]:
    """A verifier that hands out these verdicts."""

    def verify(law: Any, *, claims: Any, effort: str, coupled: bool, on_claim: Any, on_method: Any) -> Verification:
        results = tuple(result(claim, verdict) for claim, verdict in zip(CLAIMS, verdicts, strict=False))
        for each in results:
            on_claim(each)
        return Verification(duhem.load(law), results, (LeftOut("thermal", "isothermal law"),), ("a remark",))

    return verify


def test_verify_proves_and_exits_with_0(run: Run) -> None:
    code, out, err = run("verify", "coulomb")
    assert (code, err) == (0, "")
    for claim in asked_of(None):
        assert re.search(rf"^{claim} +proved ", out, re.MULTILINE)
    assert "generalized standard: yes" in out
    assert "dissipative: yes" in out
    assert "mu positive" in out
    assert max(map(len, out.splitlines())) <= 100


def test_verify_refutes_and_exits_with_1(run: Run) -> None:
    code, out, _ = run("verify", "box", "--claims", "smoothness")
    assert code == 1
    assert "smoothness  refuted" in out
    assert "counterexample at mu_a = " in out
    assert "generalized standard: not decided" in out


def test_set_fixes_exactly(run: Run) -> None:
    code, out, _ = run(
        "verify", "orthotropic", "--set", "mu_a=0.15", "--set", "mu_b = 1/3", "--claims", "origin,convexity", "--format", "json"
    )
    report = json.loads(out)
    assert code == 0
    assert report["parameters"] == {"mu_a": "3/20", "mu_b": "1/3"}
    assert [c["claim"] for c in report["claims"]] == ["origin", "convexity"]


@pytest.mark.slow
def test_json_report(run: Run) -> None:
    code, out, err = run("verify", "box", "--format", "json")
    report = json.loads(out)
    assert (code, err) == (1, "")
    assert (report["duhem"], report["criterion"]) == (duhem.__version__, "box")
    assert report["parameters"] == {"mu_a": "positive", "mu_b": "positive"}
    assert [c["claim"] for c in report["claims"]] == list(asked_of(None))
    for claim in report["claims"]:
        assert {"claim", "verdict", "method", "scope", "seconds", "detail", "witness"} <= claim.keys()
        assert claim["verdict"] in list(Verdict)
        assert (claim["verdict"] == "refuted") == (claim["witness"] is not None)
    assert report["generalized_standard"] is True
    assert {"part", "reason"} == report["left_out"][0].keys()


@pytest.mark.parametrize(
    ("verdicts", "strict", "code"),
    [
        ((Verdict.PROVED, Verdict.NOT_APPLICABLE), True, 0),
        ((Verdict.PROVED, Verdict.UNDECIDED), False, 0),
        ((Verdict.PROVED, Verdict.UNDECIDED), True, 3),
        ((Verdict.PROVED, Verdict.TESTED), True, 3),
        ((Verdict.REFUTED, Verdict.UNDECIDED), True, 1),
        ((Verdict.REFUTED, Verdict.PROVED), False, 1),
    ],
)
def test_exit_code(run: Run, monkeypatch: pytest.MonkeyPatch, verdicts: tuple[Verdict, ...], strict: bool, code: int) -> None:
    monkeypatch.setattr(verification, "verify", made_up(*verdicts))
    assert run("verify", "coulomb", *(["--strict"] if strict else []))[0] == code


@pytest.mark.parametrize(
    ("verdicts", "expected", "code", "said"),
    [
        ((Verdict.PROVED, Verdict.REFUTED), ["convexity=refuted"], 0, ""),
        ((Verdict.REFUTED, Verdict.REFUTED), ["convexity=refuted"], 1, ""),
        ((Verdict.PROVED, Verdict.PROVED), ["convexity = refuted"], 1, "duhem: coulomb: convexity is proved, where refuted is expected\n"),
        ((Verdict.UNDECIDED, Verdict.REFUTED), ["origin=undecided", "convexity=refuted"], 0, ""),
        ((Verdict.TESTED, Verdict.REFUTED), ["convexity=refuted"], 3, ""),
    ],
)
def test_expected_verdicts_are_no_failure_and_others_in_their_place_are(
    run: Run, monkeypatch: pytest.MonkeyPatch, verdicts: tuple[Verdict, ...], expected: list[str], code: int, said: str
) -> None:
    monkeypatch.setattr(verification, "verify", made_up(*verdicts))
    words = [word for each in expected for word in ("--expect", each)]
    found, _, err = run("verify", "coulomb", "--strict", *words)
    assert (found, err) == (code, said)
    found, out, _ = run("verify", "coulomb", "--strict", "--format", "junit", *words)
    failed = ElementTree.fromstring(out).findall(".//failure")
    assert found == code and bool(failed) == (code != 0)


CORNERS = """[criterion]
name = "corners"
pressure = false
g = "max(abs(sigma_a), abs(sigma_b)) - 1"
expect = {expect}
"""


@pytest.mark.parametrize(
    ("expect", "option", "code", "said"),
    [
        ('{ smoothness = "refuted" }', [], 0, ""),
        ("{}", [], 1, ""),
        ('{ smoothness = "proved" }', [], 1, "corners: smoothness is refuted, where proved is expected"),
        ('{ smoothness = "proved" }', ["--expect", "smoothness=refuted"], 0, ""),
        ('{ smoothness = "refuted", origin = "refuted" }', [], 1, "corners: origin is proved, where refuted is expected"),
        ('{ smothness = "refuted" }', [], 2, "expect of corners: unknown claim 'smothness'; did you mean 'smoothness'?"),
        ('{ smoothness = "refused" }', [], 2, "expect of corners: unknown verdict 'refused'; did you mean 'refuted'?"),
        ("[1]", [], 2, 'corners.toml:5:1: expect is not a table of claims and verdicts; write expect = { smoothness = "refuted" }'),
        ("{ smoothness = 1 }", [], 2, "expect is not a table of claims and verdicts"),
    ],
)
def test_a_law_says_which_verdicts_are_no_failure(
    run: Run, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, expect: str, option: list[str], code: int, said: str
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "corners.toml").write_text(CORNERS.replace("{expect}", expect))
    found, _, err = run("verify", "corners.toml", "--claims", "origin,smoothness", *option)
    assert found == code and said in err and bool(said) == bool(err), err
    if code < 2:
        _, out, _ = run("verify", "corners.toml", "--claims", "origin,smoothness", "--format", "junit", *option)
        assert bool(ElementTree.fromstring(out).findall(".//failure")) == bool(code)


@pytest.mark.parametrize(
    ("expected", "said"),
    [
        (["--expect", "smoothness"], "not of the form CLAIM=VERDICT"),
        (["--expect", "smoothnes=refuted"], "did you mean 'smoothness'?"),
        (["--expect", "smoothness=refused"], "unknown verdict 'refused'; did you mean 'refuted'?"),
        (["--expect", "smoothness=proved", "--expect", "smoothness=refuted"], "smoothness is expected to be proved too"),
        (["--expect", "smoothness=refuted", "--claims", "origin"], "the selected claims are: origin"),
    ],
)
def test_what_cannot_be_expected_is_told(run: Run, expected: list[str], said: str) -> None:
    code, out, err = run("verify", "coulomb", *expected)
    assert (code, out) == (2, "") and said in err and "--expect smooth" in err


@pytest.mark.parametrize(
    ("verdicts", "settled"),
    [
        ((Verdict.PROVED, Verdict.NOT_APPLICABLE), True),
        ((Verdict.UNDECIDED,), False),
        ((Verdict.PROVED, Verdict.UNDECIDED), False),
        ((Verdict.PROVED, Verdict.TESTED), False),
        ((Verdict.PROVED, Verdict.REFUTED), False),
        ((Verdict.NOT_APPLICABLE,), False),
    ],
)
def test_all_is_said_to_be_settled_by_proof_only_where_it_is(verdicts: tuple[Verdict, ...], settled: bool) -> None:
    said = [part.reason for part in not_needed(duhem.load("coulomb"), verdicts)]
    assert ("every examined claim has a proof, so no verdict rests on samples" in said) is settled


def test_the_conclusion_names_the_trust_of_what_the_kernel_has_not_checked() -> None:
    trusts = {"origin": Trust.CHECKED, "convexity": Trust.SOLVER, "normality": Trust.SOLVER, "dissipation": Trust.PROVER}
    proved = {claim: ClaimResult(claim, Verdict.PROVED, "by hand", "everywhere", 0.0, "", trust=trust) for claim, trust in trusts.items()}
    report = as_text(Verification(duhem.load("coulomb"), tuple(proved.values()), (), ()))
    said = " ".join(report.split())
    assert "generalized standard: yes (origin, convexity and normality proved; trust: solver for convexity and normality)" in said
    assert "dissipative: yes (dissipation proved; trust: prover for dissipation)" in said


def test_text_report_shows_witness_conclusion_left_out_and_remarks() -> None:
    witness = Witness(
        {"mu": "3/20"}, {"p": {"sigma_a": "1/3", "sigma_b": "-2"}}, {"g(p)": ("0.1", "0.2")}, "g(p) > 0", {"corner_degrees": 12.5}
    )
    refuted = ClaimResult("convexity", Verdict.REFUTED, "by hand", "at the witness", 0.25, "not convex", witness)
    done = Verification(
        duhem.load("coulomb"), (result("origin", Verdict.PROVED), refuted), (LeftOut("thermal", "isothermal law"),), ("a remark",)
    )
    report = as_text(done)
    for piece in (
        "mu*sigma_n + norm(sigma_a, sigma_b) <= 0",
        "source",
        "convexity  refuted         by hand  at the witness   0.25 s",
        "counterexample at mu = 0.15 = 3/20",
        "p: sigma_a ~ 0.33333333 = 1/3, sigma_b = -2",
        "g(p) in [0.1, 0.2]",
        "corner degrees 12.5",
        "generalized standard: no (convexity refuted)",
        "dissipative: not decided (dissipation not examined)",
        "thermal: isothermal law",
        "a remark",
    ):
        assert piece in report


def test_progress_only_on_a_terminal(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(verification, "verify", made_up(Verdict.PROVED, Verdict.UNDECIDED))
    assert run("verify", "coulomb")[2] == ""
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    _, out, err = run("verify", "coulomb")
    assert "origin proved" in err and "convexity undecided" in err
    assert err.endswith("\r\x1b[2K")
    assert "\x1b" not in out


def test_a_method_that_lasts_is_named_with_its_steps_on_a_terminal_alone(monkeypatch: pytest.MonkeyPatch, capsys: Any) -> None:
    monkeypatch.setattr(output, "_TICK", 0.01)
    monkeypatch.setattr(output, "_LONG", 0.0)
    steps = Budget(16_000_000)
    assert steps.pays(1_240_000)
    with output.Progress() as progress:
        progress.tries("convexity", "polar", steps)
        time.sleep(0.05)
    assert capsys.readouterr().err == ""
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    with output.Progress() as progress:
        progress.tries("convexity", "polar", steps)
        err = capsys.readouterr().err
        for _ in range(1_000):
            time.sleep(0.01)
            if "steps" in (err := err + capsys.readouterr().err):
                break
        progress.show("1: convexity proved")
        time.sleep(0.05)
    said = (err + capsys.readouterr().err).split("\r\x1b[2K")
    assert said[1:3] == ["verifying", "convexity: polar"] and said[-2:] == ["1: convexity proved", ""]
    assert said[3:-2] and all(re.fullmatch(r"convexity: polar, \d+ s, 1\.2 of 16 million steps", line) for line in said[3:-2])


INTERRUPTED = """
import signal, sys, time
signal.signal(signal.SIGINT, signal.default_int_handler)  # where whoever started the tests ignores it
from duhem.proof import verification
from duhem.__main__ import main
from duhem.omitted import LeftOut
from duhem.proof.verdict import Verdict

def slow(law, parameters=None, claims=None, *, effort, coupled, on_claim, on_method):
    on_claim(verification.ClaimResult("origin", Verdict.PROVED, "by hand", "all parameters", 0.1, "made up", None))
    work()

def ready():
    print("ready", file=sys.stderr, flush=True)

def sleep():
    ready()
    time.sleep(60)

def solve():
    import sympy as sp, z3
    from duhem.law import parameter_domain
    parameter_domain._STEPS = 10**9
    names = x, y, z, w = sp.symbols("x y z w", real=True)
    means = sp.expand((x**2 + y**2 + z**2 + w**2)**4 - 256*x**2*y**2*z**2*w**2 + x*y*z**3*w**3/1000)  # z3 takes minutes
    check = z3.Solver.check
    z3.Solver.check = lambda solver: [ready(), check(solver)][1]
    parameter_domain.solution(names, [means < 0])

work = {"sleep": sleep, "solve": solve}[sys.argv[1]]
verification.verify = slow
sys.argv = ["duhem", "verify", "coulomb", *sys.argv[2:]]
sys.exit(main())
"""


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="Windows has no SIGINT for one process")
@pytest.mark.parametrize(("work", "form"), long_but([1], [("sleep", "text"), ("sleep", "json"), ("solve", "text")]))
def test_ctrl_c_prints_what_was_decided(work: str, form: str) -> None:
    with subprocess.Popen(
        [sys.executable, "-c", INTERRUPTED, work, "--format", form], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stderr is not None
        assert process.stderr.readline() == "ready\n"
        time.sleep(0.5)  # by now z3 is at work
        start = time.monotonic()
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=30)
    assert time.monotonic() - start < 10
    assert process.returncode == 130
    assert "Traceback" not in err
    if form == "json":
        report = json.loads(out)
        assert [c["claim"] for c in report["claims"]] == ["origin"]
        assert report["interrupted"] is True and report["generalized_standard"] is None
    else:
        assert re.search("^origin +proved", out, re.MULTILINE)
        assert "Interrupted after 1 claim:" in out


def test_interrupted_json_has_the_keys_of_the_complete_one(run: Run) -> None:
    complete = json.loads(run("verify", "coulomb", "--claims", "origin", "--format", "json")[1])
    law = duhem.load("coulomb")
    partial = replace(duhem.verify(law, claims=["origin"]), interrupted=True).to_dict()
    assert partial.keys() - {"interrupted"} == complete.keys()
    assert partial["claims"][0].keys() == complete["claims"][0].keys()
    assert partial["parameters"] == complete["parameters"]


def test_internal_failure_is_short_and_exits_with_4(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: Any, **__: Any) -> None:
        raise RuntimeError("two\nlines")

    monkeypatch.setattr(verification, "verify", broken)
    code, out, err = run("verify", "coulomb")
    assert (code, out) == (4, "")
    assert re.fullmatch(r"duhem: internal failure: RuntimeError: two lines \(at test_cli\.py:\d+\); .*report it.*\n", err)


def test_missing_extra_names_the_remedy_and_exits_with_2(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    def lacking(*_: Any, **__: Any) -> None:
        raise MissingExtraError("matplotlib", "plot")

    monkeypatch.setattr(verification, "verify", lacking)
    assert run("verify", "coulomb") == (2, "", 'duhem: matplotlib is not installed; install it with: pip install "duhem[plot]"\n')


@pytest.mark.parametrize("arguments", [["verify"], ["nothing"], ["verify", "coulomb", "--wrong"], ["verify", "coulomb", "--format", "xml"]])
def test_wrong_usage_exits_with_2(run: Run, arguments: list[str]) -> None:
    code, out, err = run(*arguments)
    assert (code, out) == (2, "")
    assert "Error: " in err and "Traceback" not in err


def test_help_names_every_command_and_exit_code(run: Run) -> None:
    code, out, _ = run("--help")
    assert code == 0
    for word in ("verify", "derive", "list", "init", "explain", "doctor", "130 interrupted"):
        assert word in " ".join(out.split())


def test_version(run: Run) -> None:
    assert run("--version") == (0, f"duhem {duhem.__version__}\n", "")


def test_list_names_every_law(run: Run) -> None:
    code, out, _ = run("list")
    assert code == 0
    assert tuple(line.split()[0] for line in out.splitlines()) == (*catalogue.names(), *groups())


@pytest.mark.slow
@pytest.mark.parametrize("form", ["text", "latex", "markdown"])
def test_derive_prints_the_derivation(run: Run, form: str) -> None:
    code, out, _ = run("derive", "coulomb", "--format", form)
    assert code == 0
    assert out == getattr(duhem.derive(duhem.load("coulomb")), form)() + "\n"


def test_explain(run: Run) -> None:
    code, out, _ = run("explain")
    assert code == 0
    assert [line.split()[0] for line in out.splitlines()] == [*CLAIMS, "open"]
    code, out, _ = run("explain", "open")
    assert code == 0 and "neither proved nor refuted" in out and "asked again" in " ".join(out.split())
    code, out, _ = run("explain", "convexity")
    assert code == 0
    assert CLAIMS["convexity"].theory.strip() in out
    code, _, err = run("explain", "convxity")
    assert code == 2
    assert "did you mean 'convexity'?" in err


def test_init_writes_a_file_once(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert run("init", "mine")[0] == 0
    assert duhem.load("mine.toml").name == "mine"
    before = Path("mine.toml").read_bytes()
    code, _, err = run("init", "mine.toml")
    assert code == 2
    assert "exists already" in err
    assert Path("mine.toml").read_bytes() == before
    assert run("init", "../up")[0] == 2


@pytest.mark.slow
def test_a_law_in_a_module_beside_the_user(tmp_path: Path) -> None:
    (tmp_path / "beside.py").write_text(
        "import duhem\n@duhem.criterion\ndef thin(sigma_a, sigma_b, sigma_n, mu):\n    'Thin.'\n    return abs(sigma_a)/mu + sigma_n\n"
    )
    code = "import sys; sys.path.remove(''); from duhem.__main__ import main; sys.exit(main())"
    command = [sys.executable, "-c", code, "verify", "beside:thin", "--claims", "origin"]
    environment = os.environ | {"PYTHONPATH": str(SOURCE)}
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr) == (0, "")


def test_doctor_lists_what_the_project_declares(run: Run) -> None:
    project = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text("utf-8"))["project"]

    def names(requirements: list[str]) -> set[str]:
        return {re.split(r"[\[><=~!; ]", r)[0] for r in requirements} - {"duhem"}

    assert names(project["dependencies"]) == set(CORE)
    declared = {extra: names(r) for extra, r in project["optional-dependencies"].items() if extra != "all"}
    assert declared == {extra: set(packages) for extra, packages in EXTRAS.items()}
    assert set(PURPOSES) == set(EXTRAS)
    code, out, _ = run("doctor")
    assert code == 0
    assert re.search(r"^  sympy +\d", out, re.MULTILINE)
    assert "python" in out


def test_doctor_gives_the_remedy_for_a_gap(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    def version(name: str) -> str:
        if name == "matplotlib":
            raise PackageNotFoundError(name)
        return "1.0"

    monkeypatch.setattr("importlib.metadata.version", version)
    code, out, _ = run("doctor")
    assert code == 0
    assert 'pip install "duhem[plot]"' in out
    assert 'pip install "duhem"' not in out
    monkeypatch.setattr("duhem.cli.verbs.doctor.CORE", ("matplotlib",))
    code, out, _ = run("doctor")
    assert code == 4
    assert 'pip install "duhem"' in out


def test_completion_knows_the_laws_without_importing_sympy() -> None:
    code = (
        "import atexit, sys; atexit.register(lambda: print('sympy' in sys.modules, file=sys.stderr))\n"
        "from duhem.__main__ import main; sys.exit(main())"
    )
    environment = os.environ | {"_DUHEM_COMPLETE": "bash_complete", "COMP_WORDS": "duhem verify ant", "COMP_CWORD": "2"}
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, timeout=60)
    assert "plain,antoni2007\nplain,antoni2007-1d" in done.stdout
    assert done.stderr == "False\n"


@pytest.mark.parametrize(
    ("line", "offered"),
    [
        ("verify coulomb --claims con", ["convexity"]),
        ("verify coulomb --claims origin,d", ["origin,dissipation", "origin,duality"]),
        ("verify coulomb --claims origin,o", []),
        ("verify coulomb --expect smooth", ["smoothness="]),
        ("verify coulomb --expect smoothness=re", ["smoothness=refuted"]),
        ("explain sm", ["smoothness"]),
        ("verify orthotropic --set ", ["mu_a=", "mu_b="]),
        ("verify limacon coulomb --set ", ["mu=", "e="]),
        ("project antoni2007 --set mu_a_p", ["mu_a_plus="]),
        ("verify nothing-such --set ", []),
        ("plot os:path --set ", []),
        ("identify points.csv --law orthotropic --set mu_", ["mu_a=", "mu_b="]),
        ("identify points.csv --law orthot", ["orthotropic", "orthot"]),
        ("test --law coulomb mine:update --set ", ["mu="]),
        ("snapshot orthot", ["orthotropic", "orthot"]),
    ],
)
def test_what_the_shell_offers(line: str, offered: list[str]) -> None:
    *words, last = line.split(" ")
    assert [item.value for item in ShellComplete(cli, {}, "duhem", "_DUHEM_COMPLETE").get_completions(words, last)] == offered


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="POSIX pipes")
@pytest.mark.parametrize(("arguments", "code"), [(["list"], 0), (["verify", "box", "--claims", "smoothness"], 1)], ids=["list", "verify"])
def test_a_reader_that_goes_away_changes_no_exit_code(arguments: list[str], code: int) -> None:
    read_end, write_end = os.pipe()
    os.close(read_end)
    done = subprocess.run([sys.executable, "-m", "duhem", *arguments], stdout=write_end, stderr=subprocess.PIPE, text=True, timeout=60)
    os.close(write_end)
    assert (done.returncode, done.stderr) == (code, "")


VERIFY = ["verify", "coulomb", "--claims", "origin"]
CLOSED_TO = [(VERIFY, 0), (["list"], 0), (["verify", "colomb"], 2), (["verify"], 2)]


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="POSIX streams")
@pytest.mark.parametrize(
    ("arguments", "code", "closed"),
    long_but([4, 7, 9], [(*case, closed) for case in CLOSED_TO for closed in ((1,), (2,), (1, 2))]),
    ids=str,
)
def test_a_stream_that_is_closed_changes_no_exit_code(arguments: list[str], code: int, closed: tuple[int, ...]) -> None:
    shell = f'exec "$@" {" ".join(f"{number}>&-" for number in closed)}'
    command = ["sh", "-c", shell, "sh", sys.executable, "-m", "duhem", *arguments]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert done.returncode == code and "internal failure" not in done.stderr and "Traceback" not in done.stderr
    assert bool(done.stdout) == (code == 0 and 1 not in closed) and bool(done.stderr) == (code != 0 and 2 not in closed)


@pytest.mark.slow
@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no /dev/full")
@pytest.mark.parametrize("arguments", [["list"], ["--help"], [*VERIFY, "--format", "json"]], ids=str)
def test_a_full_disk_is_no_defect(arguments: list[str]) -> None:
    command = [sys.executable, "-m", "duhem", *arguments]
    with open("/dev/full", "w") as full:
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, timeout=60)
        silent = subprocess.run(command, stdout=full, stderr=full, timeout=60)
    assert done.returncode == silent.returncode == 2
    assert re.fullmatch(r"duhem: the output cannot be written: [^\n]+; [^\n]+\n", done.stderr) and "defect" not in done.stderr


@pytest.mark.slow
def test_output_that_cannot_show_a_letter() -> None:
    environment = os.environ | {"PYTHONIOENCODING": "iso8859-7", "PYTHONUTF8": "0"}  # Greek has no é
    command = [sys.executable, "-m", "duhem", "verify", "antoni2007", "--claims", "origin"]
    done = subprocess.run(command, env=environment, capture_output=True, encoding="iso8859-7", timeout=60)
    assert (done.returncode, done.stderr) == (0, "")
    assert r"Saffr\xe9" in done.stdout


# -- for what reads JUnit's XML, and several laws at once -------------------------------------------------------------------


def suites(out: str) -> dict[str, dict[str, list[str]]]:
    """What stands below each case, by its suite and name."""
    return {
        suite.get("name", ""): {case.get("name", ""): [child.tag for child in case] for case in suite.iter("testcase")}
        for suite in junit_document(out)
    }


def test_a_refuted_claim_fails_in_junit_with_its_witness(run: Run) -> None:
    code, out, _ = run("verify", "limacon", "--set", "e=0.6", "--claims", "origin,convexity", "--format", "junit")
    assert code == 1 and suites(out) == {"limacon": {"origin": ["system-out"], "convexity": ["failure"]}}
    (suite,) = junit_document(out)
    said = {p.get("name"): p.get("value") or "" for p in suite.iter("property")}
    assert said["convexity verdict"] == "refuted" and said["origin trust"] == "checked" and said["parameter e"] == "= 3/5"
    witness = json.loads(said["convexity witness"])
    failure = suite.find(".//failure")
    assert failure is not None and witness["statement"] in (failure.text or "") and "e = 0.6 = 3/5" in failure.text


def test_what_is_open_is_skipped_in_junit_and_fails_if_strict(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    verdicts = (Verdict.PROVED, Verdict.UNDECIDED, Verdict.TESTED, Verdict.NOT_APPLICABLE)
    monkeypatch.setattr(verification, "verify", made_up(*verdicts))
    for strict, code, tag in ((), 0, "skipped"), (("--strict",), 3, "failure"):
        found, out, _ = run("verify", "coulomb", "--format", "junit", *strict)
        names = [*CLAIMS][:4]
        assert found == code
        assert suites(out)["coulomb"] == dict(zip(names, [["system-out"], [tag], [tag], ["skipped"]], strict=True))


def test_several_laws_are_verified_one_after_the_other(run: Run, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(verification, "verify", made_up(Verdict.PROVED, Verdict.UNDECIDED))
    laws = ("coulomb", "box", "polygon")
    _, out, _ = run("verify", *laws, "--format", "json")
    assert [each["criterion"] for each in json.loads(out)] == [*laws]
    assert [*suites(run("verify", *laws, "--format", "junit")[1])] == [*laws]
    code, _, err = run("verify", *laws, "--certificate", str(tmp_path / "c.json"))
    assert code == 2 and "a certificate can contain only one law" in err and not list(tmp_path.iterdir())
    code, _, err = run("verify", "coulomb", "limacon", "--set", "e=0.6")
    assert code == 2 and "coulomb, --set e=0.6: unknown parameter 'e'" in err
