"""Sets K that are known as curves, or by what they are made of, drawn by chance: where their closest points lie needs no formula g."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from duhem.law.formula_law import Criterion

Array = NDArray[np.float64]
Drawn = tuple[str, Array]  # g over a and b, and the boundary of its K, point by point
_ANGLE = np.linspace(0.0, 2.0 * np.pi, 20_001)
GRID = 1e-5  # more than a grid of these boundaries is off by


def polar(radius: Callable[[Array], Array]) -> Array:
    r = radius(_ANGLE)
    return np.stack([r * np.cos(_ANGLE), r * np.sin(_ANGLE)], axis=1)[r > 0.0]


def discs(rng: np.random.Generator) -> Drawn:
    """Up to three that overlap or lie apart."""
    many = int(rng.integers(2, 4))
    middle, radius = rng.uniform(-2.5, 2.5, (many, 2)).round(3), rng.uniform(0.4, 1.2, many).round(3)
    middle[0] = 0.0
    parts = [f"norm(a - ({x}), b - ({y})) - {r}" for (x, y), r in zip(middle.tolist(), radius.tolist(), strict=True)]
    edge = np.vstack([polar(lambda t, r=r: np.full_like(t, r)) + m for m, r in zip(middle, radius, strict=True)])
    depth = np.min([np.hypot(*(edge - m).T) - r for m, r in zip(middle, radius, strict=True)], axis=0)
    return f"min({', '.join(parts)})", edge[depth > -1e-9]


def oval_of(e: float) -> Drawn:
    """A limacon: convex up to e = 1/2."""
    return f"norm(a, b)**2 - (norm(a, b) + {e}*a)", polar(lambda t: 1.0 + e * np.cos(t))


def flower_of(e: float) -> Drawn:
    """r = 1 + e cos 3 theta: convex up to e = 1/10."""
    return f"norm(a, b)**4 - norm(a, b)**3 - {e}*(a**3 - 3*a*b**2)", polar(lambda t: 1.0 + e * np.cos(3.0 * t))


def cassini_of(c: float) -> Drawn:
    """|sigma - (1, 0)| |sigma + (1, 0)| = c^2 with c > 1: convex from c = 2^1/2 on."""
    edge = polar(lambda t: np.sqrt(np.cos(2.0 * t) + np.sqrt(c**4 - np.sin(2.0 * t) ** 2)))
    return f"((a - 1)**2 + b**2)*((a + 1)**2 + b**2) - {c**4!r}", edge


def lemniscate_of(c: float) -> Drawn:
    return f"(a**2 + b**2)**2 - {c}*(a**2 - b**2)", polar(lambda t: np.sqrt(np.maximum(c * np.cos(2.0 * t), 0.0)))


def number(low: float, high: float) -> Callable[[np.random.Generator], float]:
    return lambda rng: round(float(rng.uniform(low, high)), 4)


def of(shape: Callable[[float], Drawn], low: float, high: float) -> Callable[[np.random.Generator], Drawn]:
    return lambda rng: shape(number(low, high)(rng))


def law(g: str) -> Criterion:
    return Criterion("drawn", g, {}, forces=("a", "b"), pressure=None)


NOT_CONVEX = {
    "discs": discs,
    "ovals": of(oval_of, 0.55, 0.9),
    "flowers": of(flower_of, 0.2, 0.6),
    "lemniscates": of(lemniscate_of, 0.5, 3.0),
    "cassini": of(cassini_of, 1.01, 1.2),
}
CONVEX = {
    "ovals": of(oval_of, 0.0, 0.5),
    "flowers": of(flower_of, 0.0, 0.1),
    "cassini": of(cassini_of, 1.4143, 3.0),
}


# -- in any number of forces: g, and how far trial stresses (n, d) lie from K ---------------------------------------------

Apart = Callable[[Array], Array]
NAMES = "abcdef"


def balls(rng: np.random.Generator, d: int) -> tuple[str, Apart]:
    """Two or three, which overlap or lie apart."""
    many = int(rng.integers(2, 4))
    middle, radius = rng.uniform(-2.0, 2.0, (many, d)).round(3), rng.uniform(0.4, 1.2, many).round(3)
    middle[0] = 0.0
    parts = [
        f"norm({', '.join(f'{x} - ({c})' for x, c in zip(NAMES, m, strict=False))}) - {r}"
        for m, r in zip(middle.tolist(), radius.tolist(), strict=True)
    ]

    def apart(trial: Array) -> Array:
        return np.maximum(np.min([np.linalg.norm(trial - m, axis=1) - r for m, r in zip(middle, radius, strict=True)], axis=0), 0.0)

    return f"min({', '.join(parts)})", apart


def turned_oval(rng: np.random.Generator, d: int) -> tuple[str, Apart]:
    """A limacon turned about its axis, with a dent at one end of it."""
    e, size = number(0.55, 0.95)(rng), f"norm({', '.join(NAMES[:d])})"
    return f"{size}**2 - ({size} + {e}*a)", _turned(oval_of(e)[1])


def turned_cassini(rng: np.random.Generator, d: int) -> tuple[str, Apart]:
    """A polynomial with a dent all round its waist."""
    c, square = number(1.02, 1.3)(rng), " + ".join(f"{x}**2" for x in NAMES[1:d])
    return f"((a - 1)**2 + {square})*((a + 1)**2 + {square}) - {c**4!r}", _turned(cassini_of(c)[1])


def _turned(edge: Array) -> Apart:
    def apart(trial: Array) -> Array:
        plane = np.stack([trial[:, 0], np.linalg.norm(trial[:, 1:], axis=1)], axis=1)
        return np.array([np.linalg.norm(edge - u, axis=1).min() for u in plane])

    return apart


IN_SPACE = {"balls": balls, "ovals": turned_oval, "cassini": turned_cassini}
