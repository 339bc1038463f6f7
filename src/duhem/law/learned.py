"""A learned law as a criterion file with its numbers beside it: networks and polynomials, from arrays as NumPy keeps them.

Each number is written in all of its decimals, so that the law is the network in the exact values of its weights; a table is read as the
texts that stand in it, as of any law.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from decimal import Decimal
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, Any

from duhem.errors import InputError
from duhem.expression.abbreviations import Stress
from duhem.expression.number import DECIMAL, MOST_DIGITS
from duhem.law.placed_toml import document_text, text_of

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

__all__ = ["MOST_NUMBERS", "Book", "LearnedFile", "arrays_of", "check_numbers", "exact", "learned", "read_from", "table_beside"]

Arrays = Mapping[str, "NDArray[Any]"]
_ACTIVATIONS = {"softplus": "softplus", "relu": "pos", "tanh": "tanh"}
MOST_NUMBERS = 1_000_000


@dataclass(frozen=True)
class LearnedFile:
    """The ``text`` of a criterion file, and the CSV text of each table beside it by its file's name."""

    text: str
    tables: Mapping[str, str]


def arrays_of(file: str | os.PathLike[str]) -> dict[str, NDArray[Any]]:
    """The arrays of an ``.npz`` file; InputError for any other, and where one holds no finite numbers.  Nothing in it is executed."""
    import numpy as np

    where = os.fspath(file)
    if not where.endswith(".npz"):
        remedy = "save a network with torch.export.save or torch.onnx.export, or its weights with numpy.savez (page: Verify a learned law)"
        raise InputError("only .npz files of NumPy, .onnx files and .pt2 files are read", where=where, remedy=remedy)
    with read_from(file, "save plain arrays with numpy.savez"):
        with open(file, "rb") as stream, np.load(stream, allow_pickle=False) as given:
            found = {name: np.asarray(given[name]) for name in given.files}
        for name, array in found.items():
            check_numbers(name, array)
    return found


@contextmanager
def read_from(file: str | os.PathLike[str], remedy: str) -> Iterator[None]:
    """InputError with the file for what is found in it, and for the errors of those who read it."""
    where = os.fspath(file)
    try:
        yield
    except InputError as fault:
        raise InputError(fault.what, where=fault.where or where, remedy=fault.remedy) from None
    except FileNotFoundError:
        raise InputError("there is no such file", where=where, remedy="check the path") from None
    except Exception as fault:  # zip, JSON, protobuf, onnx and NumPy have errors of their own for what a file should not contain
        said = " ".join(str(fault).split())[:120] or type(fault).__name__
        raise InputError(f"the file cannot be read: {said}", where=where, remedy=remedy) from None


def check_numbers(name: str, array: NDArray[Any]) -> None:
    """InputError for what is no matrix of finite numbers."""
    import numpy as np

    if array.dtype.kind not in "fiu" or array.dtype.itemsize > 8 or array.size > MOST_NUMBERS or array.ndim > 2:
        raise InputError(f"{name} is no matrix of numbers", remedy="save arrays of floats of at most 64 bits")
    if not np.isfinite(array).all():
        raise InputError(f"{name} holds a number that is not finite", remedy="train again, or look at the export")


def learned(
    arrays: Arrays, kind: str, name: str, *, forces: Sequence[str] | Stress, activation: str = "softplus", level: str = "0", stem: str
) -> LearnedFile:
    """The criterion file of what was learned: K is where it is at most ``level``.

    ``icnn``: z_0 = a(Wx0 x + b0), z_k = a(Wz_k z_(k-1) + Wx_k x + b_k), and the last without a (Amos, Xu, Kolter 2017); Wx_k and b_k may
    be left out for k > 0.  ``mlp``: the same with W_k alone.  ``polynomial``: sum_i coefficients_i prod_j x_j^exponents_ij.  Rows are
    outputs.  InputError for an array that is missing, is of another shape or is not used.
    """
    book = Book({**arrays}, stem, forces)
    rows: dict[str, Any] = {}
    if kind == "polynomial":
        g = _polynomial(book)
    else:
        inner, first = ("W", "W0") if kind == "mlp" else ("Wz", "Wx0")
        rows, g = _network(book, _ACTIVATIONS[activation], inner, first, kind == "icnn")
    if book.left:
        raise InputError(f"the array {next(iter(book.left))} is not used", remedy="leave it out, or choose another --kind")
    return book.criterion_file(name, rows, g, level)


