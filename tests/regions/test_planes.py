"""For which values of several parameters: exact regions and pavings, held to sums that share nothing with them, and their certificates."""

from __future__ import annotations

import json
import random
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

import duhem
from duhem.cli import cli
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.certificate import digest
from duhem.proof.kernel.dents import dents
from duhem.proof.kernel.signs import RealRoot
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import UNREADABLE
from duhem.proof.recheck import RecheckedRegion
from duhem.regions import PavedRegion, told
from duhem.regions.paving import Paving
from duhem.show.printing import latex, text
from tests.long import long_but, mostly_long

BETWEEN = duhem.Domain.between
Point = Mapping[str, Fraction]


def form(rows: list[list[Any]]) -> bool:
    """Whether a quadratic form is >= 0, by all of its principal minors."""
    n = len(rows)
    subsets = [[i for i in range(n) if mask >> i & 1] for mask in range(1, 2**n)]
    return all(_determinant([[rows[i][j] for j in rows_] for i in rows_]) >= 0 for rows_ in subsets)


def _determinant(rows: list[list[Any]]) -> Any:
    if not rows:
        return 1
    return sum((-1) ** j * rows[0][j] * _determinant([r[:j] + r[j + 1 :] for r in rows[1:]]) for j in range(len(rows)))


def quartic(at: Point) -> bool:
    """Whether x^4 + a x^3 y + b x^2 y^2 + a x y^3 + y^4 is convex: 0 <= b <= 6 and 9 a^2 <= 2 b^2 + 12 b, by the roots of its Hessian."""
    a, b = at["a"], at["b"]
    return 0 <= b <= 6 and 9 * a * a <= 2 * b * b + 12 * b


POSITIVE_BELOW_ONE = duhem.Domain(high=1, positive=True)
PLANE = duhem.Criterion(name="plane", pressure=None, forces=("x", "y"), g="x**2 + a*x*y + b*y**2 - 1",
                        parameters={"a": BETWEEN(-3, 3), "b": BETWEEN(-1, 3)})  # fmt: skip
LAWS: dict[str, tuple[duhem.Criterion, tuple[str, ...], str, str, Callable[[Point], bool]]] = {
    "form of two": (PLANE, ("a", "b"), "convexity", "a**2 - 4*b <= 0", lambda at: at["a"] ** 2 <= 4 * at["b"]),
    "shifted": (
        duhem.Criterion(name="shifted", pressure=None, forces=("x", "y"), g="sqrt(((x - s)/m)**2 + y**2) - 1",
                        parameters={"s": BETWEEN(-2, 2), "m": BETWEEN("1/10", 3)}),
        ("s", "m"), "origin", "m + s >= 0 and -m + s <= 0", lambda at: abs(at["s"]) <= at["m"],
    ),
    "dilatancy": (
        duhem.Criterion(name="dilatancy", pressure=None, forces=("s", "t"), g="abs(t) + m*s - k", potential="abs(t) + b*s",
                        parameters={"m": POSITIVE_BELOW_ONE, "b": BETWEEN(0, 1), "k": duhem.POSITIVE}),
        ("m", "b"), "dissipation", "b - m <= 0", lambda at: at["b"] <= at["m"],
    ),
    "fibre": (
        duhem.Criterion(name="fibre", forces=("s22", "s33", "s23", "s12"), pressure=None,
                        g="(1/T - 1/C)*(s22 + s33) + (s22 + s33)**2/(T*C) + (s23**2 - s22*s33)/S**2 + s12**2/L**2 - 1",
                        parameters={**dict.fromkeys("TCS", BETWEEN("1/10", 5)), "L": duhem.POSITIVE}),
        ("T", "C", "S"), "convexity", "C*T - 4*S**2 <= 0", lambda at: 4 * at["S"] ** 2 >= at["T"] * at["C"],
    ),
    "hoffman": (
        duhem.load("hoffman"), ("Xt", "Xc", "Yt", "Yc"), "convexity", "4*Xc*Xt - Yc*Yt >= 0",
        lambda at: 4 * at["Xt"] * at["Xc"] >= at["Yt"] * at["Yc"],
    ),
    "root": (
        duhem.Criterion(name="root", pressure=None, forces=("x", "y"), g="2*sqrt(x**2 - 2*r*x*y + q*y**2) + a*(x + y) - s",
                        parameters={"r": BETWEEN(-2, 2), "q": BETWEEN("1/10", 5), "a": BETWEEN(0, 1), "s": duhem.POSITIVE}),
        ("r", "q"), "convexity", "q - r**2 >= 0", lambda at: at["r"] ** 2 <= at["q"],
    ),
    "hill": (
        duhem.Criterion(name="cone", forces=("x", "y", "z"), pressure=None, g="F*(y - z)**2 + G*(z - x)**2 + H*(x - y)**2 - 1",
                        parameters={"F": BETWEEN(-3, 3), "G": BETWEEN("1/10", 3), "H": BETWEEN("1/10", 3)}),
        ("F", "G", "H"), "convexity", "F + H >= 0 and F + G >= 0 and F*G + F*H + G*H >= 0",
        lambda at: form([[at["G"] + at["H"], -at["H"], -at["G"]], [-at["H"], at["F"] + at["H"], -at["F"]],
                         [-at["G"], -at["F"], at["F"] + at["G"]]]),
    ),
}  # fmt: skip
QUARTIC = duhem.Criterion(name="quartic of two", pressure=None, forces=("x", "y"), g="x**4 + a*x**3*y + b*x**2*y**2 + a*x*y**3 + y**4 - 1",
                          parameters={"a": BETWEEN(-3, 3), "b": BETWEEN(-1, 7)})  # fmt: skip
