"""Inputs with one to four things changed: criterion files, scenes, tables and values of --set, each put to the command.

    python -m tests.campaigns.inputs --files 5000 --scenes 2000 --tables 1000 --settings 500 --seed 1

Each run must end with 0, 1 or 2, and with 2 in lines that begin "duhem: "; it may take 5 s of processor time and 500 MB before the
work proper starts, execute nothing, and write to no file but its output.  Every ``--through``-th run goes on into the work.
A run has a process of its own, with limits; what it opens, starts and imports is seen by an audit hook.
"""

from __future__ import annotations

import argparse
import os
import re
import resource
import shutil
import signal
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from random import Random
from typing import Any, NamedTuple

from duhem.__main__ import main as command_line
from duhem.law import catalogue

MOST_SECONDS, MOST_MEGABYTES = 5.0, 500.0
_LONGEST = 3_000_000  # characters: a line that is repeated 300 times, three times over, would be beyond any machine
_CODES = {0, 1, 2}
_ACTS = "open('ran', 'w').close()\n"
_LAWS = (
    catalogue.template("mine"),
    '[criterion]\nname = "x"\ng = "norm(sigma_a/mu_a, sigma_b/mu_b) - abs(sigma_n)"\nconstraints = ["mu_a < mu_b"]\n'
    '[parameters]\nmu_a = { positive = true }\nmu_b = { positive = true, max = 2 }\n[flow]\ndirection = ["sigma_a", "sigma_b"]\n',
    '[criterion]\nname = "y"\nstress = { name = "sigma", kind = "3d" }\npressure = false\ng = "sqrt(3*J2) + a*I1 - c"\n'
    '[define]\nc = "2*k"\n[parameters]\na = { min = 0, max = 0.5 }\nk = { positive = true }\n',
    '[criterion]\nname = "z"\n[[surface]]\ng = "sigma_a + mu*sigma_n"\n[[surface]]\ng = "-sigma_a + mu*sigma_n"\nflow = ["-1", "0"]\n'
    "[parameters]\nmu = { positive = true }\n[domain]\nsigma_n = { min = -100 }\n",
    '[criterion]\nname = "w"\n[boundary]\nangle = "phi"\nT = ["mu*cos(phi)", "mu*sin(phi)"]\n[parameters]\nmu = { positive = true }\n',
)
_HEAD = 'law = "coulomb"\nstiffness = 1e9\n[parameters]\nmu = 0.3\n[path]\n'
_SCENES = (
    f'{_HEAD}kind = "linear"\npoints = [[0, 0], [1e-3, 5e-4]]\npressure = -1e6\n[method]\nintegrator = "exact"\nsubsteps = 4\n',
    f'{_HEAD}kind = "cycle"\namplitude = [1e-3, 0]\ncycles = 2\nmean = 0.0\npressure = -1e6\n[output]\ntable = "h.csv"\n',
    f'{_HEAD}kind = "circle"\nradius = 1e-3\npoints = 12\nturns = 1.5\nstart = 0.5\ncentre = [0, 0]\npressure = -1e6\n',
    f'{_HEAD}kind = "random"\nseed = 1\npoints = 9\nscale = 1e-3\npressure = [-2e6, -1e6]\n',
    f'{_HEAD}kind = "table"\nfile = "t.csv"\n[output]\ntable = "h.csv"\n',
    'law = "law.toml"\nstiffness = [[2.0, 0.5], [0.5, 1.0]]\nstress = [0.01, 0]\n[parameters]\nmu_a = 0.2\nmu_b = 0.3\n'
    '[path]\nkind = "linear"\npoints = [[0, 0], [1, 1]]\npressure = [-1, -2]\n',
)
_LAW_OF_SCENE = _LAWS[1].split("[flow]")[0]
_PATH = "time,u_a,u_b,sigma_n\n" + "".join(f"{i},{i * 1e-3!r},{(-1) ** i * 5e-4!r},-1e6\n" for i in range(8))
_POINTS = "sigma_a,sigma_b,sigma_n,weight\n" + "".join(f"{x},{y},-1,1\n" for x, y in ((0.3, 0), (0.2, 0.2), (0, 0.31), (-0.3, 0.02)))
_SETTINGS = ("mu=0.3", "mu=3/20", "mu=1e-6", "mu = 0.5")
_NUMBERS = ("0", "1", "2", "-1", "0.25", "3", "7", "1e3", "1e-9", "1e9", "-0.5", "40", "1e200", "1/3", "0.0", "12345.678")
_VALUES = (
    "0", "-1", "1e9", "1e300", "4000000", "19000000", "99999999999", "nan", "inf", "-inf", "1e400", "0x" + "f" * 4000, "9" * 5000,
    "true", "false", "[]", "{}", "[[]]", '""', '"a"', "1979-05-27", "[1, [2]]", "[[1, 2], [3]]", "[0, 1]", "[1, 2, 3]", "[true]",
    "{ a = 1 }", '"acts:law"', '"acts"', '"/dev/zero"', '"pipe"', '"link"', '"."', '"../x"', '"law.toml"', '"scene.toml"', '"t.csv"',
    '"link.csv"', '"h.csv"', "[[0, 0], [1e200, 1]]", "1e-320", "1.7e308", "[1e308, 1e308]", "[" + "1," * 9000 + "]",
    "[" + '"a",' * 9000 + "]", '"µ"', '"sigma_a/0"',
)  # fmt: skip
_ODD = (
    "", " ", "0", "-1", "nan", "inf", "-inf", "1e400", "1e-400", "1e308", "0x" + "f" * 4000, "9" * 5000, "1_0", "1/0", "true", "false",
    "[]", "{}", "[[]]", '""', '"a"', "1979-05-27", "[1, [2]]", "[1, 2, 3]", "{ a = 1 }", "99999999999", "acts:law", '"acts:law"', '"acts"',
    '"/dev/zero"', '"pipe"', '"link"', '"../x"', '"law.toml"', '"scene.toml"', '"t.csv"', "__import__('os').system('touch ran')",
    "exec(open('acts.py').read())", "x" * 3000, "(" * 200, ")" * 3, "[" * 2000, "{" * 500, ".".join("a" * 3000),
    "\0", "\x1b[31m", "\ud7ff",
    "ｐｉ", "µ", "μ", "\u202e", "é", "\ufeff", "²",
    "½", '"""', "'''", "#", "\\", "\\u0000", "\r", "\n", "\n\n", "=", ",", ";", "\t", "--",
    "**", "9**9**9", "sqrt(-1)", "log(0)", "1/(sigma_a - sigma_a)",
    "where(", "norm()", "max(", "sigma_a", "mu", "[parameters]", "[[surface]]",
    "positive = true", "min = 1", "value = 0", '"mu" = {}', "turns = 1e300", "cycles = 4000000", "points = 9999999", "substeps = 9999999",
)  # fmt: skip


