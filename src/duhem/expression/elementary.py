"""The elementary functions of one number, each with all that duhem knows of it in one place.

Every interpreter of formulas takes its row of such a word from here: values on arrays, numbers and in many digits, enclosures, power
series, first and second derivatives, bounds of rounding, signs, units, atoms of CVXPY, C.  The kernel, which trusts nobody, keeps
a table of its own.  A new word is one entry here and what the kernel is to know of it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from math import inf, nan
from types import MappingProxyType
from typing import Any, Literal

import sympy as sp

__all__ = ["ELEMENTARY", "Elementary", "array_function", "imports", "on_arrays"]

_EVERYWHERE = (-inf, inf)


@dataclass(frozen=True)
class Elementary:
    """A function f, smooth where it is defined, from pure numbers to pure numbers.

    ``name`` is that of formulas, of C, of Python's ``math``, mpmath and Arb; ``numpy`` that of NumPy or else ``scipy.special``.
    ``slope`` and ``bend`` are f' and f'' as texts over {x}, the value {v} and, for the latter, the slope {s}; ``off`` bounds
    |f(x + h) - f(x)| for |h| <= {e}.  They are run on arrays and written into what is compiled: expressions with NumPy's names.
    """

    node: type  # of SymPy
    name: str
    meaning: str
    slope: str
    bend: str
    off: str
    numpy: str
    domain: tuple[float, float] = _EVERYWHERE  # two finite ends belong to it, the one end of a half line does not
    far: tuple[float, float] | None = None  # the limits at -inf and inf, nan where there is none; None where f is worked out at any x
    poles: bool = False
    curvature: Literal["convex", "concave"] | None = None  # on the domain
    increasing: bool = False
    atom: Callable[[Any, Any], Any] | None = None  # from the module cvxpy and an argument
    series: Callable[[Any], Any] | None = None  # of a power series, where Arb has no method of that name

    @property
    def analytic(self) -> bool:
        """Whether it is analytic on the whole line."""
        return self.domain == _EVERYWHERE and not self.poles


def _word(node: type, meaning: str, slope: str, bend: str, off: str, numpy: str = "", **more: Any) -> Elementary:
    name = node.__name__
    return Elementary(node, name, meaning, slope, bend, off, numpy or name, **more)


def _of_angle(node: type, meaning: str, slope: str) -> Elementary:
    return _word(node, meaning, slope, "-{v}", "minimum({e}, 2.0)", far=(nan, nan))


def _arc(node: type, meaning: str, sense: int) -> Elementary:
    """Its bound is that of the slope at the far end; at the ends of [-1, 1] the root of the bound takes over."""
    end = "(abs({x}) + {e})"
    steep = f"{{e}} / sqrt(maximum((1.0 - {end}) * (1.0 + {end}), 0.0))"
    return _word(
        node,
        meaning,
        f"{float(sense)} / sqrt((1.0 - {{x}}) * (1.0 + {{x}}))",
        "{x} * {s} * {s} * {s}",
        f"where({end} < 1.0, where({{e}} == 0.0, 0.0, {steep}), 2.3 * sqrt({{e}}))",
        numpy=f"arc{node.__name__[1:]}",
        domain=(-1.0, 1.0),
    )


def _steep(slope: str) -> str:
    """The bound of a function whose slope grows with |x|."""
    return f"where({{e}} == 0.0, 0.0, {slope}(abs({{x}}) + {{e}}) * {{e}})"


_TURN = "tan(minimum({e}, 1.5))"

_ALL = (
    _word(
        sp.exp, "exponential", "{v}", "{v}", "{v} * expm1({e})",
        far=(0.0, inf), curvature="convex", increasing=True, atom=lambda cp, x: cp.exp(x),
    ),
    _word(
        sp.log, "natural logarithm", "1.0 / {x}", "-{s} * {s}", "where({x} > {e}, -log1p(-{e} / {x}), inf)",
        domain=(0.0, inf), curvature="concave", increasing=True, atom=lambda cp, x: cp.log(x),
    ),
    _of_angle(sp.sin, "sine (rad)", "cos({x})"),
    _of_angle(sp.cos, "cosine (rad)", "-sin({x})"),
    _word(
        sp.tan, "tangent (rad)", "1.0 + {v} * {v}", "2.0 * {v} * {s}",
        f"where(({{e}} < 1.5) & (abs({{v}}) * {_TURN} < 1.0), {_TURN} * (1.0 + {{v}} * {{v}}) / (1.0 - abs({{v}}) * {_TURN}), inf)",
        far=(nan, nan), poles=True,
    ),
    _arc(sp.asin, "arc sine (rad) of a number between -1 and 1", 1),
    _arc(sp.acos, "arc cosine (rad) of a number between -1 and 1", -1),
    _word(
        sp.atan, "arc tangent (rad)", "1.0 / (1.0 + {x} * {x})", "-2.0 * {x} * {s} * {s}", "{e}", numpy="arctan",
        increasing=True,
    ),
    _word(
        sp.sinh, "hyperbolic sine", "cosh({x})", "{v}", _steep("cosh"),
        far=(-inf, inf), increasing=True, series=lambda x: (x.exp() - (-x).exp()) / 2,
    ),
    _word(
        sp.cosh, "hyperbolic cosine", "sinh({x})", "{v}", _steep("sinh"), far=(inf, inf), curvature="convex",
        atom=lambda cp, x: (cp.exp(x) + cp.exp(-x)) / 2, series=lambda x: (x.exp() + (-x).exp()) / 2,
    ),
    _word(
        sp.tanh, "hyperbolic tangent", "1.0 - {v} * {v}", "-2.0 * {v} * {s}", "{e}",
        far=(-1.0, 1.0), increasing=True, series=lambda x: 1 - 2 / ((2 * x).exp() + 1),
    ),
)  # fmt: skip

ELEMENTARY: Mapping[str, Elementary] = MappingProxyType({word.name: word for word in _ALL})


def array_function(name: str) -> Any:
    """The function of that name on arrays, NumPy's or else SciPy's."""
    import numpy as np

    if hasattr(np, name):
        return getattr(np, name)
    from scipy import special

    return getattr(special, name)


def imports(names: Iterable[str]) -> str:
    """The lines by which a text has functions of these names on numbers: NumPy's, or those of Python that NumPy lacks."""
    import numpy as np

    return "\n".join(f"from {'numpy' if hasattr(np, name) else 'math'} import {name}" for name in sorted({*names}))


@lru_cache(maxsize=256)
def on_arrays(text: str) -> Callable[..., Any]:
    """One of the texts of a word as a function of arrays ``x``, ``v``, ``s`` and ``e``, given by keyword."""
    import numpy as np

    source = text.format(x="x", v="v", s="s", e="e")
    found: Callable[..., Any] = eval(f"lambda *, x=None, v=None, s=None, e=None: {source}", {**vars(np), "abs": abs})
    return found
