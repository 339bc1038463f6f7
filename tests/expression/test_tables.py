"""Every interpreter has a row for every word, or says why not; every row that gives a value gives the value by hand.

The tables are found, not listed: a new interpreter is held to this as soon as it walks a formula.
"""

from __future__ import annotations

import ast
import importlib
import pkgutil
from collections.abc import Callable, Mapping
from fractions import Fraction
from pathlib import Path
from typing import Any

import flint
import mpmath
import numpy as np
import pytest
import sympy as sp

import duhem.expression
from duhem.errors import InputError
from duhem.expression import (
    NODES,
    WORDS,
    Where,
    ball_series,
    balls,
    cvxpy_,
    double_double,
    error_bounds,
    fold,
    jets,
    mpmath_,
    numpy_,
    scalar_bounds,
    smt,
    symbol,
)
from duhem.expression.fold import bound, recorded
from duhem.expression.scalar_bounds import Name
from tests.expression.by_hand import AT, ROWS, x, y
from tests.expression.text_as_functions import as_functions, named

MODULES = {
    info.name: importlib.import_module(f"duhem.expression.{info.name}")
    for info in pkgutil.iter_modules(duhem.expression.__path__)
}  # fmt: skip
WALKERS = {
    "recording": "records a walk for others",
    "build": "asks the table of many digits for doubles",
    "branches": "splits kinks and rebuilds any other node as it is",
    "parse": "counts the nodes of a choice that it writes out",
}


def _table(module: Any) -> Mapping[type, Any] | None:
    if hasattr(module, "table"):
        return dict(module.table(mpmath.MPContext()))
    return getattr(module, "TABLE", None) or getattr(module, "ROLES", None)


TABLES = {name: table for name, module in MODULES.items() if (table := _table(module)) is not None}
LEFT_OUT: dict[str, Mapping[type, str]] = {name: getattr(MODULES[name], "LEFT_OUT", {}) for name in TABLES}


def _missing(table: Mapping[type, Any], left_out: Mapping[type, str]) -> list[type]:
    return [kind for kind in NODES if (kind in table) == (kind in left_out)]


# -- completeness ------------------------------------------------------------------------------------------------------


def test_the_tables_are_found() -> None:
    known = {
        "ball_series",
        "balls",
        "cvxpy_",
        "jets",
        "mpmath_",
        "numpy_",
        "double_double",
        "error_bounds",
        "scalar_bounds",
        "scalar_jets",
        "smt",
        "dimensions",
    }
    assert set(TABLES) >= known


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(MODULES))
def test_what_walks_a_formula_has_a_table(name: str) -> None:
    """Whoever imports the walk, in whatever way, is an interpreter and is held to the words."""
    tree = ast.parse(Path(str(MODULES[name].__file__)).read_text(encoding="utf-8"))
    imported = {alias.name for node in ast.walk(tree) if isinstance(node, ast.ImportFrom) for alias in node.names}
    assert not imported & {"fold", "recorded"} or name in TABLES or name in WALKERS


@pytest.mark.parametrize("name", sorted(TABLES))
def test_every_table_has_a_row_for_every_node_or_a_reason(name: str) -> None:
    assert _missing(TABLES[name], LEFT_OUT[name]) == []
    assert all(len(reason) > 10 for reason in LEFT_OUT[name].values())


@pytest.mark.parametrize("name", sorted(TABLES))
def test_a_table_without_a_row_is_noticed(name: str) -> None:
    for kind in NODES:
        table = {k: row for k, row in TABLES[name].items() if k is not kind}
        reasons = {k: why for k, why in LEFT_OUT[name].items() if k is not kind}
        assert _missing(table, reasons) == [kind]


def test_every_word_builds_nodes_of_the_list() -> None:
    arguments = {"where": [x < y, x, y], "eigmax": [x, y, x, y, x, y]}
    for name, word in WORDS.items():
        built = word.build(*arguments.get(name, [x, y][: word.most or 2]))
        assert {type(node) for node in sp.preorder_traversal(built) if node.args} <= set(NODES), name
    assert set(ROWS) == set(NODES)
    assert all(type(formula) is kind for kind, (formula, _) in ROWS.items())


@pytest.mark.parametrize("kind", sorted(smt.LEFT_OUT, key=lambda kind: kind.__name__), ids=lambda kind: kind.__name__)
def test_what_is_left_out_is_refused_by_name(kind: type) -> None:
    with pytest.raises(InputError, match=f"no meaning is given to {kind.__name__}"):
        smt.Reals([x, y]).term(ROWS[kind][0])


