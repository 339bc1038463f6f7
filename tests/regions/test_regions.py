"""For which parameters: the regions of known laws, held to curvature worked out by other means, also close to their ends."""

from __future__ import annotations

import json
import random
from collections.abc import Callable, Mapping
from dataclasses import replace
from fractions import Fraction
from functools import cache
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import mpmath
import numpy as np
import pytest
import sympy as sp
from click.testing import CliRunner

import duhem
from duhem.cli import cli
from duhem.law.builtin.lobes import lobe_law
from duhem.proof.kernel.certificate import digest
from duhem.proof.kernel.signs import RealRoot
from duhem.proof.recheck import RecheckedRegion
from duhem.regions import entry
from duhem.regions.places import OPEN, Decided, ParameterCell, square_root_near
from duhem.regions.search import Asked, cells_of
from duhem.show.printing import text
from tests.long import mostly_long
from tests.regions.test_planes import tampered

CHRISTENSEN = duhem.Criterion(
    name="fibre", forces=("s22", "s33", "s23", "s12"), pressure=None,
    g="(1/T - 1/C)*(s22 + s33) + (s22 + s33)**2/(T*C) + (s23**2 - s22*s33)/S**2 + s12**2/L**2 - 1",
    parameters={"T": duhem.Domain.fixed(2), "C": duhem.Domain.fixed(2), "S": duhem.POSITIVE, "L": duhem.POSITIVE},
)  # fmt: skip
LAWS: dict[str, tuple[Any, str, Mapping[str, Any], str]] = {
    "limacon": ("limacon", "e", {}, "0 <= e and e <= 1/2"),
    "two lobes": (lobe_law(2), "e", {}, "-1/5 <= e and e <= 1/5"),
    "four lobes": (lobe_law(4), "e", {}, "-1/17 <= e and e <= 1/17"),
    "eight lobes": (lobe_law(8), "e", {}, "-1/65 <= e and e <= 1/65"),
    "quartic": ("quartic", "c", {}, "0 <= c and c <= 6"),
    "drucker": ("drucker1949", "c", {}, "-27/8 <= c and c <= 9/4"),
    "shifted ellipse": ("shifted-ellipse", "shift", {}, "true"),
    "argyris": ("argyris", "K", {"K": "0:1"}, "7/9 <= K and K <= 1"),
    "willam warnke": ("willam-warnke", "e", {"e": (0, 1)}, "1/2 <= e and e <= 1"),
    "cazacu barlat": ("cazacu-barlat", "c", {"c": (-2, 2)}, "-3*sqrt(3)/4 <= c and c <= 3*sqrt(3)/4"),
    "fibre": (CHRISTENSEN, "S", {}, "S >= 1"),
    "even powers of ramps": (duhem.load("cpb06").fix({"a": 4}), "k", {"k": (-2, 2)}, "true"),
    "a line in a normal form": (duhem.load("hill79").fix({"m": 4}), "r", {"r": (-1, 1)}, "-1/2 <= r and r <= 1"),
    "a section by a quartic": (duhem.load("yld89").fix({"M": 4}), "a", {"a": (-1, 5)}, "0 <= a and a <= 2"),
}


@cache
def found(name: str) -> duhem.ParameterRegion:
    law, parameter, over, _ = LAWS[name]
    return duhem.region(law, parameter, over=over)


@pytest.mark.parametrize(
    "name", mostly_long(LAWS, "limacon", "two lobes", "quartic", "shifted ellipse", "argyris", "fibre", "a section by a quartic")
)
def test_regions_are_exact(name: str) -> None:
    done = found(name)
    assert done.exact and done.condition == LAWS[name][3]
    assert done.open_share == 0
    assert all(cell.trust == "checked" and (cell.witness is not None) is (cell.verdict == "refuted") for cell in done.cells)
    assert duhem.recheck(done.certificate()).ok


