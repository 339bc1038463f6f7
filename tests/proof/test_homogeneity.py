"""Dissipation by Euler's relation alone, and signs of what holds exponentials; beside each what is almost so and false."""

from contextlib import suppress
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from duhem import Criterion, Domain, InputError, verify
from duhem.expression.numpy_ import compiled
from duhem.proof.certificate import law_as_text
from duhem.proof.kernel.bounds import NEGATIVE
from duhem.proof.kernel.bounds import POSITIVE as POSITIVE_SIGN
from duhem.proof.kernel.certificate import stated
from duhem.proof.kernel.claims import objection
from duhem.proof.kernel.curvature import over, within_ranges
from duhem.proof.kernel.steps import TooDearError, within
from duhem.proof.kernel.term import parse
from duhem.proof.verdict import Trust, Verdict
from tests.long import long_but
from tests.oracles.prover import degrees
from tests.oracles.prover.decide import AskedSubject

POSITIVE = Domain(positive=True)


def law(g, forces=("a", "b", "c"), pressure=None, **parameters):
    return Criterion("law", g, parameters, forces=forces, pressure=pressure)


def checked(one):
    return objection("dissipation", "homogeneity", frozenset(), stated(law_as_text(one)), {}) == ""


@pytest.mark.parametrize(
    "g",
    [
        "a**4 - 5*a**2*b**2 + b**4 + c**4 - 1",  # K is not convex and has no end
        "a**6 + b**2 + c**4 - k",  # of three degrees
        "max(abs(a) - 2*b, norm(b, c) - a) - k",
        "(a**2 + b**2 + c**2)**(3/2) + a*b*c - k",
    ],
)
def test_what_rises_outward_by_its_degrees(g):
    one = law(g, k=POSITIVE)
    found = degrees.dissipation(AskedSubject(one))
    assert found is not None and found.verdict is Verdict.PROVED and checked(one)


@pytest.mark.parametrize("g", ["(a**2 + b**2 + c**2)**2 - norm(a, b, c)", "a**2 + b**2 + c**2 - a"])
def test_at_zero_force_the_power_is_zero_anyway(g):
    assert degrees.dissipation(AskedSubject(law(g))) is not None


@pytest.mark.parametrize(
    "one",
    [
        law("a**2 + b**2 + c**2 - 3*a + 2"),  # 0 is outside
        law("a**2 - b**2 + c**2 - a"),  # so do A and B
        law("norm(a, b, c) - exp(a)"),  # of no degree
        Criterion("law", "norm(a, b, c) - 1", {}, forces=("a", "b", "c"), pressure=None, flow=("-a", "-b", "-c")),
    ],
)
def test_what_only_looks_so(one):
    assert degrees.dissipation(AskedSubject(one)) is None and not checked(one)


LOADED = "norm(a, b) - k*(1 - exp(-m*abs(sigma_n)/k))"


def load(g, m=POSITIVE):
    return law(g, ("a", "b"), "sigma_n", k=POSITIVE, m=m)


def test_an_exponential_lies_on_one_side_of_1():
    found = verify(load(LOADED), claims=["origin", "smoothness", "dissipation"])
    assert [(r.verdict, r.trust) for r in found.results] == [(Verdict.PROVED, Trust.CHECKED)] * 3


@pytest.mark.parametrize(
    "one",
    long_but(
        [0, 2],
        [
            load(LOADED.replace("exp(-m", "exp(m")),
            load(LOADED.replace("(1 -", "(1/2 -")),
            load(LOADED.replace("(1 -", "(999/1000 -")),
            load(LOADED, Domain.between(-1, 1)),
        ],
    ),
)
def test_nothing_of_an_exponential_is_proved_beyond_that(one):
    assert verify(one, claims=["origin"])["origin"].verdict is not Verdict.PROVED


@pytest.mark.slow
def test_where_the_exponent_may_be_0_the_tip_may_be_on_the_boundary():
    found = verify(load(LOADED, Domain.between(0, Fraction(1))), claims=["origin", "smoothness"])
    assert found["origin"].verdict is Verdict.PROVED and found["smoothness"].verdict is not Verdict.PROVED


CONE = "max(-a, -b, -c, (a + b + c)*(a*b + b*c + c*a) - k*a*b*c)"  # Matsuoka, Nakai (1974)


@pytest.mark.parametrize(
    "g", [CONE, "max(-a, a**2 - b**2, k*c*norm(a, b))", "abs(a) - k*norm(b, c)", "max(a**3, min(b, -c**2))", "(a*b*c)**3"]
)
def test_the_normals_of_a_cone_are_across_the_force(g):
    one = law(g, k=POSITIVE)
    found = degrees.dissipation(AskedSubject(one))
    assert found is not None and found.verdict is Verdict.PROVED and checked(one)