DISC = duhem.Criterion(name="disc", pressure=None, forces=("x", "y"), g="norm(x - a, y - b) - 1",
                       parameters=dict.fromkeys("ab", BETWEEN("-3/2", "3/2")))  # fmt: skip


def disc(at: Point) -> bool:
    """Whether 0 lies in the disc of radius 1 about (a, b)."""
    return at["a"] ** 2 + at["b"] ** 2 <= 1


@cache
def found(name: str) -> PavedRegion:
    law, names, claim, _, _ = LAWS[name]
    done = duhem.region(law, names, claim)
    assert isinstance(done, PavedRegion)
    return done


@cache
def paved(steps: int = 300_000) -> PavedRegion:
    done = duhem.region(DISC, ("a", "b"), "origin", steps=steps)
    assert isinstance(done, PavedRegion)
    return done


def points(region: PavedRegion, count: int, seed: int = 5) -> list[dict[str, Fraction]]:
    draw = random.Random(seed)
    ends = {name: (float(own.low or 0), float(own.high or 9)) for name, own in region.everything.box.items()}
    drawn = [{name: Fraction(draw.uniform(*own)).limit_denominator(10**4) for name, own in ends.items()} for _ in range(count)]
    return [point for point in drawn if all(region.everything.box[name].holds(x) for name, x in point.items())]


def compiled(region: PavedRegion) -> list[tuple[Any, str]]:
    """The conditions of the cells as Python reads them, with the verdicts."""
    return [(compile(cell.condition.replace("true", "True"), "a cell", "eval"), cell.verdict) for cell in region.cells]


def verdict_of(cells: list[tuple[Any, str]], point: Point) -> str:
    """Of the cell in which a point lies."""
    (said,) = {verdict for condition, verdict in cells if eval(condition, {}, dict(point))}
    return said


def beside(region: PavedRegion, holds: Callable[[Point], bool], point: Point, other: Point) -> list[dict[str, Fraction]]:
    """Two points about 1e-12 apart, on both sides of where the claim ends between two points."""
    low, high = Fraction(0), Fraction(1)

    def at(share: Fraction) -> dict[str, Fraction]:
        return {name: point[name] + share * (other[name] - point[name]) for name in point}

    for _ in range(40):
        middle = (low + high) / 2
        low, high = (middle, high) if holds(at(middle)) == holds(point) else (low, middle)
    return [at(low), at(high)]


@pytest.mark.parametrize("name", mostly_long(LAWS, "form of two", "root", "shifted", "fibre", "hoffman"))
def test_regions_of_several_parameters_are_exact(name: str) -> None:
    done, (_, names, claim, condition, _) = found(name), LAWS[name]
    assert done.exact and done.open_share == 0 and done.parameters == names and done.claim == claim
    assert done.short == condition
    assert all(cell.trust == "checked" and (cell.witness is not None) is (cell.verdict == "refuted") for cell in done.cells)
    assert duhem.recheck(done.certificate()).ok