@pytest.mark.long
def test_scales_are_set_to_one() -> None:
    done = duhem.region("matchstick")
    assert done.scales == ("mu_b",) and done.condition == "sqrt(2)/2 <= mu_a and mu_a <= sqrt(2)"
    assert [(end.polynomial, end.closed) for end in done.ends] == [("2*mu_a**2 - 1", True), ("mu_a**2 - 2", True)]
    assert "where mu_b = 1" in done.sentence


@pytest.mark.parametrize(
    ("g", "ends"),
    [
        ("where(c <= 0, (x**2 + y**2)*(x - 1), x - 1)", []),  # K is {x <= 1} for all c, but for c <= 0 no rule shows it
        ("x**4 + c*x**2*y**2 + y**4 - 1", [("0", True)]),
        ("max(x**4 + c*x**2*y**2 + y**4 - 1, where(c <= 1/2, x - 2, (x**2 + y**2)*(x - 2)))", []),
    ],
)
def test_an_end_is_where_the_claim_is_refuted_beyond(g: str, ends: list[tuple[str, bool]]) -> None:
    """Beside values that are open nobody knows whether the claim ceases to hold."""
    done = duhem.region(duhem.Criterion("k", g, {"c": duhem.Domain.between(-1, 1)}, ("x", "y"), None), "c", steps=1_000_000)
    assert done.stretches("proved") and [(end.value, end.closed) for end in done.ends] == ends
    assert (f"{done.claim} still holds there" in repr(text(done))) is bool(ends)


# -- held to the curvature of the boundary -----------------------------------------------------------------------------


def lobed(n: int) -> Callable[[Any], bool]:
    """Whether r = 1 + e cos(n theta) bounds a convex set: r^2 + 2 r'^2 - r r'' >= 0 at many angles, those of least curvature among them."""

    def convex(e: Any) -> bool:
        angles = [mpmath.pi * k / (24 * n) for k in range(48 * n)]
        curved = []
        for theta in angles:
            r, one, two = 1 + e * mpmath.cos(n * theta), -n * e * mpmath.sin(n * theta), -(n**2) * e * mpmath.cos(n * theta)
            curved.append(r**2 + 2 * one**2 - r * two)
        return bool(min(curved) >= -(mpmath.mpf(10) ** -30))

    return convex


def quartic(c: Any) -> bool:
    """Whether x^4 + c x^2 y^2 + y^4 has a Hessian >= 0 at many angles."""
    for k in range(97):
        x, y = mpmath.cos(mpmath.pi * k / 96), mpmath.sin(mpmath.pi * k / 96)
        xx, yy, xy = 12 * x**2 + 2 * c * y**2, 12 * y**2 + 2 * c * x**2, 4 * c * x * y
        # the gauge is convex where the curvature of the level line is >= 0
        gx, gy = 4 * x**3 + 2 * c * x * y**2, 4 * y**3 + 2 * c * x**2 * y
        if xx * gy**2 - 2 * xy * gx * gy + yy * gx**2 < -(mpmath.mpf(10) ** -30):
            return False
    return True


def within(region: duhem.ParameterRegion, x: Fraction) -> str:
    """The verdict of the cell in which a value lies, by the condition of the cell as Python reads it."""
    (name,) = region.parameters
    return next(cell.verdict for cell in region.cells if eval(cell.condition, {name: x, "sqrt": mpmath.sqrt}))


@pytest.mark.parametrize(
    ("name", "convex", "low", "high"),
    [("limacon", lobed(1), 0, 1), ("two lobes", lobed(2), -1, 1), ("quartic", quartic, Fraction(-19, 10), 20)],
    ids=["limacon", "two lobes", "quartic"],
)
def test_verdicts_are_those_of_the_curvature(name: str, convex: Callable[[Any], bool], low: Any, high: Any) -> None:
    region, draw = found(name), random.Random(7)
    tiny = Fraction(1, 10**12)
    values = [Fraction(draw.uniform(float(low), float(high))).limit_denominator(10**6) for _ in range(12)]
    values += [Fraction(end.value) + way * tiny for end in region.ends for way in (-1, 0, 1) if low <= Fraction(end.value) + way * tiny]
    with mpmath.workdps(50):
        for x in values:
            if low <= x < high:
                assert within(region, x) == ("proved" if convex(mpmath.mpf(x.numerator) / x.denominator) else "refuted"), x


