"""Certificates with one thing changed: numbers, signs, formulas, domains, claims, rules, evidence; half of the time with a new hash.

    python -m tests.campaigns.tampering 2000

None may confirm what is false of the law that then stands in it.  Where that is another law, the refuters of duhem are asked;
a potential is compared with the greatest sigma . d along the boundary.  A quarter have other labels too: all claims are called
proved on the word of a prover, with their rules or without, or a verdict or a version is spelt otherwise; ``recheck`` may not
pass one (exit 0) in which anything called proved is not confirmed.
"""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from fractions import Fraction
from random import Random
from typing import Any, NamedTuple

from duhem import Criterion, Domain, InputError, Verdict, verify
from duhem.proof.kernel.certificate import Rechecked, digest, recheck
from duhem.proof.kernel.term import NotWritten, parse
from duhem.proof.recheck import recheck as rechecked
from tests.campaigns.families.table import trials
from tests.oracles import drawn_formulas

LAWS = ("antoni2007", "coulomb", "superellipse", "shifted-ellipse", "limacon", "radial-flow", "capped", "drucker1949", "quartic")


class Tampering(NamedTuple):
    """How many were refused, how many were about another law, how many said nothing false, and those that did."""

    refused: int
    other_laws: int
    harmless: int
    wrong: tuple[str, ...]


def tampering(made: Mapping[str, dict[str, Any]], count: int, seed: int, laws: Sequence[str] = LAWS) -> Tampering:
    """``count`` certificates of some of the laws, each changed in one place."""
    rng, refused, other_laws, harmless, wrong = Random(seed), 0, 0, 0, list[str]()
    for _ in range(count):
        original = made[rng.choice(laws)]
        copy = tampered(original, rng)
        try:
            rows = recheck(copy)
        except NotWritten:
            refused += 1
            continue
        if copy["law"] == original["law"]:
            told = {c["claim"]: c["verdict"] for c in original["claims"]}
            false = [r.claim for r in rows if r.confirmed and told[r.claim] == "refuted"]
        else:
            other_laws += 1
            false = refuted_of(copy["law"], rows)
        if rechecked(copy).ok:
            false += [r.claim for r in rows if r.verdict == "proved" and not r.confirmed]
        if any(r.claim == "duality" and r.confirmed for r in rows) and _stated(copy) != _stated(original):
            false += [] if dual(copy) else ["duality"]
        harmless += not false
        wrong += [f"{false} of {json.dumps(copy['law'])}"] if false else []
    return Tampering(refused, other_laws, harmless, tuple(wrong))


def tampered(made: dict[str, Any], rng: Random) -> dict[str, Any]:
    """The certificate with one leaf changed, and the hash made anew half of the time."""
    copy = json.loads(json.dumps(made))
    part = copy["law"] if rng.random() < 0.5 else copy
    *path, last = rng.choice(list(leaves(part)))
    for key in path:
        part = part[key]
    part[last] = changed(part[last], rng)
    if rng.random() < 0.25:
        return otherwise_labelled(copy, rng)
    return copy | {"sha256": digest(copy)} if rng.random() < 0.5 else copy


def otherwise_labelled(made: dict[str, Any], rng: Random) -> dict[str, Any]:
    """The certificate with labels that its writer might like better, and the hash that goes with them."""
    way = rng.randrange(4)
    if way < 2:
        return relabelled(made, rng.choice(("prover", "solver")), offered=way == 0)
    claims = json.loads(json.dumps(made["claims"]))
    if way == 2 and isinstance(claims, list):
        row = rng.choice(claims)
        row["verdict"] = rng.choice(("proved ", "Proved", "PROVED", " proved", "proved\n", "pr\u043eved", True))
    copy = made | {"claims": claims} | ({"schema": rng.choice(("duhem certificate 1", "duhem certificate 3", "", 2))} if way == 3 else {})
    return copy | {"sha256": digest(copy)}


def relabelled(made: Mapping[str, Any], trust: str, offered: bool) -> dict[str, Any]:
    """The certificate with everything called proved on the word of a prover or solver, the rules ``offered`` still or not."""
    claims = made["claims"]
    if isinstance(claims, list):
        less = {} if offered else {"rule": None, "evidence": {}}
        claims = [{**row, "verdict": "proved", "trust": trust, **less} if isinstance(row, dict) else row for row in claims]
    copy = {**made, "claims": claims}
    return copy | {"sha256": digest(copy)}


