"""What the atlas says of a published law, and how it is shown: where it stands, what the literature claims of it, what duhem finds.

A file of the atlas is an ordinary criterion file with a table ``[atlas]``.  It is read when it is asked for; naming the laws
reads no file.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import Any, NoReturn

from duhem.errors import InputError
from duhem.law.frozen_mapping import FrozenMapping
from duhem.law.placed_toml import parsed
from duhem.show.printing import Sheet, Shown, plain, sheet

__all__ = ["ASKED", "Atlas", "AtlasEntry", "as_dict", "as_sheet", "as_sheet_of_one", "atlas", "entries", "entry", "file_of", "groups"]

ASKED = ("origin", "convexity", "smoothness", "normality", "dissipation")
"""The claims of which an entry keeps verdicts; one of a law with an energy keeps that of its state laws too, and duality is our own."""

_FOLDER = Path(__file__).parent


@dataclass(frozen=True, repr=False)
class AtlasEntry(Shown):
    """One law of the atlas.

    ``equation``: the criterion in the symbols of its source, with its number where it has one.  ``claims``: what the
    literature says, claim by claim.  ``verdicts``: the word of :class:`duhem.Verdict` that verifying the law gives, for each
    claim of ``ASKED``, over the whole domain of its file.  ``regions``: for options of ``duhem region``, which give parameters
    other ranges than the file, for which of their values a claim holds.  ``note``: where the print or what is said of it does not hold.
    """

    name: str
    group: str
    summary: str
    source: str
    equation: str
    claims: Mapping[str, str]
    verdicts: Mapping[str, str]
    regions: Mapping[str, str]
    note: str

    def __repr__(self) -> str:
        return f"<AtlasEntry {self.name}: {', '.join(f'{claim} {verdict}' for claim, verdict in self.verdicts.items())}>"

    @property
    def found(self) -> tuple[str, ...]:
        """For which parameters a claim holds, each with the command that says so."""
        return tuple(f"{sentence} (duhem region {self.name} {options})" for options, sentence in self.regions.items())

    def to_dict(self) -> dict[str, Any]:
        """All of it as plain values."""
        return vars(self) | {key: dict(getattr(self, key)) for key in ("claims", "verdicts", "regions")}


class Atlas(Shown, FrozenMapping[str, AtlasEntry]):
    """Laws of the atlas by name; each name stands for a law wherever one is asked for."""

    def __missing__(self, name: str) -> NoReturn:
        near = get_close_matches(str(name), self, n=1)
        raise KeyError(f"{name}; {f'did you mean {near[0]}?' if near else 'duhem.atlas() names those it has'}")

    def __repr__(self) -> str:
        return f"<Atlas: {len(self)} laws of {', '.join(dict.fromkeys(law.group for law in self.values()))}>"


def atlas(group: str | None = None) -> Atlas:
    """Return the published laws by name, all or those of one group.

    Each has its source, its claims in the literature and the verdicts of duhem.  This function reads the files of the atlas and
    verifies nothing.  Raises InputError for an unknown group.
    """
    return Atlas({law.name: law for law in entries(group)})


def groups() -> dict[str, tuple[str, ...]]:
    """The groups of the atlas and the names of their laws, both sorted."""
    folders = sorted(folder for folder in _FOLDER.iterdir() if folder.is_dir() and not folder.name.startswith("_"))
    return {folder.name: tuple(sorted(file.stem for file in folder.glob("*.toml"))) for folder in folders}


def file_of(name: str) -> Path | None:
    """The criterion file of a law of the atlas, or None."""
    return next((_FOLDER / group / f"{name}.toml" for group, names in groups().items() if name in names), None)


def entry(name: str) -> AtlasEntry:
    """What the atlas says of a law; InputError where it has none of that name."""
    file = file_of(name)
    if file is None:
        raise InputError(f"the atlas has no law {name[:60]!r}", remedy="duhem atlas names those it has")
    return _read(file)


def _read(file: Path) -> AtlasEntry:
    document = parsed(file.read_text("utf-8"), f"{file}").document
    head, said = document["criterion"], document["atlas"]
    stated: dict[str, Any] = {key: head[key] for key in ("summary", "source")}
    stated |= {key: FrozenMapping(said.get(key, {})) for key in ("claims", "verdicts", "regions")}
    return AtlasEntry(name=file.stem, group=file.parent.name, equation=said["equation"], note=said.get("note", ""), **stated)


def entries(group: str | None = None) -> tuple[AtlasEntry, ...]:
    """The laws of one group, or of all; InputError for a group that the atlas lacks."""
    known = groups()
    if group is not None and (not isinstance(group, str) or group not in known):
        said = f"the atlas has no group {group[:60]!r}" if isinstance(group, str) else f"{type(group).__name__} is no name of a group"
        raise InputError(said, remedy=f"groups are: {', '.join(known)}")
    return tuple(_read(_FOLDER / each / f"{name}.toml") for each in ([group] if group else known) for name in known[each])


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
    said = {**law.verdicts, **law.claims}
    rows = tuple((claim, law.verdicts.get(claim, "").replace("_", " "), law.claims.get(claim, "")) for claim in said)
    fields = (("group", law.group), ("source", law.source), ("equation", law.equation))
    notes = ((title, texts) for title, texts in (("Regions", law.found), ("Note", (law.note,) if law.note else ())) if texts)
    return Sheet(f"{law.name}: {law.summary}", fields, ("claim", "verdict", "what the literature says"), rows, tuple(notes))