class Case(NamedTuple):
    """A command line, the files beside it, and what it may write."""

    kind: str
    arguments: tuple[str, ...]
    files: dict[str, bytes]
    output: str = ""


class Outcome(NamedTuple):
    """How a run ended; ``code`` None where it reached the work and stopped there; ``faults`` say what must not be."""

    code: int | None
    seconds: float
    megabytes: float
    message: str
    faults: tuple[str, ...]


def cases(counts: dict[str, int], rng: Random) -> Iterator[Case]:
    """As many of each kind as asked for."""
    made = {"file": _file, "scene": _scene, "table": _table, "setting": _setting}
    for kind, count in counts.items():
        for _ in range(count):
            yield made[kind](rng)


def _file(rng: Random) -> Case:
    return Case("file", ("verify", "law.toml", "--effort", "quick"), {"law.toml": changed(rng.choice(_LAWS), rng)})


def _scene(rng: Random) -> Case:
    scene = changed(rng.choice(_SCENES), rng)
    files = {"scene.toml": scene, "t.csv": _PATH.encode(), "law.toml": _LAW_OF_SCENE.encode()}
    wrong = ("scene.toml", "t.csv" if b'"t.csv"' in scene else "link.csv", "link.csv", "no/out.csv", "pipe.csv")
    out = rng.choice(("--out out.csv", "--out out.csv", "", f"--out {rng.choice(wrong)}")).split()
    return Case("scene", ("simulate", "scene.toml", *out), files, "out.csv")


