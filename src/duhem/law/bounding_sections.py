"""What bounds K in a criterion file, and the slip there: g and flow, several surfaces, or a boundary curve."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import sympy as sp

from duhem.errors import InputError
from duhem.expression.abbreviations import Abbreviations
from duhem.expression.gradient import gradient
from duhem.law.curve_law import closes
from duhem.law.placed_toml import Key
from duhem.law.section_reader import SectionReader
from duhem.law.yield_surface import YieldSurface

__all__ = ["BoundingSections", "curve"]


@dataclass(frozen=True)
class BoundingSections:
    """Formulas over the symbols ``known``, some of them ``forces``; ``short`` is what stands for other formulas."""

    toml: SectionReader
    forces: Sequence[str]
    known: Mapping[str, sp.Symbol]
    short: Abbreviations

    def whole(self) -> YieldSurface:
        """The one surface of a law without [[surface]]: g and potential in [criterion], or [flow]."""
        flow = ("flow", "direction") if "flow" in self.toml.document else ()
        if flow:
            self.toml.keys("flow", self.toml.table("flow"), ("direction",))
            if "direction" not in self.toml.table("flow"):
                raise self.toml.error("[flow] has no direction", "flow", remedy=f"write direction = {self._example()}")
        return self._surface(("criterion",), flow, "[flow]")

    def surfaces(self) -> tuple[YieldSurface, ...]:
        """Those of [[surface]], in order; none where there is no such section."""
        given = self.toml.document.get("surface", [])
        if not (isinstance(given, list) and all(isinstance(entry, dict) for entry in given)):
            raise self.toml.error("surface is no list of tables", "surface", remedy="write [[surface]] above each of them")
        if given:
            self.toml.alone("[[surface]]", "criterion", "g", "potential")
            self.toml.alone("[[surface]]", "", "flow")
        for i, entry in enumerate(given):
            self.toml.keys("surface", entry, ("g", "flow", "potential"), at=("surface", i))
        flows = [("surface", i, "flow") if "flow" in entry else () for i, entry in enumerate(given)]
        return tuple(self._surface(("surface", i), flow, "flow") for i, flow in enumerate(flows))

    def _surface(self, section: tuple[Key, ...], flow: tuple[Key, ...], flow_name: str) -> YieldSurface:
        """The g and potential of a section with the flow at a place, if it has one."""
        toml = self.toml
        g = toml.expression(*section, "g", known=self.known, short=self.short)
        if not g.free_symbols & {self.known[f] for f in self.forces}:
            raise toml.error("g does not depend on any force", *section, "g", remedy=f"use at least one of {', '.join(self.forces)}")
        written = toml.written(*section, "g", short=self.short)
        if flow and "potential" in toml.value(*section):
            raise toml.error(f"{flow_name} and potential are both given", *section, "potential", remedy="leave one of them out")
        if "potential" in toml.value(*section):
            return YieldSurface(g, potential=self._potential((*section, "potential")), written=written)
        if not flow:
            return YieldSurface(g, written=written)
        entries = toml.entries(*flow, example=self._example())
        if len(entries) != len(self.forces):
            counts = f"{len(entries)} components for {len(self.forces)} forces"
            remedy = f"give one expression for each of {', '.join(self.forces)}"
            raise toml.error(f"the flow direction has {counts}", *flow, remedy=remedy)
        slip = tuple(toml.expression(*entry, known=self.known, short=self.short) for entry in entries)
        return YieldSurface(g, slip, None, written, tuple(toml.written(*entry, short=self.short) for entry in entries))

    def _potential(self, at: tuple[Key, ...]) -> str:
        """A formula that has a gradient by the forces."""
        value = self.toml.expression(*at, known=self.known, short=self.short)
        try:
            flow = gradient(value, [self.known[f] for f in self.forces])
        except InputError as fault:
            raise self.toml.error(fault.what, *at, remedy=fault.remedy) from None
        if not any(flow):
            remedy = f"use at least one of {', '.join(self.forces)}"
            raise self.toml.error("the potential does not depend on any force", *at, remedy=remedy)
        return self.toml.written(*at, short=self.short)

    def _example(self) -> str:
        return "[" + ", ".join(f'"{f}"' for f in self.forces) + "]"


def curve(
    toml: SectionReader, key: str, angle: sp.Symbol, known: Mapping[str, sp.Symbol], short: Abbreviations
) -> list[tuple[str, sp.Expr]]:
    """The two components in [boundary] with their texts; they close because the angle enters by its cosine and sine only."""
    example = f'["cos({angle})", "sin({angle})"]'
    if key not in toml.table("boundary"):
        raise toml.error(f"[boundary] has no {key}", "boundary", remedy=f"add {key} = {example}")
    entries = toml.entries("boundary", key, example=example)
    if len(entries) != 2:
        raise toml.error(f"{key} has {len(entries)} components for 2 forces", "boundary", key, remedy=f"write {key} = {example}")
    found = [toml.expression(*entry, known=known, short=short) for entry in entries]
    for entry, expr in zip(entries, found, strict=True):
        if not closes(expr, angle):
            remedy = f"write it in cos({angle}) and sin({angle}), multiples of the angle expanded"
            raise toml.error(f"{key} uses {angle} otherwise than as cos({angle}) and sin({angle})", *entry, remedy=remedy)
    return [(toml.written(*entry, short=short), expr) for entry, expr in zip(entries, found, strict=True)]
