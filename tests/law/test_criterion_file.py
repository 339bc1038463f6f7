"""Criterion files: read exactly, and every fault named with file, line, column and remedy."""

from pathlib import Path

import pytest
import sympy as sp

from duhem.errors import InputError
from duhem.expression import Norm
from duhem.law.criterion_file import read, reads
from duhem.law.domain import POSITIVE, REAL, Domain
from duhem.law.formula_law import Criterion
from duhem.law.parameter_domain import check_domain

WHOLE = """\
# [parameters] in a comment is no section
[criterion]
name = "tilted"
summary = '''
Two
lines'''
source = "Author (2000), Eq. (1)"
forces = ["s", "t"]   # two
pressure = "p"
g = \"""
norm(s/mu_a, 0.15*t/mu_b) \\
  - abs(p) + 0*free\"""
constraints = [
  "e < mu_a",   # a comment ] with "quotes"
  'e <= mu_b',
]

[parameters]
mu_a = { positive = true }
mu_b = { value = 0.15 }
e = { min = 0, max = 1e-1 }
cap = { max = "1/3" }
bounded = { positive = true, max = 2 }
free = {}

[flow]
direction = ["s", "t*2"]
"""


def test_a_whole_file(tmp_path: Path) -> None:
    path = tmp_path / "tilted.toml"
    path.write_text(WHOLE, "utf-8")
    law = read(path)
    s, t, p, mu_a, mu_b, e = (law.symbols()[n] for n in ("s", "t", "p", "mu_a", "mu_b", "e"))
    third = sp.Rational(1, 3)
    assert law == Criterion(
        name="tilted",
        summary="Two lines",
        source="Author (2000), Eq. (1)",
        forces=("s", "t"),
        pressure="p",
        g=Norm(s / mu_a, sp.Rational(3, 20) * t / mu_b) + p,
        constraints=(e < mu_a, e <= mu_b),
        parameters={
            "mu_a": POSITIVE,
            "mu_b": Domain.fixed("3/20"),
            "e": Domain.between(0, "1/10"),
            "cap": Domain(high=third),
            "bounded": Domain(sp.S.Zero, sp.Integer(2), positive=True),
            "free": REAL,
        },
        flow=(s, 2 * t),
    )
    assert reads(WHOLE.replace("\n", "\r\n")) == law


def test_defaults() -> None:
    law = reads('[criterion]\nname = "least"\ng = "norm(sigma_a, sigma_b) + sigma_n"\n')
    assert (law.forces, law.pressure, law.flow, dict(law.parameters)) == (("sigma_a", "sigma_b"), "sigma_n", None, {})


def test_a_law_without_pressure() -> None:
    law = reads('[criterion]\nname = "mises"\nforces = ["s"]\npressure = false\ng = "abs(s) - k"\n[parameters]\nk = { positive = true }\n')
    assert law.pressure is None


@pytest.mark.parametrize("layout", ['criterion = {name = "a", g = "sigma_a + foo"}', 'criterion.name = "a"\ncriterion.g = "sigma_a + foo"'])
def test_other_layouts_of_toml_find_the_place_too(layout: str) -> None:
    with pytest.raises(InputError) as caught:
        reads(layout, "law.toml")
    line = layout.count("\n") + 1
    column = layout.splitlines()[-1].index("foo") + 1
    assert caught.value.where == f"law.toml:{line}:{column}"


HEAD = '[criterion]\nname = "x"\n'
G = 'g = "norm(sigma_a/mu_a, sigma_b/mu_b) - abs(sigma_n)"\n'
P = "[parameters]\nmu_a = { positive = true }\nmu_b = { positive = true }\n"

