"""Laws that do not change when the stress is turned, decided in principal stresses: who is one, and who only looks like one."""

from __future__ import annotations

import pytest

from duhem import Criterion, Domain, verify
from duhem.expression.invariance import shears_of_isotropic
from duhem.law.criterion_file import reads
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.claims import objection
from duhem.proof.kernel.stated_law import StatedLaw
from tests.long import long_but
from tests.oracles.reevaluation import confirmed

FORCES = ("xx", "yy", "zz", "yz", "xz", "xy")
J2 = "(((xx - yy)**2 + (yy - zz)**2 + (zz - xx)**2)/6 + yz**2 + xz**2 + xy**2)"
DET = "(xx*yy*zz + 2*yz*xz*xy - xx*yz**2 - yy*xz**2 - zz*xy**2)"
GREATEST = "eigmax(xx, yy, zz, yz, xz, xy)"


def law(g: str, forces: tuple[str, ...] = FORCES, **more: object) -> Criterion:
    return Criterion(name="law", g=g, forces=forces, pressure=None, **more)  # type: ignore[arg-type]


def isotropic(stated: Criterion) -> bool:
    return shears_of_isotropic(stated.g, stated.force_symbols()) is not None


@pytest.mark.slow
@pytest.mark.parametrize(
    "g",
    [
        f"{J2} - 1",
        f"sqrt({J2}) + k*(xx + yy + zz) - 1",
        f"{DET} - 1",
        f"{GREATEST} - 1",
        "eigmax(-xx, -yy, -zz, -yz, -xz, -xy) + xx + yy + zz - 1",
        f"abs({DET})**(1/3) + max({GREATEST}, {J2}) - exp(-xx - yy - zz)",
        f"where({DET} > 0, sqrt({J2}), 2*sqrt({J2})) - 1",
        "eigmax(2*xx + yy + zz, xx + 2*yy + zz, xx + yy + 2*zz, yz, xz, xy) - 1",
        "eigmax(xx**2 + xy**2 + xz**2, yy**2 + xy**2 + yz**2, zz**2 + xz**2 + yz**2,"
        " xy*xz + yz*(yy + zz), xy*yz + xz*(xx + zz), xz*yz + xy*(xx + yy)) - 1",
        f"(xx + yy + zz)*{J2}*sqrt({J2}) - 1",
        f"abs({J2} - 1)**2 + norm({J2}, {DET})**2 - 1",
    ],
)
def test_what_is_isotropic(g: str) -> None:
    assert isotropic(law(g, parameters={"k": Domain()}) if "k*" in g else law(g))


def test_the_order_of_the_shear_components_is_found() -> None:
    renamed = {"yz": "xy", "xz": "yz", "xy": "xz"}
    turned = "".join(renamed.get(part, part) for part in DET.replace("(", "( ").replace("*", " * ").split(" "))
    assert isotropic(law(f"{turned} - 1"))
    assert not isotropic(law(f"{DET} + {turned} - 1"))  # each of the two with another order


@pytest.mark.slow
@pytest.mark.parametrize(
    "g",
    [
        f"{J2} + xy**2/1000000000 - 1",
        f"{J2.replace('yz**2', '2*yz**2')} - 1",
        f"{J2.replace('/6', '/5')} - 1",
        f"{DET.replace('2*', '-2*')} - 1",
        f"{DET.replace('- zz', '+ zz')} - 1",
        "eigmax(xx, yy, zz, xz, yz, xy) + eigmax(xx, yy, zz, yz, xz, xy) - 1",
        "eigmax(xx, yy, zz, yz, xz, 2*xy) - 1",
        "eigmax(xx, yy, 0, yz, xz, xy) - 1",
        "eigmax(xx, yy, zz, yz, xz, xy + 1) - 1",
        "eigmax(xx, yy, zz, -yz, xz, xy) + xx*yz**2 - 1",
        f"where(xy > 0, sqrt({J2}), 2*sqrt({J2})) - 1",
        f"max({J2}, xy) - 1",
        f"sqrt({J2}) + sqrt(xx**2 + yy**2 + zz**2 + 2*yz**2 + 2*xz**2 + 2*xy**2 + xy**4) - 1",
        f"{J2}**(1 + xy**2) - 1",
        f"abs({J2} - xy)**2 - 1",
        "eigmax(abs(xx), abs(yy), abs(zz), yz, xz, xy) - 1",
        "abs(xx) + abs(yy) + abs(zz) + abs(yz) + abs(xz) + abs(xy) - 1",
        # about one axis alone
        "zz**2 - 1",
        "xx**2 - 1",
        "(xx - yy)**2 + 4*xy**2 - 1",
        "(yy - zz)**2 + 4*yz**2 - 1",
        "eigmax(xx, yy, 0, 0, 0, xy) - 1",
        "eigmax(0, yy, zz, yz, 0, 0) - 1",
    ],
)
def test_what_only_looks_isotropic(g: str) -> None:
    assert not isotropic(law(g))


