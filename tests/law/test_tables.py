"""Tables beside a law, sums and maxima over an index, vectors: what is read is the formula written out, and faults are told."""

from __future__ import annotations

from pathlib import Path

import pytest
import sympy as sp

from duhem import load
from duhem.errors import InputError
from duhem.expression.parse import parse_expression
from duhem.expression.text import formula
from duhem.law.criterion_file import reads
from duhem.law.formula_law import Criterion

W = "1,-2.5,3\n0.125,5e-1,+6\n"
HEAD = '[criterion]\nname = "t"\nforces = ["x", "y", "z"]\npressure = false\n'


def law(folder: Path, g: str, more: str = "", w: str = W) -> Criterion:
    (folder / "w.csv").write_text(w, encoding="utf-8")
    (folder / "law.toml").write_text(f'{HEAD}g = "{g}"\n[tables]\nw = "w.csv"\n{more}', encoding="utf-8")
    found: Criterion = load(folder / "law.toml")
    return found


def plain(g: str) -> Criterion:
    found = reads(f'{HEAD}g = "{g}"\n')
    assert isinstance(found, Criterion)
    return found


V = '[define]\nv = ["x", "y - z", "2*z"]\n'
SAME = [
    ("w[1, 2]*x + w[2, 1] - 1", "", "(-2.5)*x + 0.125 - 1"),
    ("sum(i, 1, 3, w[1, i]*abs(x)) - 1", "", "(1*abs(x) + (-2.5)*abs(x) + 3*abs(x)) - 1"),
    ("sum(i, 1, 2, x + w[i, 1]) - 1", "", "((x + 1) + (x + 0.125)) - 1"),
    ("max_over(i, 1, 2, w[i, 1]*x - i*y) - 1", "", "max(1*x - 1*y, 0.125*x - 2*y) - 1"),
    ("max_over(i, 2, 2, w[i, 3]*x) - 1", "", "6*x - 1"),
    ("sum(i, 1, 2, sum(j, i, 3, w[i, j]*x**j)) - 1", "", "1*x**1 + (-2.5)*x**2 + 3*x**3 + 0.5*x**2 + 6*x**3 - 1"),
    ("sum(i, 1, 3, v[i]**2) + v[2*2 - 1] - 1", V, "x**2 + (y - z)**2 + (2*z)**2 + 2*z - 1"),
    ("norm(u[1], u[2]) - 1", '[define]\nu = "vector(i, 1, 2, w[i, 1]*x + w[i, 2]*y)"\n', "norm(1*x + (-2.5)*y, 0.125*x + 0.5*y) - 1"),
    ("cos(2*pi*sum(i, 1, 2, i)/24)*x - 1", "", "cos(2*pi*3/24)*x - 1"),
    ("x - 1", "[define]\nv = []\n", "x - 1"),  # a vector of no parts that nothing uses
]  # fmt: skip


@pytest.mark.parametrize(("g", "more", "same"), SAME)
def test_a_law_with_indices_is_the_one_written_out(tmp_path: Path, g: str, more: str, same: str) -> None:
    assert law(tmp_path, g, more).g == plain(same).g


@pytest.mark.parametrize("n", [30, 48])
def test_a_maximum_over_many_is_one_maximum(tmp_path: Path, n: int) -> None:
    """Also of 48 slip systems, and its text is read back."""
    found = law(tmp_path, f"max_over(i, 1, {n}, i*x - i*i*y) - 1")
    (most,) = found.g.atoms(sp.Max)
    assert len(most.args) == n and parse_expression(formula(found.g), found.symbols()) == found.g


