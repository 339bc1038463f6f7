"""Laws of the words and forms of learned laws, of known truth: python -m tests.campaigns.learned [COUNT [SEED]]

Each is written as a file with tables beside it and read from there, so that sums, maxima and vectors are written out, and graphs are made.
Why each is convex or not stands with its family.  Prints what :mod:`tests.campaigns.polynomials` prints of its own.
"""

from __future__ import annotations

import random
import sys
import tempfile
from collections.abc import Callable, Iterator
from itertools import cycle
from pathlib import Path

import numpy as np

from duhem import load
from tests.campaigns.families.trial import Trial
from tests.campaigns.polynomials import run

Tables = dict[str, list[list[float]]]
Made = tuple[str, Tables, list[str], bool]  # g, tables, definitions, and whether K is convex


def _rows(rng: random.Random, height: int, width: int, least: float = -2.0) -> list[list[float]]:
    return [[round(rng.uniform(least, 2.0), 3) for _ in range(width)] for _ in range(height)]


def networks(rng: random.Random) -> Made:
    """Weights >= 0 after the first layer; with g turned over K is what a convex set leaves of the plane, no half-plane."""
    n, m, turned, word = rng.randint(3, 9), rng.randint(2, 9), rng.random() < 0.4, rng.choice(("softplus", "pos"))
    tables = {"A": [*_rows(rng, n, 2), [1.0, 0.3], [-1.0, 0.2], [0.2, -1.0]], "W": _rows(rng, m, n + 3, 0.01), "c": _rows(rng, 1, m, 0.1)}
    rows = [
        f'z = "vector(i, 1, {n + 3}, {word}(A[i, 1]*s + A[i, 2]*t))"',
        f'y = "vector(i, 1, {m}, {word}(sum(j, 1, {n + 3}, W[i, j]*z[j]) - 1/2))"',
    ]
    level = 5 + sum(sum(row) for row in tables["W"]) * 4
    f = f"sum(i, 1, {m}, c[i]*y[i])"
    return (f"{level:.3f} - {f}" if turned else f"{f} - {level:.3f}"), tables, rows, not turned


def log_sums(rng: random.Random) -> Made:
    """A smooth maximum is convex; a smooth minimum of two far discs has two pieces."""
    if rng.random() < 0.5:
        tables = {"A": _rows(rng, rng.randint(2, 12), 2)}
        n = len(tables["A"])
        return f"log(sum(i, 1, {n}, exp(A[i, 1]*s + A[i, 2]*t))) + s**2/9 + t**2/9 - {3 + n}", tables, [], True
    far = rng.randint(4, 9)
    return f"-logsumexp(-((s - {far})**2 + t**2), -((s + {far})**2 + {rng.randint(1, 3)}*t**2)) - 2", {"A": [[1.0]]}, [], False


def slip_systems(rng: random.Random) -> Made:
    """sum w_i |m_i . x| has a kink where m_i . x = 0, inward exactly where w_i < 0; it counts where the sum is > 0."""
    n = rng.randint(2, 10)
    m, w = _rows(rng, n, 2), [[round(rng.uniform(0.2, 2.0), 3)] for _ in range(n)]
    truth, (a, b) = True, m[0]
    if rng.random() < 0.5:
        w[0][0] = -0.1
        rest = sum(k[0] * abs(-b * p + a * q) for k, (p, q) in zip(w[1:], m[1:], strict=True))
        truth = not (rest > 0.0 and any(abs(a * q - b * p) > 0.0 for p, q in m[1:]))
    return f"sum(i, 1, {n}, w[i]*abs(m[i, 1]*s + m[i, 2]*t)) - 1", {"m": m, "w": w}, [], truth


