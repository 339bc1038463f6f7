"""Local names of a law: the law is what it is with all of them written out, and faults are found where they stand."""

from __future__ import annotations

import pickle

import pytest
import sympy as sp

from duhem import Criterion, criterion, derive
from duhem.errors import InputError
from duhem.law.criterion_file import reads
from duhem.law.domain import POSITIVE, Domain
from duhem.proof.certificate import law_as_text
from duhem.proof.statement import as_written

FILE = """\
[criterion]
name = "cone"
stress = { name = "sigma", kind = "principal" }
pressure = false
g = "q + twice/2*I1(sigma) - k"
constraints = ["twice < 3"]
[define]
twice = "2*alpha"
q = '''sqrt(
  J2(sigma))'''
slope = "twice/2"
[flow]
direction = ["sigma_1 + slope", "sigma_2", "sigma_3*twice"]
[parameters]
alpha = { positive = true }
k = { positive = true }
"""
LONG = "sqrt(((sigma_1 - sigma_2)**2 + (sigma_2 - sigma_3)**2 + (sigma_3 - sigma_1)**2)/6)"
ALPHA = {"alpha": POSITIVE, "k": POSITIVE}


def _long(**more: object) -> Criterion:
    """The same law with nothing abbreviated."""
    own = {"g": f"{LONG} + 2*alpha/2*(sigma_1 + sigma_2 + sigma_3) - k", "constraints": ("2*alpha < 3",)}
    flow = ("sigma_1 + 2*alpha/2", "sigma_2", "sigma_3*2*alpha")
    return Criterion(name="cone", forces=("sigma_1", "sigma_2", "sigma_3"), pressure=None, parameters=ALPHA, flow=flow, **(own | more))


def test_a_law_is_the_one_with_its_definitions_written_out() -> None:
    short, long = reads(FILE), _long()
    assert (short.g, short.forces, short.constraints, short.flow) == (long.g, long.forces, long.constraints, long.flow)
    assert short == Criterion(
        name="cone",
        g="q + twice/2*I1(sigma) - k",
        stress={"name": "sigma", "kind": "principal"},
        define=short.define,
        pressure=None,
        parameters=ALPHA,
        constraints=["twice < 3"],
        flow=["sigma_1 + slope", "sigma_2", "sigma_3*twice"],
    )
    assert pickle.loads(pickle.dumps(short)) == short
    assert short.fix({"alpha": 1}).define == short.define


def test_the_kernel_reads_the_formula_written_out_and_unsimplified() -> None:
    law = reads('[criterion]\nname = "x"\ng = "q - sigma_a + abs(sigma_a)"\n[define]\nr = "sigma_a"\nq = "r/r*r"\n')
    assert law_as_text(law)["g"] == as_written(law)[0] == law.written == "((sigma_a)/(sigma_a)*(sigma_a)) - sigma_a + abs(sigma_a)"


def test_brackets_are_those_of_the_definition() -> None:
    law = reads('[criterion]\nname = "x"\ng = "2*s - s**2 - abs(sigma_n)"\n[define]\ns = "sigma_a + sigma_b"\n')
    a, b, n = law.symbols().values()
    assert sp.expand(law.g - (2 * (a + b) - (a + b) ** 2 + n)) == 0


def test_from_python() -> None:
    stress = {"name": "sigma", "kind": "principal"}

    @criterion(stress=stress, pressure=None, define={"q": "sqrt(J2(sigma)) + beta"}, parameters={"beta": Domain.fixed(2)})
    def pear(q: sp.Expr, sigma_1: sp.Expr, k: sp.Expr) -> sp.Expr:
        """A law of a defined name."""
        return q + sigma_1 - k

    given = {"g": "q + sigma_1 - k", "stress": stress, "define": {"q": "sqrt(J2(sigma)) + beta"}, "summary": "A law of a defined name."}
    law = Criterion(name="pear", pressure=None, parameters={"k": POSITIVE, "beta": Domain.fixed(2)}, **given)
    assert pear == law and "beta) + sigma_1 - k" in law.written