def leaves(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """The places of all values in a document."""
    if isinstance(value, dict | list) and value:
        for key in value if isinstance(value, dict) else range(len(value)):
            yield from leaves(value[key], (*path, key))
    else:
        yield path


def changed(value: Any, rng: Random) -> Any:
    if isinstance(value, str) and rng.random() < 0.8:
        at = rng.randrange(len(value) + 1)
        mark = rng.choice(("", "-", "2", "0", "+", "1/", "*", "abs", " ", "9"))
        return value[:at] + mark + value[at + rng.choice((0, 1)) :]
    return rng.choice((None, True, "proved", "convexity", "0", [], {}, "checked", 1, "-1", "fenchel", "composition"))


def refuted_of(stated: dict[str, Any], rows: tuple[Rechecked, ...]) -> list[str]:
    """Claims that were confirmed and that duhem refutes, for the law as it stands in the certificate."""
    confirmed = [r.claim for r in rows if r.confirmed and r.claim != "state_laws"]
    fields = {k: stated[k] for k in ("g", "forces", "pressure", "constraints", "flow")}
    domains = {n: _domain(entry) for n, entry in stated["parameters"].items()}
    try:
        found = verify(Criterion(name="tampered", parameters=domains, **fields), claims=confirmed)
    except InputError:  # undefined at some parameters
        return [claim for claim in confirmed if claim != "normality"]
    return [claim for claim in confirmed if found[claim].verdict is Verdict.REFUTED]


def _stated(document: Mapping[str, Any]) -> tuple[Any, Any]:
    """The law, and what is said of its potential."""
    return document["law"], [c["evidence"] for c in document["claims"] if c["claim"] == "duality"]


def dual(document: Mapping[str, Any]) -> bool:
    """Whether the potential is sup sigma . d over K, two per cent apart at most, at the parameters given; a law it cannot follow passes."""
    stated, (claim,) = document["law"], (c for c in document["claims"] if c["claim"] == "duality")
    at = {name: float(Fraction(x)) for name, x in document["inhabited"].items()} | {stated["pressure"]: -1.0}
    g, potential, slips = parse(stated["g"]), parse(claim["evidence"]["potential"]), claim["evidence"]["slips"]
    directions = [(math.cos(t), math.sin(t)) for t in (2 * math.pi * k / 720 for k in range(240))]

    def level(x: float, y: float) -> float:
        return drawn_formulas.value(g, at | dict(zip(stated["forces"], (x, y), strict=True)))

    try:
        reaches = [_reach(lambda r, c=c, s=s: level(r * c, r * s)) for c, s in directions]
        for c, s in directions[::30]:
            here = drawn_formulas.value(potential, at | dict(zip((slips[f] for f in stated["forces"]), (c, s), strict=True)))
            most = max(r * (x * c + y * s) for r, (x, y) in zip(reaches, directions, strict=True))
            if abs(here - most) > 0.02 * (abs(here) + abs(most)):
                return False
    except (KeyError, ValueError, OverflowError):  # another vocabulary, three forces, a K that is not around 0 or has no end
        return True
    return True


def _reach(level: Callable[[float], float]) -> float:
    """How far a ray from 0 stays in K."""
    low, high = 0.0, 1.0
    while level(high) <= 0:
        low, high = high, 2 * high
        if high > 1e9:
            raise OverflowError
    if level(0.0) > 0:
        raise ValueError
    for _ in range(24):
        middle = (low + high) / 2
        low, high = (middle, high) if level(middle) <= 0 else (low, middle)
    return low


def _domain(entry: dict[str, Any]) -> Domain:
    if "value" in entry:
        return Domain.fixed(entry["value"])
    high = Domain.between(None, entry.get("max")).high
    return Domain(Domain.between(0).low, high, positive=True) if entry.get("positive") else Domain.between(entry.get("min"), high)


def drawn() -> Iterator[Criterion]:
    """Laws whose certificates have evidence of other kinds: identities, points inside, polyhedra."""
    yield from (trial.law for trial in trials(18, 2) if trial.family in ("even quartic", "shifted ellipse", "polygon", "two ellipses"))


if __name__ == "__main__":
    certificates = {name: verify(name).certificate() for name in (*LAWS, "polygon", "tresca", "von-mises", "hosford", "lobes")}
    certificates |= {law.name: verify(law).certificate() for law in drawn()}
    found = tampering(certificates, int(sys.argv[1]) if len(sys.argv) > 1 else 2000, 1, tuple(certificates))
    print(f"refused {found.refused}, about another law {found.other_laws}, nothing false {found.harmless}, wrong {len(found.wrong)}")
    print(*found.wrong, sep="\n")