@pytest.mark.parametrize(
    "one",
    [
        law("max(-a, -b, -c, (a + b + c)*(a*b + b*c + c*a) - k*a*b*c - a)", k=POSITIVE),
        law("max(-a, -b - k, c)", k=POSITIVE),  # its tip is elsewhere
        law("max(a + b**2, -c)"),
        law("where(a > 1, a**2 - b**2, a**2 - 2*b**2)"),
        law("a**2*b + a*b*p", forces=("a", "b"), pressure="p"),
        Criterion("law", "abs(a) - norm(b, c)", {}, forces=("a", "b", "c"), pressure=None, flow=("-a", "-b", "-c")),
    ],
)
def test_what_only_looks_like_a_cone(one):
    assert degrees.dissipation(AskedSubject(one)) is None and not checked(one)


# -- parts without a value on a cone -------------------------------------------------------------------------------------

J2 = "(((a - b)**2 + (b - c)**2 + (c - a)**2)/6)"
J3 = "((2*a - b - c)*(2*b - c - a)*(2*c - a - b)/27)"
LODE = f"(3*sqrt(3)/2*{J3}/{J2}**(3/2))"
ROUND = f"3*{J2}/k*(1 - 27/32*{J3}**2/{J2}**3) + 7/8*(m - 1)*(a + b + c) - 7/8*m*k"
SECTION = f"(sqrt(1 + q) - sqrt(1 - q))*e/(e*sqrt(1 + q) - sqrt(1 - q) + (1 - e)*sqrt(1 + q*{LODE}))"
BICUBIC = f"((27*{J2}**3 + q*27/2*{J3}*(3*{J2})**(3/2))/(1 + q))**(1/6) + m*(a + b + c) - k"
CAPPED = f"{J2} - (a + b + c)**2*(m + k*(a + b + c))/sqrt(1 + e*{LODE})"
COMPRESSED = dict.fromkeys("abc", Domain.between(None, 0))
WORDS = {"abs": np.abs, "norm": lambda *x: np.sqrt(sum(y**2 for y in x)), "sqrt": np.sqrt, "pos": lambda x: np.maximum(x, 0)}
UNIT = Domain.between(0, 1)
CONE = {"e": Domain.between("3/5", 1), "q": Domain.fixed("99/100"), "m": POSITIVE}
VALUES = {"k": 1.0, "m": 0.5, "e": 0.6, "q": 0.99}


def falls(g, values, ranges):
    """Whether g, in floats, is > 0 and then < 0 along a ray, some rays being near the axis and near planes on which forces are 0."""
    rng = np.random.default_rng(7)
    ways = rng.normal(size=(900, 3))
    ways[:300] = rng.choice([-1.0, 1.0], size=(300, 1)) + ways[:300] * 10.0 ** rng.uniform(-4, 0, size=(300, 1))
    ways[300:500] = rng.integers(-2, 3, size=(200, 3)) + 1e-4 * ways[300:500]
    points = (-np.abs(ways) if ranges else ways)[:, None, :] * np.geomspace(1e-3, 1e3, 500)[:, None]
    with np.errstate(all="ignore"):
        level = eval(g, {**WORDS, **values}, dict(zip("abc", np.moveaxis(points, -1, 0), strict=True)))
    level = np.where(np.isfinite(level), level, 0)
    small = 1e-7 * np.maximum.accumulate(np.abs(level), axis=1)
    above = np.maximum.accumulate(level > small, axis=1)
    return bool(np.any(above & (level < -small)))


def asked(g, ranges, **parameters):
    with suppress(TooDearError), within(2_000_000):
        return checked(Criterion("law", g, parameters, forces=("a", "b", "c"), pressure=None, domain=ranges))
    return False


