"""The greatest eigenvalue of a symmetric matrix: in every arithmetic, at double eigenvalues and over boxes, in prover and kernel."""

from __future__ import annotations

from fractions import Fraction
from random import Random

import flint
import mpmath
import numpy as np
import pytest
import sympy as sp

import duhem
from duhem import Criterion, Domain
from duhem.expression import EigMax, ball_series, balls, fold, jets, mpmath_, numpy_, symbol
from duhem.expression.branches import TooManyBranchesError, branches
from duhem.expression.parse import parse_expression
from duhem.expression.vocabulary import rows
from duhem.law.domain import POSITIVE
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.certificate import stated
from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.domain import NEGATIVE
from duhem.proof.kernel.term import parse
from tests.long import long_but

NAMES = [symbol(n) for n in ("xx", "yy", "zz", "yz", "xz", "xy")]
FORM = EigMax(*NAMES)
# entries and the greatest eigenvalue by hand; the last ones have it twice or three times
BY_HAND = [
    ((1, 2, 3, 0, 0, 0), 3),
    ((-3, 4, 2, 0, 0, 12), 13),
    ((0, 0, 0, 1, 1, 1), 2),
    ((0, 0, 0, -1, -1, -1), 1),
    ((5, 5, 5, 0, 0, 0), 5),
    ((0, 0, 0, 0, 0, 0), 0),
    ((2, 2, -7, 0, 0, 0), 2),
]


@pytest.mark.parametrize(("entries", "greatest"), BY_HAND)
def test_by_hand_in_every_arithmetic(entries: tuple[int, ...], greatest: int) -> None:
    here = dict(zip(NAMES, map(sp.Integer, entries), strict=True))
    assert float(numpy_.evaluate(FORM, {x: float(v) for x, v in here.items()})) == pytest.approx(greatest, abs=1e-14)
    assert fold(FORM, mpmath_.table(mpmath_.doubles()), lambda x: float(here[x])) == pytest.approx(greatest, abs=1e-14)
    assert abs(mpmath_.evaluate(FORM, here, 60) - greatest) < mpmath.mpf("1e-25")
    assert float(EigMax(*entries).evalf(20)) == pytest.approx(greatest, abs=1e-9)
    ball = balls.enclose(FORM, {x: balls.ball(Fraction(int(v))) for x, v in here.items()})
    assert ball.contains(greatest) and ball.rad() < 1e-6
    with balls.precision(400):
        sharp = balls.enclose(FORM, {x: balls.ball(Fraction(int(v))) for x, v in here.items()})
    assert sharp.contains(greatest) and sharp.rad() < 1e-50


@pytest.mark.slow
def test_a_box_holds_every_eigenvalue_in_it() -> None:
    rng = Random(5)
    for _ in range(40):
        middle = [Fraction(rng.randint(-40, 40), 16) for _ in NAMES]
        radii = [Fraction(rng.choice((0, 0, 1, 3, 20)), 32) for _ in NAMES]
        box = balls.enclose(FORM, {x: balls.ball(m - r, m + r) for x, m, r in zip(NAMES, middle, radii, strict=True)})
        spread = float(sum(r**2 * (1 + (i > 2)) for i, r in enumerate(radii))) ** 0.5
        assert float(box.rad()) <= spread * 1.01 + 1e-6
        for _ in range(12):
            point = [m + r * Fraction(rng.choice((-1, 1, 0)) * rng.randint(0, 8), 8) for m, r in zip(middle, radii, strict=True)]
            with mpmath.workdps(30):
                value = max(mpmath.eigsy(mpmath.matrix(rows(*(mpmath.mpf(v.numerator) / v.denominator for v in point))), eigvals_only=True))
                assert mpmath.mpf(str(box.lower().str(25, radius=False))) - mpmath.mpf("1e-20") <= value
                assert value <= mpmath.mpf(str(box.upper().str(25, radius=False))) + mpmath.mpf("1e-20")


def test_without_shear_it_is_the_greatest_entry() -> None:
    x, y, z = NAMES[:3]
    assert EigMax(x, y, z, 0, 0, 0) == sp.Max(x, y, z)
    assert parse_expression("eigmax(xx, yy, zz, xx - xx, 0, 0)", {n.name: n for n in NAMES}) == sp.Max(x, y, z)


