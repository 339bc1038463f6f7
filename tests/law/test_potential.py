"""A potential instead of a flow: its gradient, in the law and in the kernel, and what is proved and refuted of it."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp

import duhem
from duhem import Criterion
from duhem.errors import InputError
from duhem.expression import Where
from duhem.expression.vocabulary import rows
from duhem.law.criterion_file import criterion_text, reads
from duhem.law.domain import POSITIVE
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.certificate import digest, recheck, stated
from duhem.proof.kernel.claims import objection
from duhem.proof.kernel.gradient import gradient
from duhem.proof.kernel.term import NotWritten, Term, parse
from tests.long import mostly_long

HEAD = '[criterion]\nname = "x"\nforces = ["a", "b"]\npressure = false\n'
K = "[parameters]\nk = { positive = true }\n"


def _law(g: str, potential: str) -> Criterion:
    return reads(f'{HEAD}g = "{g}"\npotential = "{potential}"\n{K}')


POTENTIALS = (
    "a**2*b + 3*a/b",
    "norm(a, 2*b)**3 - sqrt(a**2 + b**2 + 1)",
    "exp(a*b) + log(a**2 + 1)*sin(b) - cos(a) + tan(b/5)",
    "tanh(a) + atan(a*b)/2",
    "sinh(a) - cosh(a*b) + asin(a/5) + acos(b/5)",
    "abs(a)*b + pos(a - b) - 2*neg(a + b)",
    "max(a, b, -a)*min(a, 2*b)",
    "where(a < b, a**2, k*b)",
    "eigmax(a, b, a*b, a/2, 1, b)",
    "where(a < b and a > -1, a**2, k*b)",
)
POINTS = ((0.7, -1.3), (-0.4, 0.9), (2.5, 1.1), (-1.7, -0.6))


def _value(term: Term, at: dict[str, float]) -> float:
    """A term of the kernel in floating point."""
    if term.op in ("number", "name"):
        return float(term.value) if term.op == "number" else at[term.name]
    if term.op == "where":
        return _value(term.args[1 if _value(term.args[0], at) else 2], at)
    x, *rest = values = [_value(a, at) for a in term.args]
    if term.op == "eigmax":
        return float(np.linalg.eigvalsh(rows(*values))[-1])
    words = {
        "abs": abs,
        "pos": lambda x: max(x, 0.0),
        "neg": lambda x: max(-x, 0.0),
        "norm": math.hypot,
        "max": lambda *x: max(x),
        "min": lambda *x: min(x),
    }
    signs = {"+": sum, "*": math.prod}
    if term.op in signs:
        return float(signs[term.op](values))
    if term.op in ("**", ">=", "<", ">", "and"):
        compared = {">=": x >= rest[0], "<": x < rest[0], ">": x > rest[0], "and": x and rest[0]}
        return x ** rest[0] if term.op == "**" else float(compared[term.op])
    return float((words.get(term.op) or getattr(math, term.op))(*values))


@pytest.mark.slow
@pytest.mark.parametrize("potential", mostly_long(POTENTIALS, *(p for p in POTENTIALS if "eigmax" not in p)))
def test_the_kernels_gradient_is_the_laws(potential: str) -> None:
    law = _law("norm(a, b) - k", potential)
    for a, b in POINTS:
        at = {"a": a, "b": b, "k": 2.0}
        ours = [float(c.subs({law.symbols()[n]: sp.Float(v, 30) for n, v in at.items()})) for c in law.flow or ()]
        assert [_value(c, at) for c in gradient(parse(potential), ("a", "b"))] == pytest.approx(ours, rel=1e-12)


def test_a_power_of_a_force_has_no_derivative_in_the_kernel() -> None:
    with pytest.raises(NotWritten):
        gradient(parse("k**a"), ("a",))


def test_at_a_kink_the_pieces_stand_side_by_side() -> None:
    law = _law("norm(a, b) - k", "abs(a) + max(a, b)")
    assert all(c.has(Where) and not c.has(sp.Derivative, sp.sign, sp.Heaviside) for c in law.flow or ())


VERDICTS = {
    ("norm(a, b) - k", "norm(a, b)"): ("proved", "proved"),
    ("norm(a, b) - k", "a**2 + b**2"): ("proved", "proved"),
    ("norm(a, b) - k", "a**2 + b**2 - a/10"): ("refuted", None),
    ("a**2 + 2*b**2 - k", "a**2 + b**2"): ("refuted", "proved"),
    ("norm(a, b) - k", "a**2 - b**2"): ("refuted", "refuted"),
    ("norm(a, b) - k", "-norm(a, b)"): ("refuted", "refuted"),
    ("norm(a, b) + a/5 - k", "norm(a, b) + a/20"): ("refuted", "proved"),
    ("norm(a, b) + a/5 - k", "norm(a, b) + a/5"): ("proved", "proved"),
    ("norm(a, b) + a/5 - k", "norm(a, b) + 2*a"): ("refuted", "refuted"),
}


@pytest.mark.slow
@pytest.mark.parametrize(("g", "potential"), mostly_long(VERDICTS, *[*VERDICTS][2:5], [*VERDICTS][6]))
def test_what_is_decided_of_it(g: str, potential: str) -> None:
    found = duhem.verify(_law(g, potential), claims=["convexity", "normality", "dissipation"])
    normality, dissipation = VERDICTS[g, potential]
    assert found["convexity"].verdict.value == "proved" and found["normality"].verdict.value == normality
    assert dissipation in (None, found["dissipation"].verdict.value)


def test_a_flow_that_is_undefined_on_the_boundary_says_nothing_of_k() -> None:
    found = duhem.verify(_law("norm(a, b) - k", "log(a**2) + b**2"), claims=["origin", "convexity", "dissipation"])
    assert [found[c].verdict.value for c in ("origin", "convexity")] == ["proved", "proved"]
    assert found["dissipation"].verdict.value != "proved"
    assert "duhem could not show that the flow has a value on the whole boundary" in " ".join(found.remarks)


@pytest.mark.parametrize("potential", ["a**2 + b**2 + log(-1 - k)*0", "a**2 + b**2 + 0*log(a)"])
def test_a_potential_must_be_defined_for_its_gradient_to_be(potential: str) -> None:
    text = law_as_text(_law("norm(a, b) - k", "a**2 + b**2"))
    assert not objection("dissipation", "boundary-power", frozenset(), stated(text), {})
    assert objection("dissipation", "boundary-power", frozenset(), stated(text | {"flow": {"potential": potential}}), {})


@pytest.mark.parametrize(
    ("potential", "share", "confirmed"),
    [
        ("norm(a, b) + a/20", "1/4", True),
        ("norm(a, b) + a/20", "1/3", False),
        ("norm(a, b) + a/20", "a", False),
        ("norm(a, b) + a/4", "5/4", False),  # more dilatancy than friction
        ("norm(a, b) + a/20 - norm(a, b)**2/9", "1/4", False),
        ("norm(a, b) + a/20 + exp(a)", "1/4", False),
        ("log(a)*0 + norm(a, b) + a/20", "1/4", False),
    ],
)
def test_the_kernel_takes_a_share_of_g_from_the_power(potential: str, share: str, confirmed: bool) -> None:
    text = law_as_text(_law("norm(a, b) + a/5 - k", "a")) | {"flow": {"potential": potential}}
    assert (not objection("dissipation", "potential", frozenset(), stated(text), {"share": share})) == confirmed


@pytest.mark.long
def test_at_the_tip_of_a_cone_the_flow_is_a_mean_of_those_around() -> None:
    """Drucker-Prager with dilatancy below friction: the formula of the flow is 0/0 at the tip."""
    g, potential = "sqrt(J2(s)) + alpha*I1(s) - k", "sqrt(J2(s)) + beta*I1(s)"
    given = {"stress": {"name": "s", "kind": "principal"}, "pressure": None, "constraints": ("beta <= alpha",)}
    law = Criterion(name="x", g=g, potential=potential, parameters=dict.fromkeys(("alpha", "beta", "k"), POSITIVE), **given)
    found = duhem.verify(law, claims=["dissipation"])["dissipation"]
    assert (found.verdict.value, str(found.trust)) == ("proved", "checked")


def test_a_certificate_holds_the_potential_and_not_its_gradient() -> None:
    law = Criterion(name="x", g="a**2 + 2*b**2 - k", potential="a**2 + b**2", forces=("a", "b"), pressure=None, parameters={"k": POSITIVE})
    written = duhem.verify(law, claims=["dissipation"]).certificate()
    assert written["law"]["flow"] == {"potential": "a**2 + b**2"}
    assert all(row.confirmed for row in recheck(written) if row.claim == "dissipation")
    other = written | {"law": written["law"] | {"flow": {"potential": "a**2 - b**2"}}}
    assert not any(row.confirmed for row in recheck(other | {"sha256": digest(other)}) if row.claim == "dissipation")


def test_it_survives_fixing_and_text() -> None:
    law = _law("norm(a, b) - k", "k*a**2 + b**2")
    assert law.fix({"k": 2}).flow == _law("norm(a, b) - k", "k*a**2 + b**2").fix({"k": 2}).flow
    assert reads(criterion_text(law)) == law
    assert law.fix({"k": Fraction(1, 2)}).potential == law.potential


FAULTS = {
    "unknown name": ('"a**2"', '"a**2 + c"', "6:21", "unknown name 'c'"),
    "no force": ('"a**2"', '"k"', "6:1", "does not depend on any force"),
    "empty": ('"a**2"', '""', "6:1", "potential is empty"),
    "beside a flow": ("[parameters]", '[flow]\ndirection = ["a", "b"]\n[parameters]', "6:1", "both given"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_is_found_where_it_stands(fault: str) -> None:
    old, new, place, message = FAULTS[fault]
    text = f'{HEAD}g = "norm(a, b) - k"\npotential = "a**2"\n{K}'
    with pytest.raises(InputError, match=message) as caught:
        reads(text.replace(old, new), "law.toml")
    assert caught.value.where == f"law.toml:{place}"


@pytest.mark.parametrize("given", [{"potential": 3}, {"potential": "a", "flow": ("a", "b")}, {"potential": "2"}])
def test_what_a_program_may_get_wrong(given: dict[str, object]) -> None:
    with pytest.raises(InputError):
        Criterion(**({"name": "x", "g": "norm(a, b) - 1", "forces": ("a", "b"), "pressure": None} | given))
