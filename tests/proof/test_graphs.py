"""Laws kept as a graph: networks are proved by their structure and refuted by a chord, and no rule goes through them as a tree."""

from __future__ import annotations

import json
import pickle
from fractions import Fraction
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest

from duhem import Criterion, Domain, Verdict, load, project, recheck, verify
from duhem.errors import InputError
from duhem.expression import numpy_, symbol
from duhem.expression.parse import parse_as_written
from duhem.law.criterion_file import criterion_text, reads
from duhem.proof.certificate import law_as_text
from duhem.proof.facts.graph_subject import GraphSubject
from duhem.proof.kernel import term
from duhem.proof.kernel.certificate import digest
from duhem.proof.kernel.claims import objection, rules_of
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.steps import TooDearError, within
from duhem.proof.kernel.term import NotWritten, definitions
from tests.long import mostly_long
from tests.oracles import reevaluation
from tests.proof.networks import Network

CLAIMS = ("origin", "convexity", "normality", "dissipation")


def verdicts(law: Any, *claims: str) -> dict[str, str]:
    return {r.claim: r.verdict.value + (f" {r.trust.value}" if r.trust else "") for r in verify(law, claims=claims or CLAIMS)}


PROVED = dict.fromkeys(CLAIMS, "proved checked")


@pytest.mark.parametrize(
    ("width", "layers", "activation"),
    [
        (6, 1, "softplus"),
        (12, 2, "softplus"),
        (12, 3, "pos"),
        pytest.param(64, 2, "softplus", marks=pytest.mark.slow),
        pytest.param(64, 3, "pos", marks=pytest.mark.slow),
    ],
)
def test_a_network_with_weights_that_are_not_negative_is_proved_and_rechecked(
    tmp_path: Path, width: int, layers: int, activation: str
) -> None:
    network = Network(width, layers, activation)
    found = verify(load(network.write(tmp_path)), claims=CLAIMS)
    assert {r.claim: (r.verdict.value, r.trust and r.trust.value) for r in found} == dict.fromkeys(CLAIMS, ("proved", "checked"))
    assert recheck(found.certificate()).ok


@pytest.mark.slow
@pytest.mark.parametrize(
    ("width", "layers", "activation", "cornered"),
    [pytest.param(12, 2, "pos", True, marks=pytest.mark.long), (12, 2, "softplus", False), (12, 3, "pos", False)],
)
def test_a_short_network_of_ramps_has_a_corner(tmp_path: Path, width: int, layers: int, activation: str, cornered: bool) -> None:
    """A long one is not looked at: all are cornered."""
    law = load(Network(width, layers, activation).write(tmp_path))
    found = verify(law, claims=["smoothness"])["smoothness"]
    assert (found.verdict is Verdict.REFUTED) is cornered
    assert not cornered or (found.witness is not None and reevaluation.confirmed(written_out(law), "smoothness", found.witness))


def written_out(law: Criterion) -> Criterion:
    subject = GraphSubject(law).written_out
    assert subject is not None
    return subject.law


def test_the_weights_are_those_of_the_tables(tmp_path: Path) -> None:
    """The node that SymPy sees, and the law after pickling, have the network's value."""
    network, at = Network(12, 2, "softplus"), np.random.default_rng(1).normal(size=(50, 3)) * 5.0
    law = load(network.write(tmp_path))
    assert law.graph is not None and law == pickle.loads(pickle.dumps(law))
    for each in (law, pickle.loads(pickle.dumps(law))):
        assert numpy_.compiled(each.g, each.force_symbols())(*at.T) == pytest.approx(network.value(at), rel=1e-13, abs=1e-13)


@pytest.mark.parametrize(("activation", "layer"), [("pos", "c"), ("softplus", "c"), pytest.param("pos", "W1", marks=pytest.mark.slow)])
def test_a_negative_weight_is_refuted_by_a_chord(tmp_path: Path, activation: str, layer: str) -> None:
    network = Network(12, 2, activation, level=2.0)
    network.tables[layer][..., int(np.argmax(network.tables[layer][0]))] *= -3.0
    found = verify(load(network.write(tmp_path)), claims=["convexity"])["convexity"]
    assert found.verdict.value == "refuted" and found.witness is not None
    p, q, middle = (np.array([[float(Fraction(x)) for x in found.witness.points[role].values()]]) for role in ("p", "q", "midpoint"))
    assert np.allclose(middle, (p + q) / 2.0)
    assert network.value(p) < 0.0 and network.value(q) < 0.0 and network.value(middle) > 0.0