def test_its_slopes_are_those_of_differences() -> None:
    entries = np.array([0.3, -1.1, 0.8, 0.4, -0.7, 0.2])
    jet, _ = jets.formula(FORM, NAMES, [])(entries[None], [])
    here = dict(zip(NAMES, entries, strict=True))
    slopes = [float(sp.diff(FORM, x).subs(FORM, float(jet.value[0])).subs(here)) for x in NAMES]
    step = 1e-6
    moved = [entries + s * step * e for e in np.eye(6) for s in (1, -1)]
    values = numpy_.evaluate(FORM, dict(zip(NAMES, np.array(moved).T, strict=True)))
    differences = (values[::2] - values[1::2]) / (2 * step)
    assert jet.gradient is not None and jet.hessian is not None
    assert jet.gradient[0] == pytest.approx(differences, abs=1e-9)
    assert jet.gradient[0] == pytest.approx(np.array(slopes), abs=1e-12)
    turned = [jets.formula(FORM, NAMES, [])(m[None], [])[0].gradient[0] for m in moved]  # type: ignore[index]
    bends = [(a - b) / (2 * step) for a, b in zip(turned[::2], turned[1::2], strict=True)]
    assert jet.hessian[0] == pytest.approx(np.array(bends), abs=1e-7)


def test_no_derivative_is_known_at_a_double_eigenvalue() -> None:
    series = [flint.arb_series([flint.arb(v), flint.arb(1)], prec=2) for v in (2, 2, -7, 0, 0, 0)]
    (value,) = ball_series.compiled([FORM], NAMES)(*series)
    assert value[0].contains(2) and not value[1].is_finite()
    with pytest.raises(TooManyBranchesError):
        branches(FORM)


KERNEL = {
    "eigmax(a, b, c, 0, a, 2*b)": (True, True, False),
    "-eigmax(a, b, c, 0, a, 2*b)": (True, False, True),
    "eigmax(a**2, b, c, 0, a, b)": (True, False, False),
    "eigmax(a, b, c, abs(a), 0, 0)": (True, False, False),
    "eigmax(a, b, c, log(a), 0, 0)": (False, False, False),
    "eigmax(abs(a), b, c, 0, 0, 0)": (True, True, False),
}


@pytest.mark.parametrize("text", KERNEL)
def test_the_kernel_knows_it_convex_in_its_entries(text: str) -> None:
    law = Criterion(name="x", g="a + b + c", forces=("a", "b", "c"), pressure=None)
    found = over(stated(law_as_text(law))).facts(parse(text))
    assert (found.defined, found.convex, found.concave) == KERNEL[text]
    assert over(stated(law_as_text(law))).facts(parse("eigmax(-1, -2, -3, 0, 0, 0)")).sign == NEGATIVE


def _verdicts(g: str, **parameters: Domain) -> dict[str, tuple[str, str | None]]:
    stress = {"name": "s", "kind": "3d"}
    law = Criterion(name="x", g=g, stress=stress, pressure=None, parameters={"k": POSITIVE} | parameters)
    found = duhem.verify(law, claims=["origin", "convexity", "normality", "dissipation", "smoothness"])
    return {row.claim: (row.verdict.value, None if row.trust is None else row.trust.value) for row in found.results}


FRICTION = "(1 + sin(phi))*principal(s, 1) - (1 - sin(phi))*principal(s, 3) - k*cos(phi)"


@pytest.mark.slow
@pytest.mark.parametrize(
    "g",
    long_but(
        [1, 3],
        [
            "principal(s, 1) - k",
            "principal(s, 1) - principal(s, 3) - k",
            pytest.param("max(principal(s, 1) - k, -principal(s, 3) - 10*k)", marks=pytest.mark.long),
            FRICTION,
        ],
    ),
)
def test_laws_of_principal_stresses_are_proved(g: str) -> None:
    phi = {"phi": Domain.between("0.05", "1.2")} if "phi" in g else {}
    found = _verdicts(g, **phi)
    assert [found[c] for c in ("origin", "convexity", "normality", "dissipation")] == [("proved", "checked")] * 4
    assert found["smoothness"][0] == "refuted"  # it has edges


@pytest.mark.slow
@pytest.mark.parametrize("g", long_but([0], ["principal(s, 2) - k", "principal(s, 1) + 2*principal(s, 3) - k"]))
def test_false_neighbours_are_refuted(g: str) -> None:
    assert _verdicts(g)["convexity"][0] == "refuted"


def test_where_no_matrix_is_diagonal_no_edge_is_seen() -> None:
    law = Criterion(name="x", g="eigmax(a, b, -10, 0, 0, 1) - k", forces=("a", "b"), pressure=None, parameters={"k": POSITIVE})
    assert duhem.verify(law, claims=["smoothness"])["smoothness"].verdict.value == "undecided"


@pytest.mark.slow
@pytest.mark.long
def test_a_smooth_law_of_eigenvalues_has_no_edge() -> None:
    assert _verdicts("principal(s, 1)**2 + principal(s, 2)**2 + principal(s, 3)**2 - k")["smoothness"][0] != "refuted"
