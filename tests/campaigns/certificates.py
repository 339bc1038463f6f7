"""Every proof of the built-in laws and of generated ones, written down and checked by a process that has only the kernel.

    python -m tests.campaigns.certificates 100

That process can import neither SymPy, NumPy, z3, FLINT, CVXPY nor anything of duhem but the kernel.  Printed: the share of
proofs that it confirms, what each other one rests on, what the kernel took of the time, and any claim called `checked`
that it does not confirm (exit code 1).
"""

from __future__ import annotations

import json
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import duhem
from duhem.law import catalogue
from duhem.law.curve_law import Law
from duhem.proof import verification
from tests.campaigns.families.table import trials

__all__ = ["KERNEL_ALONE", "Written", "rechecked", "written"]

KERNEL_ALONE = """
import importlib.abc, json, sys

class OnlyTheKernel(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path=None, target=None):
        known = name in ("duhem", "duhem.version", "duhem.proof") or name.startswith("duhem.proof.kernel")
        if name.partition(".")[0] in ("sympy", "mpmath", "numpy", "scipy", "z3", "flint", "cvxpy", "duhem") and not known:
            raise ImportError(f"{name} is not the kernel's")

sys.meta_path.insert(0, OnlyTheKernel())
from duhem.proof.kernel.certificate import recheck
for line in sys.stdin:
    print(json.dumps([[r.claim, r.verdict, r.trust, r.confirmed] for r in recheck(json.loads(line))]), flush=True)
"""


class Written(NamedTuple):
    """A law's certificate and the seconds that its verification and, within it, the kernel took."""

    family: str
    document: dict[str, Any]
    seconds: float
    kernel: float


def laws(count: int) -> Iterator[tuple[str, Law]]:
    """The built-in laws and ``count`` of the campaign."""
    yield from (("built-in", duhem.load(name)) for name in catalogue.names())
    yield from ((trial.family, trial.law) for trial in trials(count, 1))


def written(family: str, law: Law) -> Written:
    """The law verified, its proofs written down."""
    spent, of = [0.0], verification.Confirmations.of

    def timed(*arguments: Any) -> Any:
        start = time.perf_counter()
        found = of(*arguments)
        spent[0] += time.perf_counter() - start
        return found

    verification.Confirmations.of = timed  # type: ignore[method-assign]
    try:
        start = time.perf_counter()
        found = duhem.verify(law)
        seconds = time.perf_counter() - start
    finally:
        verification.Confirmations.of = of  # type: ignore[method-assign]
    return Written(family, found.certificate(), seconds, spent[0])


def rechecked(documents: Sequence[Mapping[str, Any]]) -> list[dict[str, bool]]:
    """Of each certificate the proofs, and whether the kernel confirms them in a process of its own."""
    text = "".join(json.dumps(d) + "\n" for d in documents)
    done = subprocess.run([sys.executable, "-c", KERNEL_ALONE], input=text, capture_output=True, text=True, check=True)
    return [
        {claim: confirmed for claim, verdict, _, confirmed in json.loads(row) if verdict == "proved"} for row in done.stdout.splitlines()
    ]


def main(count: int) -> int:
    """Print the shares; 1 if a claim that is called checked is not confirmed."""
    found = [written(*law) for law in laws(count)]
    confirmed = rechecked([w.document for w in found])
    proofs, rest, wrong = Counter[str](), Counter[tuple[str, str, str]](), 0
    for w, answers in zip(found, confirmed, strict=True):
        for claim in w.document["claims"]:
            if claim["verdict"] != "proved":
                continue
            where = "built-in" if w.family == "built-in" else "generated"
            proofs[f"{where} {claim['trust']}"] += 1
            if (claim["trust"] == "checked") is not answers[claim["claim"]]:
                wrong += 1
                print(f"WRONG {w.document['law']['name']} {claim['claim']}: {claim['trust']}, but {answers[claim['claim']]}")
            if claim["trust"] != "checked":
                name = w.document["law"]["name"] if where == "built-in" else w.family
                rest[name, claim["claim"], f"{claim['trust']}: {claim['method']}"] += 1
    for where in ("built-in", "generated"):
        mine = {key.split()[1]: n for key, n in proofs.items() if key.startswith(where)}
        here = [w for w in found if (w.family == "built-in") is (where == "built-in")]
        total, seconds, kernel = sum(mine.values()), sum(w.seconds for w in here), sum(w.kernel for w in here)
        if total:
            share = f"{mine.get('checked', 0)} of {total} proofs checked ({100 * mine.get('checked', 0) / total:.1f} %)"
            print(f"{where}: {len(here)} laws, {share}; {seconds:.1f} s, the kernel {100 * kernel / seconds:.1f} % of it")
    for (name, claim, why), n in sorted(rest.items()):
        print(f"  {n:4} {name}, {claim}: {why}")
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]) if len(sys.argv) > 1 else 100))
