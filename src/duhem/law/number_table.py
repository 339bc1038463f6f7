"""Tables of numbers beside a criterion file: CSV, each number kept as the text that it is, so that it is read exactly."""

from __future__ import annotations

import re
from pathlib import Path

from duhem.errors import InputError
from duhem.expression.number import DECIMAL, MOST_DIGITS
from duhem.law.placed_toml import text_of

__all__ = ["table_beside"]

_MOST_BYTES, _MOST_NUMBERS = 50_000_000, 1_000_000
_NUMBER = re.compile(rf"[+-]?{DECIMAL}", re.ASCII)


def table_beside(folder: Path | None, given: str, where: str) -> tuple[tuple[str, ...], ...]:
    """The rows of the table in a file of ``folder``; InputError, at ``where`` or in the table, for what is no table of numbers.

    Entries are decimals between commas; there is no heading, every row is as long as the first, and nothing is left blank.
    """
    place = Path(given)
    if folder is None:
        raise InputError("a table stands in a file beside the law, and the law is in none", where=where, remedy="read the law from a file")
    if place.is_absolute() or ".." in place.parts:
        raise InputError(f"{given[:60]!r} is not beside the law", where=where, remedy="put the table in the folder of the criterion file")
    file = folder / place
    rows = tuple(tuple(entry.strip() for entry in line.split(",")) for line in text_of(file, "table of numbers", _MOST_BYTES).splitlines())
    if not rows:
        raise InputError("the table is empty", where=f"{file}", remedy="write rows of numbers with commas between them")
    if len(rows) * len(rows[0]) > _MOST_NUMBERS:
        raise InputError("the table is too large", where=f"{file}", remedy=f"at most {_MOST_NUMBERS} numbers are read")
    for i, row in enumerate(rows, 1):
        if len(row) != len(rows[0]):
            what = f"the row has {len(row)} entries, and the first has {len(rows[0])}"
            raise InputError(what, where=f"{file}:{i}", remedy="make all rows as long, without blank lines")
        for j, entry in enumerate(row, 1):
            if len(entry) > MOST_DIGITS:
                what = f"entry {j} has {len(entry)} characters"
                raise InputError(what, where=f"{file}:{i}", remedy=f"at most {MOST_DIGITS} are read")
            if not _NUMBER.fullmatch(entry):
                what = f"entry {j} is {f'{entry[:24]!r}, which is' if entry else 'blank, which is'} no number"
                raise InputError(what, where=f"{file}:{i}", remedy="write finite decimals such as 0.15 or -1e-6, and no heading")
    return tuple(tuple(_plain(entry) for entry in row) for row in rows)


def _plain(entry: str) -> str:
    """Without a plus or zeros before the number, which formulas do not have."""
    sign, digits = ("-", entry[1:]) if entry[0] == "-" else ("", entry.lstrip("+"))
    return sign + re.sub(r"^0+(?=[0-9])", "", digits)
