"""Verdicts of the built-in laws with the time each takes: python -m tests.campaigns.known_laws"""

from __future__ import annotations

import time

from duhem import verify
from tests.oracles.literature import KNOWN


def main() -> None:
    """Print a line a law: seconds, verdicts, the slowest claim."""
    print(f"{'law':16} {'s':>6}  verdicts")
    for name in KNOWN:
        start = time.perf_counter()
        results = verify(name).results
        seconds = time.perf_counter() - start
        slowest = max(results, key=lambda r: r.seconds)
        verdicts = " ".join(f"{r.claim}={r.verdict}" for r in results)
        print(f"{name:16} {seconds:6.2f}  {verdicts}  (slowest: {slowest.claim} {slowest.seconds:.2f})")


if __name__ == "__main__":
    main()
