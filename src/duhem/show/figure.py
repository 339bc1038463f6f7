"""Whether a figure can be written, asked before the work rather than after it (matplotlib, extra ``plot``)."""

from __future__ import annotations

import os

from duhem.errors import InputError, MissingExtraError

__all__ = ["check"]


def check(file: str | os.PathLike[str]) -> None:
    """MissingExtraError without matplotlib, InputError for an ending it cannot write."""
    try:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
    except ImportError:
        raise MissingExtraError("matplotlib", "plot") from None
    ending = os.path.splitext(os.fspath(file))[1].removeprefix(".").lower()
    if ending not in FigureCanvasAgg.get_supported_filetypes():
        raise InputError(f"{ending or 'no ending'} is no format of a figure", where=f"{file}", remedy="end the name in .png, .pdf or .svg")
