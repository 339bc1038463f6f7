"""Functions of J2 and J3: convex where their section is, in principal stresses and in components, and no further.

The thresholds are the literature's: Gudehus and Argyris K = 7/9, van Eekelen beta = 0.7925, Drucker c = -27/8 and 9/4, Cazacu and Barlat
c = 3 sqrt(3)/4, Ottosen and Bigoni, Piccolroaz 0 <= b <= pi/3.  Drawn sections are held against f'' + f on a fine grid.
"""

from __future__ import annotations

import math
from random import Random

import pytest

from duhem import Criterion, verify
from duhem.law.domain import POSITIVE, Domain
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.regularity import smooth_near_the_boundary
from duhem.proof.kernel.stated_law import StatedLaw
from duhem.proof.verdict import Trust, Verdict
from tests.long import long_at, long_but, mostly_long
from tests.proof.composed import by_kernel, by_prover

PRINCIPAL, SIX, PLANE = ("a", "b", "c"), ("xx", "yy", "zz", "yz", "xz", "xy"), ("x", "y", "t")
S = {
    PRINCIPAL: ("(((a-b)**2 + (b-c)**2 + (c-a)**2)/6)", "((2*a-b-c)*(2*b-c-a)*(2*c-a-b)/27)", "(a + b + c)"),
    SIX: (
        "(((xx-yy)**2 + (yy-zz)**2 + (zz-xx)**2)/6 + yz**2 + xz**2 + xy**2)",
        "(((2*xx-yy-zz)/3)*((2*yy-zz-xx)/3)*((2*zz-xx-yy)/3) + 2*yz*xz*xy - ((2*xx-yy-zz)/3)*yz**2"
        " - ((2*yy-zz-xx)/3)*xz**2 - ((2*zz-xx-yy)/3)*xy**2)",
        "(xx + yy + zz)",
    ),
    PLANE: (
        "((x**2 - x*y + y**2)/3 + t**2)",
        "(((2*x-y)/3)*((2*y-x)/3)*((-x-y)/3) - ((-x-y)/3)*t**2)",
        "(x + y)",
    ),
}
C3 = "(3*sqrt(3)/2*J3/J2**(3/2))"


def acos(z: str) -> str:
    return f"(pi/2 - atan(({z})/sqrt(1 - ({z})**2)))"


OTTOSEN = f"A*J2 + L*sqrt(J2)*cos({acos(f'G*{C3}')}/3) + B*I1 - 1"
LODE = f"sqrt(3*J2)*cos(E*pi/6 - {acos(f'G*{C3}')}/3) + B*I1 - 1"
ARGYRIS = "sqrt(J2)*(1 + K)/(2*K) - (1 - K)/(2*K)*(3*sqrt(3)/2)*J3/J2 - 1"
between = Domain.between

