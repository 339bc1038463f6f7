"""What a step of a law with a state costs, by arrays and compiled: kinematic hardening in six components, points by steps.

    python -m tests.campaigns.state_steps [POINTS [STEPS]]

Printed are microseconds of processor time a point and step, the best of three runs of each way, their ratio, and by how much the two
histories differ.  10,000 points and 1,000 steps take some minutes.
"""

from __future__ import annotations

import sys
import time

import numpy as np

from duhem import POSITIVE, Criterion, Path, Paths, simulate
from duhem.law.state import Variable
from duhem.path.state_path import StateHistory

ENDS = ("11", "22", "33", "12", "13", "23")
DIAGONAL, SHEAR = ENDS[:3], ENDS[3:]


def hardening() -> Criterion:
    """Von Mises with a linear back stress; strains 2 e_12 and so on, as engineers write them."""
    mean = "(" + " + ".join(f"s{end} + x{end}" for end in DIAGONAL) + ")/3"
    squares = [f"(s{end} + x{end} - {mean})**2" for end in DIAGONAL] + [f"2*(s{end} + x{end})**2" for end in SHEAR]
    volume = " + ".join(f"u{end} - p{end}" for end in DIAGONAL)
    shape = [f"(u{end} - p{end} - ({volume})/3)**2" for end in DIAGONAL] + [f"(u{end} - p{end})**2/2" for end in SHEAR]
    back = " + ".join(f"a{end}**2{'/2' * (end in SHEAR)}" for end in ENDS)
    variables = {f"u{end}": Variable(f"s{end}", observable=True) for end in ENDS}
    variables |= {f"p{end}": Variable(f"s{end}") for end in ENDS} | {f"a{end}": Variable(f"x{end}") for end in ENDS}
    return Criterion(
        "hardening", f"sqrt(3/2*({' + '.join(squares)})) - R", dict.fromkeys("RKGC", POSITIVE),
        tuple(f"{kind}{end}" for kind in "sx" for end in ENDS), None,
        energy=f"K/2*({volume})**2 + G*({' + '.join(shape)}) + C/3*({back})", variables=variables,
    )  # fmt: skip


def main() -> int:
    """Print the table; 1 if the histories differ by more than 1e-10 of the largest stress."""
    points, steps = (int(text) for text in (*sys.argv[1:], *("10000", "1000")[len(sys.argv) - 1 :]))
    ends = np.array([[0.0] * 6, [0.02, -0.01, -0.01, 0.02, 0.0, 0.0], [-0.02, 0.01, 0.01, 0.01, 0.01, 0.0]])
    law, numbers = hardening(), {"R": 1.0, "K": 500.0, "G": 300.0, "C": 30.0}

    def asked(compiled: bool, n: int, m: int) -> tuple[float, StateHistory]:
        paths = Paths.scaled(Path.linear(ends), np.random.default_rng(0).uniform(0.5, 2.0, n))
        begun = time.process_time()
        found = simulate(law, paths, parameters=numbers, substeps=m // 2, keep="last", compiled=compiled)
        assert isinstance(found, StateHistory)
        return (time.process_time() - begun) / (n * m) * 1e6, found

    asked(True, 2, 2)  # compiled, or found on disk
    quick = [asked(True, points, steps) for _ in range(3)]
    slow = [asked(False, min(points, 2048), min(steps, 50)) for _ in range(3)]
    _, other = asked(True, min(points, 2048), min(steps, 50))
    apart = float(np.abs(other.force - slow[0][1].force).max() / np.abs(other.force).max())
    best, worst = min(cost for cost, _ in quick), min(cost for cost, _ in slow)
    print(
        f"compiled: {best:.1f} us a point and step, {points} points, {steps} steps; arrays: {worst:.1f}, {worst / best:.1f} times as much"
    )
    print(f"stresses differ by {apart:.1e} of the largest")
    return int(not apart <= 1e-10)


if __name__ == "__main__":
    sys.exit(main())
