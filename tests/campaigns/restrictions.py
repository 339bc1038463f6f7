"""Whether a narrower question gets an answer that is no weaker: of a proved law, some parameters fixed, smaller ranges, fewer claims.

What is proved over a domain holds on every part of it; so a restriction must keep the verdict *proved* and its trust, or better.

    python -m tests.campaigns.restrictions --count 2000 --seed 1
"""

from __future__ import annotations

import argparse
import random
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import sympy as sp

from duhem import Criterion, Domain, InputError, Verdict, load, verify
from duhem.law import catalogue
from duhem.law.atlas.entry import groups
from duhem.proof.claims import CLAIMS
from duhem.proof.verdict import ClaimResult, Trust

__all__ = ["Restriction", "restrictions", "weaker"]


@dataclass(frozen=True)
class Restriction:
    """A law of the catalogue or the atlas over a part of its domain, and the claims that are asked of it."""

    law: str
    ranges: Mapping[str, Domain]
    claims: tuple[str, ...]

    def __str__(self) -> str:
        told = [domain.stated(name) for name, domain in self.ranges.items()]
        claims = ", ".join(self.claims) if len(self.claims) < len(CLAIMS) else "all claims"
        return f"{self.law} ({', '.join(told) or 'all parameters'}): {claims}"

    def results(self) -> tuple[ClaimResult, ...]:
        """What is said of it."""
        law = load(self.law)
        fixed = {name: domain.value for name, domain in self.ranges.items() if domain.value is not None}
        left = {name: domain for name, domain in self.ranges.items() if domain.value is None}
        narrowed = law.within(left) if isinstance(law, Criterion) and left else law
        return verify(narrowed, fixed, self.claims).results


def restrictions(count: int, seed: int, names: Sequence[str] = ()) -> Iterator[Restriction]:
    """So many, drawn from the laws of the names, all of them without any."""
    rng = random.Random(seed)
    names = names or (*catalogue.names(), *(name for group in groups().values() for name in group))
    while count > 0:
        name = rng.choice(names)
        law = load(name)
        free = [x for x, domain in law.parameters.items() if domain.value is None]
        chosen = rng.sample(free, min(len(free), rng.choice((0, 1, 1, 2, len(free)))))
        ranges = {x: _part(law.parameters[x], rng, isinstance(law, Criterion)) for x in chosen}
        claims = tuple(CLAIMS) if ranges and rng.random() < 0.5 else (rng.choice(tuple(CLAIMS)),)
        if not _empty(law, ranges):
            count -= 1
            yield Restriction(name, ranges, claims)


def _part(domain: Domain, rng: random.Random, ranges: bool) -> Domain:
    """A value or a range within a domain; a plain value, an end, or one with many digits."""
    low = sp.S.Zero if domain.low is None else domain.low
    high = low + sp.Rational(rng.choice(("1", "10", "1/10"))) if domain.high is None else domain.high

    def inside() -> sp.Rational:
        share = rng.choice(("1/2", "1/10", "9/10", "1/3", f"{rng.randrange(1, 999)}/1000"))
        return low + (high - low) * sp.Rational(share)

    if not ranges or rng.random() < 0.6:
        closed = [end for end in (None if domain.positive else domain.low, domain.high) if end is not None]
        return Domain.fixed(rng.choice(closed) if closed and rng.random() < 0.3 else inside())
    return Domain.between(*sorted((inside(), inside())))


def _empty(law: object, ranges: Mapping[str, Domain]) -> bool:
    """Whether no values are left, or a formula that has none."""
    try:
        Restriction(law.name, ranges, ("state_laws",)).results()  # type: ignore[attr-defined]
    except InputError:
        return True
    return False


def weaker(asked: Restriction, whole: Mapping[str, ClaimResult]) -> list[str]:
    """The claims that are proved of the whole law and not so of the part, or with less trust."""
    trusts, found = list(Trust), []
    for result in asked.results():
        before = whole.get(result.claim)  # one about heat is asked of a law without heat only by its name
        if before is None or before.verdict is not Verdict.PROVED or before.trust is None:
            continue
        kept = result.verdict is Verdict.PROVED and result.trust is not None and trusts.index(result.trust) <= trusts.index(before.trust)
        if not kept:
            found.append(f"{result.claim} {before.verdict}/{before.trust} -> {result.verdict}/{result.trust} ({result.method})")
    return found


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the campaign, print each weaker answer and the count; 1 if there is one."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("names", nargs="*", help="laws in place of all of the catalogue and the atlas")
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args(arguments)
    known: dict[str, Mapping[str, ClaimResult]] = {}
    bad = done = 0
    for one in restrictions(asked.count, asked.seed, asked.names):
        if one.law not in known:
            known[one.law] = {result.claim: result for result in verify(one.law).results}
        done += 1
        if found := weaker(one, known[one.law]):
            bad += 1
            print(f"WEAKER {one}: {'; '.join(found)}", flush=True)
    print(f"{done} restrictions of {len(known)} laws, weaker answers: {bad}")
    return int(bad > 0)


if __name__ == "__main__":
    sys.exit(main())