CASES = [
    (ARGYRIS, {"K": between("0.7778", 1)}, True),
    (ARGYRIS, {"K": between("0.7777", 1)}, False),
    (f"sqrt(J2)*(1 - E*{C3})**0.229 - 1", {"E": between("-0.792", "0.792")}, True),
    (f"sqrt(J2)*(1 - E*{C3})**0.229 - 1", {"E": between(0, "0.793")}, False),
    (f"sqrt(J2)*(1 - E*{C3})**0.229 - 1", {"E": between(0, 1)}, False),  # the section reaches 0
    ("J2**(3/2) - E*J3 - 1", {"E": between("-1.299", "1.299")}, True),
    ("J2**(3/2) - E*J3 - 1", {"E": between(0, "1.2991")}, False),
    ("J2**3 - E*J3**2 - 1", {"E": between("-27/8", "9/4")}, True),
    ("J2**3 - E*J3**2 - 1", {"E": between(0, "2.2501")}, False),
    ("J2**3 - E*J3**2 - 1", {"E": between("-3.3751", 0)}, False),
    ("(J2**(3/2) - E*J3)**(1/3) + B*I1 - 1", {"E": between("-1.299", "1.299")}, True),  # Cazacu, Barlat (2004) as a cone
    (OTTOSEN, {"G": between("-0.99", "0.99"), "A": POSITIVE, "L": POSITIVE}, True),
    (OTTOSEN.replace(acos(f"G*{C3}"), f"acos(G*{C3})"), {"G": between("-1", "1"), "A": POSITIVE, "L": POSITIVE}, True),
    (OTTOSEN.replace(acos(f"G*{C3}"), f"acos(G*{C3})"), {"G": between("-1.001", "1"), "A": POSITIVE, "L": POSITIVE}, False),
    (OTTOSEN, {"G": between(0, "1.001"), "A": POSITIVE, "L": POSITIVE}, False),  # no acos
    (OTTOSEN, {"G": between(0, "0.99"), "A": POSITIVE, "L": between("-0.1", 1)}, False),
    (LODE, {"E": between(0, 2), "G": between(0, "0.99")}, True),
    (LODE, {"E": between(0, "2.001"), "G": between(0, "0.99")}, False),
    (LODE, {"E": between("-0.001", 1), "G": between(0, "0.99")}, False),
    (LODE.replace("/3)", "/2)"), {"E": between(0, 2), "G": between(0, "0.99")}, False),  # half of the angle
    (ARGYRIS.replace("J3/J2", "J3/J2*I1/(I1 + 1)"), {"K": between("0.7778", 1)}, False),
    (f"{ARGYRIS} + I1**3", {"K": between("0.7778", 1)}, False),
]  # fmt: skip


def law(g: str, forces: tuple[str, ...], parameters: dict[str, Domain]) -> Criterion:
    for name, text in zip(("J2", "J3", "I1"), S[forces], strict=True):
        g = g.replace(name, text)
    table = {"B": POSITIVE, **parameters}
    return Criterion(name="law", g=g, forces=forces, pressure=None, parameters={n: d for n, d in table.items() if n in g})


def kernel_knows(g: str, parameters: dict[str, Domain], convex: bool, forces: tuple[str, ...]) -> bool:
    shown = by_kernel(law(g, forces, parameters))
    return (shown.defined and shown.quasiconvex) is convex


@pytest.mark.parametrize(("g", "parameters", "convex"), CASES[:2])
def test_the_kernel_knows_a_threshold(g: str, parameters: dict[str, Domain], convex: bool) -> None:
    assert kernel_knows(g, parameters, convex, PRINCIPAL)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("forces", "g", "parameters", "convex"),
    mostly_long(
        [(forces, *case) for case in CASES for forces in S],
        *((PRINCIPAL, *case) for case in CASES[2::2]),
        *((SIX, *c) for c in CASES[::8]),
        *((PLANE, *c) for c in CASES[2::8]),
    ),
)
def test_the_kernel_knows_every_threshold(g: str, parameters: dict[str, Domain], convex: bool, forces: tuple[str, ...]) -> None:
    assert kernel_knows(g, parameters, convex, forces)


@pytest.mark.slow
@pytest.mark.parametrize(("g", "parameters", "convex"), long_but([2, 6, 8, 12, 16, 20], CASES))
def test_the_prover_knows_the_threshold(g: str, parameters: dict[str, Domain], convex: bool) -> None:
    assert by_prover(law(g, PRINCIPAL, parameters)) is convex


@pytest.mark.slow
@pytest.mark.parametrize(
    ("change",),
    long_at([0], zip([("2*yz*xz*xy", "3*yz*xz*xy"), ("(2*yy-zz-xx)/3)*xz**2", "(2*yy-zz-xx)/3)*yz**2"), ("xx + yy", "xx + 2*yy")])),
)
def test_what_is_no_invariant_is_taken_for_none(change: tuple[str, str]) -> None:
    honest = law(f"{ARGYRIS} + B*I1**2", SIX, {"K": between("0.8", 1)})
    spoilt = Criterion(
        name="law", g=law_as_text(honest)["g"].replace(*change), forces=SIX, pressure=None, parameters=dict(honest.parameters)
    )
    assert by_kernel(honest).convex and law_as_text(spoilt)["g"] != law_as_text(honest)["g"]
    assert by_kernel(spoilt).convex is (change[0] == "xx + yy")  # a load that is another is as good