def harmonic(n: int) -> str:
    """r^n cos(n theta) in the forces."""
    x, y = sp.symbols("sigma_a sigma_b", real=True)
    return str(sp.expand(sp.re(sp.expand((x + sp.I * y) ** n))))


@pytest.mark.long
@pytest.mark.parametrize("seed", range(12))
def test_two_harmonics(seed: int) -> None:
    """r = 1 + a cos(n theta) + e cos(m theta) at many e, against r^2 + 2 r'^2 - r r'' at many angles."""
    draw = random.Random(seed)
    n, m = draw.sample([1, 2, 3, 4], 2)
    a, top = Fraction(draw.randrange(-8, 9), 40), max(n, m)
    waves = [f"norm(sigma_a, sigma_b)**{top - k}*({harmonic(k)})" for k in (n, m)]
    g = f"norm(sigma_a, sigma_b)**{top + 1} - norm(sigma_a, sigma_b)**{top} - ({a})*{waves[0]} - e*{waves[1]}"
    high = 1 - abs(a) - Fraction(1, 50)
    law = duhem.Criterion(name="waves", pressure=None, g=g, parameters={"e": duhem.Domain.between(-high, high)})
    done = duhem.region(law, steps=15_000_000)
    assert done.open_share < 0.25 and duhem.recheck(done.certificate()).ok
    theta = np.linspace(0, 2 * np.pi, 20_001)
    for x in (Fraction(draw.randrange(-1000, 1001), 1000) * high for _ in range(300)):
        e, c = float(x), float(a)
        r, one = 1 + c * np.cos(n * theta) + e * np.cos(m * theta), -c * n * np.sin(n * theta) - e * m * np.sin(m * theta)
        least = float(np.min(r**2 + 2 * one**2 + r * (c * n**2 * np.cos(n * theta) + e * m**2 * np.cos(m * theta))))
        verdict = next(cell.leaf["verdict"] for cell in done.known if cell.cell.bounds.holds(x))
        assert not (verdict == "proved" and least < -1e-6) and not (verdict == "refuted" and least > 1e-6), (x, verdict, least)


# -- what is asked -----------------------------------------------------------------------------------------------------


@pytest.mark.long
def test_chords_refute_parts_and_what_is_between_stays_open() -> None:
    """Of a law that is no polynomial of the forces, with a K that is not bounded."""
    law = duhem.Criterion("bow", "sqrt(x**2 + y**2 + 1) - 2 - c*x**2", {"c": duhem.Domain.between(-1, 1)}, ("x", "y"), None)
    done = duhem.region(law, steps=12_000_000)
    assert isinstance(done, duhem.ParameterRegion)
    assert done.short == "c <= 0" and 0 < done.open_share < 0.5 and duhem.recheck(done.certificate()).ok
    chords = [(one.cell, one.leaf["evidence"]) for one in done.known if one.leaf["verdict"] == "refuted"]
    assert chords
    for cell, chord in chords:
        for c in (float(cell.low.low), float(cell.high.low)):
            p, q = (np.array([float(eval(chord[end].get(force, "0"), {"c": c})) for force in ("x", "y")]) for end in ("p", "q"))
            level = [float(np.sqrt(x * x + y * y + 1) - 2 - c * x * x) for x, y in (p, q, (p + q) / 2)]
            assert level[0] <= 0 and level[1] <= 0 < level[2]
    opens = [one.leaf["verdict"] == "open" for one in done.known]
    assert not any(one and two for one, two in pairwise(opens))  # what stays open is one cell