@pytest.mark.parametrize("name", mostly_long(LAWS, "form of two", "root", "shifted", "fibre", "hoffman"))
def test_verdicts_are_those_of_sums_by_hand(name: str) -> None:
    done, holds = found(name), LAWS[name][4]
    drawn = points(done, 60)
    near = [x for one, two in pairwise(drawn[:20]) if holds(one) != holds(two) for x in beside(done, holds, one, two)]
    assert near
    cells = compiled(done)
    for point in (*drawn, *near):
        assert verdict_of(cells, point) == ("proved" if holds(point) else "refuted"), point


def test_a_paving_is_never_wrong() -> None:
    done = paved()
    assert 0 < done.open_share < 1 and not done.exact and "of the domain are open" in done.sentence
    assert {cell.verdict for cell in done.cells} == {"proved", "refuted", "open"}
    cells = compiled(done)
    said = [(verdict_of(cells, point), disc(point)) for point in points(done, 150)]
    assert all(one == "open" or (one == "proved") is two for one, two in said)
    assert abs(sum(one == "open" for one, _ in said) / len(said) - done.open_share) < 0.15
    assert duhem.recheck(done.certificate()).ok


def test_more_steps_leave_less_open() -> None:
    assert paved().open_share < paved(150_000).open_share


@pytest.mark.long
def test_a_paving_of_a_quartic_is_never_wrong() -> None:
    done = duhem.region(QUARTIC, ("a", "b"), steps=20_000_000)
    assert isinstance(done, PavedRegion) and done.open_share < 0.3 and duhem.recheck(done.certificate()).ok
    cells = compiled(done)
    assert all((one := verdict_of(cells, point)) == "open" or (one == "proved") is quartic(point) for point in points(done, 500))


# -- interrupted and resumed -------------------------------------------------------------------------------------------


def test_an_interrupted_paving_goes_on_as_if_it_had_not_been(monkeypatch: pytest.MonkeyPatch, tmp_path: Any) -> None:
    whole, calls, decided = paved(), [0], Paving.decided

    def interrupted(self: Paving, place: Any) -> Any:
        calls[0] += 1
        if calls[0] == 20:
            raise KeyboardInterrupt
        return decided(self, place)

    with monkeypatch.context() as patch:
        patch.setattr(Paving, "decided", interrupted)
        part = duhem.region(DISC, ("a", "b"), "origin", steps=300_000)
    assert isinstance(part, PavedRegion) and part.stopped and part.steps < whole.steps and part.open_share > whole.open_share
    assert duhem.recheck(part.certificate(tmp_path / "part.json")).ok
    done = duhem.region(DISC, ("a", "b"), "origin", steps=300_000, resume=tmp_path / "part.json")
    assert isinstance(done, PavedRegion) and done.to_dict() == whole.to_dict() and done.certificate() == whole.certificate()


def test_resumed_in_three_parts() -> None:
    document: Any = None
    for steps in (20_000, 50_000, 300_000):
        document = duhem.region(DISC, ("a", "b"), "origin", steps=steps, resume=document).certificate()
    assert document == paved().certificate()


def test_what_cannot_be_resumed_is_an_error(tmp_path: Any) -> None:
    document = found("form of two").certificate()
    with pytest.raises(duhem.InputError, match="about something else"):
        duhem.region(PLANE, ("b", "a"), resume=document)
    with pytest.raises(duhem.InputError, match="about something else"):
        duhem.region(PLANE, ("a", "b"), "origin", resume=document)
    with pytest.raises(duhem.InputError, match="one parameter is not resumed"):
        duhem.region("limacon", resume=document)
    wrong = json.loads(json.dumps(document))
    wrong["tree"] = {"verdict": "proved", **{key: x for key, x in _leaf(wrong["tree"], "proved").items() if key != "verdict"}}
    wrong["sha256"] = digest(wrong)
    with pytest.raises(duhem.InputError, match="is not confirmed"):
        duhem.region(PLANE, ("a", "b"), resume=wrong)
    (tmp_path / "no.json").write_text("{}")
    with pytest.raises(duhem.InputError, match="cannot be resumed"):
        duhem.region(PLANE, ("a", "b"), resume=tmp_path / "no.json")


