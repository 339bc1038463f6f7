"""The compiled loops of :mod:`duhem.path.compiled_steps` as the next process finds them: on disk."""

from __future__ import annotations

import hashlib
import inspect
from functools import cache

from duhem.path import compiled_steps
from duhem.path.compiled_steps import Loops
from duhem.projection import compiled, quadrants, quarter_ellipse
from duhem.projection.kept_code import compiled_text

__all__ = ["loops"]

_KEPT = """\
# {stamp}
from duhem.path.compiled_steps import made

inner = made().{name}


def run({names}):
    inner({names})
"""
_DRIVEN, _WRITTEN = "values, factor, load, share, centre, k, c, state, status, reached, shape", "first, last, row, stress, slip, sums"


@cache
def loops() -> Loops:
    """The compiled loops: compiled at their first use (tens of seconds), then kept on disk; MissingExtraError without numba.

    What is kept belongs to the text of the modules that it was made of.
    """
    texts = map(inspect.getsource, (compiled_steps, compiled, quadrants, quarter_ellipse))
    stamp = hashlib.sha256("".join(texts).encode()).hexdigest()
    names = {name: f"{_DRIVEN}, {'' if name == 'abreast' else 'members, '}{_WRITTEN}" for name in Loops.__dataclass_fields__}
    return Loops(*(compiled_text(_KEPT.format(stamp=stamp, name=name, names=own), "run") for name, own in names.items()))