WRONG = [
    ("w[3, 1]*x - 1", "", "rows 1 to 2"), ("w[0, 1]*x - 1", "", "rows 1 to 2"), ("w[1, 4]*x - 1", "", "columns 1 to 3"),
    ("w[1]*x - 1", "", "is not there"), ("w[x, 1] - 1", "", "no whole number"), ("w[1.5, 1]*x - 1", "", "no whole number"),
    ("u[1]*x - 1", "", "no table and no vector"), ("w*x - 1", "", "unknown name 'w'"), ("v[4]*x - 1", V, "parts 1 to 3"),
    ("v - 1", V, "unknown name 'v'"), ("sum(i, 2, 1, x) - 1", "", "is empty"), ("max_over(i, 1, 0, x) - 1", "", "is empty"),
    ("sum(x, 1, 2, x) - 1", "", "already means"), ("sum(i, 1, 2, sum(i, 1, 2, i*x)) - 1", "", "already means"),
    ("sum(v, 1, 2, x) - 1", V, "already means"), ("sum(pi, 1, 2, x) - 1", "", "already means"), ("sum(i, 1, 2) - x", "", "takes an index"),
    ("sum(i, 1, x, y) - 1", "", "no whole number"), ("sum(i, 1, 30000, x) - 1", "", "too long"),
    ("sum(i, 1, 3000, sum(j, 1, 3000, x*i*j)) - 1", "", "too large"), ("vector(i, 1, 2, x) - 1", "", "where a formula should"),
    ("i*x + sum(i, 1, 2, x) - 1", "", "unknown name 'i'"), ("x[1:2] - 1", "", "unexpected"),
    ("sum(i, 1, 2, x)[1] - 1", "", "should"),
    ("x - 1", '[define]\nz1 = "vector(i, 1, 2, x) + 1"\n', "beside something else"),
    ("x - 1", '[define]\na = "b[1]*x"\nb = ["x", "y"]\n', "no table and no vector"),
    ("x - 1", '[define]\nv = ["x", "v[1]"]\n', "no table and no vector"),
    ("x - 1", '[define]\nv = ["x"]\nv__1 = "y"\n', "declared twice"), ("x - 1", '[define]\nw = "x"\n', "names no table"),
    ("x.__class__[1] - 1", "", "should"), ("__import__('os')[1]*x - 1", "", "not a function"),
]  # fmt: skip


@pytest.mark.parametrize(("g", "more", "said"), WRONG)
def test_a_wrong_index_is_told_with_its_place(tmp_path: Path, g: str, more: str, said: str) -> None:
    with pytest.raises(InputError, match=said) as fault:
        law(tmp_path, g, more)
    assert "law.toml:" in str(fault.value)


@pytest.mark.parametrize(
    ("w", "said"),
    [
        ("", "empty"), ("1,2\n3\n", "1 entries"), ("1,nan\n", "no number"), ("1,inf\n", "no number"), ("1,-Infinity\n", "no number"),
        ("1,,2\n", "blank"), ("1,2\n\n3,4\n", "1 entries"), ("a,b\n1,2\n", "no number"), ("1;2\n", "no number"), ("0x10,1\n", "no number"),
        ("1e999999,1\n", "too long or too large"), ("1_000,1\n", "no number"), ("1/3,1\n", "no number"), ("\u0661,1\n", "no number"),
    ],
)  # fmt: skip
def test_a_table_holds_finite_decimals_alone(tmp_path: Path, w: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        law(tmp_path, "w[1, 1]*x - 1", w=w)


def test_a_table_lies_beside_the_law(tmp_path: Path) -> None:
    for given in ("../w.csv", "/etc/passwd"):
        (tmp_path / "law.toml").write_text(f'{HEAD}g = "x - 1"\n[tables]\nw = "{given}"\n', encoding="utf-8")
        with pytest.raises(InputError, match="not beside the law"):
            load(tmp_path / "law.toml")
    with pytest.raises(InputError, match="in none"):
        reads(f'{HEAD}g = "x - 1"\n[tables]\nw = "w.csv"\n')
    with pytest.raises(InputError, match="no such file"):
        law(tmp_path, "x - 1", 'v = "missing.csv"\n')


def test_a_row_or_a_column_takes_one_index(tmp_path: Path) -> None:
    assert law(tmp_path, "w[2]*x - 1", w="1,7\n").g == law(tmp_path, "w[2]*x - 1", w="1\n7\n").g == plain("7*x - 1").g


def test_every_part_of_a_vector_is_as_short_as_a_formula_must_be(tmp_path: Path) -> None:
    """Also one that is longer than the first, by the signs of its numbers."""
    rows = ",".join(["1"] * 900) + "\n" + ",".join(["-1"] * 900) + "\n"
    more = '[define]\nu = "vector(i, 1, 2, sum(j, 1, 900, w[i, j]*x))"\n'
    with pytest.raises(InputError, match="too large"):
        law(tmp_path, "u[1] - 1", more, w=rows)