def _leaf(node: Any, verdict: str) -> Any:
    if "split" in node:
        return next(filter(None, (_leaf(node[key], verdict) for key in ("holds", "fails"))), None)
    return node if node["verdict"] == verdict else None


# -- certificates ------------------------------------------------------------------------------------------------------


def nodes(node: Any) -> list[Any]:
    return [node, *(more for key in ("holds", "fails") if key in node for more in nodes(node[key]))]


def tampered(document: dict[str, Any], draw: random.Random) -> dict[str, Any]:
    """A certificate with one or two things changed, and the hash of what it then is."""
    made: dict[str, Any] = json.loads(json.dumps(document))
    a, *_, b = made["parameters"] * 2
    for _ in range(draw.choice([1, 1, 2])):
        every = nodes(made["tree"])
        splits, leaves = [n for n in every if "split" in n], [n for n in every if "verdict" in n]
        leaf = draw.choice(leaves)
        match draw.randrange(8):
            case 0 if splits:
                one = draw.choice(splits)
                one["holds"], one["fails"] = one["fails"], one["holds"]
            case 1 if splits:
                one = draw.choice(splits)
                op = next(op for op in ("<=", ">=", "<", ">") if op in one["split"])
                one["split"] = one["split"].replace(op, draw.choice(["<=", ">=", "<", ">"]))
            case 2 if splits:
                one = draw.choice(splits)
                one["split"] += draw.choice([" + 1/10", " - 1/10", f" + {a}/100", " - 1/1000000", f"/{b}", f"*{a}", " + k", "*0"])
            case 3:
                leaf["verdict"] = draw.choice(["proved", "refuted", "open"])
            case 4:
                other = draw.choice(leaves)
                first, second = dict(leaf), dict(other)
                leaf.clear(), other.clear()
                leaf.update(second), other.update(first)
            case 5 if splits:
                one = draw.choice(splits)
                kept = one[draw.choice(["holds", "fails"])]
                one.clear()
                one.update(kept)
            case 6 if leaf.get("evidence"):
                key = draw.choice([*leaf["evidence"]])
                leaf["evidence"][key] = draw.choice([{"x": "1"}, {"y": "1"}, {"x": "a", "y": "-2"}, {}, {"value": "1/3"}, "arc 0"])
            case _:
                made["parameters"] = draw.choice([[a], [b, a], [a, b, "c"], [], [a, a], f"{a}{b}"])
    made["sha256"] = digest(made)
    return made


def confirms_only_what_is_true(document: dict[str, Any], region: PavedRegion, holds: Callable[[Point], bool], count: int) -> int:
    draw, drawn, read = random.Random(11), points(region, 300), 0
    for _ in range(count):
        try:
            done = duhem.recheck(tampered(document, draw))
        except duhem.InputError:
            continue
        assert isinstance(done, RecheckedRegion)
        read += 1
        for row in done.cells:
            if not row.reason and row.verdict != "open":
                there = [point for point in drawn if eval(row.said.replace("everywhere", "True"), {}, dict(point))]
                assert all(holds(point) is (row.verdict == "proved") for point in there), row
    return read


@pytest.mark.parametrize(
    ("name", "count"),
    mostly_long(
        [("form of two", 20), ("form of two", 40), *((name, 400) for name in ("form of two", "dilatancy", "shifted", "fibre"))],
        ("form of two", 20),
    ),
)
def test_no_tampered_certificate_confirms_a_false_region(name: str, count: int) -> None:
    assert confirms_only_what_is_true(found(name).certificate(), found(name), LAWS[name][4], count) > count / 4


@pytest.mark.parametrize("count", mostly_long((20, 100), 20))
def test_no_tampered_paving_confirms_a_false_region(count: int) -> None:
    small = paved(30_000)
    assert confirms_only_what_is_true(small.certificate(), small, disc, count) > count / 4


@pytest.mark.long
def test_no_tampered_paving_of_many_confirms_a_false_region() -> None:
    assert confirms_only_what_is_true(paved().certificate(), paved(), disc, 500) > 100