def test_where_it_is_undefined_counts_too() -> None:
    """The prover reads 0*log(x) as 0, and says that of such a formula only what the kernel confirms is proved."""
    stated = StatedLaw.read(law_as_text(law(f"{J2} + 0*log(xy) - 1")))
    assert objection("convexity", "composition", frozenset(), stated, {})
    assert "logarithm of xy" in verify(law(f"{J2} + 0*log(xy) - 1"), claims=["origin"]).remarks[0]


def test_what_does_not_change_is_counted_in_six_components() -> None:
    assert "g does not change along 1 direction of the forces" in verify(law(f"{J2} - 1"), claims=["origin"]).remarks[0]


@pytest.mark.parametrize("g", ["xx**2 + yy**2 + zz**2 - 1", "(xx - yy)**2 + 4*xy**2 - 1"])
def test_fewer_components_are_taken_as_they_are(g: str) -> None:
    assert not isotropic(law(g, tuple(x for x in FORCES if x in g)))


def test_duality_is_not_asked_in_principal_stresses() -> None:
    """The support function of K in six slips is another than that in three."""
    stated = StatedLaw.read(law_as_text(law(f"{GREATEST} - 1")))
    evidence = {"potential": "abs(a) + abs(b) + abs(c)", "slips": {"xx": "a", "yy": "b", "zz": "c"}}
    assert objection("duality", "polar-gauge", frozenset(), stated, evidence)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("g", "convex"),
    long_but(
        [0, 3],
        [
            ("J2(s)**(3/2) + 1.29*J3(s) - 1", True),
            ("J2(s)**(3/2) + 1.3*J3(s) - 1", False),
            ("3*principal(s, 1) + 2*principal(s, 2) + principal(s, 3) - 1", True),
            ("3*principal(s, 1) + 1*principal(s, 2) + 1.001*principal(s, 3) - 1", False),
        ],
    ),
)
def test_what_is_decided_in_principal_stresses_holds_of_all_six(g: str, convex: bool) -> None:
    head = '[criterion]\nname = "law"\nstress = { name = "s", kind = "3d" }\npressure = false\n'
    stated = reads(f'{head}g = "{g}"\n', "law")
    found = verify(stated, claims=["convexity"])["convexity"]
    assert found.verdict.value == ("proved" if convex else "refuted")
    if convex:
        assert str(found.trust) == "checked"
    else:
        assert found.witness is not None and confirmed(stated, "convexity", found.witness)


@pytest.mark.parametrize(
    ("g", "convex"),
    [
        ("3*max(a, b) - 2*(max(a, b) - norm(a, b)) - 1", True),
        ("2*max(a, b) - 3*(max(a, b) - norm(a, b)) - 1", False),
        ("m*max(a, b) + a - n*max(a, b) - 1", True),
        ("n*max(a, b) + a - m*max(a, b) - 1", False),
        ("2*norm(a, b) + log(a*b) - (norm(a, b) + log(a*b)) - 1", False),  # not defined everywhere
        ("2*norm(a, b) + sqrt(a + b) - (norm(a, b) + sqrt(a + b)) - 1", False),
        ("2*norm(a, b) + log(a + b) - (norm(a, b) + log(a + b)) - 1", False),
    ],
)
def test_the_kernel_takes_like_parts_of_a_sum_together(g: str, convex: bool) -> None:
    stated = law(g, ("a", "b"), parameters={"m": Domain(low=2, high=3), "n": Domain(low=0, high=2)} if "m" in g.replace("max", "") else {})
    assert (objection("convexity", "composition", frozenset(), StatedLaw.read(law_as_text(stated)), {}) == "") == convex