def test_what_may_be_convex_with_a_negative_weight_is_left_open(tmp_path: Path) -> None:
    network = Network(12, 2, "softplus")
    network.tables["W1"][0, 0] = -0.0009765625
    found = verify(load(network.write(tmp_path)), claims=["convexity"])["convexity"]
    assert found.verdict == "undecided" and "the weight of z0__1 in z1__1 is -0.0009765625" in found.detail


def test_a_decreasing_hidden_layer_is_not_proved(tmp_path: Path) -> None:
    """Weights that are not negative over neurons that decrease, by minus signs that no table shows."""
    network = Network(12, 2, "pos", level=-1.0)
    file = network.write(tmp_path)
    file.write_text(file.read_text("utf-8").replace("pos(sum(j, 1, 12, W1", "-pos(sum(j, 1, 12, W1"), encoding="utf-8")
    assert verdicts(load(file), "convexity")["convexity"] in ("undecided", "refuted")


def test_zero_force_outside_is_refuted(tmp_path: Path) -> None:
    assert verdicts(load(Network(12, 2, "softplus", level=0.01).write(tmp_path)), "origin") == {"origin": "refuted"}


def test_a_law_kept_as_a_graph_is_refused_in_one_sentence(tmp_path: Path) -> None:
    law = load(Network(12, 2, "softplus").write(tmp_path))
    with pytest.raises(InputError, match=r"kept as a graph of \d+ definitions"):
        project(law, [1.0, 0.0, 0.0], None, 1.0, {})


@pytest.mark.parametrize(("span", "nearest"), [(None, -1), ((-10, -5), -5), (("-1/2", 0), "-1/2"), ((-3, 0), -1)])
def test_the_pressure_is_the_one_of_its_range_nearest_to_minus_one(span: Any, nearest: Any) -> None:
    given = wide(20, 2) | {"f": f"{wide(20, 2)['f']} + p"}
    found = Criterion(
        name="pressed", forces=("x", "y"), pressure="p", g="f", define=given, domain={"p": Domain.between(*span)} if span else {}
    )
    assert GraphSubject(found).values_at({}, [Fraction(0)] * 2)[found.symbols()["p"]] == Fraction(nearest)


def test_a_law_without_values_in_doubles_is_looked_at_in_silence() -> None:
    """Of inf - inf there is none anywhere."""
    far = wide(20, 2, "softplus") | {"f": "softplus(g1_0 + 9000) - softplus(g1_1 + 9001)"}
    assert verdicts(law(far, "f + g1_2 - g1_3"), "convexity")["convexity"] != "proved checked"


# -- definitions that are written by hand ------------------------------------------------------------------------------


def chain(step: str, n: int = 40, last: str = "a{n} - 3", **more: Any) -> dict[str, Any]:
    """Definitions of which each uses the one before it more than once, as a certificate has them."""
    rows = [["a0", "x + y"], *([f"a{i}", step.format(f"a{i - 1}")] for i in range(1, n + 1))]
    empty: dict[str, Any] = {"pressure": None, "parameters": {}, "constraints": [], "flow": None}
    return {"name": "chain", "forces": ["x", "y"], **empty, "g": last.format(n=n), "define": rows, **more}


STEPS = [
    "pos({0}) + neg({0})", "{0} + {0}", "{0}*{0}", "softplus({0}) + softplus(-{0})", "norm({0}, {0} + 1)", "max({0}, 2*{0})",
    "where({0} > 1, {0}, 2*{0})", "({0})**2 - ({0})", "sqrt(1 + {0}*{0})", "atan2({0}, {0} + 1)", "1/(1 + {0}*{0})", "cos({0}*{0})",
    "{0}*(1 + {0})", "sqrt(1 + {0}*(1 + {0}))", "1/(1 + {0}*pos({0}))", "cos({0}*(1 - {0}))",
    "log(1 + exp({0}) + exp(-{0})*exp({0}))", "eigmax({0}, {0}, {0}, {0}, {0}, {0})", "abs({0}) - {0}", "{0}*log({0})",
]  # fmt: skip