FAULTS = {
    "unknown name": ('"q +', '"qq +', "5:6", "did you mean 'q'"),
    "called": ('"q +', '"q(3) +', "5:6", "write q*(...)"),
    "behind a definition": ("- k", "- kk", "5:30", "unknown name 'kk'"),
    "in a definition": ("J2(sigma))", "J2(sigma) + foo)", "10:15", "unknown name 'foo'"),
    "used before it is defined": ('"2*alpha"', '"2*q"', "8:12", "'q' is used before it is defined"),
    "used in itself": ('"2*alpha"', '"2*twice"', "8:12", "'twice' is used before it is defined"),
    "a force": ('slope = "', 'sigma_1 = "', "11:1", "declared twice"),
    "a parameter": ('slope = "', 'alpha = "', "11:1", "declared twice"),
    "the pressure": ("pressure = false", 'pressure = "slope"', "11:1", "declared twice"),
    "a word": ('slope = "', 'abs = "', "11:1", "already means something"),
    "an invariant": ('slope = "', 'J2 = "', "11:1", "already means something"),
    "a parameter named as an invariant": ("[parameters]", "[parameters]\nJ3 = {}", "15:1", "already means something"),
    "no name": ('slope = "', '"a b" = "', "11:1", "not a name"),
    "no text": ('"2*alpha"', "2", "8:1", "twice is not a text"),
    "empty": ('"2*alpha"', '""', "8:1", "twice is empty"),
    "a comparison": ('"2*alpha"', '"alpha < 1"', "8:10", "comparison"),
    "forces in a constraint": ('["twice < 3"]', '["q < 3"]', "6:17", "'q' stands for a formula of 'sigma_1'"),
    "undefined at every value": ('"q +', '"1/(twice - twice) +', "5:6", "division by zero"),
    "not real": ('"q +', '"sqrt(-1 - twice**2) +', "5:6", "'sqrt(-1 - twice**2)'"),
    "side by side": ('"q +', '"q q +', "5:8", "unexpected 'q' after 'q'"),
    "two declarations": ("pressure = false", 'forces = ["s"]\npressure = false', "3:1", "both declared"),
    "unknown kind": ('"principal"', '"cubic"', "3:1", "kinds are: 3d, plane, principal"),
    "no kind": (', kind = "principal"', "", "3:1", "not a table of name and kind"),
    "no table of a stress": ('{ name = "sigma", kind = "principal" }', '"sigma"', "3:1", "not a table of name and kind"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_is_found_where_it_stands(fault: str) -> None:
    old, new, place, message = FAULTS[fault]
    assert FILE.count(old) == 1
    with pytest.raises(InputError) as caught:
        reads(FILE.replace(old, new), "law.toml")
    assert caught.value.where == f"law.toml:{place}" and message in str(caught.value)


def test_definitions_of_definitions_are_shared_where_they_grow_too_large() -> None:
    lines = ['a0 = "sigma_a + sigma_a"', *(f'a{i} = "a{i - 1}*a{i - 1}"' for i in range(1, 40))]
    law = reads('[criterion]\nname = "x"\ng = "a39 - 1"\n[define]\n' + "\n".join(lines))
    assert isinstance(law, Criterion) and law.graph is not None and len(law.graph.nodes) == 40
    with pytest.raises(InputError, match="too large"):
        reads('[criterion]\nname = "x"\ng = "sigma_a - 1"\n[flow]\ndirection = ["a39", "0"]\n[define]\n' + "\n".join(lines))


@pytest.mark.parametrize(
    "given", [{"define": {"q": 3}}, {"define": "q"}, {"stress": "sigma"}, {"stress": {"name": "s"}}, {"forces": ("a",)}]
)
def test_what_a_program_may_get_wrong(given: dict[str, object]) -> None:
    own = {"name": "x", "g": "J2(sigma) - 1", "stress": {"name": "sigma", "kind": "3d"}, "pressure": None}
    with pytest.raises(InputError):
        Criterion(**(own | given))


@pytest.mark.slow
def test_a_derivation_prints_them() -> None:
    found = derive(reads(FILE))
    assert "D0.2" in found.text() and "q = sqrt( J2(sigma))" in found.text()
    assert sp.simplify(found["definition_slope"].rhs - found["definition_twice"].rhs / 2) == 0
