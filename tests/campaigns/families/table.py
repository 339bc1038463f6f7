"""The families of laws of known truth, and laws drawn from them in turn."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Mapping
from itertools import islice

from tests.campaigns.families.flats import polygon, union
from tests.campaigns.families.quartics import even_quartic, quartic
from tests.campaigns.families.rounds import ellipse, quadrants, two_ellipses
from tests.campaigns.families.series import gauge, radius
from tests.campaigns.families.trial import Trial

__all__ = ["FAMILIES", "trials"]

FAMILIES: Mapping[str, Callable[[random.Random, str], Trial]] = {
    "quartic form": quartic, "even quartic": even_quartic, "gauge series": gauge, "radius series": radius, "shifted ellipse": ellipse,
    "quadrants": quadrants, "polygon": polygon, "union of polygons": union, "two ellipses": two_ellipses,
}  # fmt: skip


def trials(count: int, seed: int) -> Iterator[Trial]:
    """``count`` laws, the families in turn; each law depends on the seed and its own place only."""

    def endless() -> Iterator[Trial]:
        place = 0
        while True:
            for family, make in FAMILIES.items():
                yield make(random.Random(f"{seed}/{family}/{place}"), f"{family.replace(' ', '-')}-{place}")
            place += 1

    return islice(endless(), count)