@pytest.mark.long
def test_what_is_not_shown_is_open() -> None:
    odd = duhem.Criterion(name="odd", pressure=None, g="exp(sigma_a**2*sigma_b**2*e) + sigma_a**2 + sigma_b**2 - 2",
                          parameters={"e": duhem.Domain.between(0, 40)})  # fmt: skip
    done = duhem.region(odd, "e", steps=2_000_000)
    assert not done.exact and 0 < done.open_share <= 1
    assert "of the domain are open" in done.sentence
    assert duhem.recheck(done.certificate()).ok


@pytest.mark.parametrize(("end", "share"), [("4", 1 / 4), ("12", 3 / 4), (None, 1 / 4)])
def test_an_open_share_is_one_of_lengths(end: str | None, share: float) -> None:
    """Of a domain without an end after x/(1 + |x|)."""
    zero, three, last = (None if x is None else RealRoot.of(Fraction(x)) for x in ("0", "3", end))
    cells = Decided(ParameterCell(zero, three), {"verdict": "proved"}), Decided(ParameterCell(three, last, True), OPEN)
    assert replace(found("limacon"), known=cells, everything=ParameterCell(zero, last)).open_share == share


def test_a_single_value_and_no_value_are_told_shortly() -> None:
    any_, form = duhem.Domain(), "sigma_a**2 + {}*sigma_a*sigma_b + sigma_b**2 - {}"
    one = duhem.region(duhem.Criterion(name="one", pressure=None, g=form.format("(2 + e**2)", 1), parameters={"e": any_}))
    assert one.sentence == "convexity holds exactly for e = 0" and one.condition == "e == 0"
    none = duhem.Criterion(name="none", pressure=None, g=form.format("(3 + e)", "mu**2"),
                           parameters={"e": duhem.Domain.between(0, 1), "mu": duhem.POSITIVE})  # fmt: skip
    assert duhem.region(none).sentence == "convexity holds for no value of the domain"


def test_what_is_published_is_said_of_the_law_of_the_atlas_alone() -> None:
    own = found("argyris")
    other = replace(own, criterion=replace(own.criterion, summary="another law of this name"))
    assert "published  for K >= 7/9" in text(own) and "published" not in text(other)


def test_the_origin_has_a_region() -> None:
    law = duhem.Criterion(name="apart", pressure=None, g="norm(sigma_a - m, sigma_b) - 1", parameters={"m": duhem.REAL})
    done = duhem.region(law, claim="origin")
    assert done.exact and done.condition == "-1 <= m and m <= 1"
    assert duhem.region(law).condition == "true"


def test_several_surfaces_are_the_greatest_of_them(tmp_path: Any) -> None:
    (tmp_path / "two.toml").write_text(
        '[criterion]\nname = "two"\nforces = ["x", "y"]\npressure = false\n[[surface]]\ng = "x**2 + e*x*y + y**2 - 1"\n'
        '[[surface]]\ng = "x - 1/2"\n[parameters]\ne = { min = -3, max = 3 }\n'
    )
    done = duhem.region(tmp_path / "two.toml")
    assert done.sentence == "convexity holds exactly for e >= -2 and e <= 2" and duhem.recheck(done.certificate()).ok


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ({"law": "limacon", "parameters": ()}, "no parameter is free"),
        ({"law": "limacon", "parameters": ("e", "e")}, "a parameter is named twice"),
        ({"law": "limacon", "parameters": "f"}, "unknown parameter 'f'"),
        ({"law": "limacon", "claim": "beauty"}, "regions are not known of the claim"),
        ({"law": "limacon", "over": {"e": "1"}}, "this is no range"),
        ({"law": "limacon", "over": {"e": "1/3:1/3"}}, "a range has two different ends"),
        ({"law": "limacon", "over": {"e": "0:a"}}, "--over e=0:a: 'a' is not a number"),
        ({"law": "limacon", "over": {"e": (1, 0)}}, "over e: the domain .* is empty"),
        ({"law": "willam-warnke", "parameters": "e"}, "e is fixed at 3/5"),
    ],
)
def test_errors_say_what_is_wrong(asked: dict[str, Any], said: str) -> None:
    with pytest.raises(duhem.InputError, match=said):
        duhem.region(**asked)