def test_nothing_else_leaves_words_out() -> None:
    assert [name for name, reasons in LEFT_OUT.items() if reasons] == ["double_double", "smt"]


# -- values ------------------------------------------------------------------------------------------------------------


def _of_ball(value: Any) -> float:
    if isinstance(value, bool):
        return float(value)
    assert value.rad() <= 1e-12
    return float(value.mid())


def _exact(point: Mapping[sp.Symbol, float]) -> dict[sp.Symbol, Any]:
    return {s: balls.ball(Fraction(v)) for s, v in point.items()}


def _by_series(formula: sp.Expr, point: Mapping[sp.Symbol, float]) -> float:
    (value,) = ball_series.compiled([formula], list(point))(*(flint.arb_series([v, 1], prec=3) for v in _exact(point).values()))
    return _of_ball(value[0] if isinstance(value, flint.arb_series) else value)


def _by_jets(formula: sp.Expr, point: Mapping[sp.Symbol, float]) -> float:
    jet, _ = jets.formula(formula, list(point), [])(np.array([list(point.values())]), [])
    return float(jet.value[0])


def _by_pairs(formula: sp.Expr, point: Mapping[sp.Symbol, float]) -> float:
    program = double_double.paired(formula, tuple(point))
    assert program is not None
    (high, _), _ = program([double_double.Pair(np.array([value]), np.array([0.0])) for value in point.values()], 1)
    return float(high[0])


def _by_bounds(formula: sp.Expr, point: Mapping[sp.Symbol, float]) -> float:
    (value,), _ = error_bounds.bounded(formula, tuple(point))([np.array([value]) for value in point.values()], [0.0] * len(point))
    return float(value)


def _by_lines(formula: sp.Expr, point: Mapping[sp.Symbol, float]) -> float:
    """As text, with the same bound as on arrays."""
    found = scalar_bounds.scalar_bounds(formula, list(point), [], 0)
    space = named(*scalar_bounds.FUNCTIONS)
    exec(found.text, space)
    given: Any = np.array([list(point.values())])
    value, off = space["bounded"](given, 0, np.array(found.constants), np.array(found.off))
    known = error_bounds.bounded(formula, tuple(point))([np.array([v]) for v in point.values()], [0.0] * len(point))[1]
    assert off == pytest.approx(float(known[0]), rel=1e-12, abs=1e-300)
    return float(value)


def _by_text(formula: sp.Expr, point: Mapping[sp.Symbol, float]) -> float:
    return as_functions(formula, list(point))[0](np.array([list(point.values())]))[0]


def _by_solver(formula: sp.Expr, point: Mapping[sp.Symbol, float]) -> float:
    import z3

    names = smt.Reals(point)
    solver = z3.Solver(ctx=names.context)
    solver.add(*(names.term(s - sp.Rational(v)) == 0 for s, v in point.items()))
    assert solver.check() == z3.sat
    value = solver.model().eval(names.term(formula), model_completion=True)
    return float(z3.is_true(value)) if z3.is_bool(value) else float(value.as_fraction())


VALUES: dict[str, Callable[[sp.Expr, Mapping[sp.Symbol, float]], Any]] = {
    "ball_series": _by_series,
    "balls": lambda formula, point: _of_ball(balls.enclose(formula, _exact(point))),
    "cvxpy_": lambda formula, point: cvxpy_.expression(formula, point).value,
    "jets": _by_jets,
    "mpmath_": lambda formula, point: float(mpmath_.evaluate(formula, point)),
    "numpy_": numpy_.evaluate,
    "double_double": _by_pairs,
    "error_bounds": _by_bounds,
    "scalar_bounds": _by_lines,
    "scalar_jets": _by_text,
    "smt": _by_solver,
}
OWN: dict[tuple[str, type], tuple[sp.Expr, float]] = {
    ("ball_series", Where): (Where(x > -2, x, y), 4.0),  # on the border of a comparison a series stays open
    ("double_double", sp.Pow): (y ** sp.Rational(-3, 2), 0.125),  # whole powers of it and its root
    ("smt", sp.Pow): (y**-2, 0.0625),  # roots are given as equations
}


CASES = [pytest.param(name, kind, id=f"{name}-{kind.__name__}") for name in VALUES for kind in NODES if kind not in LEFT_OUT[name]]


def test_every_table_that_gives_values_is_tried() -> None:
    assert set(TABLES) == {*VALUES, "dimensions"}  # weights give units: tests of scaled formulas and of verify's simplification