@dataclass
class Book:
    """Arrays of a law over ``forces`` that become tables beside ``stem`` as they are asked for."""

    left: dict[str, NDArray[Any]]
    stem: str
    forces: Sequence[str] | Stress
    files: dict[str, str] = field(default_factory=dict)  # their names by table
    texts: dict[str, str] = field(default_factory=dict)  # what they contain, by name

    @property
    def components(self) -> Sequence[str]:
        return self.forces.components if isinstance(self.forces, Stress) else self.forces

    def table(self, name: str, height: int | None, width: int) -> int:
        """Write an array down as a table, a vector as a column, and say how many rows it has."""
        if name not in self.left:
            raise InputError(f"there is no array {name}", remedy=f"those left are: {', '.join(self.left) or 'none'}")
        array = self.left.pop(name)
        array = array.reshape(-1, 1) if array.ndim < 2 and width == 1 else array.reshape(1, -1) if array.ndim < 2 else array
        if array.shape[1] != width or array.shape[0] != (height or array.shape[0]) or not array.size:
            raise InputError(f"{name} has {array.shape[0]} x {array.shape[1]} numbers", remedy=f"it takes {height or 'n'} x {width}")
        self.files[name] = file = f"{self.stem}_{name}.csv"
        self.texts[file] = "".join(",".join(map(exact, row)) + "\n" for row in array)
        return int(array.shape[0])

    def criterion_file(self, name: str, rows: Mapping[str, Any], g: str, level: str) -> LearnedFile:
        """The law g <= level, with ``rows`` of definitions over the vector x of the forces."""
        inputs = {"stress": vars(self.forces)} if isinstance(self.forces, Stress) else {"forces": self.components}
        head = {"name": name, **inputs, "pressure": False, "g": f"{g} - ({level})"}
        return LearnedFile(document_text({"criterion": head, "tables": self.files, "define": {"x": self.components, **rows}}), self.texts)


def _network(book: Book, activation: str, inner: str, first: str, skips: bool) -> tuple[dict[str, Any], str]:
    """The definitions of the hidden layers, and the formula of the last."""
    rows, formula, inputs = dict[str, Any](), "", len(book.components)
    name, of, width, layers = first, "x", inputs, next(k for k in count(1) if f"{inner}{k}" not in book.left)
    for k in range(layers):
        height = book.table(name, None, width)
        formula = f"sum(j, 1, {width}, {name}[i, j]*{of}[j])"
        if skips and k and f"Wx{k}" in book.left:
            book.table(f"Wx{k}", height, inputs)
            formula += f" + sum(j, 1, {inputs}, Wx{k}[i, j]*x[j])"
        if f"b{k}" in book.left:
            book.table(f"b{k}", height, 1)
            formula += f" + b{k}[i, 1]"
        name, of, width = f"{inner}{k + 1}", f"z{k}", height
        rows[of] = f"vector(i, 1, {height}, {activation}({formula}))"
    if width != 1 or layers == 1:
        what = f"the last layer has {width} outputs" if layers > 1 else "there is one layer"
        raise InputError(what, remedy="give two layers or more, the last of them with one output")
    del rows[of]
    return rows, re.sub(r"\[i, ", "[1, ", formula)


def _polynomial(book: Book) -> str:
    count = book.table("coefficients", None, 1)
    exponents = book.left.get("exponents")
    if exponents is not None and (exponents.dtype.kind not in "iu" or (exponents < 0).any()):
        raise InputError("exponents are not whole numbers >= 0", remedy="save them as integers")
    book.table("exponents", count, len(book.components))
    powers = "*".join(f"x[{j}]**exponents[i, {j}]" for j in range(1, len(book.components) + 1))
    return f"sum(i, 1, {count}, coefficients[i, 1]*{powers})"


def exact(x: np.generic) -> str:
    """All decimals of what a number of any precision holds."""
    told = str(int(x)) if x.dtype.kind in "iu" else str(Decimal(float(x)))
    if len(told) > MOST_DIGITS:
        remedy = "round such numbers, or save the arrays as 32-bit floats"
        raise InputError(f"{float(x):.3g} has more than {MOST_DIGITS} digits, written exactly", remedy=remedy)
    return told


# -- tables of numbers beside a criterion file -------------------------------------------------------------------------

_MOST_BYTES = 50_000_000  # of a table
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
    if len(rows) * len(rows[0]) > MOST_NUMBERS:
        raise InputError("the table is too large", where=f"{file}", remedy=f"at most {MOST_NUMBERS} numbers are read")
    for i, row in enumerate(rows, 1):
        if len(row) != len(rows[0]):
            what = f"the row has {len(row)} entries, and the first has {len(rows[0])}"
            raise InputError(what, where=f"{file}:{i}", remedy="make all rows as long, without blank lines")
        for j, entry in enumerate(row, 1):
            if len(entry) > MOST_DIGITS:
                raise InputError(f"entry {j} has {len(entry)} characters", where=f"{file}:{i}", remedy=f"at most {MOST_DIGITS} are read")
            if not _NUMBER.fullmatch(entry):
                what = f"entry {j} is {f'{entry[:24]!r}, which is' if entry else 'blank, which is'} no number"
                raise InputError(what, where=f"{file}:{i}", remedy="write finite decimals such as 0.15 or -1e-6, and no heading")
    return tuple(tuple(_plain(entry) for entry in row) for row in rows)


def _plain(entry: str) -> str:
    """Without a plus or zeros before the number, which formulas do not have."""
    sign, digits = ("-", entry[1:]) if entry[0] == "-" else ("", entry.lstrip("+"))
    return sign + re.sub(r"^0+(?=[0-9])", "", digits)
