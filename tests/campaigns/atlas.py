"""Whether the verdicts that the atlas keeps are those that verifying its laws gives, every witness evaluated again.

    python -m tests.campaigns.atlas                     all laws; exit code 1 where one differs
    python -m tests.campaigns.atlas hill48 orowan       these
    python -m tests.campaigns.atlas --group soils       a group
    python -m tests.campaigns.atlas --write             keeps the new verdicts in the files

A verdict that differs because a new argument decides what was open is progress and is written; one that turns `proved` into
`refuted`, or back, is never written: it is a defect here or there.
"""

from __future__ import annotations

import argparse
import re
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from duhem import Criterion, Witness, load, verify
from duhem.law.atlas.entry import ASKED, AtlasEntry, entries, entry, file_of
from tests.oracles.reevaluation import confirmed

__all__ = ["Found", "found", "kept"]

_DECIDED = {"proved", "refuted"}


@dataclass(frozen=True)
class Found:
    """What verifying a law of the atlas gives: the verdicts, those that contradict the file, witnesses that do not hold.

    ``unheard`` are claims whose witness has no second opinion: the formula has a word that the other arithmetic lacks.
    """

    verdicts: Mapping[str, str]
    trusts: Mapping[str, str]
    contradictions: tuple[str, ...]
    witnesses: tuple[str, ...]
    unheard: tuple[str, ...]
    seconds: float


def found(said: AtlasEntry) -> Found:
    """Verify the law of an entry."""
    law, start = load(said.name), time.process_time()
    results = verify(law, claims=tuple(dict.fromkeys((*ASKED, *said.verdicts)))).results
    verdicts = {r.claim: r.verdict.value for r in results}
    against = tuple(c for c, v in verdicts.items() if {v, said.verdicts.get(c, v)} == _DECIDED)
    opinions = {r.claim: _confirmed(law, r.claim, r.witness) for r in results if r.witness}
    unheld, unheard = (tuple(c for c, holds in opinions.items() if holds is opinion) for opinion in (False, None))
    trusts = {r.claim: r.trust.value for r in results if r.trust is not None}
    return Found(verdicts, trusts, against, unheld, unheard, time.process_time() - start)


def _confirmed(law: Criterion, claim: str, witness: Witness) -> bool | None:
    """Whether the witness holds in another arithmetic; None where that lacks a word."""
    try:
        return confirmed(law, claim, witness)
    except NotImplementedError:
        return None


def kept(text: str, verdicts: Mapping[str, str]) -> str:
    """The text of a file of the atlas with these verdicts."""
    table = ", ".join(f'{claim} = "{verdict}"' for claim, verdict in verdicts.items())
    changed, count = re.subn(r"^verdicts = \{.*\}$", f"verdicts = {{ {table} }}", text, flags=re.M)
    assert count == 1, "the file keeps its verdicts on one line"
    return changed


def main(arguments: Sequence[str]) -> int:
    """Run the campaign; 1 where a verdict differs from the one that is kept, or a witness does not hold."""
    parser = argparse.ArgumentParser(prog="python -m tests.campaigns.atlas", description="the verdicts of the atlas, anew")
    parser.add_argument("names", nargs="*", help="laws of the atlas (left out: all)")
    parser.add_argument("--group", help="the laws of one group")
    parser.add_argument("--write", action="store_true", help="keep what is found in the files")
    given = parser.parse_args(arguments)
    laws = tuple(map(entry, given.names)) or entries(given.group)
    code, decided, asked, checked, proved = 0, 0, 0, 0, 0
    for said in laws:
        new = found(said)
        changed = {c: f"{said.verdicts.get(c, 'nothing')} -> {v}" for c, v in new.verdicts.items() if v != said.verdicts.get(c)}
        faults = [*(f"CONTRADICTS {c}" for c in new.contradictions), *(f"WITNESS of {c} does not hold" for c in new.witnesses)]
        notes = [*(f"{c}: {text}" for c, text in changed.items()), *(f"no second opinion on {c}" for c in new.unheard)]
        print(f"{said.name:32} {new.seconds:7.1f} s", *faults, *notes, sep="  ", flush=True)
        if faults or (changed and not given.write):
            code = 1
        if changed and given.write and not faults and (file := file_of(said.name)) is not None:
            file.write_text(kept(file.read_text("utf-8"), new.verdicts), "utf-8")
        asked += len(new.verdicts)
        decided += sum(v in _DECIDED | {"not_applicable"} for v in new.verdicts.values())
        proved += sum(v == "proved" for v in new.verdicts.values())
        checked += sum(t == "checked" for t in new.trusts.values())
    print(f"{len(laws)} laws; {decided} of {asked} claims decided, {checked} of {proved} proofs checked by the kernel")
    return code


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
