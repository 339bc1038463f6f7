"""The course in `notebooks/`: executed, made light, compared with what is kept.

    python -m tests.course FILE...

executes each notebook and says what it shows otherwise than is kept; with ``--write`` it keeps what is shown now.  What is kept:
texts, and pictures of few colours.  What is not: places of this machine, times of execution, the names of figures.  Seconds in a text
may differ from run to run; a cell with the tag ``varies`` shows what does so otherwise (times, the last digits of a solver), and only
has to run.
"""

from __future__ import annotations

import argparse
import base64
import io
import os
import re
import sys
from collections.abc import Iterable, Iterator, Sequence
from itertools import groupby, zip_longest
from pathlib import Path
from tempfile import TemporaryDirectory
from unittest.mock import patch

import nbformat
import numpy as np
from jupyter_client.kernelspec import KernelSpec
from jupyter_client.manager import AsyncKernelManager
from nbclient import NotebookClient
from nbformat import NotebookNode
from nbformat.v4 import new_output

__all__ = ["LONGEST", "NOTEBOOKS", "ROOT", "departures", "executed", "main", "pictures", "texts"]

ROOT = Path(__file__).parents[1]
NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))
LONGEST = 120  # seconds a cell may take on a machine that has much else to do

_SECONDS = re.compile(r"\d+\.\d+ s\b")
_NUMBER = re.compile(r"[-+]?\d+\.?\d*(?:e[-+]?\d+)?")
_ROUNDING, _DIGITS = 1e-9, 1e-6
_KEPT = {"kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"}, "language_info": {"name": "python"}}