@pytest.mark.parametrize("step", STEPS)
def test_no_rule_goes_through_a_graph_as_a_tree(step: str) -> None:
    """Written out, each has 2^40 parts and more; within so many steps every rule has ended."""
    stated, settled = StatedLaw.read(chain(step)), set[str]()
    assert stated.g.large or "{0}*{0}" in step  # which is read as a power, and is no graph then
    for claim in ("origin", "convexity", "smoothness", "normality", "dissipation"):
        for rule in rules_of(claim, stated):
            with within(3_000_000):
                try:
                    if not objection(claim, rule, frozenset(settled), stated, {}):
                        settled.add(claim)
                except TooDearError:
                    pass
    assert "convexity" not in settled or step not in ("where({0} > 1, {0}, 2*{0})", "({0})**2 - ({0})", "cos({0}*{0})", "abs({0}) - {0}")


def test_equal_definitions_are_one_term() -> None:
    rows = [[f"{v}{i}", f"pos({v}{i - 1}) + neg({v}{i - 1})" if i else "x"] for i in range(40) for v in "ab"]
    found = definitions(rows, ["x"])
    assert found["a39"] is found["b39"] and found["a39"] == found["b39"]


@pytest.mark.parametrize(
    "rows",
    [
        [["a", "a + x"]], [["a", "b"], ["b", "x"]], [["a", "x"], ["a", "y"]], [["x", "y"]], [["pi", "x"]], [["max", "x"]], [["a b", "x"]],
        [["a", "x > 0"]], [["a", "x", "y"]], [["a", 1]], {"a": "x"}, [["a", ""]], [["and", "x"]], ["ax"], [["a", "x"]] * 2, [[1, "x"]],
    ],
)  # fmt: skip
def test_what_defines_nothing_is_refused(rows: Any) -> None:
    with pytest.raises((NotWritten, TypeError, AttributeError)):
        StatedLaw.read(chain("{0}") | {"g": "x - 1", "define": rows})


@pytest.mark.parametrize("more", [{"viscous": True}, {"energy": "x"}, {"variables": {}}, {"surfaces": [{"g": "x", "flow": None}]}])
def test_a_law_with_a_state_has_no_graph(more: dict[str, Any]) -> None:
    given = chain("pos({0})") | more
    with pytest.raises((NotWritten, KeyError)):
        StatedLaw.read(given)


def test_a_flow_uses_no_definition() -> None:
    with pytest.raises(NotWritten, match="not declared"):
        StatedLaw.read(chain("pos({0})", flow=["a1", "y"]))


def test_what_stands_in_a_definition_must_have_a_value() -> None:
    for inner in ("1/x", "sqrt(x)", "log(x)", "x/x", "asin(x)", "0*(1/x)", "x**(1/3)"):
        rows = [["a", inner], *([f"b{i}", f"a + 0*pos(a)*{i}"] for i in range(3))]
        stated = StatedLaw.read(chain("{0}") | {"define": rows, "g": "b2 - b1 + x - 1"})
        assert all(objection("convexity", rule, frozenset(), stated, {}) for rule in rules_of("convexity", stated)), inner


def law(define: dict[str, str], g: str = "f - 1", **more: Any) -> Criterion:
    return Criterion(name="by hand", forces=("x", "y"), pressure=None, g=g, define=define, **more)


def wide(n: int = 60, rounds: int = 3, name: str = "pos") -> dict[str, str]:
    """Definitions that are too long to be written out."""
    rows = {f"h{i}": f"{name}({i}*x/{n} - y)" for i in range(n)}
    for k in range(rounds):
        before = "h{i}" if k == 0 else f"g{k - 1}_{{i}}"
        total = " + ".join(before.format(i=i) for i in range(n))
        rows |= {f"g{k}_{i}": f"{name}(({total})/{n} - {i})" for i in range(n)}
    return rows | {"f": " + ".join(f"g{rounds - 1}_{i}" for i in range(n))}


def test_definitions_that_are_too_long_are_kept_as_a_graph() -> None:
    found = law(wide(20, 2))
    assert found.graph is not None and len(found.graph.nodes) == 61
    assert verdicts(found) == PROVED
    assert law_as_text(found)["define"][0] == ["h0", "pos(0*x/20 - y)"]
    assert found == found.fix({}) and hash(found) == hash(law(wide(20, 2)))