def bend(f: tuple[float, ...], root: float) -> float:
    """The least f'' + f on a grid of theta, relative to f, of the root of a polynomial in cos 3 theta; nan where that is < 0."""
    least, n = math.inf, 4000

    def h(theta: float) -> float:
        c = math.cos(3 * theta)
        return math.pow(sum(a * c**i for i, a in enumerate(f)), root)

    step = 1e-3
    for k in range(n + 1):
        theta = k * math.pi / 3 / n
        least = min(least, ((h(theta + step) - 2 * h(theta) + h(theta - step)) / step**2 + h(theta)) / h(theta))
    return least


@pytest.mark.long
def test_drawn_sections_are_convex_where_a_grid_finds_them_so() -> None:
    rng, both = Random(3), [0, 0]
    while min(both) < 8:
        f = (1.0, *(round(rng.uniform(-0.2, 0.2), 2) for _ in range(rng.randint(1, 3))))
        root = rng.choice((1, 1 / 2, 1 / 3, 1 / 4))
        if min(sum(a * c**i for i, a in enumerate(f)) for c in (k / 50 - 1 for k in range(101))) < 0.01:
            continue
        if abs(least := bend(f, root)) < 0.01:
            continue  # the grid does not tell
        g = (
            f"(sqrt(J2)**{round(1 / root)}*("
            + " + ".join(f"({a})*{C3}**{i}" if i else str(a) for i, a in enumerate(f))
            + f"))**(1/{round(1 / root)}) - 1"
        )
        assert by_kernel(law(g, PRINCIPAL, {})).convex is (least > 0), (f, root, least)
        both[least > 0] += 1


@pytest.mark.slow
def test_a_law_in_six_components_is_proved_and_checked() -> None:
    found = verify(law(OTTOSEN, SIX, {"A": POSITIVE, "G": between(0, "0.99"), "L": POSITIVE}), claims=["convexity"])["convexity"]
    assert (found.verdict, found.trust) == (Verdict.PROVED, Trust.CHECKED)


@pytest.mark.slow
@pytest.mark.parametrize(("load", "inside"), long_at([1], [("B*I1 - 1", True), ("B*I1 + K - 0.9", False), ("1/I1", False)]))
def test_zero_force_is_where_the_sections_are_0(load: str, inside: bool) -> None:
    found = verify(law(f"{ARGYRIS[:-4]} + {load}", PRINCIPAL, {"K": between("0.8", 1)}), claims=["origin"])["origin"]
    assert (found.verdict is Verdict.PROVED) is inside
    assert found.trust is (Trust.CHECKED if inside else None)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("g", "smooth"),
    [
        (ARGYRIS, True),
        (f"sqrt(J2)*(1 - 0.7*{C3})**0.229 - 1", True),
        pytest.param(f"{ARGYRIS} + B*I1", False, marks=pytest.mark.long),  # a cone: its tip lies where J2 = 0
        (f"{ARGYRIS} + abs(a - b)", False),  # a kink beside the section
        ("abs(sqrt(J2)/2 + J3/J2) + sqrt(J2) - 1", False),  # a kink of the section
        (OTTOSEN.replace("A*J2 + L*", "").replace("G", "1").replace("+ B*I1", ""), False),  # corners: it is Rankine's
        (f"sqrt(J2)*(1 - {C3})**(1/2) - 1", True),  # where the root is of 0, g is -1
        (f"sqrt(J2)*(1 - {C3})**(1/2) + sqrt(J2) - 1", False),  # it is of 0 on the boundary, too
    ],
)
def test_a_section_is_smooth_but_on_the_axis(g: str, smooth: bool) -> None:
    stated = StatedLaw.read(law_as_text(law(g, PRINCIPAL, {"K": between("0.8", 1)})))
    assert smooth_near_the_boundary(stated.g, over(stated)) is smooth