STARS = [
    (ROUND, {"k": POSITIVE, "m": Domain.between(1, "8/5")}, {}),  # Ghorbel (2008): 0/0 on the axis, which the boundary meets
    (f"(m*(a + b + c)**6 + 27*{J2}**3 + q*{J3}**2)**(1/6) - k", {"m": UNIT, "q": Domain.between(-182, 60), "k": POSITIVE}, {}),
    (BICUBIC, {"q": Domain.between("-3/10", 1), "m": UNIT, "k": POSITIVE}, {}),  # Altenbach, Bolchoun, Kolupaev (2014)
    (f"sqrt(3*{J2}) - m*{SECTION}*(k - (a + b + c)/3)", CONE | {"k": POSITIVE}, {}),  # Jiang (1988)
    (CAPPED, {"m": POSITIVE, "k": POSITIVE, "e": Domain.between(0, "3/4")}, COMPRESSED),  # as of Desai (1986): no value on the axis
    ("a**4 - 5*a**2*b**2 + b**4 + c**4 - k", {"k": UNIT}, {}),  # a cone for k = 0
    ("(a**2 + b**2 + c**2)**2 - m*a**2", {"m": UNIT}, {}),  # grad g = 0 at zero force
    ("norm(a, b, c) + a**2/abs(b) - k", {"k": POSITIVE}, {}),
    ("abs(a)/abs(a) + b**2 + c**2 - k", {"k": POSITIVE}, {}),  # K has no point with a = 0: its normals there are across it
]  # fmt: skip
NO_STARS = [  # and values with which g falls
    (ROUND, {"k": POSITIVE, "m": Domain.between(-2, 1)}, {}, {"k": 1.0, "m": -1.9}),
    (ROUND.replace("27/32", "27/4*(1 + m)"), {"k": POSITIVE, "m": UNIT}, {}, {"k": 1.0, "m": 0.2}),
    (BICUBIC, {"q": UNIT, "m": UNIT, "k": Domain.between(-1, 1)}, {}, {"q": 0.5, "m": 1.0, "k": -1.0}),
    (f"sqrt(3*{J2}) - m*{SECTION}*(k - (a + b + c)/3)", CONE | {"k": Domain.between(-1, 1)}, {}, VALUES | {"k": -1.0}),
    (CAPPED, {"m": POSITIVE, "k": POSITIVE, "e": Domain.between(0, "3/4")}, {}, VALUES),  # in tension g falls again
    ("a**4 - 5*a**2*b**2 + b**4 + c**4 - k", {"k": Domain.between(-1, 1)}, {}, {"k": -1.0}),
    ("(a**2 + b**2 + c**2)**2 - m*a**2 + (1 - m)/40", {"m": UNIT}, {}, {"m": 0.8}),
    ("k - norm(a, b, c) + a**2/abs(b)", {"k": POSITIVE}, {}, VALUES),
]  # fmt: skip


@pytest.mark.parametrize(("g", "parameters", "ranges"), STARS)
def test_rays_without_a_value_are_left_out(g, parameters, ranges):
    assert asked(g, ranges, **parameters)
    assert not falls(g, VALUES, ranges) and not falls(g, VALUES | {"k": 0.1, "m": 1.0}, ranges)


@pytest.mark.parametrize(("g", "parameters", "ranges", "values"), NO_STARS)
def test_a_g_that_falls_along_some_ray_is_not_shown_to_dissipate(g, parameters, ranges, values):
    assert not asked(g, ranges, **parameters)
    assert falls(g, values, ranges)


@pytest.mark.parametrize("part", ["abs(a - 1)/abs(a - 1)", "abs(a + b - m)/abs(a + b - m)", "norm(a, c - k)/norm(a, c - k)"])
@pytest.mark.parametrize("g", ["norm(a, b, c) + part - k - 3", f"sqrt({J2})*(1 + part) + a + b + c - k", "(a**2 + b**2)*part + c**4 - k"])
def test_a_plane_or_a_line_beside_0_without_a_value_is_an_end_of_k(g, part):
    """Beside {a = 1} K has the normals +a and -a, of which one has a power < 0; what is 0 on a cone is left out as before."""
    known = {"k": POSITIVE, "m": POSITIVE}
    assert not asked(g.replace("part", f"({part})"), {}, **known)
    at_zero = part.replace(" - 1", "").replace(" - m", "").replace(" - k", "")
    assert asked(g.replace("part", f"({at_zero})"), {}, **known)


_TERM = st.sampled_from([
    LODE, "abs(a)/abs(a)", f"a**2/{J2}", "a", "norm(a, b)", f"sqrt({J2})", "pos(b)", "a**2/abs(b)", f"{J3}/{J2}", "a**2", J2, "a*b",
    f"{J2}*(1 - 27/32*{J3}**2/{J2}**3)", f"sqrt({J2})*(a + b + c)",
])  # fmt: skip
_SCALE = st.sampled_from(["m*", "-m*", "e*", "-e*", "(1 - e)*", "q*", ""])  # 0 and both signs among them


@pytest.mark.long
@settings(max_examples=12, deadline=None, derandomize=True)
@given(
    terms=st.lists(st.tuples(_SCALE, _TERM, st.sampled_from(["", f"*(1 + e*{LODE}/2)"])), min_size=1, max_size=3),
    end=st.sampled_from(["- k", "- e", "+ q", "- 1"]),
)
def test_of_drawn_sums_none_that_falls_is_shown_to_dissipate(terms, end):
    g = " + ".join(f"{scale}{part}{factor}" for scale, part, factor in terms) + f" {end}"
    with suppress(InputError):  # no force is left
        if asked(g, {}, m=POSITIVE, k=POSITIVE, e=UNIT, q=Domain.between(-1, 1)):
            drawn = [{"m": 1.0, "k": 1.0, "e": e, "q": q} for e in (0.0, 0.5, 1.0) for q in (-1.0, 0.0, 1.0)]
            assert not any(falls(g, values, {}) for values in drawn)


