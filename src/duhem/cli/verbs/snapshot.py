"""``duhem snapshot``: what is known of laws, kept and compared."""

from __future__ import annotations

import os
from collections.abc import Sequence

import click

from duhem.cli.arguments import laws_argument, read_law
from duhem.cli.output import HELD, REFUTED, Progress, say

__all__ = ["snapshot"]


@click.command()
@laws_argument
@click.option("--file", metavar="FILE", default="duhem-snapshot.json", show_default=True, help="The file with the snapshots.")
@click.option("--update", is_flag=True, help="Store the present results.")
def snapshot(laws: Sequence[str], file: str, update: bool) -> int:
    """Compare each LAW with its stored snapshot.

    A snapshot contains verdicts, methods, trust, exact witnesses, and some slip increments.

    Exit codes: 0 nothing has changed; 1 something has changed (the output says what); 2 there is no snapshot yet. Stresses and slips
    may differ by the tolerance that FILE states. --update writes the file; laws in it that you do not name stay unchanged.
    """
    from duhem.api.increments import project
    from duhem.show.place import check_place
    from duhem.testing.snapshots import SnapshotFile, differences
    from duhem.testing.snapshots import snapshot as taken

    known = {name: read_law(name) for name in dict.fromkeys(laws)}
    if update:
        check_place(file, laws)
    kept = SnapshotFile() if update and not os.path.lexists(file) else SnapshotFile.read(file)
    before = {name: kept.laws.get(name) if update else kept.entry(name, file) for name in known}
    entries, changed = {}, False
    with Progress("comparing") as progress:
        for name, law in known.items():
            progress.show(name)
            old = before[name]
            entries[name] = now = taken(law, project, increments=None if old is None or update else old["increments"])
            found = ("not kept before",) if old is None else differences(old, now, kept.tolerance)
            changed = changed or bool(found)
            progress.show("")
            for line in found or ("as kept",):
                say(f"{name}: {line}")
    if update:
        kept.with_entries(entries).write(file)
        say(f"wrote {file}")
        return HELD
    return REFUTED if changed else HELD