def _table(rng: Random) -> Case:
    if rng.random() < 0.5:
        return Case("table", ("identify", "t.csv", "--law", "coulomb"), {"t.csv": changed(_POINTS, rng)})
    return Case(
        "table",
        ("simulate", "scene.toml", "--out", "out.csv"),
        {"scene.toml": _SCENES[4].encode(), "t.csv": changed(_PATH, rng)},
        "out.csv",
    )


def _setting(rng: Random) -> Case:
    text = changed(rng.choice(_SETTINGS), rng).replace(b"\0", b"")[:100_000].decode(errors="ignore")  # as long as an argument may be
    return Case("setting", ("verify", "coulomb", "--effort", "quick", "--set", text), {})


def changed(text: str, rng: Random) -> bytes:
    """``text`` with one to four things changed: numbers, characters, words, lines, its end, its encoding."""
    if rng.random() < 0.5 and (assigned := list(re.finditer(r"(?m)^\w+ *= *(.*)$", text))):
        given = rng.choice(assigned)
        text = text[: given.start(1)] + rng.choice(_VALUES) + text[given.end(1) :]
        if rng.random() < 0.7:
            return text.encode()
    for _ in range(rng.choice((1, 1, 1, 2, 2, 3, 4))):
        at = rng.randrange(len(text) + 1)
        line = text.rfind("\n", 0, at) + 1
        end = (text.find("\n", at) + 1) or len(text)
        word = at
        while word < len(text) and text[word] not in ' \n,;="[](){}':
            word += 1
        match rng.randrange(12):
            case 0:
                text = text[:at] + rng.choice(_ODD) + text[at:]
            case 1 | 2:
                text = text[:at] + rng.choice(_ODD) + text[word:]
            case 3:
                equals = text.find("=", line, end)
                text = text[: equals + 1] + f" {rng.choice(_ODD)}\n" + text[end:] if equals > 0 else text[:line] + text[end:]
            case 4:
                text = text[:line] + text[end:]
            case 5:
                text = text[:end] + text[line:end] * rng.choice((1, 1, 300)) + text[end:]
            case 6:
                text = text[:at] + chr(rng.choice((rng.randrange(32, 127), rng.randrange(1, 0xD7FF)))) + text[at + rng.randrange(2) :]
            case 7:
                text = text[:at] if rng.random() < 0.3 else text[:at] + text[at + rng.randrange(20) :]
            case 8 | 9 | 10 if numbers := list(re.finditer(r"(?<![\w.])[0-9][0-9.e/-]*", text)):
                number = rng.choice(numbers)
                text = text[: number.start()] + rng.choice(_NUMBERS) + text[number.end() :]
            case 11 if rng.random() < 0.3:
                text = text.replace(*rng.choice(((",", ";"), (",", "\t"), (".", ","), ("\n", "\r\n"), (" ", ""), ('"', "'"))))
        text = text[:_LONGEST]
    data = text.encode()
    if rng.random() < 0.05:
        at = rng.randrange(len(data) + 1)
        data = rng.choice(
            (
                text.encode("utf-16"),
                data[:at] + bytes(rng.randrange(256) for _ in range(9)) + data[at:],
                data * min(2000, 1 + 2 * _LONGEST // (len(data) + 1)),
            )
        )
    return data


def outcome(case: Case, through: bool = False, command: Callable[[], int] = command_line) -> Outcome:
    """The case in a process of its own, in a folder of its own; ``through``: the work too, else up to it."""
    folder = Path(tempfile.mkdtemp(prefix="inputs"))
    try:
        before = {"acts.py": _ACTS.encode(), **case.files}
        for name, content in before.items():
            (folder / name).write_bytes(content)
        for name in ("link", "link.csv"):
            (folder / name).symlink_to("acts.py")
        for name in ("pipe", "pipe.csv"):
            os.mkfifo(folder / name)
        reader, writer = os.pipe()
        child = os.fork()
        if child == 0:
            os.close(reader)
            _child(case, folder, through, writer, command)
        os.close(writer)
        with os.fdopen(reader, "rb") as stream:
            said = stream.read().decode(errors="replace")
        _, status = os.waitpid(child, 0)
        message = (folder / ".stderr").read_text(errors="replace") if (folder / ".stderr").exists() else ""
        after = {
            p.name: p.read_bytes() for p in folder.iterdir() if p.is_file() and not p.is_symlink() and p.name not in (".stderr", ".stdout")
        }
        return _judged(case, said, status, message, before, after, through)
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def _judged(case: Case, said: str, status: int, message: str, before: dict[str, bytes], after: dict[str, bytes], through: bool) -> Outcome:
    if status or not said:
        return Outcome(None, 0.0, 0.0, message, (f"it died of {os.waitstatus_to_exitcode(status) if status else 'nothing said'}",))
    code_text, seconds, megabytes, *deeds = said.split("\n")
    code = None if code_text == "None" else int(code_text)
    written = {name for name, content in after.items() if before.get(name) != content} | (before.keys() - after.keys())
    own = {case.output, "h.csv"} - before.keys()
    faults = [f"{name} was written" for name in sorted(written - own)] + [deed for deed in deeds if deed]
    if code is not None and code not in _CODES:
        faults.append(f"it ended with {code}")
    if code == 2 and not all(line.startswith(("duhem: ", "Usage: ", "Try ", "Error: ")) for line in message.splitlines() if line):
        faults.append("it says more than its own lines")
    if code == 2 and not message.strip():
        faults.append("it says nothing")
    if not through or code == 2:
        faults += [f"it took {seconds} s"] * (float(seconds) > MOST_SECONDS) + [f"it took {megabytes} MB"] * (
            float(megabytes) > MOST_MEGABYTES
        )
    return Outcome(code, float(seconds), float(megabytes), message, tuple(faults))


class _Reached(BaseException):
    """The input is read and checked, and the work would begin."""


def _child(case: Case, folder: Path, through: bool, writer: int, command: Callable[[], int]) -> None:
    """Run the command and write code, seconds, megabytes and what was done besides; never returns."""
    os.chdir(folder)
    for stream, name in ((1, ".stdout"), (2, ".stderr")):
        os.dup2(os.open(name, os.O_CREAT | os.O_WRONLY), stream)
    resource.setrlimit(resource.RLIMIT_CPU, (120, 130) if through else (20, 22))
    resource.setrlimit(resource.RLIMIT_AS, (8 << 30, 8 << 30))
    signal.alarm(600)
    sys.argv, sys.path[:] = ["duhem", *case.arguments], [*(entry for entry in sys.path if entry), str(folder)]
    deeds = _watched(folder)
    if not through:
        _stop_at_the_work()
    began, size = time.process_time(), resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    try:
        code: int | None = command()
    except _Reached:
        code = None
    seconds, more = time.process_time() - began, (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - size) / 1024
    sys.stdout.flush()
    sys.stderr.flush()
    os.write(writer, "\n".join([f"{code}", f"{seconds:.2f}", f"{more:.0f}", *sorted(set(deeds))[:5]]).encode())
    os._exit(0)


def _watched(folder: Path) -> list[str]:
    """What is written outside of the folder, started, or imported from the folder, as it happens."""
    deeds: list[str] = []
    inside = f"{folder}{os.sep}"

    def hook(event: str, given: tuple[Any, ...]) -> None:
        if event == "open" and isinstance(given[0], str | bytes):
            writes = given[2] & (os.O_WRONLY | os.O_RDWR | os.O_CREAT) if isinstance(given[2], int) else False
            place = os.path.abspath(os.fsdecode(given[0]))
            if writes and not place.startswith(inside) and place != os.devnull:
                deeds.append(f"it opened {place} for writing")
        elif event in ("os.system", "os.exec", "os.posix_spawn", "os.fork", "subprocess.Popen", "socket.connect", "os.remove", "os.rename"):
            place = os.path.abspath(os.fsdecode(given[0])) if event in ("os.remove", "os.rename") and isinstance(given[0], str) else ""
            if not place.startswith(inside):
                deeds.append(f"it called {event} {given!r:.80}")
        elif event == "import" and given[0] == "acts":
            deeds.append("it imported acts")

    sys.addaudithook(hook)
    return deeds


def _stop_at_the_work() -> None:
    from duhem.identification import estimation
    from duhem.path import scene
    from duhem.proof import verification

    def reached(*_: object, **__: object) -> Any:
        raise _Reached

    verification.verify = scene.perform = estimation.estimated = reached


def campaign(counts: dict[str, int], seed: int, through: int = 0, keep: Path | None = None) -> tuple[Counter[tuple[str, str]], list[str]]:
    """How many runs of each kind ended how, and what must not be, each with the number of its case."""
    ends: Counter[tuple[str, str]] = Counter()
    faults: list[str] = []
    slowest: dict[str, tuple[float, float]] = {}
    sys.dont_write_bytecode = True
    prepare()
    for number, case in enumerate(cases(counts, Random(seed))):
        whole = bool(through) and number % through == 0
        found = outcome(case, whole)
        ends[case.kind, "reached the work" if found.code is None and not found.faults else f"{found.code}"] += 1
        if not whole:
            old = slowest.get(case.kind, (0.0, 0.0))
            slowest[case.kind] = max(old[0], found.seconds), max(old[1], found.megabytes)
        if found.faults:
            faults.append(f"{case.kind} {number}: {'; '.join(found.faults)}: {' '.join(case.arguments)[:80]!r}: {found.message[:300]!r}")
            for name, content in case.files.items() if keep else ():
                (keep / f"{number}-{name}").write_bytes(content)  # type: ignore[operator]
    for kind, (seconds, megabytes) in slowest.items():
        ends[kind, f"most: {seconds:.1f} s and {megabytes:.0f} MB"] += 1
    return ends, faults


def prepare() -> None:
    """Everything that a run imports is there before it is forked off, so that its own cost shows."""
    import duhem.identification.estimation
    import duhem.law.parameter_domain
    import duhem.path.scene
    import duhem.path.scene_file
    import duhem.proof.recheck
    import duhem.proof.report
    import duhem.proof.verification  # noqa: F401
    from duhem.cli import cli

    list(cli.commands.values())  # a verb is imported when its command is asked for
    for law in ("coulomb", "limacon"):
        catalogue.load(law)


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser()
    for kind, count in (("file", 300), ("scene", 200), ("table", 100), ("setting", 100)):
        parser.add_argument(f"--{kind}s", type=int, default=count, dest=kind)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--through", type=int, default=0)
    parser.add_argument("--keep", type=Path)
    given = parser.parse_args(arguments)
    counts = {kind: getattr(given, kind) for kind in ("file", "scene", "table", "setting")}
    ends, faults = campaign(counts, given.seed, given.through, given.keep)
    for (kind, end), count in sorted(ends.items()):
        print(f"{kind:8} {end:30} {count}")
    print("\n".join(faults) or "nothing that must not be")
    return bool(faults)


if __name__ == "__main__":
    raise SystemExit(main())
