"""What the kernel shows by signs: on pieces, along rays, on the face of a surface, of roots; beside each what is almost so and false."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pytest

from duhem import POSITIVE, Criterion, Domain, InputError, Verdict, YieldSurface, verify
from duhem.proof.kernel.bounds import NEGATIVE, ZERO, Bounds
from duhem.proof.kernel.bounds import POSITIVE as ABOVE
from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.kernel.term import number, parse
from duhem.proof.verdict import Trust


def law(g: str, forces: str = "ab", parameters: Mapping[str, Domain] | None = None, **given: object) -> Criterion:
    return Criterion("law", g, parameters or {}, forces=tuple(forces), pressure=None, **given)


def checked(criterion: Criterion, claim: str = "dissipation") -> bool:
    (found,) = (r for r in verify(criterion, claims=[claim]).results if r.claim == claim)
    return (found.verdict, found.trust) == (Verdict.PROVED, Trust.CHECKED)


# -- a choice that rays keep ----------------------------------------------------------------------------------------------

SIGNED = "a**2/where(a > 0, x, y)**2 - a*b/where(a > 0, x, y)**2 + b**2/where({0}, u, v)**2 - 1"
FOUR = dict.fromkeys("xyuv", POSITIVE)


@pytest.mark.parametrize("condition", ["b > 0", "b >= 0", "a + 2*b > 0", "a*b > 0", "b > abs(a)"])
def test_a_choice_that_no_ray_changes_may_stand_anywhere(condition: str) -> None:
    """g is 2 (g + 1) along each ray, whatever the choice; beyond a - 1 it is another at the end of a ray than at its begin."""
    assert checked(law(SIGNED.format(condition), parameters=FOUR))


@pytest.mark.parametrize("condition", ["b > 1", "b**2 > a", "a + b**3 > 0"])
def test_a_choice_that_changes_along_rays_shows_nothing(condition: str) -> None:
    assert not checked(law(SIGNED.format(condition), parameters=FOUR))
    numbers = {"x": 1.0, "y": 1.0, "u": 1.0, "v": 0.2}
    ways = np.stack([np.cos(t := np.linspace(0, 2 * np.pi, 400)), np.sin(t)], axis=1)
    a, b = np.moveaxis(ways[:, None, :] * np.linspace(0.01, 8, 4000)[:, None], -1, 0)
    level = eval(SIGNED.format(condition), {"where": np.where, "abs": np.abs, **numbers}, {"a": a, "b": b})
    above = np.maximum.accumulate(level > 1e-9, axis=1)
    assert np.any(above & (level < -1e-9))  # K is entered again along some ray


# -- flows by pieces ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("slip", "true"),
    [
        (("where(a > 0, 1, -1)", "0"), True),  # |a|
        (("where(a > 0, 1, -1)", "where(b < 0, -2, 1)"), True),
        (("where(a + b > 0, 1, -1)", "where(a + b > 0, 1, -1)"), True),
        (("where(a > 0, 1, 1/2)", "0"), False),
        (("where(b > 0, 1, -1)", "0"), False),
    ],
)
def test_a_flow_may_have_a_sense_for_each_side(slip: Sequence[str], true: bool) -> None:
    assert checked(law("norm(a, b) - 1", flow=tuple(slip))) is true


@pytest.mark.parametrize(("limit", "true"), [("a - 1", True), ("a - 2", False), ("a - 3", False)])
def test_a_flow_of_a_surface_needs_a_value_where_the_others_allow_it(limit: str, true: bool) -> None:
    """It has none at (2, 0), which lies on the surface, too, as long as the other one does not leave it out."""
    away = YieldSurface("norm(a, b) - 1 - a/2", ("a/norm(a - 2, b)", "b/norm(a - 2, b)"))
    found = Criterion("law", forces=("a", "b"), pressure=None, surfaces=(away, YieldSurface(limit)))
    assert checked(found) is true


MOHR = "(1 + sin(psi))/2*max(a, b, c) - (1 - sin(psi))/2*min(a, b, c)"


@pytest.mark.parametrize(("psi", "true"), [("1/10", True), ("3/5", True), ("7/10", False)])
def test_a_potential_of_mohr_and_coulomb_s_kind(psi: str, true: bool) -> None:
    """It dissipates up to the apex as long as the dilatancy is no greater than the friction."""
    own = {"phi": Domain.fixed("3/5"), "psi": Domain.fixed(psi), "k": POSITIVE}
    assert checked(law(f"{MOHR.replace('psi', 'phi')} - k*cos(phi)", "abc", own, potential=MOHR)) is true


# -- roots of parameters --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "sign"),
    [
        ("x - 2*sqrt(x)*sqrt(y) + y", ABOVE | ZERO),
        ("x + 2*f*sqrt(x)*sqrt(y) + y", ABOVE),  # |f| < 1
        ("2*f*sqrt(x)*sqrt(y) - x - y", NEGATIVE),
        ("x - 3*sqrt(x)*sqrt(y) + y", NEGATIVE | ZERO | ABOVE),
        ("x - sqrt(x)", NEGATIVE | ZERO | ABOVE),
        ("where(f > 0, 1, -1)**2", ABOVE),
        ("where(f > 0, f, -1)**2", ABOVE | ZERO),
        ("sqrt(x**2*((y - z)/2)**2) - x*(y + z)/2", NEGATIVE),
        ("sqrt(x**2*((y - z)/3)**2) - x*(y + z)/2", NEGATIVE),
        ("sqrt(x**2*(2*(y - z)/3)**2) - x*(y + z)/2", NEGATIVE | ZERO | ABOVE),
    ],
)
def test_signs_of_roots_and_squares(text: str, sign: int) -> None:
    own = {name: Bounds.read({"positive": True}) for name in "xyz"} | {"f": Bounds.read({"min": "-99/100", "max": "99/100"})}
    found = over(StatedLaw(("force",), None, number(0), None, own, ())).facts(parse(text)).sign
    assert found == sign
    rng = np.random.default_rng(4)
    x, y, z, f = (*10.0 ** rng.uniform(-2, 2, (3, 2000)), rng.uniform(-0.99, 0.99, 2000))
    seen = eval(text, {"where": np.where, "sqrt": np.sqrt}, {"x": x, "y": y, "z": z, "f": f})
    assert np.all((seen > -1e-9) | bool(found & NEGATIVE)) and np.all((seen < 1e-9) | bool(found & ABOVE))


# -- what constraints say of a divisor ------------------------------------------------------------------------------------

ANY = {"m": Domain(), "n": Domain()}
RANGES = {"m": Domain.between(0, 1), "n": Domain.between(0, 1)}


@pytest.mark.parametrize(
    ("divisor", "constraint", "known", "true"),
    [
        ("(m*n)", "m*n >= 1", ANY, True),
        ("(m*n)", "m*n >= 0", ANY, False),
        ("(m - 3)**2", "(m - 3)**2 >= 1", ANY, True),
        ("(m - 3)**2", "(m - 2)**2 >= 1", ANY, False),
        ("cos(m + n)", "m + n < pi/2", RANGES, True),
        ("cos(m + n)", "m + n < pi", RANGES, False),
        ("(pi*n - m)", "m < pi*n", RANGES, True),
        ("(3*n - m)", "m < pi*n", RANGES, False),
    ],
)
def test_a_divisor_that_a_constraint_keeps_from_0(divisor: str, constraint: str, known: Mapping[str, Domain], true: bool) -> None:
    divided = law(f"norm(a, b)/{divisor} - k", parameters={**known, "k": POSITIVE}, constraints=(constraint,))
    try:
        found = verify(divided, claims=["origin"])
    except InputError as fault:  # it is 0 at values that are admitted
        assert not true and "which is 0" in fault.what
    else:
        assert (found["origin"].verdict is Verdict.PROVED) is true
        assert any("could not show that g has a value" in remark for remark in found.remarks) is not true
