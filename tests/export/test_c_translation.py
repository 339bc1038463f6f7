"""The translation into C: the same numbers as Python for what it takes, and a refusal for everything else."""

from __future__ import annotations

import ctypes
import math
from pathlib import Path

import numpy as np
import pytest

from duhem.export.c_translation import Array, NotTranslated, c_functions
from tests.export.shared_library import STRICT, compiler, shared

HEAD = "from math import floor, frexp, ldexp, isfinite\nfrom typing import Any\nimport numpy as np\nfrom numpy import nan, sqrt, hypot\n"
ARRAYS = {"x": Array("double", ("4",)), "table": Array("double", ("2", "2")), "marks": Array("signed char", ("4",))}

TEXT = '''
N, SMALL = 4, 2.0**-3
NEGATIVE = -1

def order(x: Any) -> int:
    """Sorts, and counts the exchanges."""
    count = 0
    for i in range(N - 1):
        for k in range(N - 1, i, -1):
            if x[k] < x[k - 1]:
                x[k], x[k - 1] = x[k - 1], x[k]
                count += 1
    return count

def filled(x: Any, table: Any) -> float:
    marks = np.empty(4, np.int8)
    total, short = 0.0, 1.0
    for i in range(N):
        marks[i] = -1 if x[i] < 0.0 else 1
        total += marks[i] * x[i] ** 2
    table[0, 1], table[1, 0] = total - -short, -total - (short - total)
    return max(total, min(short, x[0]))

def function(x: Any, table: Any) -> float:
    """Everything */ that /* is taken."""
    unused = hypot(x[0], 1.0)
    unread = unused + 1.0
    a, steps = x[0], 0
    while True:
        steps += 1
        if steps > 20 or not a > 0.0:
            break
        if steps % 3 == 1:
            continue
        a = a / 2.0 - SMALL if 0.5 < a <= 8.0 or (a > 100.0 and isfinite(a)) else a - 1.0
    b = filled(x, table)
    count = order(x)
    exact = ldexp(1.0, frexp(abs(b))[1] + NEGATIVE)
    whole = floor(exact)
    rest = nan if x[0] > 1e9 else float(count) * 2.0 - (3.0 - (1.0 - a)) / exact
    if count == 3:
        rest += 1.0
    elif x[1] >= 0.0:
        rest = sqrt(x[1]) if x[1] > whole else -(rest + int(whole))
    return rest + steps
'''


def test_the_same_numbers(tmp_path: Path) -> None:
    space: dict[str, object] = {}
    exec(HEAD + TEXT, space)
    source = c_functions(HEAD + TEXT, "function", ARRAYS, {})
    (tmp_path / "f.c").write_text(f"#include <math.h>\n{source}\ndouble run(double *x, double t[][2]) {{ return function(x, t); }}\n")
    run = shared([tmp_path / "f.c"], *STRICT, with_=compiler("CC", "cc", "gcc", "clang")).run
    run.argtypes, run.restype = [ctypes.c_void_p] * 2, ctypes.c_double
    rng = np.random.default_rng(0)
    assert "unused" not in source and "unread" not in source
    for row in [*rng.normal(size=(200, 4)) * 10.0, np.array([np.nan, 1.0, 2.0, -3.0]), np.array([2e9] * 4), np.zeros(4)]:
        one, other, tables = row.copy(), row.copy(), np.zeros((2, 2, 2))
        with np.errstate(all="ignore"):
            expected = space["function"](one, tables[0])  # type: ignore[operator]
        found = run(other.ctypes.data, tables[1].ctypes.data)
        assert found == expected or (math.isnan(found) and math.isnan(expected)), row
        assert np.array_equal(one, other, equal_nan=True) and np.array_equal(tables[0], tables[1], equal_nan=True)


@pytest.mark.parametrize(
    "body",
    [
        "return 1 / 2",  # an int by an int is another number in C
        "return 3.0 // 2.0",
        "return max(1, 2)",
        "return other(x)",
        "return [a for a in (1.0, 2.0)][0]",
        "return x[0, 1]",
        "return strange[0]",
        "x[0] = print(1.0)\n    return 1.0",
        "count = 3\n    for i in range(count):\n        count = 2\n    return 1.0",
        "for i in (1, 2):\n        x[i] = 0.0\n    return 1.0",
        "a, b = x\n    return a",
        "with x:\n        return 1.0",
        "return function(x)",
        "return 5.0 % 3.0",
        "return 'text'",
        "return 1.0 @ 2.0",
    ],
)
def test_anything_else_is_refused(body: str) -> None:
    with pytest.raises((NotTranslated, KeyError)):
        c_functions(f"def function(x: Any) -> float:\n    {body}\n", "function", ARRAYS, {})


def test_a_parameter_without_a_type_is_refused() -> None:
    with pytest.raises(NotTranslated, match="what is y"):
        c_functions("def function(y):\n    return y\n", "function", ARRAYS, {})