@pytest.mark.parametrize("split", ["1/a >= 0", "sqrt(a) >= 0", "log(b) > 0", "a + c <= 0", "x <= 0", "a", "a <= 1 <= b", "a == 0"])
def test_a_tree_is_divided_by_what_always_has_a_value(split: str) -> None:
    """Where a comparison has no value neither of its sides is, and leaves would not cover the domain."""
    document = found("form of two").certificate()
    document["tree"] = {"split": split, "holds": {"verdict": "open"}, "fails": {"verdict": "open"}}
    document["sha256"] = digest(document)
    with pytest.raises(duhem.InputError):
        duhem.recheck(document)


def test_a_looser_end_below_a_tighter_one_is_not_said() -> None:
    """Of a proof for b >= 2 the certificate says that, whatever stands further down the way."""
    document = found("form of two").certificate()
    proved, open_ = _leaf(document["tree"], "proved"), {"verdict": "open"}
    inner = {"split": "b >= -1", "holds": proved, "fails": open_}
    document["tree"] = {"split": "b >= 9/4", "holds": inner, "fails": open_}
    document["sha256"] = digest(document)
    done = duhem.recheck(document)
    assert isinstance(done, RecheckedRegion)
    assert next((row.said, row.verdict) for row in done.cells) == ("a >= -3 and a <= 3 and b >= 9/4 and b <= 3", "proved") and done.ok


def test_a_witness_is_of_parameters_that_exist() -> None:
    """A line refutes nothing where the other parameter has no value, and a value may not be given for a parameter of the region."""
    document = found("form of two").certificate()
    leaf = _leaf(document["tree"], "refuted")
    for values in ({"a": "3"}, {"b": "-1"}, {"c": "1"}):
        leaf["evidence"]["values"] = values
        document["sha256"] = digest(document)
        assert not duhem.recheck(document).ok
    leaf["evidence"]["values"] = {}
    document["law"]["parameters"]["m"] = {"min": "0", "max": "1"}
    document["law"]["constraints"] = ["a <= m"]
    document["inhabited"]["m"] = "1"
    document["inhabited"]["a"] = "0"
    document["sha256"] = digest(document)
    assert not duhem.recheck(document).ok


# -- what is asked -----------------------------------------------------------------------------------------------------


def test_constraints_on_the_parameters_bound_the_domain() -> None:
    law = duhem.Criterion(name="bound", pressure=None, forces=("x", "y"), g="x**2 + a*x*y + b*y**2 - 1", constraints=("a <= b",),
                          parameters={"a": BETWEEN(0, 1), "b": BETWEEN(0, 3)})  # fmt: skip
    done = duhem.region(law, ("a", "b"))
    assert "a <= b" in done.to_dict()["domain"] and duhem.recheck(done.certificate()).ok
    assert isinstance(done, PavedRegion)
    cells = compiled(done)
    for point in points(done, 40):
        if point["a"] <= point["b"]:
            assert verdict_of(cells, point) in ("proved" if point["a"] ** 2 <= 4 * point["b"] else "refuted", "open")


@pytest.mark.parametrize("constraint", long_but([1], ["a + b <= 0", "a*b >= 1", "2*a < b"]))
def test_what_the_constraints_leave_out_is_outside(constraint: str) -> None:
    """It counts neither as open nor as a cell, and the kernel confirms of no other leaf that it is outside."""
    done = duhem.region(replace(DISC, constraints=(constraint,)), ("a", "b"), "origin", steps=600_000)
    assert isinstance(done, PavedRegion) and done.open_share < 0.8
    inside = compile(constraint, "a constraint", "eval")
    drawn = [point for point in points(done, 300) if eval(inside, {}, dict(point))]
    assert all((said := verdict_of(compiled(done), at)) == "open" or (said == "proved") is disc(at) for at in drawn[:40])
    document = done.certificate()
    assert "outside" in json.dumps(document["tree"])
    for leaf in [node for node in nodes(document["tree"]) if "verdict" in node]:
        leaf.clear(), leaf.update(verdict="outside")
    document["sha256"] = digest(document)
    checked = duhem.recheck(document)
    assert isinstance(checked, RecheckedRegion) and not checked.ok
    for row in checked.cells:
        there = compile(row.said, "a cell", "eval")
        assert row.reason or not any(eval(there, {}, dict(point)) for point in drawn), row