def test_parameters_are_fixed_inside_a_graph() -> None:
    rows = wide(20, 2) | {"f": f"k*({wide(20, 2)['f']})"}
    found = law(rows, parameters={"k": Domain.between(0, None)})
    assert verdicts(found) == PROVED

    def value(k: int) -> float:
        fixed = found.fix({"k": k})
        return float(numpy_.compiled(fixed.g.xreplace(fixed.settled()), fixed.force_symbols())(30.0, 1.0))

    assert value(2) + 1.0 == pytest.approx(2.0 * (value(1) + 1.0)) and value(1) > 0.0
    falling = law(rows, parameters={"k": Domain.between(-1, None)})
    assert verdicts(falling, "convexity")["convexity"] != "proved checked"


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"f": "f"}, "used before"), ({"f": "later", "later": "x"}, "used before"), ({"f": "h0 + unknown"}, "unknown name"),
        ({"f": "h0 h1"}, "unexpected"), ({"f": "pos(h0, h1)"}, "takes 1 argument"), ({"f": "h0 > 1"}, "comparison"),
        ({"f": "where(h0, h1, 1)"}, "no comparison"), ({"f": "where(0 < h0 < 1, h1, 1)"}, "chains"), ({"f": "x.y"}, "unexpected"),
        ({"x": "h1"}, "declared twice"), ({"max": "h1"}, "already means"), ({"f": "g1_0(x)"}, "not a function"), ({"f": "(g1_0"}, "closed"),
        ({"f": "max()"}, "unexpected"), ({"f": "open(g1_0)"}, "not a function"), ({"f": "1 + (g1_0 > 0)"}, "comparison"),
        ({"f": "1e999999*g1_0"}, "too long or too large"),
    ],
)  # fmt: skip
def test_a_wrong_definition_is_told(change: dict[str, str], said: str) -> None:
    """Also where it is too long for a value to be made of it."""
    rows = {**{name: text for name, text in wide(20, 2).items() if name != "f"}, **change}
    with pytest.raises(InputError, match=said):
        law(rows, "x + g1_0 - 1" if "f" not in change else "f + g1_0 - 1")


def test_g_alone_may_use_what_is_too_long() -> None:
    with pytest.raises(InputError, match="too large"):
        law(wide(20, 3), flow=("f", "y"))
    with pytest.raises(InputError, match="too large"):
        law(wide(20, 3), g="x - 1", flow=("g2_1", "y"))


# -- certificates ------------------------------------------------------------------------------------------------------


def _changed(document: dict[str, Any], change: Any, seal: bool = True) -> dict[str, Any]:
    made = json.loads(json.dumps(document))
    change(made["law"])
    return made | ({"sha256": digest(made)} if seal else {})


def _turn(own: dict[str, Any]) -> None:
    own["define"][-1][1] = own["define"][-1][1].replace(" + g1_0", " - g1_0").replace("g1_1 +", "-g1_1 +")


def _leave_out(own: dict[str, Any]) -> None:
    del own["define"][3]


def _all(own: dict[str, Any]) -> None:
    del own["define"]


def _order(own: dict[str, Any]) -> None:
    own["define"].reverse()


def test_a_certificate_carries_all_definitions_and_their_change_is_seen() -> None:
    document = verify(law(wide(20, 2)), claims=CLAIMS).certificate()
    assert recheck(document).ok
    for change in (_turn, _leave_out, _all, _order):
        with pytest.raises(InputError, match="sha256"):
            recheck(_changed(document, change, seal=False))
    assert "convexity" in recheck(_changed(document, _turn)).failed
    for change in (_leave_out, _all, _order):
        with pytest.raises(InputError, match=r"not declared|not defined before"):
            recheck(_changed(document, change))


def test_a_number_without_a_value_in_a_definition_is_refused() -> None:
    document = verify(law(wide(20, 2)), claims=CLAIMS).certificate()
    with pytest.raises(InputError, match="a number in the law"):
        recheck(_changed(document, lambda own: own["define"].append(["more", "1/0"])))


# -- softplus and logsumexp --------------------------------------------------------------------------------------------

SHAPES = [
    ("softplus(x)", True), ("softplus(-x)", True), ("log(1 + exp(x))", True), ("log(exp(x) + 1)", True), ("softplus(x**2 + y)", True),
    ("logsumexp(x, y, x + y)", True), ("logsumexp(x, y**2)", True), ("log(exp(x) + 2*exp(y) + 3)", True),
    ("softplus(softplus(x) + abs(y))", True),
    ("log(exp(x)*exp(y**2) + 1)", True), ("-softplus(x)", False), ("softplus(-x**2)", False), ("log(2 - exp(x))", False),
    ("log(1 + exp(x) - exp(y)/2)", False), ("logsumexp(x, -y**2)", False), ("log(1 + x**2)", True), ("log(exp(x) - 1)", False),
    ("softplus(x)*softplus(y)", False), ("log(1 + exp(-x**2))", False), ("log(1 - 2*exp(x))", False),
]  # fmt: skip


