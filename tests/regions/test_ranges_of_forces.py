"""K within ranges of the forces: chords inside of them refute, for one value of a parameter and for all of a cell, and no others."""

from __future__ import annotations

import json
from fractions import Fraction

import pytest

import duhem
from duhem.proof.kernel.certificate import digest

BETWEEN = duhem.Domain.between
BOX = {"s": BETWEEN(-1, 1), "t": BETWEEN(-1, 1)}


def law(g: str, **parameters: duhem.Domain) -> duhem.Criterion:
    return duhem.Criterion(name="boxed", pressure=None, forces=("s", "t"), g=g, domain=BOX, parameters=parameters)


@pytest.mark.parametrize(
    ("g", "refuted"),
    [
        ("s*t", True),
        ("s**2 - t**2", True),
        ("1/2 - abs(s) - t", True),
        ("2 - s - t**2", False),  # one point
        ("4 - s**2 - t**2", False),  # empty in the box
        ("s**4 + 9*s**2*t**2 + t**4 - 1", True),
        ("s**4 + 9*s**2*t**2 + t**4 - 100", False),  # everything in the box
        ("(s**2 - t**2)*(s + 2)", True),
        ("(s + 3/2)*(s + 5/2) - 4", False),  # a half-plane there
    ],
)
def test_a_chord_within_the_ranges_refutes(g: str, refuted: bool) -> None:
    (found,) = duhem.verify(law(g), claims=["convexity"]).results
    assert (found.verdict is duhem.Verdict.REFUTED) is refuted
    if found.witness is not None:
        assert all(abs(Fraction(x)) <= 1 for key in ("p", "q", "midpoint") for x in found.witness.points[key].values())


def test_families_of_chords_within_the_ranges() -> None:
    done = duhem.region(law("s**2 - e*t**2", e=BETWEEN("1/2", 2)), "e")
    assert done.exact and done.condition == "false"
    document = done.certificate()
    assert duhem.recheck(document).ok
    assert document["tree"]["rule"] == "chord"
    for factor in (3, Fraction(3, 2)):  # chords of the whole K that leave the box
        wide = json.loads(json.dumps(document))
        evidence = wide["tree"]["evidence"]
        for key in ("p", "q"):
            evidence[key] = {f: str(factor * Fraction(x)) for f, x in evidence[key].items()}
        wide["sha256"] = digest(wide)
        assert not duhem.recheck(wide).ok
        wide["law"]["domain"] = {}
        wide["sha256"] = digest(wide)
        assert duhem.recheck(wide).ok
