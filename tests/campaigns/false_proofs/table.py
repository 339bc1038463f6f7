"""The families of traps, and as many of them as are asked for."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Mapping, Sequence

from tests.campaigns.false_proofs.ends import ending
from tests.campaigns.false_proofs.jumps import jumping
from tests.campaigns.false_proofs.maps import mapped
from tests.campaigns.false_proofs.names import named
from tests.campaigns.false_proofs.ranks import losing_rank
from tests.campaigns.false_proofs.trap import Trap
from tests.campaigns.false_proofs.undefined import undefined

__all__ = ["FAMILIES", "traps"]

FAMILIES: Mapping[str, Callable[[random.Random, int], Trap]] = {
    "maps": mapped, "jumps": jumping, "ends": ending, "ranks": losing_rank, "names": named, "undefined": undefined,
}  # fmt: skip


def traps(count: int, families: Sequence[str] = tuple(FAMILIES), seed: int = 1) -> Iterator[tuple[str, Trap]]:
    """``count`` laws, the families in turn; each depends on the seed and its own place only."""
    for i in range(count):
        family, place = families[i % len(families)], i // len(families)
        yield family, FAMILIES[family](random.Random(f"{seed}/{family}/{place}"), place)