# Each text with the place of the fault (line:column, or nothing where the whole file is at fault) and a word of the message.
FAULTS = {
    "empty": ("", "", "empty"),
    "blank": (" \n\t\n", "", "empty"),
    "no criterion": (P, "", "no [criterion]"),
    "criterion is a number": ("criterion = 3\n", "1:1", "not a table"),
    "unknown section": (HEAD + G + P + "[flw]\n", "7:1", "did you mean 'flow'"),
    "unknown key": (HEAD + "sumary = 'a'\n" + G + P, "3:1", "did you mean 'summary'"),
    "no name": ("[criterion]\n" + G + P, "1:1", "no name"),
    "name is a number": ("[criterion]\nname = 3\n" + G + P, "2:1", "not a text"),
    "name is empty": ("[criterion]\nname = ''\n" + G + P, "2:1", "empty"),
    "name is not printable": ('[criterion]\nname = "a\\u001b[31m"\n' + G + P, "2:1", "printable"),
    "no g": (HEAD + P, "1:1", 'add g = "...", or a potential or forces_of_rates in the section [dissipation]'),
    "rates and no g": (HEAD + P + '[dissipation]\nrates = { e = "rate" }\n', "1:1", "the rates that are there come beside one of these"),
    "g without forces": (HEAD + 'g = "mu_a - abs(sigma_n)"\n' + P, "3:1", "does not depend on any force"),
    "missing parameter": (HEAD + G + "[parameters]\nmu_a = {}\n", "3:33", "unknown name 'mu_b'"),
    "unknown name in lines": (HEAD + 'g = """\n  norm(sigma_a,\n   sigma_b) + foo"""\n' + P, "5:15", "unknown name 'foo'"),
    "unknown name after a continuation": (HEAD + 'g = """sigma_a \\\n   + foo"""\n' + P, "4:6", "unknown name 'foo'"),
    "forces are no list": (HEAD + 'forces = "s"\n' + G + P, "3:1", "not a list of names"),
    "no forces": (HEAD + "forces = []\n" + G + P, "3:1", "not a list of names"),
    "force is a keyword": (HEAD + 'forces = ["in"]\n' + G + P, "3:1", "already means something"),
    "force is no name": (HEAD + 'forces = ["a b"]\n' + G + P, "3:1", "not a name"),
    "pressure has no name": (HEAD + 'pressure = ""\n' + G + P, "3:1", "pressure is not a name"),
    "pressure is a number": (HEAD + "pressure = 1\n" + G + P, "3:1", "pressure is not a name"),
    "force and pressure agree": (HEAD + 'pressure = "sigma_a"\n' + G + P, "3:1", "declared twice"),
    "parameter named like a word": (HEAD + G + P + "abs = {}\n", "7:1", "already means something"),
    "parameter named like a force": (HEAD + G + P + "sigma_a = {}\n", "7:1", "declared twice"),
    "duplicate key": (HEAD + G + P + "mu_a = {}\n", "7:10", "overwrite"),
    "broken TOML": (HEAD + "g =\n", "3:4", "invalid value"),
    "deep TOML": ("x = " + "[" * 100_000, "", "nests too deeply"),
    "domain is a number": (HEAD + G + "[parameters]\nmu_a = 0.15\n", "5:1", "write mu_a = { value = 0.15 }"),
    "domain is a text": (HEAD + G + "[parameters]\nmu_a = 'positive'\n", "5:1", "not a table"),
    "unknown key of a domain": (HEAD + G + "[parameters]\nmu_a = { mn = 1 }\n", "5:1", "did you mean 'min'"),
    "mixed domain": (HEAD + G + "[parameters]\nmu_a = { positive = true, min = 1 }\n", "5:1", "mixes positive and min"),
    "mixed value": (HEAD + G + "[parameters]\nmu_a = { value = 1, max = 1 }\n", "5:1", "mixes value and max"),
    "not positive": (HEAD + G + "[parameters]\nmu_a = { positive = false }\n", "5:1", "is not true"),
    "empty domain": (HEAD + G + "[parameters]\nmu_a = { min = 1, max = 0.5 }\n", "5:1", "is empty"),
    "infinite bound": (HEAD + G + "[parameters]\nmu_a = { max = inf }\n", "5:1", "not a number"),
    "truth as a bound": (HEAD + G + "[parameters]\nmu_a = { max = true }\n", "5:1", "truth value"),
    "huge bound": (HEAD + G + "[parameters]\nmu_a = { max = 1e999999 }\n", "5:1", "too large"),
    "domain in a section of its own": (HEAD + G + "[parameters.mu_a]\nmax = 'x'\n", "4:1", "not a number"),
    "constraint is no comparison": (HEAD + G + 'constraints = ["mu_a"]\n' + P, "4:17", "no comparison"),
    "constraint on a force": (
        HEAD + G + 'constraints = ["mu_a < 1", "mu_a < sigma_a"]\n' + P,
        "4:36",
        "a constraint depends on sigma_a, which is no parameter",
    ),
    "constraint never holds": (HEAD + G + 'constraints = ["mu_a < -1"]\n' + P, "4:17", "contradictory"),
    "constraints contradict each other": (HEAD + G + 'constraints = ["mu_a < mu_b", "mu_b < mu_a"]\n' + P, "4:1", "no parameter values"),
    "constraint against a domain": (HEAD + G + 'constraints = ["e > mu_b"]\n' + P + "e = { max = 0 }\n", "4:1", "no parameter values"),
    "non-linear contradiction": (
        HEAD + G + 'constraints = ["mu_a*mu_b > 1", "mu_a < 0.1", "mu_b < 5"]\n' + P,
        "4:1",
        "no parameter values",
    ),
    "flow without direction": (HEAD + G + P + "[flow]\n", "7:1", "no direction"),
    "flow of wrong length": (HEAD + G + P + '[flow]\ndirection = ["sigma_a"]\n', "8:1", "1 components for 2 forces"),
    "flow of numbers": (HEAD + G + P + "[flow]\ndirection = [1, 2]\n", "8:1", "not a list of expressions"),
    "fault in the flow": (HEAD + G + P + '[flow]\ndirection = ["sigma_a",\n  "sigma_b*foo"]\n', "9:12", "unknown name 'foo'"),
}


