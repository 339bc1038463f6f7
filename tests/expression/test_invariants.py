"""Invariants of a stress as formulas of its components: against the tensor itself, exactly."""

from __future__ import annotations

from dataclasses import replace
from itertools import permutations

import numpy as np
import pytest
import sympy as sp

from duhem import Criterion, Domain
from duhem.errors import InputError
from duhem.expression import symbol
from duhem.expression.abbreviations import INVARIANTS, KINDS, Abbreviations, Stress
from duhem.expression.numpy_ import evaluate
from duhem.expression.parse import parse_expression

R = sp.Rational
POINTS = {
    "3d": [(3, -1, 2, R(1, 2), -2, 1), (0, 0, 0, 1, 2, 3), (1, 1, 1, 0, 0, 0)],
    "plane": [(3, -1, 2), (0, 0, 1), (-2, -2, 0)],
    "principal": [(3, -1, 2), (1, 1, 5), (-4, 0, R(1, 3))],
}
CASES = [(kind, point) for kind, points in POINTS.items() for point in points]


def _tensor(kind: str, point: tuple[sp.Rational, ...]) -> sp.Matrix:
    if kind == "principal":
        return sp.diag(*point)
    xx, yy, zz, yz, xz, xy = point if kind == "3d" else (point[0], point[1], 0, 0, 0, point[2])
    return sp.Matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _value(text: str, kind: str, point: tuple[sp.Rational, ...]) -> sp.Expr:
    stress = Stress("s", kind)
    known = {name: symbol(name) for name in stress.components}
    return parse_expression(text, known, short=Abbreviations(stress=stress)).subs(dict(zip(known.values(), point, strict=True)))


@pytest.mark.parametrize(("kind", "point"), CASES)
def test_invariants_are_those_of_the_tensor(kind: str, point: tuple[sp.Rational, ...]) -> None:
    tensor = _tensor(kind, point)
    deviator = tensor - tensor.trace() / 3 * sp.eye(3)
    assert _value("I1(s)", kind, point) == _value("tr(s)", kind, point) == tensor.trace()
    j2 = (deviator * deviator).trace() / 2
    assert _value("J2(s)", kind, point) == j2
    assert _value("J3(s)", kind, point) == deviator.det()
    if kind != "plane":
        assert _value("det(s)", kind, point) == tensor.det()
    if j2:
        assert sp.simplify(sp.cos(3 * _value("lode(s)", kind, point)) - _value("cos3theta(s)", kind, point)) == 0
        assert sp.simplify(_value("cos3theta(s)", kind, point) - 3 * sp.sqrt(3) / 2 * deviator.det() / j2 ** R(3, 2)) == 0


@pytest.mark.parametrize("point", POINTS["plane"])
def test_principal_stresses_in_the_plane(point: tuple[sp.Rational, ...]) -> None:
    xx, yy, xy = point
    one, two = (_value(f"principal(s, {i})", "plane", point) for i in (1, 2))
    assert sp.simplify(one + two - xx - yy) == 0 == sp.simplify(one * two - xx * yy + xy**2)
    assert one >= two


@pytest.mark.parametrize("point", [*permutations((3, -1, 2)), (1, 1, 5)])
def test_principal_stresses_in_order(point: tuple[sp.Rational, ...]) -> None:
    assert [_value(f"principal(s, {i})", "principal", point) for i in (1, 2, 3)] == sorted(point, reverse=True)


@pytest.mark.parametrize("kind", KINDS)
def test_a_shear_stands_once_and_counts_twice(kind: str) -> None:
    """The inner product of tensors is the sum over the listed components, where a shear's conjugate is twice the tensor's."""
    point = POINTS[kind][0]
    tensor = _tensor(kind, point)
    conjugate = [x * (2 if shear else 1) for x, shear in zip(point, Stress("s", kind).shears, strict=True)]
    assert sum(x * e for x, e in zip(point, conjugate, strict=True)) == (tensor * tensor).trace()