def test_the_command_prints_and_writes(tmp_path: Any) -> None:
    file = tmp_path / "e.json"
    done = CliRunner().invoke(cli, ["region", "limacon", "e", "--set", "mu=1/3", "--certificate", str(file)])
    assert done.exit_code == 0 and "convexity holds exactly for e <= 1/2." in done.output
    checked = CliRunner().invoke(cli, ["recheck", str(file)])
    assert checked.exit_code == 0 and "confirmed: 2 of 2 cells" in checked.output
    told = json.loads(CliRunner().invoke(cli, ["region", "limacon", "--format", "json"]).output)
    assert told == found("limacon").to_dict()
    assert CliRunner().invoke(cli, ["region", "limacon", "--format", "latex"]).output == "0 \\leq e \\leq \\frac{1}{2}\n"


def test_verify_ends_with_the_region() -> None:
    done = CliRunner().invoke(cli, ["verify", "limacon", "--claims", "convexity"])
    assert done.output.endswith("For which parameters\n  convexity holds exactly for e <= 1/2\n")


def test_the_command_that_finds_more_is_of_the_same_law_and_said_where_some_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = duhem.load("limacon").fix({"mu": "1/3"})
    for steps, open_share, said in (
        (1, None, " is open: 1 steps decide no range of values"),
        (1, 0.5, ": duhem region limacon --set mu=1/3 e"),
    ):
        monkeypatch.setattr(entry, "_STEPS_OF_A_SENTENCE", steps)
        if open_share is not None:
            half = SimpleNamespace(exact=False, open_share=open_share)
            monkeypatch.setattr(entry, "region", lambda *_, half=half, **__: half)
        told = entry.told(asked, "convexity", "limacon --set mu=1/3")
        assert told.startswith("for which e convexity holds" + said)


def test_what_goes_wrong_beside_the_verdicts_leaves_them_as_they_are(monkeypatch: pytest.MonkeyPatch, tmp_path: Any) -> None:
    def wrong(*_: Any, **__: Any) -> None:
        raise RuntimeError

    monkeypatch.setattr(entry, "region", wrong)
    done = CliRunner().invoke(cli, ["verify", "limacon", "--claims", "convexity", "--certificate", str(tmp_path / "e.json")])
    assert done.exception is None and "refuted" in done.output and (tmp_path / "e.json").exists()


def test_a_picture_is_drawn(tmp_path: Any) -> None:
    pytest.importorskip("matplotlib")
    (axes,) = found("quartic").plot(tmp_path / "c.svg")
    assert (tmp_path / "c.svg").stat().st_size > 1000
    assert [words.get_text() for words in axes.texts] == ["$c = 0$", "$c = 6$"]


# -- constraints that relate the parameter to another ------------------------------------------------------------------


def related(*constraints: str, high: Any = 5) -> duhem.Criterion:
    parameters = {"e": duhem.Domain.between(0, high), "m": duhem.Domain.between(0, 1)}
    g = "sigma_a**2 + e*sigma_a*sigma_b + sigma_b**2 - 1"
    return duhem.Criterion(name="related", pressure=None, g=g, parameters=parameters, constraints=constraints)


@pytest.mark.parametrize("constraint", ["e <= m", "m**2 + e <= 1", "e**2 + m <= 1"])
def test_a_region_says_where_there_may_be_no_law(constraint: str) -> None:
    """For e > 1 no m is admitted, and the claim would hold of nothing."""
    assert f"as far as other parameters exist with {constraint}" in duhem.region(related(constraint, high=2), "e").sentence
    assert "as far as" not in duhem.region(related("e*m <= 5"), "e").sentence


