"""The sheet of all laws of the atlas is legible, and told as the atlas has it."""

from __future__ import annotations

from dataclasses import replace

import pytest

import duhem
from duhem.law.atlas.entry import entries, groups
from duhem.show import figure

pytest.importorskip("matplotlib")

from duhem.portrait.pictures import atlas_sheet, has_section
from tests.long import mostly_long
from tests.oracles.legible import faults


@pytest.mark.slow
@pytest.mark.parametrize("group", mostly_long([*groups(), None]))
def test_the_atlas_is_legible_and_told_as_it_is(group: str | None) -> None:
    laws = entries(group)
    places = atlas_sheet(laws)
    drawn = [figure.shortened(law.name, 24) for law in laws if has_section(duhem.load(law.name))]
    assert [place.get_title().splitlines()[0] for place in places] == drawn and len(drawn) >= len(laws) - 6  # of rates alone, without a K
    assert [fault for fault in faults(places[0].figure) if "no quantity with a unit" not in fault] == []


def test_a_law_of_the_atlas_is_filled_by_its_verdict() -> None:
    (hill,) = (law for law in entries("metals") if law.name == "hill90")
    (place,) = atlas_sheet([hill])
    assert place.get_title() == "hill90\nnormality refuted"
    area, lines = place.patches
    assert area.get_label() == lines.get_label() == "$K$ convex: refuted" and lines.get_hatch() == "xxx"
    assert [patch.get_label() for patch in atlas_sheet([replace(hill, verdicts=dict.fromkeys(hill.verdicts, "proved"))])[0].patches] == [
        "$K$ convex: proved"
    ]