@pytest.mark.parametrize("kind", KINDS)
def test_a_law_has_one_stress_so_that_it_need_not_be_named(kind: str) -> None:
    words = [word for word in INVARIANTS if word != "principal" and (word, kind) != ("det", "plane")]
    pairs = [(f"{word}*2 - {word}", f"{word}(s)*2 - {word} (s)") for word in words]
    for short, long in [*pairs, ("principal(1) - principal( 2 )", "principal(s, 1) - principal(s, 2)")]:
        assert _value(short, kind, POINTS[kind][0]) == _value(long, kind, POINTS[kind][0])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("J2()", "write J2\\(s\\)"),
        ("J2(1)", "write J2\\(s\\)"),
        ("J2 (s 1)", "write J2\\(s\\)"),
        ("principal", "write principal\\(s, 1\\)"),
        ("principal()", "write principal\\(s, 1\\)"),
        ("principal(,1)", "write principal\\(s, 1\\)"),
        ("principal(12)", "no principal stress 12"),
        ("principal(0)", "no principal stress 0"),
        ("J2(t)", "write J2\\(s\\)"),
        ("J2(s, 1)", "write J2\\(s\\)"),
        ("J2(s*s)", "write J2\\(s\\)"),
        ("J2(s + 1)", "write J2\\(s\\)"),
        ("J2(1/s)", "write J2\\(s\\)"),
        ("J2(s**2)", "write J2\\(s\\)"),
        ("J2(abs(s))", "write J2\\(s\\)"),
        ("J2(s - x)", "components X_xx"),
        ("J2(s -)", "write J2\\(s\\)"),
        ("J2(s", "write J2\\(s\\)|never closed"),
        ("principal(s)", "write principal\\(s, 1\\)"),
        ("principal(s, 0)", "no principal stress 0"),
        ("principal(s, 4)", "no principal stress 4"),
        ("principal(s, x)", "write principal\\(s, 1\\)"),
        ("s", "unknown name 's'"),
        ("s_zz", "unknown name 's_zz'"),
        ("principal(s, 3)", "plane stress is 0"),
        ("det(s)", "s_xx\\*s_yy - s_xy\\*\\*2"),
    ],
)
def test_what_is_no_invariant(text: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        _value(text, "plane", (1, 2, 3))


SUMS = {
    "s - x": (1, -1),
    "x - s": (-1, 1),
    "2*(s - x/3)": (2, R(-2, 3)),
    "-s": (-1, 0),
    "x": (0, 1),
    "s*k + x*(k - 1)": (5, 4),
    "s - (s - x)": (0, 1),
}


@pytest.mark.parametrize(("kind", "word"), [(kind, word) for kind in KINDS for word in INVARIANTS if (kind, word) != ("plane", "det")])
def test_a_sum_of_tensors_has_the_invariants_of_its_value(kind: str, word: str) -> None:
    """Of a back stress x by its components, which may be parameters, forces or definitions."""
    index, own = ", 1" * INVARIANTS[word].indexed, len(KINDS[kind])
    s, x = ((3, -1, 2, R(1, 2), -2, 1)[:own], (1, 2, -4, R(1, 3), 1, -2)[:own])
    names = [f"{tensor}_{end}" for tensor in "sx" for end in KINDS[kind]]
    values = dict(zip(map(symbol, [*names, "k"]), [*s, *x, 5], strict=True))
    known = {name.name: name for name in values}
    for stress in (Stress("s", kind), *([None] if kind == "3d" else [])):
        for text, (one, two) in SUMS.items():
            found = parse_expression(f"{word}({text}{index})", known, short=Abbreviations(stress=stress, known=frozenset(known))).subs(
                values
            )
            wanted = _value(f"{word}(s{index})", kind, tuple(one * a + two * b for a, b in zip(s, x, strict=True)))
            assert sp.N(found - wanted, 40, maxn=400) == pytest.approx(0, abs=1e-30), text


def test_a_tensor_whose_last_component_is_defined() -> None:
    """A deviator has five components that are free; what scales a tensor may be defined as well."""
    free = {f"alpha_{end}": {"min": -1, "max": 1} for end in ("xx", "yy", "yz", "xz", "xy")}
    define = {"p": "-I1/3", "alpha_zz": "-alpha_xx - alpha_yy"}
    law = Criterion("cone", "sqrt(2*J2(sigma - p*alpha)) - m*p", pressure=None, define=define, stress={"name": "sigma", "kind": "3d"},
                    parameters={"m": Domain(positive=True), **{name: Domain.between(-1, 1) for name in free}})  # fmt: skip
    at = dict(zip(law.forces, (-3, -2, -4, 1, 0, -1), strict=True)) | {name: 0.1 * i for i, name in enumerate(free)} | {"m": 0.5}
    alpha, sigma = [np.array(_tensor("3d", t), dtype=float) for t in ((0, 0.1, -0.1, 0.2, 0.3, 0.4), (-3, -2, -4, 1, 0, -1))]
    apart = sigma - 3 * alpha + 3 * np.eye(3)
    wanted = np.sqrt((apart**2).sum()) - 0.5 * 3
    assert float(law.g.subs({x: at[x.name] for x in law.g.free_symbols})) == pytest.approx(wanted)


@pytest.mark.parametrize("word", INVARIANTS)
def test_without_a_stress_they_are_names_like_others(word: str) -> None:
    x = symbol(word)
    assert parse_expression(f"2*{word}", {word: x}) == 2 * x
    for text in (f"{word}(sigma)", word, f"2*{word} + 1"):
        with pytest.raises(InputError, match="declare stress"):
            parse_expression(text, {})
    with pytest.raises(InputError, match="already means something"):
        parse_expression("1", {word: x}, short=Abbreviations(stress=Stress("s", "3d")))


@pytest.mark.parametrize(("name", "kind"), [("s", "2d"), ("a b", "3d"), ("", "3d")])
def test_what_is_no_stress(name: str, kind: str) -> None:
    with pytest.raises(InputError):
        Stress(name, kind)


def test_principal_stresses_in_space_are_the_eigenvalues_in_order() -> None:
    rng = np.random.default_rng(2)
    for point in rng.uniform(-2, 2, (6, 6)):
        tensor = np.array(_tensor("3d", tuple(point)), dtype=float)
        here = {symbol(n): v for n, v in zip(Stress("s", "3d").components, point, strict=True)}
        short = Abbreviations(stress=Stress("s", "3d"))
        known = {x.name: x for x in here}
        values = [float(evaluate(parse_expression(f"principal(s, {i})", known, short=short), here)) for i in (1, 2, 3)]
        assert values == pytest.approx(np.linalg.eigvalsh(tensor)[::-1].tolist(), abs=1e-12)


@pytest.mark.parametrize(
    ("forces", "parameters", "text"),
    [
        ("s_xx s_yy s_zz s_yz s_zx s_xy", "", "J2(s)"),
        ("s_xx s_yy s_zz s_xy", "", "I1(s)"),
        ("s_xx s_yy s_zz s_yz s_xz s_xy", "x_xx x_yy x_xy", "J2(s - x)"),
        ("s_1 s_2 s_3 s_xx s_yy s_xy", "", "I1(s)"),
        ("s_1 s_2 s_3", "x_1 x_2", "J2(s - x)"),
    ],
)
def test_names_that_are_more_or_less_than_one_tensor_are_refused(forces: str, parameters: str, text: str) -> None:
    """Else the invariants of another tensor would be read, and components passed over."""
    with pytest.raises(InputError, match=r"J2|I1"):
        Criterion("law", f"{text} - 1", forces=tuple(forces.split()), pressure=None, parameters=dict.fromkeys(parameters.split(), Domain()))


def test_a_back_stress_out_of_the_plane_is_refused() -> None:
    define = {"x_zz": "-x_xx - x_yy"}
    with pytest.raises(InputError, match="X_xx"):
        Criterion("law", "J2(s - x) - 1", pressure=None, stress={"name": "s", "kind": "plane"}, define=define,
                  parameters=dict.fromkeys(("x_xx", "x_yy", "x_xy"), Domain()))  # fmt: skip


def test_other_names_may_begin_as_a_tensor_does_and_lines_may_break() -> None:
    names = ("x_1", "x_2", "x_3", "s_y", "x_max")
    law = Criterion(
        "law", "sqrt(3*J2(s\n  - x)) - s_y - x_max", forces=("s_1", "s_2", "s_3"), pressure=None, parameters=dict.fromkeys(names, Domain())
    )
    assert {"x_1", "s_y"} <= {str(x) for x in law.g.free_symbols}


def test_a_long_sum_of_tensors_is_gone_through_once() -> None:
    names = [f"{tensor}_{i}" for tensor in "sx" for i in (1, 2, 3)]
    known = {name: symbol(name) for name in names}
    text = f"J2({'+'.join(['s'] * 60)} - {'-'.join(['x'] * 60)})"
    found = parse_expression(text, known, short=Abbreviations(known=frozenset(known)))
    values = dict(zip(known.values(), (3, -1, 2, 1, 1, 5), strict=True))
    assert found.subs(values) == 3600 * _value("J2(s)", "principal", (2, -2, -3))


def test_a_law_with_another_parameter_has_another_tensor() -> None:
    """What a definition was read with is no longer what it is read with."""
    fixed = Criterion("law", "J2(s) - 1", forces=("s_1", "s_2", "s_3"), pressure=None)
    names = dict.fromkeys(("x_1", "x_2", "x_3"), Domain())
    moved = replace(fixed, g="J2(s - x) - 1", written="", parameters=names)
    assert {"x_1", "x_2", "x_3"} <= {str(x) for x in moved.g.free_symbols}