@pytest.mark.parametrize(("g", "convex"), SHAPES)
def test_logarithms_of_log_convex_parts_are_convex(g: str, convex: bool) -> None:
    """That of 1 + x^2 is quasiconvex alone, which is enough once 0 x^2 is left out."""
    stated = StatedLaw.read(chain("{0}") | {"g": f"{g} + x**2*0 - 9", "define": []})
    assert (objection("convexity", "composition", frozenset(), stated, {}) == "") is convex


def test_a_textbook_softplus_network_is_proved() -> None:
    rows = {f"z{i}": f"log(1 + exp(0.{i + 1}*x - 0.{9 - i}*y + 0.0{i}))" for i in range(4)}
    assert verdicts(law(rows, "0.1*z0 + 0.2*z1 + 0.3*z2 + 0.4*z3 - 4")) == PROVED


def test_a_law_kept_as_a_graph_is_written_down_and_read_back() -> None:
    found = law(wide(20, 2), parameters={"k": Domain.between(0, 1)}, g="f - k - 1")
    assert reads(criterion_text(found)) == found


# -- drawn graphs ------------------------------------------------------------------------------------------------------

DRAWN = [
    "pos({a} + {k}*{b})", "softplus({s}{a} + {k}*{b})", "logsumexp({a}, {s}{b}, {k})", "log({k} + exp({a}) {t} {k}*exp({b}))",
    "max({a}, {b})",
    "abs({a})", "{k}*{a} {t} {k}*{b}", "norm({a}, {b})", "({a})**2", "{a}*{b}", "neg({a})", "exp({s}{a}) + {b}", "sqrt(1 + ({a})**2)",
    "log(1 + exp({a})*exp({b}))", "min({a}, {b})", "where({a} > 0, {b}, {c})", "({a})**2/(1 + exp({b}))",
]  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("most", mostly_long([6, 20_000], 6))
def test_what_is_proved_of_drawn_graphs_is_so(most: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also where nearly all of them count as too large for a tree."""
    monkeypatch.setattr(term, "_MOST_PARTS", most)
    rng, places, proved = Random(5), np.random.default_rng(5), 0
    for _ in range(150):
        names, rows = ["x", "y"], list[list[str]]()
        for i in range(rng.randint(2, 7)):
            a, b, c = rng.choices(names, k=3)
            k, s, t = rng.choice(("0.5", "2", "1", "0")), rng.choice(("", "-")), rng.choice("+-")
            rows.append([f"d{i}", rng.choice(DRAWN).format(a=a, b=b, c=c, k=k, s=s, t=t)])
            names += [f"d{i}"] * rng.randint(1, 2)
        given = chain("{0}") | {"define": rows, "g": f"{names[-1]} + {rng.choice(names)} - 1"}
        stated, made = StatedLaw.read(given), dict[str, Any]({name: symbol(name) for name in "xy"})
        if objection("convexity", "composition", frozenset(), stated, {}):
            continue
        for name, text in rows:
            made[name] = parse_as_written(text, made)
        g, proved = numpy_.compiled(parse_as_written(given["g"], made), (symbol("x"), symbol("y"))), proved + 1
        for size in (0.3, 2.0):
            p, q = size * places.normal(size=(2, 2000, 2))
            inside = (g(*p.T) < -1e-7) & (g(*q.T) < -1e-7)
            assert not (inside & (g(*(0.5 * (p + q)).T) > 1e-7)).any(), given
    assert proved > 30


def test_a_graph_has_its_value_where_exponentials_overflow() -> None:
    rows = {f"h{i}": f"softplus({i - 9}*x + y)" for i in range(40)}
    rows |= {f"l{i}": f"logsumexp(({' + '.join(f'h{j}' for j in range(40))})/40 - {i}, x, {i}*y)" for i in range(40)}
    found = law(rows | {"f": " + ".join(f"l{i}*softplus(h{i} - {i})" for i in range(40))}, "f - 1")
    assert found.graph is not None
    program = numpy_.compiled(found.g, found.force_symbols())
    for x, y in ((0.3, -0.2), (3000.0, -2000.0), (-1e6, 1e5)):
        h = [np.logaddexp(0.0, (i - 9) * x + y) for i in range(40)]
        inner = [np.logaddexp(np.logaddexp(sum(h) / 40 - i, x), i * y) for i in range(40)]
        assert float(program(x, y)) == pytest.approx(sum(inner[i] * np.logaddexp(0.0, h[i] - i) for i in range(40)) - 1.0, rel=1e-13)