@pytest.mark.parametrize(("name", "kind"), CASES)
def test_values_by_hand(name: str, kind: type) -> None:
    formula, expected = OWN.get((name, kind), ROWS[kind])
    assert VALUES[name](formula, AT) == pytest.approx(expected, rel=4e-16, abs=0)


@pytest.mark.parametrize("kind", NODES, ids=lambda kind: kind.__name__)
def test_the_table_of_many_digits_has_the_same_values_in_doubles(kind: type) -> None:
    formula, expected = ROWS[kind]
    found = fold(formula, mpmath_.table(mpmath_.doubles()), lambda leaf: AT.get(leaf) or float(leaf))
    assert type(found) is float and found == pytest.approx(expected, rel=4e-16, abs=0)


SMOOTH = [kind for kind in NODES if not issubclass(kind, sp.core.relational.Relational)]
BASE, WAY = (-2.5, 4.0), (1.0, 2.0)  # off every kink of the rows


@pytest.mark.parametrize("kind", SMOOTH, ids=lambda kind: kind.__name__)
def test_derivatives_agree_with_differences_in_many_digits(kind: type) -> None:
    formula = ROWS[kind][0]

    def along(t: Any) -> Any:
        point = {s: b + w * mpmath.mpf(t) for s, b, w in zip((x, y), BASE, WAY, strict=True)}
        return mpmath.mpf(mpmath_.evaluate(formula, point, 300))

    with mpmath.workdps(40):
        expected = [float(mpmath.diff(along, 0, n)) for n in range(3)]
    series = [flint.arb_series([balls.ball(Fraction(b)), balls.ball(Fraction(w))], prec=3) for b, w in zip(BASE, WAY, strict=True)]
    (value,) = ball_series.compiled([formula], [x, y])(*series)
    assert [_of_ball(c) for c in ball_series.derivatives(value, 2)] == pytest.approx(expected, rel=1e-13, abs=1e-13)
    jet, _ = jets.formula(formula, [x, y], [])(np.array([BASE]), [])
    assert jet.gradient is not None and jet.hessian is not None
    found = [jet.value[0], jet.gradient[0] @ WAY, WAY @ jet.hessian[0] @ WAY]
    assert found == pytest.approx(expected, rel=1e-13, abs=1e-13)
    value, gradient, hessian = as_functions(formula, [x, y])[1](np.array([BASE]))
    assert [value, gradient @ WAY, WAY @ hessian @ WAY] == pytest.approx(expected, rel=1e-13, abs=1e-13)


# -- recordings --------------------------------------------------------------------------------------------------------


def test_a_recording_is_the_fold() -> None:
    """The steps of a record, run, do what the walk does: shared parts once, the notes told to every step first."""
    z = symbol("z")
    size = sp.Abs(x + y)
    formula = size**2 + sp.exp(size) * z
    rows = {kind: lambda node, *parts: (type(node).__name__, *parts) for kind in NODES}
    plain = recorded(formula, (x, y, z), bound(rows), lambda node: lambda: str(node))
    leaf = {x: "x", y: "y", z: "z"}
    folded = fold(formula, rows, lambda node: leaf.get(node, str(node)))
    assert plain.run("xyz")[plain.last] == plain.value("xyz") == folded
    assert sorted(place for spent in plain.spent for place in spent) == sorted({*range(len(plain.steps) + 3)} - {plain.last})
    assert len(plain.steps) == len({node for node in sp.preorder_traversal(formula) if node not in leaf})
    heard: list[Any] = []
    table: dict[type, Any] = {kind: lambda _: lambda note, *parts: heard.append(note) for kind in NODES}
    told = recorded(formula, (x, y, z), table, lambda _: heard.append)
    told.run("xyz", "note")
    assert heard == ["note"] * len(told.steps)
    with pytest.raises(InputError, match="no meaning is given to exp"):
        recorded(formula, (x, y, z), {k: row for k, row in bound(rows).items() if k is not sp.exp}, lambda node: lambda: node)


def test_a_name_that_is_written_over_is_another_name() -> None:
    """As a number is: what else has the old name keeps its value; an array to write into is refused."""
    lines: dict[str, str] = {}
    first = Name(lines, "x")
    then = first
    then += 1.0
    then *= first
    known: dict[str, float] = {"x": 2.0}
    exec("\n".join(f"{name} = {text}" for text, name in lines.items()), known)
    assert then is not first and known[then.name] == 6.0 and known[first.name] == 2.0
    with pytest.raises(TypeError):
        np.add(first, 1.0, out=then)
