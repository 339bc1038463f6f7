"""Laws with a state in criterion files and in Python: what is read and written, and what does not fit is named."""

from __future__ import annotations

import pytest

from duhem import Criterion, Domain, InputError
from duhem.law.criterion_file import criterion_text, reads
from duhem.law.state import Variable
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import NotWritten
from tests.proof.laws_with_state import ABOVE_0, ALONG, FILE, PRAGER, QUADRATIC, SLIP, armstrong_frederick, misread

NORTON = """\
[criterion]
name = "norton"
pressure = false
forces = ["s"]
[dissipation]
potential = "A*s**2"
[parameters]
A = { positive = true }
"""


def test_a_file_states_all_of_it() -> None:
    read = reads(FILE)
    assert list(read.variables) == ["u", "w", "alpha", "u_in"] and read.parameters["alpha"] == Domain.between(-1, 1)
    assert [str(d) for d in read.flow or ()] == ["(X + sigma)/Abs(X + sigma)", "-alpha*gamma + (X + sigma)/Abs(X + sigma)"]
    assert {x: str(r) for x, r in read.unforced.items()} == {"w": "1"} and {x: str(r) for x, r in read.rates.items()} == {"alpha": "X/C"}
    assert law_as_text(read)["energy"] == "k/2*(u - u_in)**2 + C/2*alpha**2"
    assert read.fix({"C": 2}).within({"gamma": Domain.between(0, 1)}).energy == read.fix({"C": 2}).energy


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        ('u_in = { force = "sigma" }\n', "", "no internal variable has the force sigma"),
        ('force = "X", min', 'force = "Z", min', "the force 'Z' of alpha is not declared; add it to forces, which are: "),
        ("w = {}", 'w = { force = "X" }', "X is the force of two internal variables, w and alpha"),
        ("w = {}", "w = { temperature = true, observable = true }", "w is an observable and the temperature"),
        ("w = {}", 'w = { temperature = true, force = "X" }', "the temperature w has a force"),
        ("w = {}", "w = { observable = true }", "another name if no internal variable has this force: the energy gives it"),
        ('u_in = { force = "sigma" }\n', "", "remove sigma from forces, as the energy gives the force of u; or declare one"),
        ('rates = { alpha = "X/C" }', "", "[dissipation] says nothing; write potential, rates or forces_of_rates in it"),
        ("pressure = false", 'pressure = false\nconstraints = ["C < sigma"]', "a constraint depends on sigma, which is no parameter"),
        ("w = {}", "w = { colour = 1 }", "unknown key 'colour' of w"),
        ("w = {}", "w = 3", "w is not a table"),
        ("w = {}", "R = {}", "'R' is declared twice"),
        ('"1", ', "", "the flow direction has 2 components for 3 rates; give one expression for each of w, alpha, u_in"),
        ("u_in)**2 + ", "u_in)**2 + sigma + ", "the energy uses ['sigma']"),
        ('alpha = "X/C"', 'u = "X/C"', "'u' has a rate and is no internal variable"),
        ('psi = "k', 'phi = "k', "unknown key 'phi'"),
        (
            'rates = { alpha = "X/C" }',
            'forces_of_rates = { sigma = "tanh(u_in_rate)" }',
            "the forces_of_rates of [dissipation] and g are both given",
        ),
        ("pressure = false", 'pressure = false\nconstraints = ["alpha < C"]', "the constraint alpha < C relates alpha"),
    ],
)
def test_what_does_not_fit_is_named(before: str, after: str, said: str) -> None:
    assert said in misread(FILE, before, after)


@pytest.mark.parametrize("given", [FILE, FILE.replace("w = {}", "T = { temperature = true, min = 1 }").replace('"1", ', ""), NORTON])
def test_a_law_with_a_state_is_written_as_a_file_that_says_it(given: str) -> None:
    read = reads(given)
    written = criterion_text(read)
    again = reads(written)
    assert again == read and again.variables == read.variables and criterion_text(again) == written
    assert (again.energy, dict(again.rates), dict(again.unforced), again.viscous) == (read.energy, read.rates, read.unforced, read.viscous)


def test_a_potential_of_rates_in_a_file() -> None:
    text = NORTON
    read = reads(text)
    assert read.viscous and law_as_text(read)["viscous"] is True and str(read.g) == "A*s**2"
    with pytest.raises(InputError, match="are both given"):
        reads(text.replace('forces = ["s"]', 'forces = ["s"]\ng = "s"'))
    with pytest.raises(InputError, match="are both given"):
        reads(text + '[flow]\ndirection = ["1"]\n')


def test_a_surface_has_no_rate_of_a_variable_without_a_force() -> None:
    text = FILE[: FILE.index("[flow]")].replace('g = "norm(sigma + X) - R"', "")
    two = """
[[surface]]
g = "sigma + X - R"
flow = ["{}", "1", "1"]

[[surface]]
g = "-sigma - X - R"
flow = ["0", "-1", "-1"]
"""
    assert reads(text + two.format("0"), "made").surfaces
    for wrong in ("1", "%%%((", "sqrt(-1)*zzz"):
        with pytest.raises(InputError):
            reads(text + two.format(wrong), "made")


def test_a_variable_with_a_force_has_no_second_rate() -> None:
    flow = (ALONG, ALONG)
    with pytest.raises(InputError, match="alpha has a force, and a rate beside the flow"):
        Criterion(
            "twice", PRAGER, {"R": ABOVE_0, "k": ABOVE_0, "C": ABOVE_0}, ("sigma", "Y"), None, flow=flow,
            energy=f"{QUADRATIC} + C/2*alpha**2", variables=SLIP | {"alpha": Variable("Y")}, unforced={"alpha": "-1000*Y"},
        )  # fmt: skip
    with pytest.raises(NotWritten):
        StatedLaw.read(law_as_text(armstrong_frederick()) | {"unforced": {"alpha": "-1000*Y"}})


def test_an_observable_may_have_a_force_that_drives_nothing_but_no_name_in_use() -> None:
    variables = {"eps": Variable("sigma", observable=True), "D": Variable("Y", domain=Domain.between(0, 1))}
    head = {"parameters": {"E": ABOVE_0, "Y_0": ABOVE_0}, "forces": ("Y",), "pressure": None, "energy": "(1 - D)*E*eps**2/2"}
    assert Criterion("bar", "Y - Y_0", variables=variables, **head).variables["eps"].force == "sigma"
    for taken in ("E", "D"):
        with pytest.raises(InputError, match="another name too"):
            Criterion("bar", "Y - Y_0", variables=variables | {"eps": Variable(taken, observable=True)}, **head)


@pytest.mark.parametrize(("section", "message"), [("", "says nothing"), ('potental = "a**2"', "did you mean 'potential'")])
def test_a_wrong_dissipation_is_named_where_g_is_missing_too(section: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        reads(f'[criterion]\nname = "rates"\nforces = ["a", "b"]\n[dissipation]\n{section}\n')