@pytest.mark.parametrize("constraint", ["e <= m", "m**2 + e <= 1", "m**2 + (e - 1)**2 <= 1"])
def test_a_witness_is_of_a_law_that_exists(constraint: str) -> None:
    """A line that leaves K for e > 2 refutes nothing where the constraint leaves no m, or where m is not given."""
    document = duhem.region(related(), "e").certificate()
    assert duhem.recheck(document).ok
    held, fails = document["tree"]["holds"], document["tree"]["fails"]
    assert (held["verdict"], fails["verdict"]) == ("proved", "refuted")
    document["law"]["constraints"] = [constraint]
    document["inhabited"] = {"e": "1/2", "m": "1/2"}
    for values in ({}, {"m": "1"}, {"m": "0"}):
        fails["evidence"]["values"] = values
        document["sha256"] = digest(document)
        assert not duhem.recheck(document).ok


# -- certificates ------------------------------------------------------------------------------------------------------


ENDS: dict[str, tuple[Any, Any, int]] = {
    "limacon": (0, mpmath.mpf(1) / 2, 1),
    "quartic": (0, 6, 20),
    "two lobes": (-mpmath.mpf(1) / 5, mpmath.mpf(1) / 5, 1),
    "cazacu barlat": (-3 * mpmath.sqrt(3) / 4, 3 * mpmath.sqrt(3) / 4, 2),
}


@pytest.mark.parametrize("name", ["limacon", *mostly_long(["quartic", "two lobes", "cazacu barlat"])])
def test_no_tampered_certificate_confirms_a_false_region(name: str) -> None:
    document, draw, (low, high, far) = found(name).certificate(), random.Random(3), ENDS[name]
    values = [mpmath.mpf(draw.randrange(-1000, 1001)) * far / 1000 for _ in range(200)]
    values += [mpmath.mpf(float(end)) + mpmath.mpf(way) / n for end in (low, high) for way in (-1, 1) for n in (10**3, 10**5)]
    for _ in range(60 if name == "limacon" else 400):
        try:
            done = duhem.recheck(tampered(document, draw))
        except duhem.InputError:
            continue
        assert isinstance(done, RecheckedRegion)
        for row in done.cells:
            if not row.reason and row.verdict != "open":
                said = row.said.replace("everywhere", "True")
                there = [x for x in values if eval(said, {done.parameter: x, "sqrt": mpmath.sqrt})]
                assert all((low <= x <= high) is (row.verdict == "proved") for x in there), row


def test_cells_are_within_the_domain_whatever_a_certificate_says() -> None:
    made = json.loads(json.dumps(found("limacon").certificate()))
    made["tree"]["split"] = "e <= -37/3"
    made["sha256"] = digest(made)
    done = duhem.recheck(made)
    assert isinstance(done, RecheckedRegion) and len(done.failed) == 2 and all("e >= 0" in cell.said for cell in done.cells[1:])


@pytest.mark.parametrize(
    ("x", "found"),
    [
        ("1/3", False),
        ("37/50", False),
        ("-2", False),
        ("0.3535533905932738", True),
        ("1.618033988749895", True),
    ],
)
def test_the_root_of_a_short_quadratic_is_none_of_a_fraction(x: str, found: bool) -> None:
    near = Fraction(x)
    assert (square_root_near(near - Fraction(1, 10**9), near + Fraction(1, 10**9)) is not None) is found


@pytest.mark.long
def test_stretches_that_are_seen_are_asked_by_themselves_before_gaps_are_halved() -> None:
    """Of the matchstick nothing is proved while its scale is free: that is seen without halving gaps, and without whole verifications."""
    asked = Asked(duhem.load("matchstick"), "convexity", ("mu_a",))
    assert [one.leaf["verdict"] for one in cells_of(asked)] == ["refuted", "open", "refuted"]
    assert asked.verifications == 0 and asked.steps < 10_000_000
