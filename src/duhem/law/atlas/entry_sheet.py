"""A law of the atlas, or all of them, as a sheet and in plain values."""

from __future__ import annotations

from typing import Any

from duhem.law.atlas.entry import ASKED, Atlas, AtlasEntry
from duhem.show.printing import plain, sheet
from duhem.show.sheet import Sheet

__all__ = ["as_dict", "as_sheet", "as_sheet_of_one"]


@sheet.register(Atlas)
def as_sheet(atlas: Atlas) -> Sheet:
    """A row a law: its group and what verifying it gives."""
    rows = tuple((law.name, law.group, *(law.verdicts[claim].replace("_", " ") for claim in ASKED)) for law in atlas.values())
    return Sheet(f"Atlas: {len(atlas)} published laws", head=("law", "group", *ASKED), rows=rows)


@plain.register(Atlas)
def as_dict(atlas: Atlas) -> dict[str, Any]:
    """A list of all, each as ``duhem atlas --format json`` has it."""
    return {"laws": [law.to_dict() for law in atlas.values()]}


@sheet.register(AtlasEntry)
def as_sheet_of_one(law: AtlasEntry) -> Sheet:
    """Where it stands, and claim by claim what verifying it gives beside what the literature says."""
    rows = tuple(
        (claim, law.verdicts.get(claim, "").replace("_", " "), law.claims.get(claim, "")) for claim in {**law.verdicts, **law.claims}
    )
    fields = (("group", law.group), ("source", law.source), ("equation", law.equation))
    notes = (("Note", (law.note,)),) if law.note else ()
    return Sheet(f"{law.name}: {law.summary}", fields, ("claim", "verdict", "what the literature says"), rows, notes)