class ThisPython(AsyncKernelManager):
    """Starts the kernel with the running interpreter, whatever kernels the machine has registered."""

    @property
    def kernel_spec(self) -> KernelSpec:
        return KernelSpec(argv=[sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"], display_name="this Python")


def executed(path: Path) -> NotebookNode:
    """The notebook run from top to bottom in a folder of its own, with light outputs; an exception where a cell raises one."""
    book = nbformat.read(path, as_version=4)
    with TemporaryDirectory() as folder:
        own = {
            "IPYTHONDIR": folder,  # not the settings of whoever runs this
            "PYTHONPATH": os.pathsep.join(filter(None, [str(ROOT / "src"), os.environ.get("PYTHONPATH")])),
            "MPLBACKEND": "module://matplotlib_inline.backend_inline",
        }
        with patch.dict(os.environ, own):
            client = NotebookClient(
                book,
                timeout=LONGEST,
                kernel_manager_class=ThisPython,
                record_timing=False,
                coalesce_streams=True,
                resources={"metadata": {"path": folder}},
            )
            client.execute()
    book.metadata = nbformat.from_dict(_KEPT)
    for cell in _code(book):
        cell.outputs = list(_light(cell.outputs))
        cell.execution_count = None
    return book


def _code(book: NotebookNode) -> list[NotebookNode]:
    return [cell for cell in book.cells if cell.cell_type == "code"]


def _light(outputs: Iterable[NotebookNode]) -> Iterator[NotebookNode]:
    for output in _joined(outputs):
        if "data" in output:
            output.metadata = nbformat.from_dict({})
            if "execution_count" in output:
                output.execution_count = None
            if "image/png" in output.data:
                output.data = nbformat.from_dict({"image/png": _few_colours(output.data["image/png"])})
        yield output


def _joined(outputs: Iterable[NotebookNode]) -> Iterator[NotebookNode]:
    """What is printed at once in one piece: into how many it comes depends on the load."""
    for name, group in groupby(outputs, lambda output: output.get("name") if output.output_type == "stream" else None):
        if name is None:
            yield from group
        else:
            yield new_output("stream", name=name, text="".join(output.text for output in group))


def _few_colours(png: str) -> str:
    """A picture in its most frequent colours and some that cover the rest: few bytes; neither areas nor small marks change."""
    from PIL import Image

    image = Image.open(io.BytesIO(base64.b64decode(png)))
    paper = Image.new("RGBA", image.size, "white")
    paper.alpha_composite(image.convert("RGBA"))
    beside = io.BytesIO()
    plain = paper.convert("RGB")
    colours, where, counts = np.unique(np.asarray(plain).reshape(-1, 3), axis=0, return_inverse=True, return_counts=True)
    covering = plain.quantize(64, method=Image.Quantize.MAXCOVERAGE).getpalette() or []
    few = np.vstack([colours[np.argsort(-counts)[:32]], np.reshape(covering, (-1, 3))])
    nearest = np.argmin(((colours[:, None].astype(int) - few) ** 2).sum(axis=2), axis=1)
    kept = Image.fromarray(nearest.astype(np.uint8)[where.ravel()].reshape(plain.height, plain.width), "P")
    kept.putpalette(few.ravel().tolist())
    kept.save(beside, "png", optimize=True)
    return base64.b64encode(beside.getvalue()).decode()


def pictures(book: NotebookNode) -> list[bytes]:
    """What is shown as PNG, in order."""
    found = (output.data.get("image/png") for cell in _code(book) for output in cell.outputs if "data" in output)
    return [base64.b64decode(png) for png in found if png]


def texts(cell: NotebookNode) -> list[str]:
    """What a cell shows: texts, and for a picture that there is one; what went to standard error has its name before it."""
    found = []
    for output in cell.outputs:
        if output.output_type == "stream":
            found.append(output.text if output.name == "stdout" else f"{output.name}: {output.text}")
        elif "image/png" in output.data:
            found.append("a picture")
        else:
            found.append("\n".join(f"{kind}: {text}" for kind, text in sorted(output.data.items())))
    return found


def departures(kept: NotebookNode, found: NotebookNode) -> list[str]:
    """What the cells of a fresh run show otherwise than those kept: words, or numbers by more than 1e-6 of themselves.

    Numbers below 1e-9 on both sides are rounding and alike.
    """
    every = []
    for one, other in zip(_code(kept), _code(found), strict=True):
        if "varies" in one.metadata.get("tags", []):
            continue
        for was, is_ in zip_longest(texts(one), texts(other), fillvalue=""):
            if not _alike(was, is_):
                every.append(f"{one.source.splitlines()[0]}\n--- kept\n{was}\n--- now\n{is_}")
    return every


def _alike(one: str, other: str) -> bool:
    one, other = (_SECONDS.sub("", text) for text in (one, other))
    words = [re.split(r"\s+", _NUMBER.sub("#", text)) for text in (one, other)]  # columns are as wide as their numbers
    if words[0] != words[1]:
        return False
    pairs = zip(_NUMBER.findall(one), _NUMBER.findall(other), strict=True)
    return all(_close(float(a), float(b)) for a, b in pairs)


def _close(a: float, b: float) -> bool:
    return abs(a - b) <= _DIGITS * max(abs(a), abs(b)) or max(abs(a), abs(b)) < _ROUNDING


def main(arguments: Sequence[str]) -> int:
    """The command; 1 where something is shown otherwise than kept and not written."""
    parser = argparse.ArgumentParser(
        "python -m tests.course", description="Execute notebooks and compare what they show with what is kept."
    )
    parser.add_argument("files", nargs="+", type=Path)
    parser.add_argument("--write", action="store_true", help="keep what they show now")
    asked = parser.parse_args(arguments)
    code = 0
    for file in asked.files:
        book = executed(file)
        others = departures(nbformat.read(file, as_version=4), book)
        if asked.write:
            nbformat.write(book, file)
            print(f"wrote {file}")
        else:
            print(f"{file}: {'shows what is kept' if not others else 'shows something else (--write keeps it)'}", *others, sep="\n")
            code = max(code, int(bool(others)))
    return code


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