@pytest.mark.parametrize("case", FAULTS)
def test_fault_names_place_and_remedy(case: str) -> None:
    text, place, words = FAULTS[case]
    with pytest.raises(InputError) as caught:
        reads(text, "law.toml")
    assert caught.value.where == ("law.toml:" + place if place else "law.toml")
    assert words in str(caught.value)
    assert caught.value.remedy
    assert "\n" not in str(caught.value)


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    binary, large = tmp_path / "binary.toml", tmp_path / "large.toml"
    binary.write_bytes(b"name\n\xff\x00\x01")
    large.write_text("#" * 1_000_001)
    cases = {
        str(tmp_path / "none.toml"): "no such file",
        str(tmp_path): "directory",
        str(binary): "UTF-8",
        str(large): "larger",
        "nul\0byte.toml": "cannot be read",
    }
    for path, words in cases.items():
        with pytest.raises(InputError, match=words):
            read(path)


def test_a_byte_order_mark_does_no_harm(tmp_path: Path) -> None:
    path = tmp_path / "bom.toml"
    path.write_text(HEAD + G + P, "utf-8-sig")
    assert read(path) == reads(HEAD + G + P)


@pytest.mark.parametrize(
    "constraints",
    [
        ["mu_a < mu_b"],
        ["mu_a < mu_b", "mu_b < 2*mu_a"],
        ["mu_a*mu_b > 1e6", "mu_a < 0.001"],
        ["norm(mu_a, mu_b) < 1", "max(mu_a, mu_b) > 0.9"],
        ["exp(mu_a) < 2", "mu_b > 100"],
        ["mu_a > -1"],
    ],
    ids=str,
)
def test_constraints_with_a_solution_pass(constraints: list[str]) -> None:
    reads(HEAD + G + f"constraints = {constraints}\n" + P)


def test_fixed_values_are_checked_against_the_constraints() -> None:
    law = reads(HEAD + G + 'constraints = ["exp(mu_a) < 1 + mu_b", "mu_a < mu_b"]\n' + P)
    check_domain(law.fix({"mu_a": 1, "mu_b": 2}))
    for values in ({"mu_a": 2, "mu_b": 1}, {"mu_a": 2, "mu_b": "5/2"}):
        with pytest.raises(InputError, match="no parameter values"):
            check_domain(law.fix(values))


def test_a_constraint_that_a_fixed_value_settles_is_dropped() -> None:
    law = reads(HEAD + 'g = "abs(sigma_a) - m*abs(sigma_n)"\nconstraints = ["m > -1", "m < 2"]\n[parameters]\nm = { min = 0 }\n')
    assert [str(c) for c in law.fix({"m": "1/2"}).constraints] == ["m < 2"]


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"mu": 1}, r"parameter mu: the domain of mu is 1; write Domain\.fixed"),
        ({"mu": (0, 1)}, r"domain of mu is \(0, 1\)"),
        ({"mu": None}, "domain of mu is None"),
        (["mu"], r"\['mu'\] does not say which.*map each name to a domain"),
        ("mu", "map each name to a domain"),
        ({3: POSITIVE}, "3 is not a name"),
    ],
)
def test_parameters_that_are_no_domains_by_name(parameters, message):
    with pytest.raises(InputError, match=message):
        Criterion("x", "abs(sigma_a) - mu*abs(sigma_n)", parameters)


@pytest.mark.parametrize(
    ("section", "most"),
    [
        ('forces = [{}]\ng = "f0"\n', 100),
        ('g = "sigma_a"\nconstraints = [{}]\n', 200),
        ('g = "sigma_a"\n[parameters]\n{}\n', 200),
        ('g = "sigma_a"\n[define]\n{}\n', 500),
        ("{}\n", 200),
    ],
)
def test_a_law_has_no_more_parts_than_are_of_use(section: str, most: int) -> None:
    def text(n: int) -> str:
        names = [f"f{i}" for i in range(n)]
        if "[{}]" in section:
            entries = ", ".join(f'"{name}"' for name in names)
        elif section == "{}\n":
            entries = '[[surface]]\ng = "sigma_a"\n' * n
        else:
            entries = "\n".join(f'{name} = "1"' if "define" in section else f"{name} = {{}}" for name in names)
        return '[criterion]\nname = "x"\n' + section.format(entries)

    with pytest.raises(InputError, match=f"has {most + 1} entries; at most {most}"):
        reads(text(most + 1))
    try:
        reads(text(most))
    except InputError as fault:
        assert "entries" not in str(fault)  # what else is wrong with it
