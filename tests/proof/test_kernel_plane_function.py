"""The bend of a function of the plane against h + h'' in numbers, in each of the variables that tell the angle; and its powers."""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from random import Random
from typing import Any

import pytest

from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.deviatoric import deviatoric_readers
from duhem.proof.kernel.plane_function import PlaneFunction, PlaneVariable, base_of, sqrt
from duhem.proof.kernel.plane_gauge import DirectionArc
from duhem.proof.kernel.polynomial import ONE, Polynomial, times
from duhem.proof.kernel.signs import RAY
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import NotWritten, Term

F = Fraction
J2 = "(((a-b)**2 + (b-c)**2 + (c-a)**2)/6)"


def stated(g: str, *forces: str) -> StatedLaw:
    given: dict[str, Any] = {"pressure": None, "parameters": {"m": {"positive": True}}, "constraints": [], "flow": None}
    return StatedLaw.read({"forces": forces, "g": g, **given})


def along_rays() -> PlaneVariable:
    end = F(1), F(1)
    return DirectionArc(over(stated("a + b", "a", "b")), ("a", "b"), 1, (-end[0], -end[1]), end, (1,))


def in_sector() -> PlaneVariable:
    law = stated(f"max(a, b, c) - (a + b + c)/3 + {J2} - 1", "a", "b", "c")
    return deviatoric_readers(law.g, over(law))[0]


def in_rays(f: Callable[[float], float], angle: float) -> float:
    t = math.tan(angle / 2)
    return f(t) / (1 + t * t)


def in_principal(f: Callable[[float], float], angle: float) -> float:
    v = math.sqrt(3) * math.tan(angle / 2)
    return f(v) / (3 + v * v)


# a variable, h by F, and v by the angle
VARIABLES = [
    (along_rays, in_rays, lambda angle: math.tan(angle / 2)),
    (in_sector, in_principal, lambda angle: math.sqrt(3) * math.tan(angle / 2)),
]


def drawn(rng: Random) -> Polynomial:
    found: Polynomial = {(): F(rng.randint(3, 9))}
    return found | {((RAY, n),): F(rng.choice((-9, -3, -1, 1, 3, 9)), 2) for n in (1, 2)}


IN_NUMBERS = over(stated("a", "a"))


def at(poly: Any, v: float) -> float:
    def of(x: Term) -> float:
        return v if x == RAY else math.sqrt(at(IN_NUMBERS.polynomial(x.args[0]), v))

    return sum(float(c) * math.prod(of(x) ** n for x, n in m) for m, c in dict(poly).items())


@pytest.mark.parametrize("variable", range(2))
def test_the_bend_has_the_sign_of_h_and_its_second_derivative(variable: int) -> None:
    (make, h, told), rng, signs, step = VARIABLES[variable], Random(variable), set[bool](), 1e-4
    plane = make()
    for _ in range(60):
        powers: dict[Any, Polynomial] = {base_of(drawn(rng)): {(): F(rng.choice((-5, -1, 1, 3, 7)), 2)} for _ in range(rng.randint(0, 2))}
        under, rooted = drawn(rng), plane.rooted and rng.random() < 0.5
        value = PlaneFunction(F(1), times(drawn(rng), sqrt(under)) if rooted else drawn(rng), powers)

        def f(v: float, value: PlaneFunction = value) -> float:
            return at(value.poly, v) * math.prod(at(base, v) ** at(e, v) for base, e in value.powers.items())

        angle = rng.uniform(0.05, 1.0)
        if any(at(base, told(angle)) < 0.1 for base in (*powers, under)):
            continue
        left, here, right = (h(f, angle + s) for s in (-step, 0, step))
        wanted = here + (left - 2 * here + right) / step**2
        if abs(wanted) > 1e-3 * abs(here):
            bend = plane.bend(value)
            assert (at(bend, told(angle)) > 0) is (wanted > 0), (value, angle)
            signs.add(wanted > 0)
    assert signs == {True, False}


def test_powers_of_what_is_positive_and_of_what_is_not() -> None:
    plane, square = along_rays(), PlaneFunction(F(2), {(): F(1), ((RAY, 2),): F(1)}, {})
    odd = PlaneFunction(F(1), {((RAY, 1),): F(1)}, {})
    assert plane.power(square, {(): F(1, 2)}) == PlaneFunction(F(1), ONE, {base_of(square.poly): {(): F(1, 2)}})
    assert plane.power(odd, {(): F(3)}) == PlaneFunction(F(3), {((RAY, 3),): F(1)}, {})
    for exponent in (F(1, 2), F(-1), F(25), F(1, 3)):
        with pytest.raises(NotWritten, match="may be <= 0"):
            plane.power(odd, {(): exponent})
    assert [plane.power(square, {(): n}).degree for n in (F(-1), F(1, 4))] == [-2, F(1, 2)]
    with pytest.raises(NotWritten, match="an exponent varies"):
        plane.power(square, {((RAY, 1),): F(1)})
    assert plane.root(square) == plane.power(square, {(): F(1, 2)})


def test_in_a_sector_a_square_root_is_one_more_variable() -> None:
    plane = in_sector()
    flat, nothing = PlaneFunction(F(2), {((RAY, 2),): F(4)}, {}), PlaneFunction(F(2), {}, {})
    half = plane.power(flat, {(): F(1, 2)})
    assert half.degree == 1 and not half.powers and plane.power(half, {(): F(2)}).poly == flat.poly
    for value, exponent in ((flat, F(1, 3)), (flat, F(-1, 2)), (nothing, F(1, 2)), (half, F(1, 2))):
        with pytest.raises(NotWritten):
            plane.power(value, {(): exponent})