def test_the_conditions_of_a_region_are_true_where_no_constraint_lets_it_fail() -> None:
    law = duhem.Criterion(name="above", pressure=None, forces=("x", "y"), g="x**2 + (b - a)*y**2 - 1", constraints=("a <= b",),
                          parameters=dict.fromkeys("ab", BETWEEN(0, 1)))  # fmt: skip
    done = duhem.region(law)
    assert done.condition == done.short == "true" and done.cells[0].condition == "true" and "all a, b" in text(done)
    refuted = duhem.region(replace(LAWS["dilatancy"][0], constraints=("m < b",)), ("m", "b"), "dissipation")
    assert refuted.condition == "false" and refuted.exact


UNDIVIDED = ("b <= 1/a", "sqrt(a) <= b", "a <= sqrt(2)", "a - b <= exp(1)", "atan(a) <= b")


@pytest.mark.parametrize("constraint", [*long_but([0], UNDIVIDED), "where(a > 1 and b > 1, a, b) <= 1"])
def test_constraints_may_be_what_a_tree_is_not_divided_by(constraint: str) -> None:
    law = duhem.Criterion(name="bound", pressure=None, forces=("x", "y"), g="x**2 + a*x*y + b*y**2 - 1", constraints=(constraint,),
                          parameters={"a": BETWEEN("1/2", 2), "b": BETWEEN(0, 2)})  # fmt: skip
    done = duhem.region(law, ("a", "b"), steps=400_000)
    assert isinstance(done, PavedRegion) and constraint in done.over and done.open_share <= 0.5 and latex(done)
    told = done.at({name: np.array([float(point[name]) for point in points(done, 60)]) for name in ("a", "b")})
    assert "proved" in told


@pytest.mark.long
def test_parameters_may_be_left_out() -> None:
    assert duhem.region(PLANE).parameters == ("a", "b")
    assert duhem.region(LAWS["root"][0]).parameters == ("r", "q")  # neither the slope nor the strength decides
    strengths = {name: duhem.POSITIVE for name in ("Xt", "Xc", "Yt", "Yc")}
    g = "a*(1/Xt - 1/Xc) + b*(1/Yt - 1/Yc) + a**2/(Xt*Xc) + b**2/(Yt*Yc) + f*a*b/sqrt(Xt*Xc*Yt*Yc) - 1"
    coupled = duhem.Criterion(name="coupled", pressure=None, forces=("a", "b"), g=g, parameters={**strengths, "f": BETWEEN(-3, 3)})
    assert duhem.region(coupled).sentence == "convexity holds exactly for f >= -2 and f <= 2"
    assert told(coupled, "convexity", "coupled.toml") == duhem.region(coupled).sentence
    assert told(coupled, "smoothness", "coupled.toml") == ""  # five parameters
    third = {"A": BETWEEN(-2, 2), "B": BETWEEN(-2, 2), "C": BETWEEN(-1, 2)}
    form = duhem.Criterion(name="form", pressure=None, forces=("x", "y"), g="A*x**2 + 2*B*x*y + C*y**2 - 1", parameters=third)
    assert told(form, "convexity", "form.toml") == "for which A, B and C convexity holds: duhem region form.toml A B C"
    assert told(form, "origin", "form.toml") == ""
    assert duhem.region("orthotropic").sentence == "convexity holds for all values of the domain"
    many = duhem.Criterion(name="many", pressure=None, forces=("x", "y"), g="x**2 + a*x*y + (1 + b + c + d)*y**2 - 1",
                           parameters=dict.fromkeys("abcd", BETWEEN(0, 1)))  # fmt: skip
    with pytest.raises(duhem.InputError, match="several parameters are free"):
        duhem.region(many)
    assert duhem.region(many, ("a", "b", "c", "d")).condition != "false"