def joint(height, **parameters):
    """|t| <= F(s) for s >= 0, as of a rock joint."""
    return Criterion("joint", f"abs(t) - ({height})", parameters, forces=("s", "t"), pressure=None, domain={"s": Domain.between(0)})


SMALL = Domain.between("1/10", "3/5")


@pytest.mark.parametrize(
    ("height", "parameters"),
    [
        ("s*m*(1 + exp(-k*s))", {"m": POSITIVE, "k": POSITIVE}),  # not concave
        ("s*tan(m + d/(1 + s/k))", {"m": SMALL, "d": SMALL, "k": POSITIVE}),
        ("s*(m + d*tanh(k/(1 + s)))", {"m": SMALL, "d": SMALL, "k": POSITIVE}),
        ("c + s*m*exp(-k*s)", {"c": POSITIVE, "m": SMALL, "k": POSITIVE}),
    ],
)
def test_what_rises_outward_by_its_gradient(height, parameters):
    """Power is 0 at the force itself, F - s F' times a size, which a second way sees to be >= 0."""
    one = joint(height, **parameters)
    assert checked(one)
    assert powers(one).min() >= -1e-12


@pytest.mark.parametrize(
    "height",
    ["s*exp(s/3)", "s*(1 + tanh(s - 2))", "s*tan(1 - 3/5*exp(-s))", "s*(2 + sin(s))", "s*(1 + s/(1 + s)) - 1", "s/2 + s**2*exp(-s)"],
)
def test_what_does_not_rise_by_its_gradient_everywhere(height):
    one = joint(height)
    assert powers(one).min() < 0 and not checked(one)


def powers(one):
    """F - s F' at drawn parameters and many s."""
    rng, (s, t) = np.random.default_rng(7), one.force_symbols()
    height = -one.g.subs(t, 0)
    rows = [[rng.uniform(float(d.low or 0) + 1e-3 * d.positive, float(d.high or 3)) for d in one.parameters.values()] for _ in range(40)]
    run = compiled(height - s * sp.diff(height, s), [s, *(x for name, x in one.symbols().items() if name in one.parameters)])
    return np.broadcast_to(run(np.geomspace(1e-3, 50, 200)[:, None], *np.array(rows).T), (200, 40))


@pytest.mark.parametrize("seed", range(40))
def test_of_drawn_joints_none_that_falls_is_shown_to_dissipate(seed):
    rng = np.random.default_rng(seed)
    word = str(rng.choice(["exp({})", "tanh({})", "atan({})", "1/(1 + {}**2)", "sqrt(1 + {}**2)", "log(2 + {}**2)", "cos({})"]))
    a, b, k = (Fraction(int(rng.integers(-9, 10)), 6) for _ in range(3))
    one = joint(f"s*({a} + ({b})*{word.format(f'({k})*s')}) + {abs(b)}/2")
    assert not (checked(one) and powers(one).min() < -1e-6)


def test_words_that_rise_tell_the_sign_of_a_difference():
    """Of c f(x) - c f(y) by the order of x and y; of tan only where both are less than a right angle."""
    read = stated(law_as_text(joint("s", m=SMALL, d=SMALL, k=POSITIVE)))
    inside, whole = within_ranges(read), over(read)
    for text in (
        "atan(m + s) - atan(s)",
        "s*tanh(s + k) - s*tanh(s)",
        "k*atan(s) - k*atan(s - m)",
        "tan(m + d*exp(-k*s)) - tan(d*exp(-k*s))",
    ):
        assert not inside.facts(parse(text)).sign & NEGATIVE
    for text in (
        "atan(m + s) - atan(2*s)",
        "tan(m + s) - tan(s)",
        "sin(m + s) - sin(s)",
        "t*atan(m + s) - t*atan(s)",
        "abs(t + m) - abs(t)",
    ):
        assert inside.facts(parse(text)).sign & NEGATIVE
    for text, holds in (("1 - m/(1 + s)", True), ("3/2 - m - m/(1 + s/k)", True), ("1/2 - m/(1 + s)", False)):
        assert (inside.facts(parse(text)).sign == POSITIVE_SIGN) is holds
        assert whole.facts(parse(text)).sign & NEGATIVE  # s < -1