def facets(rng: random.Random) -> Made:
    """A greatest of affine parts is convex; a least one of them is a union of half-planes, of which none holds the others."""
    n = rng.randint(3, 14)
    angles = sorted(rng.uniform(0, 6.28) for _ in range(n))
    angles[:3] = [0.1, 2.2, 4.3]
    tables = {"m": [[round(float(np.cos(x)), 4), round(float(np.sin(x)), 4)] for x in angles]}
    g = "m[i, 1]*s + m[i, 2]*t"
    return (
        (f"max_over(i, 1, {n}, {g}) - 1", tables, [], True) if rng.random() < 0.5 else (f"-max_over(i, 1, {n}, {g}) + 1", tables, [], False)
    )


def norms(rng: random.Random) -> Made:
    """Squares of convex parts >= 0 are convex; the bodies |x|^p + |y|^p <= 1 are not for p < 1."""
    n = rng.randint(2, 6)
    tables, p = {"m": _rows(rng, n, 2)}, rng.choice((2, 4, "3/2", "1/2", "3/4"))
    rows = [f'z = "vector(i, 1, {n}, pos(m[i, 1]*s + m[i, 2]*t))"', 'x = ["s", "t"]']
    if p in ("1/2", "3/4"):
        return f"sum(i, 1, 2, abs(x[i])**({p})) - 1 + 0*m[1, 1]", tables, rows, False
    return f"sum(i, 1, {n}, z[i]**({p})) + x[1]**2/5 + x[2]**2/7 - 1", tables, rows, True


def waves(rng: random.Random) -> Made:
    """s^2 + t^2 + e tanh(a . x): |tanh''| < 0.77, so that it is convex where 0.77 e a . a < 2; in a box, where g need not be."""
    n = rng.randint(1, 3)
    a = _rows(rng, n, 2)
    e = round(rng.uniform(0.3, 0.95) * 2.0 / (0.77 * sum(x * x + y * y for x, y in a)), 4)
    rows = ["[domain]", "s = { min = -2, max = 2 }", "t = { min = -2, max = 2 }"]
    return f"s**2 + t**2 + {e}*sum(i, 1, {n}, tanh(a[i, 1]*s + a[i, 2]*t)) - 1", {"a": a}, rows, True


def kidneys(rng: random.Random) -> Made:
    """(s^2 + t^2)^2 <= b^2 s^2 + c^2 t^2 has a dent where c^2 < b^2/2 (Booth's oval); 1/50 more on the right leaves it one, in a box."""
    b, c = round(rng.uniform(1.0, 1.5), 2), rng.choice((0.1, 0.3, 0.5))
    rows = ["[domain]", "s = { min = -2, max = 2 }", "t = { min = -2, max = 2 }"]
    return f"softplus((s**2 + t**2)**2 - {b}**2*s**2 - {c}**2*t**2 - 1/50) - softplus(0*a[1])", {"a": [[1.0]]}, rows, False


FAMILIES: tuple[Callable[[random.Random], Made], ...] = (networks, log_sums, slip_systems, facets, norms, waves, kidneys)


def trials(count: int, seed: int, folder: Path) -> Iterator[Trial]:
    """Each family in turn."""
    for made, family in zip(range(count), cycle(FAMILIES), strict=False):
        g, tables, rows, truth = family(random.Random(f"{seed}/{made}"))
        for name, table in tables.items():
            (folder / f"{name}.csv").write_text("".join(",".join(f"{x:.4f}" for x in row) + "\n" for row in table), "utf-8")
        files = [f'{name} = "{name}.csv"' for name in tables]
        own = rows if rows[:1] == ["[domain]"] else ["[define]", *rows]
        head = ["[criterion]", f'name = "{family.__name__}-{made}"', 'forces = ["s", "t"]', "pressure = false", f'g = "{g}"']
        (folder / "law.toml").write_text("\n".join([*head, "[tables]", *files, *own, ""]), "utf-8")
        yield Trial(family.__name__, load(folder / "law.toml"), {"convexity": truth}, "convex" if truth else "not convex")


if __name__ == "__main__":
    count_, seed_ = (*map(int, sys.argv[1:]), *(2000, 1)[len(sys.argv) - 1 :])
    with tempfile.TemporaryDirectory() as folder_:
        run(trials(count_, seed_, Path(folder_)))
