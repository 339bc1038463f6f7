"""Chords with ends that move with the parameter, sections and tips: what refutes over whole cells, held to values worked out apart."""

from __future__ import annotations

import random
from functools import cache
from typing import Any

import numpy as np
import pytest

import duhem
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.certificate import stated
from duhem.proof.kernel.dents import dents
from duhem.proof.kernel.stated_law import StatedLaw
from tests.regions.test_planes import tampered

BETWEEN = duhem.Domain.between


def cap(low: Any = -1, high: Any = 1) -> duhem.Criterion:
    """|y| <= 1 + c exp(x) where |x| <= 1: convex if and only if c <= 0, and of no depth at c = 0."""
    box = {"x": BETWEEN(-1, 1)}
    return duhem.Criterion("cap", "abs(y) - 1 - c*exp(x)", {"c": BETWEEN(low, high)}, ("x", "y"), None, domain=box)


@cache
def refuted() -> duhem.ParameterRegion:
    return duhem.region(cap("1/8", 1), steps=4_000_000)


def test_ends_that_move_with_the_parameter_refute_over_whole_cells() -> None:
    done, moving = refuted(), 0
    assert done.exact and done.condition == "false" and duhem.recheck(done.certificate()).ok
    for one in done.decided:
        evidence = one.row["evidence"]
        for c in np.linspace(float(one.cell.low.low), float(one.cell.high.low), 7):
            ends = [np.array([float(eval(evidence[key].get(f, "0"), {"c": c})) for f in ("x", "y")]) for key in ("p", "q")]
            level = [abs(y) - 1 - c * np.exp(x) for x, y in (*ends, (ends[0] + ends[1]) / 2)]
            assert level[0] <= 0 and level[1] <= 0 < level[2]
        moving += "*c" in "".join(evidence["p"].values())
    assert moving


def test_no_tampered_chord_confirms_a_false_cell() -> None:
    document, draw, confirmed = refuted().certificate(), random.Random(3), 0
    values = [draw.uniform(-2, 2) for _ in range(200)]
    for _ in range(60):
        try:
            done = duhem.recheck(tampered(document, draw))
        except duhem.InputError:
            continue
        for row in done.cells:
            if not row.reason and row.verdict in ("proved", "refuted"):
                confirmed += 1
                there = [c for c in values if eval(row.said.replace("everywhere", "True"), {"c": c})]
                assert all((c <= 0) is (row.verdict == "proved") for c in there), row
    assert confirmed


# -- tips and sections -------------------------------------------------------------------------------------------------

J2, I1 = "((s1 - s2)**2 + (s2 - s3)**2 + (s3 - s1)**2)/6", "(s1 + s2 + s3)"
SECTION = f"(({J2})**3 - c*((2*s1 - s2 - s3)*(2*s2 - s3 - s1)*(2*s3 - s1 - s2)/27)**2)**(1/6)"


def principal(g: str, **parameters: duhem.Domain) -> duhem.Criterion:
    return duhem.Criterion("tip", g, parameters, ("s1", "s2", "s3"), None)


def of_sectors(law: duhem.Criterion) -> list[Any]:
    found = stated(law_as_text(law))
    assert isinstance(found, StatedLaw)
    return list(dents(found, "sector"))


BEYOND = BETWEEN("5/2", 3)


@pytest.mark.parametrize(
    ("g", "dented"),
    [
        (f"{J2} + {SECTION} + {I1}/3 - 1", True),
        (f"{J2} + 2*({SECTION} - {I1}/3) - 1", True),
        (f"{SECTION} + {I1}/3 - 1", True),
        (f"(s1**2 + s2**2 + s3**2 - s1*s2 - s2*s3 - s3*s1) + {SECTION} + {I1}/3 - 1", True),  # J2 as a sum
        (f"{SECTION} - 1", True),
        (f"{J2} + {SECTION} - 1", False),  # the level is one
        (f"{J2} + {SECTION} + {I1}**2 - 1", False),
        (f"{J2} + {SECTION} + k*{I1} - 1", False),  # k may be 0
        (f"{J2} + {SECTION} + {I1} + sqrt(abs({I1})) - 1", False),
        (f"{J2} + {SECTION} + s1 - 1", False),
        (f"{SECTION} + {I1}/3 - norm(s1, s2) - 1", False),
    ],
)
def test_the_section_at_a_tip_is_that_of_the_lowest_part(g: str, dented: bool) -> None:
    law = principal(g, c=BEYOND, **({"k": BETWEEN(-1, 1)} if "k*" in g else {}))
    found = of_sectors(law)
    assert bool(found) is dented
    if dented and "2*(" in g:
        done = duhem.region(law, "c")
        assert done.exact and done.condition == "false" and duhem.recheck(done.certificate()).ok


def test_what_a_tip_shows_is_so() -> None:
    """A chord of K near the tip, at a value beyond the end of the section: worked out in floating point."""

    def g(s: np.ndarray) -> float:
        d = s - s.mean()
        return float(d @ d / 2 + ((d @ d / 2) ** 3 - 2.5 * np.prod(d) ** 2) ** (1 / 6) + s.sum() / 3 - 1)

    base, reach = np.ones(3) * (1 - 1e-4), []
    for turn in (-0.1, 0.1):  # about pure shear, where J3 = 0
        way, low, high = np.array([1.0, 0, -1]) + turn * np.array([1.0, -2, 1]), 0.0, 1.0
        for _ in range(80):
            middle = (low + high) / 2
            low, high = (middle, high) if g(base + middle * way) <= 0 else (low, middle)
        reach.append(base + low * way)
    assert max(map(g, reach)) <= 0 < 1e-9 < g((reach[0] + reach[1]) / 2)


@pytest.mark.slow
def test_the_atlas_beyond_what_was_published() -> None:
    for name, over, short in (
        ("menetrey-willam", {"e": "0:1"}, "e >= 1/2"),
        ("yu", {"b": "0:2"}, "b <= 1"),
    ):
        done = duhem.region(name, over=over)
        assert done.exact and done.short == short and duhem.recheck(done.certificate()).ok


@pytest.mark.parametrize("name", ["bresler-pister", "wiebols-cook"])
def test_lines_leave_what_is_no_polynomial_of_the_forces(name: str) -> None:
    law = duhem.load(name)
    (c,) = {"c", "C"} & {*law.parameters}
    fixed = {"a": 1, "b": 1} if c == "c" else {"A": 1, "B": 1}
    done = duhem.region(law.fix(fixed), over={c: (-1, 1)})
    assert done.exact and done.short == f"{c} <= 0" and duhem.recheck(done.certificate()).ok
