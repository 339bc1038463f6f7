"""Networks as criterion files with tables of weights, and their value by NumPy."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["Network"]

Array = NDArray[Any]
ACTIVATIONS: dict[str, Callable[[Array], Array]] = {"softplus": lambda x: np.logaddexp(0.0, x), "pos": lambda x: np.maximum(x, 0.0)}


@dataclass
class Network:
    """``layers`` of ``width`` neurons over three forces, the forces led to each layer (Amos, Xu, Kolter 2017); ``tables`` by name."""

    width: int
    layers: int
    activation: str
    seed: int = 0
    level: float = 5.0
    tables: dict[str, Array] = field(default_factory=dict)

    def __post_init__(self) -> None:
        rng, w = np.random.default_rng(self.seed), self.width
        for k in range(self.layers):
            self.tables[f"A{k}"], self.tables[f"b{k}"] = 0.6 * rng.normal(size=(w, 3)), 0.1 * rng.normal(size=(w, 1))
            if k:
                self.tables[f"W{k}"] = np.abs(rng.normal(size=(w, w))) / w
        self.tables["c"] = np.abs(rng.normal(size=(1, w))) / w
        self.tables = {name: table.astype(np.float32) for name, table in self.tables.items()}

    def value(self, at: Array) -> Array:
        """g at points (n, 3)."""
        t = {name: table.astype(float) for name, table in self.tables.items()}
        z = np.zeros((len(at), 0))
        for k in range(self.layers):
            z = ACTIVATIONS[self.activation](at @ t[f"A{k}"].T + t[f"b{k}"][:, 0] + (z @ t[f"W{k}"].T if k else 0.0))
        found: Array = z @ t["c"][0] - self.level
        return found

    def write(self, folder: Path) -> Path:
        """The criterion file, with its tables beside it."""
        w, rows = self.width, ['x = ["s", "t", "u"]']
        for k in range(self.layers):
            inner = f"sum(j, 1, {w}, W{k}[i, j]*z{k - 1}[j]) + " if k else ""
            rows.append(f'z{k} = "vector(i, 1, {w}, {self.activation}({inner}sum(j, 1, 3, A{k}[i, j]*x[j]) + b{k}[i]))"')
        for name, table in self.tables.items():
            lines = (",".join(str(Decimal(float(x))) for x in row) for row in table)
            (folder / f"{name}.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
        files = [f'{name} = "{name}.csv"' for name in self.tables]
        head = '[criterion]\nname = "network"\nforces = ["s", "t", "u"]\npressure = false\n'
        g = f'g = "sum(i, 1, {w}, c[i]*z{self.layers - 1}[i]) - {self.level}"\n'
        (folder / "network.toml").write_text("\n".join([head + g + "[tables]", *files, "[define]", *rows, ""]), encoding="utf-8")
        return folder / "network.toml"
