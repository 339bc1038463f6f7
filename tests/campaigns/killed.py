"""Runs killed at moments of chance, and gone on with until they end: the table is that of a run left alone, to the last byte.

python -m tests.campaigns.killed 20 kills each kind of run 20 times, by SIGTERM, SIGINT and SIGKILL in turn.  What SIGKILL loses
is told by the run itself, which notes each step with its time: the seconds that the steps took which are not kept.  One path may
lose those since its last checkpoint, due half a second after the one before as its scene says, or nine times what writing one takes;
many points those of the shares under way, and nothing that was noted as done.
"""

import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from itertools import pairwise
from pathlib import Path

import numpy as np

from duhem.api.histories import looked_into
from duhem.path import scene_file
from duhem.path.scene import perform, perform_many
from tests.path.scenes import TABLE, walk

CHECKPOINT = 0.5  # s
MU = {"mu_a_minus": 0.08, "mu_b_plus": 0.12, "mu_b_minus": 0.15}
BOX = {"mu_a": 0.2, "mu_b": 0.1}


def one(integrator: str, substeps: int, law: str = "antoni2007", compiled: bool = False, **parameters: float) -> str:
    method = f'[method]\nintegrator = "{integrator}"\nsubsteps = {substeps}\n{"compiled = true" if compiled else ""}\n'
    return f"{walk(40, law=law, **parameters)}pressure = -1.0\n{method}[output]\ncheckpoint = {CHECKPOINT}\n"


SCENES = {
    "implicit": one("implicit", 120, mu_a_plus=0.2, **MU),
    "extrapolated": one("extrapolated", 35, mu_a_plus=0.2, **MU),
    "exact": one("exact", 250, law="orthotropic", **BOX),
    "compiled": one("implicit", 800, law="box", compiled=True, **BOX),
    "many points": f"{walk(60, TABLE, **MU)}[method]\nsubsteps = 2\n[output]\nkeep = 20\n",
}
SIGNALS = (signal.SIGTERM, signal.SIGINT, signal.SIGKILL)


STEPS = "steps.txt"


def run(folder: Path, *options: str) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", "duhem", "simulate", "scene.toml", "--out", "h.csv", *options]
    return subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, env=dict(os.environ))


def noted(folder: Path) -> subprocess.Popen[bytes]:
    """The same run, gone on with, that notes what is done and when."""
    (folder / STEPS).unlink(missing_ok=True)
    command = [sys.executable, "-m", "tests.campaigns.killed", "--noting"]
    return subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, env=dict(os.environ))


def noting() -> None:
    """What :func:`noted` runs."""
    scene = looked_into(scene_file.read("scene.toml"))
    notes = os.open(STEPS, os.O_WRONLY | os.O_CREAT | os.O_APPEND)

    def on_step(done: int, steps: int) -> None:
        os.write(notes, f"{done} {time.monotonic()}\n".encode())

    if scene.many:
        perform_many(scene, "h.csv", True, print, on_step)
    else:
        perform(scene, "h.csv", True, on_step)


def lost(folder: Path, many: bool) -> tuple[float, float]:
    """The seconds that the steps took which the killed run had done and did not keep, and how many there may be.

    Of one path those to its next checkpoint, of which each falls between two notes and takes no longer than the longest pause of the
    run, and one such pause more: the step or the checkpoint in which it was killed.  Of many points none.
    """
    notes = (folder / STEPS).read_text().splitlines() if (folder / STEPS).exists() else []
    done = [(int(n), float(t)) for n, t in (line.split() for line in notes if line.count(" ") == 1)]
    part = folder / "h.csv.partial"
    lines = part.read_text().splitlines() if part.exists() else []
    kept = (int(lines[-1].split()[0]) if len(lines) > 1 else 0) if many else max(len(lines) - 3, 0)  # mark, header, the start
    missing = [i for i, (n, _) in enumerate(done) if n > kept]
    pause = max((after - before for (_, before), (_, after) in pairwise(done)), default=0.0)
    may = 0.0 if many else max(CHECKPOINT, 9.0 * pause) + pause
    if not missing or (folder / "h.csv").exists():  # it was killed as it left, after the table stood
        return 0.0, may
    return float("inf") if many else done[-1][1] - done[max(missing[0] - 1, 0)][1], may


def prepared(scene: str) -> Path:
    folder = Path(tempfile.mkdtemp(prefix="duhem-killed-"))
    (folder / "scene.toml").write_text(scene)
    draw = np.random.default_rng(5)
    rows = [f"{draw.choice([0.1, 0.2])},{draw.uniform(-2, -1)!r},{draw.normal()!r},{draw.normal()!r}" for _ in range(6_000)]
    (folder / "points.csv").write_text("mu_a_plus,sigma_n,scale_a,scale_b\n" + "\n".join(rows) + "\n")
    return folder


def ended(process: subprocess.Popen[bytes]) -> int:
    _, said = process.communicate()
    if process.returncode not in (0, 130, -signal.SIGKILL, -signal.SIGTERM, -signal.SIGINT):
        raise SystemExit(f"exit code {process.returncode}: {said.decode()[-300:]}")
    return process.returncode


def campaign(kind: str, kills: int, chance: random.Random) -> tuple[int, int, list[tuple[float, float]]]:
    """How often it was killed before its end, how many tables differ, and the seconds of steps that each SIGKILL lost and might."""
    folder = prepared(SCENES[kind])
    assert ended(run(folder)) == 0  # what is compiled is on disk from here on: kills are to fall on steps, not on a compiler
    (folder / "h.csv").unlink()
    began = time.monotonic()
    assert ended(run(folder)) == 0
    took = time.monotonic() - began
    right = (folder / "h.csv").read_bytes()
    done, wrong, losses = 0, 0, list[tuple[float, float]]()
    while done < kills:
        (folder / "h.csv").unlink()
        for _ in range(3):
            sent = SIGNALS[done % 3]
            process = noted(folder) if sent == signal.SIGKILL else run(folder, "--resume")
            time.sleep(chance.uniform(0.05, 0.95) * took)
            process.send_signal(sent)
            if ended(process) == 0:
                break
            done += 1
            if sent == signal.SIGKILL:
                losses.append(lost(folder, kind == "many points"))
        else:
            assert ended(run(folder, "--resume")) == 0
        wrong += (folder / "h.csv").read_bytes() != right or bool(list(folder.glob("h.csv.partial*")))
    return done, wrong, losses


def main(kills: int, seed: int = 1, *kinds: str) -> int:
    bad = 0
    for kind in kinds or SCENES:
        done, wrong, losses = campaign(kind, kills, random.Random(f"{seed} {kind}"))
        more = sum(loss > may for loss, may in losses)
        bad += wrong + more
        each = ", ".join(f"{loss:.2f} of {may:.2f}" for loss, may in losses)
        print(f"{kind}: killed {done} times, {wrong} tables differ; SIGKILL lost {each} s of steps, {more} times too many", flush=True)
    return bad


if __name__ == "__main__":
    if sys.argv[1:] == ["--noting"]:
        noting()
    else:
        count, *rest = sys.argv[1:] or ["20"]
        sys.exit(main(int(count), *map(int, rest[:1]), *rest[1:]) > 0)
