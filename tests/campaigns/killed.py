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

from tests.path.scenes import TABLE, walk

MU = {"mu_a_minus": 0.08, "mu_b_plus": 0.12, "mu_b_minus": 0.15}


def one(integrator: str, substeps: int, law: str = "antoni2007", **parameters: float) -> str:
    method = f'[method]\nintegrator = "{integrator}"\nsubsteps = {substeps}\n'
    return f"{walk(40, law=law, **parameters)}pressure = -1.0\n{method}[output]\ncheckpoint = 0.5\n"


SCENES = {
    "implicit": one("implicit", 120, mu_a_plus=0.2, **MU),
    "extrapolated": one("extrapolated", 35, mu_a_plus=0.2, **MU),
    "exact": one("exact", 250, law="orthotropic", mu_a=0.2, mu_b=0.1),
    "many points": f"{walk(60, TABLE, **MU)}[method]\nsubsteps = 2\n[output]\nkeep = 20\n",
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
