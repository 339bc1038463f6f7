"""Runs killed at moments of chance, and gone on with until they end: the table is that of a run left alone, to the last byte.

python -m tests.campaigns.killed 20 kills each kind of run 20 times, by SIGTERM, SIGINT and SIGKILL in turn.  What SIGKILL loses
is the time since the last checkpoint of the process, which is printed: at most half a second for one point, as its scene says, or
nine times what writing one takes; a share of the points where there are many.
"""

import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

ONE = """\
law = "{law}"
stiffness = [1.0, 2.0]
[parameters]
{parameters}
[path]
kind = "random"
seed = 3
points = 40
scale = 0.3
pressure = -1.0
[method]
integrator = "{integrator}"
substeps = {substeps}
[output]
checkpoint = 0.5
"""
MANY = """\
law = "antoni2007"
stiffness = [1.0, 2.0]
[parameters]
mu_a_minus = 0.08
mu_b_plus = 0.12
mu_b_minus = 0.15
[points]
table = "points.csv"
[path]
kind = "random"
seed = 3
points = 60
scale = 0.3
[method]
substeps = 2
[output]
keep = 20
"""
ELLIPSE = "mu_a_plus = 0.2\nmu_a_minus = 0.08\nmu_b_plus = 0.12\nmu_b_minus = 0.15"
SCENES = {
    "implicit": ONE.format(law="antoni2007", parameters=ELLIPSE, integrator="implicit", substeps=120),
    "extrapolated": ONE.format(law="antoni2007", parameters=ELLIPSE, integrator="extrapolated", substeps=35),
    "exact": ONE.format(law="orthotropic", parameters="mu_a = 0.2\nmu_b = 0.1", integrator="exact", substeps=250),
    "many points": MANY,
}
SIGNALS = (signal.SIGTERM, signal.SIGINT, signal.SIGKILL)


def run(folder: Path, *options: str) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", "duhem", "simulate", "scene.toml", "--out", "h.csv", *options]
    return subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, env=dict(os.environ))


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


def campaign(kind: str, kills: int, chance: random.Random) -> tuple[int, int, float]:
    """How often it was killed before its end, how many tables differ, and the seconds that SIGKILL lost at most."""
    folder = prepared(SCENES[kind])
    began = time.monotonic()
    assert ended(run(folder)) == 0
    took = time.monotonic() - began
    right = (folder / "h.csv").read_bytes()
    done, wrong, lost = 0, 0, 0.0
    while done < kills:
        (folder / "h.csv").unlink()
        for _ in range(3):
            process, sent, started = run(folder, "--resume"), SIGNALS[done % 3], time.time()
            time.sleep(chance.uniform(0.05, 0.95) * took)
            kept = folder / "h.csv.partial"
            before = kept.stat().st_mtime if kept.exists() else None
            process.send_signal(sent)
            moment = time.time()
            if ended(process) == 0:
                break
            done += 1
            if sent == signal.SIGKILL and before is not None and before > started:  # kept by this very process
                lost = max(lost, moment - before)
        else:
            assert ended(run(folder, "--resume")) == 0
        wrong += (folder / "h.csv").read_bytes() != right or bool(list(folder.glob("h.csv.partial*")))
    return done, wrong, lost


def main(kills: int, seed: int = 1) -> int:
    bad = 0
    for kind in SCENES:
        done, wrong, lost = campaign(kind, kills, random.Random(f"{seed} {kind}"))
        bad += wrong
        print(f"{kind}: killed {done} times, {wrong} tables differ; SIGKILL came at most {lost:.2f} s after a checkpoint", flush=True)
    return bad


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:] or ["20"])) > 0)
