"""What duhem.project takes today and took at an older revision, side by side: python -m tests.campaigns.against REVISION [ROUNDS]

The older source is taken from git into a folder that is removed at the end.  Both answer the same 10,000 trials in processes of their
own, in alternation; the older by `method="newton"`, today's by what the call chooses, compiled.  Least times count, of the first call
after everything is compiled.  Wall time is what a user waits for; processor time does not notice a second core.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tarfile
import tempfile
from io import BytesIO
from pathlib import Path

ROOT = Path(__file__).parents[2]
LAWS: dict[str, dict[str, float]] = {
    "superellipse": {"mu_a": 0.3, "mu_b": 0.2, "p": 3},
    "hosford": {"yield_stress": 0.3, "m": 8},
    "drucker1949": {"k": 0.3, "c": 2},
    "von-mises": {"yield_stress": 0.3},
    "limacon": {"mu": 0.3, "e": 0.4},
    "box": {"mu_a": 0.3, "mu_b": 0.2},
    "tresca": {"yield_stress": 0.3},
}
POINTS = 10_000
MEASURED = """
import json, sys, time, warnings
import numpy as np
import duhem

warnings.simplefilter("ignore")
name, values, points, repeats, options = json.loads(sys.argv[1])
law = duhem.load(name)
draw = np.random.default_rng(0)
way = draw.normal(size=(points, len(law.forces)))
trial = way / np.linalg.norm(way, axis=1, keepdims=True) * draw.uniform(0.1, 1.5, (points, 1))
k = np.diag(1.0 + np.arange(len(law.forces)))
pressure = -1.0 if law.pressure else None

def call():
    return duhem.project(law, trial, pressure, k, values, **options)

call()
wall = processor = float("inf")
for _ in range(repeats):
    a, b = time.perf_counter(), time.process_time()
    found = call()
    wall, processor = min(wall, time.perf_counter() - a), min(processor, time.process_time() - b)
print(json.dumps([wall / points * 1e9, processor / points * 1e9, np.bincount(found.status, minlength=5).tolist()]))
"""


def measured(source: Path, name: str, repeats: int, options: dict[str, object]) -> tuple[float, float, list[int]]:
    """Nanoseconds a point, of wall and processor time, and how many points have which status."""
    asked = json.dumps([name, LAWS[name], POINTS, repeats, options])
    done = subprocess.run(
        [sys.executable, "-c", MEASURED, asked], env={**os.environ, "PYTHONPATH": str(source)}, capture_output=True, text=True
    )
    if done.returncode:
        raise SystemExit(f"{name} in {source}: {done.stderr.strip().splitlines()[-1]}")
    wall, processor, statuses = json.loads(done.stdout)
    return wall, processor, statuses


def main(revision: str, rounds: int = 2) -> None:
    """Print a row a law."""
    packed = subprocess.run(["git", "archive", revision, "src"], cwd=ROOT, check=True, capture_output=True).stdout
    with tempfile.TemporaryDirectory() as folder:
        with tarfile.open(fileobj=BytesIO(packed)) as archive:
            archive.extractall(folder, filter="data")
        print(f"{'ns a point, wall (processor)':28} {revision[:12]:>18} {'today':>18}   ratio  (processor)")
        for name in LAWS:
            old, new = [], []
            for _ in range(rounds):
                old.append(measured(Path(folder) / "src", name, 2, {"method": "newton"}))
                new.append(measured(ROOT / "src", name, 30, {"compiled": True}))
            (w, p), (w_now, p_now) = ((min(r[0] for r in rows), min(r[1] for r in rows)) for rows in (old, new))
            alike = "" if old[0][2] == new[0][2] else f"  statuses {old[0][2]} and {new[0][2]}"
            row = f"{name:28} {w:9.0f} ({p:6.0f}) {w_now:9.0f} ({p_now:6.0f}) {w / w_now:7.1f}  ({p / p_now:.1f}){alike}"
            print(row, flush=True)


if __name__ == "__main__":
    main(sys.argv[1], *map(int, sys.argv[2:]))
