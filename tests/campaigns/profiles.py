"""Drawn laws with a profile along a load, put to the kernel: a chord of K that leaves it contradicts what is proved.

python -m tests.campaigns.profiles 2000 --seed 1
"""

from __future__ import annotations

import argparse
import random
import re
import sys
from collections.abc import Iterator, Sequence

import numpy as np

from duhem import Criterion, Domain, InputError
from duhem.expression.numpy_ import evaluate
from duhem.law.domain import POSITIVE
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.certificate import stated
from duhem.proof.kernel.claims import objection
from duhem.proof.kernel.steps import TooDearError, within

__all__ = ["drawn", "leaves", "proved"]

_FACTORS = (
    "p", "p", "(c - p)", "(1 - p/c)", "p**2", "pos(1 - p/c)**b", "(1 - p/c)**b", "(1 - (p/c)**n)", "(1 - b*log(p/c))", "log(p/c)",
    "(-log(p/c))", "log(1 + p)", "sqrt(p*(c - p))", "exp(p)", "exp(-p)", "(c + h*p)", "(2*p - c)", "(2*p - c)**2", "(p/c)**n", "p**n",
    "p**b", "(c - p)**2", "(2 + h)", "(-log(p/c))**b", "(1 + p)**-1", "p**-1", "(c + p)**-1", "abs(p)", "max(p, c - p)", "min(p, c - p)",
    "(q + 2*p)", "(p + t)", "where(p > 0, p*log(p/c), 0)", "where(p > 0, p**n*log(p/c), 0)", "(max(p, q) - min(p, t))",
)  # fmt: skip
_SIZES = (
    "abs(q)", "q**2", "norm(q, t)", "(abs(q)/(m*p))**n", "(q - a*p)**2", "(q - a*p)**2 + t**2", "sqrt(q**2 + b)", "q**4", "(abs(q)/p)**2",
    "q**3", "(q + t)**3", "q**2/p", "(q**2 + t**2)**2", "0*q", "abs(q)**n", "(max(p, q) - min(p, t))**n",
)  # fmt: skip
_ENDS = ("p - c", "-p", "c - 2*p", "p + t - c", "-t")
_between = Domain.between
_DOMAINS = {
    "n": (_between(1), _between(0), _between("1/2", 3), _between(1, 4), _between(-1, 2)),
    "b": (_between("1/10", 1), _between(0, 1), _between("1/10", 2), POSITIVE),
    "h": (_between(0, 1), _between("-9/10", 1), _between(-1, 1), _between(-2, "1/2")),
    "m": (POSITIVE,), "c": (POSITIVE,), "a": (Domain(), _between(-1, 1)),
}  # fmt: skip
_STEPS, _PAIRS, _CHOICES, _ABOVE = 400_000, 3_000, 8, 1e-7


def drawn(rng: random.Random) -> Iterator[Criterion]:
    """Laws without end; those that cannot be laws are left out."""
    while True:

        def product(most: int = 3) -> str:
            return "*".join(rng.choice(_FACTORS) for _ in range(rng.randint(1, most)))

        profile = f"{rng.choice(('', 'm*', '-', '2*'))}({product()}{rng.choice(('', '', f' + {product(2)}'))})"
        g = f"{rng.choice(_SIZES)}{rng.choice((' - ', ' - ', ' + '))}{profile}{rng.choice(('', '', ' - 1', ' + c'))}"
        if rng.random() < 0.15:
            g = f"({rng.choice(_SIZES)})/({rng.choice(('p', 'p**2', '(c - p)', 'p*(1 + p)'))}) - {rng.choice('cmh')}"
        ends = [end for end in _ENDS if rng.random() < 0.35]
        g = f"max({', '.join((g, *ends))})" if ends else g
        forces = tuple(x for x in "qpt" if re.search(rf"\b{x}\b", g))
        ranges = {"p": _between(0)} if "p" in forces and rng.random() < 0.4 else {}
        parameters = {name: rng.choice(own) for name, own in _DOMAINS.items() if re.search(rf"\b{name}\b", g)}
        try:
            yield Criterion("drawn", g, parameters, forces, None, domain=ranges)
        except InputError:
            continue


def proved(law: Criterion) -> bool:
    """Whether the kernel proves that K is convex by composition."""
    try:
        with within(_STEPS):
            return not objection("convexity", "composition", frozenset(), stated(law_as_text(law)), {})
    except TooDearError:
        return False


def leaves(law: Criterion, rng: random.Random) -> bool:
    """Whether a chord of K leaves it, in floats, at some parameters of the domain."""
    numbers, symbols = np.random.default_rng(rng.randrange(10**9)), law.symbols()
    for _ in range(_CHOICES):
        values = {}
        for name, own in law.parameters.items():
            low, high = max(own.ends[0], 0.05 if own.positive else -3), min(own.ends[1], 5)
            values[symbols[name]] = rng.choice((low, high, rng.uniform(low, high)))
        points = numbers.uniform(-3, 3, (2, _PAIRS, len(law.forces))) * rng.choice((0.1, 1, 3))
        for i, name in enumerate(law.forces):
            points[..., i] = np.abs(points[..., i]) if name in law.domain else points[..., i]
        with np.errstate(all="ignore"):
            places = (values | dict(zip(law.force_symbols(), x.T, strict=True)) for x in (*points, points.mean(axis=0)))
            one, two, middle = (np.broadcast_to(np.asarray(evaluate(law.g, place), dtype=float), (_PAIRS,)) for place in places)
        outside = ~(middle <= _ABOVE * (1 + np.abs(one) + np.abs(two)))  # also where it has no value
        if np.any((one <= 0) & (two <= 0) & outside):
            return True
    return False


def main(arguments: Sequence[str] | None = None) -> int:
    """Print what is contradicted, and how many were proved; 1 if anything is."""
    parser = argparse.ArgumentParser(prog="python -m tests.campaigns.profiles", description=(__doc__ or "").split("\n", 1)[0])
    parser.add_argument("count", type=int, nargs="?", default=2000)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args(arguments)
    rng = random.Random(given.seed)
    laws = [law for law, _ in zip(drawn(rng), range(given.count), strict=False) if proved(law)]
    wrong = [law for law in laws if leaves(law, rng)]
    for law in wrong:
        print(f"wrong: {law.written}, {law!r}")
    print(f"{given.count} laws, {len(laws)} proved, {len(wrong)} wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