@pytest.mark.slow
def test_a_constant_matrix_does_not_become_diagonal() -> None:
    """The greatest eigenvalue of (1, 0, 0; 0, 1, 1; 0, 1, 1) is 2 in principal stresses too: g = 1 - J2/2, and K is not convex."""
    j2 = "(((xx-yy)**2 + (yy-zz)**2 + (zz-xx)**2)/6 + yz**2 + xz**2 + xy**2)"
    g = f"({{}}(1, 1, 1, 1, 0, 0) - 3/2 + 0*exp(1))*(-{j2}) + 1"
    for word, shown in (("eigmax", False), ("min", True)):
        given = {"forces": FORCES, "pressure": None, "parameters": {}, "constraints": [], "g": g.format(word), "flow": None}
        stated = StatedLaw.read(given)
        assert (objection("convexity", "composition", frozenset(), stated, {}) == "") is shown


@pytest.mark.parametrize(
    "part", ["((xx + yy + zz)*xy/xy)**2", "(0*log(xy) + 2)**2", "((xx + yy + zz)*(xy/xy))**3", "(sqrt(xy)*0 + xx + yy + zz)**2"]
)
def test_it_counts_inside_a_power_too(part: str) -> None:
    assert objection("convexity", "composition", frozenset(), StatedLaw.read(law_as_text(law(f"{J2} + {part} - 1"))), {})


def _of_eigenvalues(text: str, entries: str = "2*xx, yy, zz, 0, 0, xy") -> bool:
    """Whether a law in the eigenvalues A >= B >= C of a matrix that no turning maps to itself is shown to be smooth."""
    turned = ", ".join(f"-({x})" for x in entries.split(", "))
    trace = " + ".join(entries.split(", ")[:3])
    words = {"A": f"eigmax({entries})", "C": f"(-eigmax({turned}))", "D": "eigmax(xx, yy, 3*zz, 0, 0, xy)"}
    g = text.translate({ord(word): formula for word, formula in (words | {"B": f"({trace} - {words['A']} - {words['C']})"}).items()})
    parameters = {name: {"min": low} for name, low in (("k", "3/2"), ("n", "1")) if name in text}
    given = {"forces": ["xx", "yy", "zz", "xy"], "pressure": None, "parameters": parameters, "constraints": [], "g": g, "flow": None}
    stated = StatedLaw.read(given)
    return not objection("smoothness", "composition", frozenset(), stated, {})


@pytest.mark.parametrize(
    "text",
    [
        "abs(A - B)**4 + abs(B - C)**4 + abs(C - A)**4 - 1",
        "abs(A - B)**k + abs(B - C)**k + abs(C - A)**k - 1",
        "A**4 + B**4 + C**4 - 1",
    ],
)
def test_a_symmetric_function_of_eigenvalues_is_smooth_where_it_is_so_in_them(text: str) -> None:
    assert _of_eigenvalues(text)


@pytest.mark.parametrize(
    "text",
    [
        "abs(A - B)**4 + abs(C - A)**4 - 1",  # another order gives another value
        "A**4 + 2*B**4 + C**4 - 1",
        "abs(A - B) + abs(B - C) + abs(C - A) - 1",
        "abs(A - B)**n + abs(B - C)**n + abs(C - A)**n - 1",
        "A**4 + B**4 + C**4 + D**2 - 1",
        "A - 1",
    ],
)
def test_what_has_a_corner_where_eigenvalues_meet_is_not_shown_to_be_smooth(text: str) -> None:
    assert not _of_eigenvalues(text)


def test_eigenvalues_of_a_matrix_with_kinks_have_kinks() -> None:
    assert not _of_eigenvalues("A**4 + B**4 + C**4 - 1", "abs(xx), yy, zz, 0, 0, xy")