@pytest.mark.parametrize(
    ("g", "dented"),
    [
        ("sqrt(x**2 - 3*x*y + y**2) - s", True),
        ("sqrt(x**2 - 3*x*y + y**2)", True),  # two lines, of which the points between them are no part
        ("s*sqrt(x**2 - 3*x*y + y**2) + x/2 - 1", True),
        ("sqrt(x**2 - y**2) + x", False),  # a convex cone: only one of the two points lies in it
        ("sqrt(x**2 - 3*x*y + y**2) + s", False),  # K is empty
        ("sqrt((1 - s)*x**2 - y**2) - 1", False),  # a point or a line
        ("sqrt(x**2 - 3*x*y + y**2 + 1) - 2", False),  # no form alone
        ("sqrt(x**2 - 3*x*y + y**2 + x) - 2", False),
        ("where(x > 0, sqrt(x**2 - 3*x*y + y**2), 0) - 1", False),  # it has a value where the root has none
        ("sqrt(x**2 - 3*x*y + y**2) + sqrt(x) - 1", False),
        ("sqrt(x**2 - 3*x*y + y**2) + 1/(1 - s) - 1", False),  # no value at s = 1
        ("sqrt(x**2 - 2*x*y + y**2) - 1", False),
    ],
)
def test_minors_of_a_form_under_a_root(g: str, dented: bool) -> None:
    law = duhem.Criterion("root", g, {"s": BETWEEN(1, 2)}, ("x", "y"), None)
    stated = StatedLaw.read(law_as_text(law))
    with suppress(*UNREADABLE):
        found = any(dent.family == "form" and dent.at(RealRoot.of(Fraction(0))) for dent in dents(stated, "form"))
        assert found is dented
        return
    assert not dented


def test_the_command_of_several_parameters(tmp_path: Any) -> None:
    law, file = tmp_path / "plane.toml", tmp_path / "p.json"
    law.write_text('[criterion]\nname = "plane"\nforces = ["x", "y"]\npressure = false\ng = "x**2 + a*x*y + b*y**2 - 1"\n'
                   "[parameters]\na = { min = -3, max = 3 }\nb = { min = -1, max = 3 }\n")  # fmt: skip
    done = CliRunner().invoke(cli, ["region", str(law), "a", "b", "--certificate", str(file)])
    assert done.exit_code == 0 and "convexity holds exactly for a**2 - 4*b <= 0." in done.output
    checked = CliRunner().invoke(cli, ["recheck", str(file)])
    assert checked.exit_code == 0 and "cells; they cover the domain of a, b" in checked.output
    told = json.loads(CliRunner().invoke(cli, ["region", str(law), "--resume", str(file), "--format", "json"]).output)
    assert told == duhem.region(PLANE).to_dict()
    assert {*told} == {*duhem.region("limacon").to_dict()}


def test_it_is_shown() -> None:
    assert latex(found("form of two")).count(r"\leq") + latex(found("form of two")).count(r"\geq") == 5
    assert "cells, " in text(paved(300_000)) and "of the domain" in text(paved(300_000))
    assert repr(found("form of two")) == "<PavedRegion of plane: convexity if a**2 - 4*b <= 0>"


def test_a_picture_of_the_plane_is_drawn(tmp_path: Any) -> None:
    pytest.importorskip("matplotlib")
    (axes,) = paved().plot(tmp_path / "plane.svg")
    assert (tmp_path / "plane.svg").stat().st_size > 1000 and axes.get_xlabel() == "$a$" and axes.get_ylabel() == "$b$"
    with pytest.raises(duhem.InputError, match="one parameter or two"):
        found("fibre").plot(tmp_path / "three.svg")


@pytest.mark.long
def test_the_published_point_is_drawn() -> None:
    pytest.importorskip("matplotlib")
    (axes,) = duhem.region("bigoni-piccolroaz", ("beta", "gamma"), over={"beta": (0, 2), "gamma": (0, "9/10")}).plot()
    assert any(line.get_label() == "published" for line in axes.lines)


def test_many_points_are_told_at_once() -> None:
    drawn, cells = points(paved(), 50), compiled(paved())
    told = paved().at({name: np.array([float(point[name]) for point in drawn]) for name in ("a", "b")})
    assert [*told] == [verdict_of(cells, point) for point in drawn]


def test_shares_are_of_what_the_constraints_leave() -> None:
    law = duhem.Criterion(name="half", pressure=None, forces=("x", "y"), g="a*x**2 + b*y**2 - 1", constraints=("a < b",),
                          parameters={"a": BETWEEN(-1, 1), "b": BETWEEN(-1, 1)})  # fmt: skip
    done = duhem.region(law, ("a", "b"), steps=1_000_000)
    assert isinstance(done, PavedRegion) and abs(done.share("proved") - 1 / 2) < 0.02  # where a < b <= 0, K is everything
    assert done.open_share == done.share("open") and abs(sum(map(done.share, ("proved", "refuted", "open"))) - 1) < 1e-12
    assert abs(done.share("refuted") - 1 / 2) < 0.02
