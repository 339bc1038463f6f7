"""What is known of the built-in laws, independently of duhem: the answers its verdicts are measured against.

``KNOWN`` holds, law by law, the verdicts over the whole declared domain.  Left out is what no theorem settles without
a convention: normality of a law whose K is not convex over its domain (it depends on which normal cone is meant) and
duality of a law with a flow of its own.

``THRESHOLDS`` holds verdicts with some parameters fixed, at a known threshold and just beside it; the others stay
free.  ``LOBES`` does so for the family ``lobe_law(n)``: (n, e, convexity).  ``OUTSIDE`` holds values that the domain
admits and the constraints exclude, where the law loses the property its constraint protects.

Numbers are exact, as text.  Each threshold was confirmed by the least level-set curvature of the boundary in 60
digits, from formulas written by hand in polar form: zero at the threshold, of the order of -1e-6 or less beyond it.
"""

from __future__ import annotations

from duhem.proof.verdict import Verdict

__all__ = ["CLAIMS", "KNOWN", "LOBES", "OUTSIDE", "THRESHOLDS"]

PROVED, REFUTED, NONE = Verdict.PROVED, Verdict.REFUTED, Verdict.NOT_APPLICABLE

CLAIMS = ("origin", "convexity", "smoothness", "normality", "dissipation", "duality", "state_laws")

_STANDARD = dict.fromkeys(CLAIMS, PROVED)
_CORNERS = {**_STANDARD, "smoothness": REFUTED}
_NO_CLOSED_POLAR = {**_STANDARD, "duality": NONE}
_STAR_SHAPED = {claim: verdict for claim, verdict in _NO_CLOSED_POLAR.items() if claim != "normality"} | {"convexity": REFUTED}
_OWN_FLOW = {claim: verdict for claim, verdict in _STANDARD.items() if claim != "duality"} | {"normality": REFUTED}

KNOWN: dict[str, dict[str, Verdict]] = {
    "antoni2007": _STANDARD,
    "antoni2007-1d": _STANDARD,
    "box": _CORNERS,
    "capped": _STANDARD,
    "cohesive": _STANDARD,
    "coulomb": _STANDARD,
    "drucker1949": _STAR_SHAPED,
    "hosford": _NO_CLOSED_POLAR,
    "limacon": _STAR_SHAPED,
    "lobes": _STAR_SHAPED,
    "matchstick": _STAR_SHAPED,
    "orthotropic": _STANDARD,
    "polygon": _CORNERS,
    "quartic": _STAR_SHAPED,
    "radial-flow": _OWN_FLOW,
    "regularised": _STANDARD,
    "rotated-flow": _OWN_FLOW,
    "shifted-ellipse": _STANDARD,
    "superellipse": _STANDARD,
    "tresca": _CORNERS,
    "von-mises": _STANDARD,
}

THRESHOLDS: list[tuple[str, dict[str, str], str, Verdict]] = [
    # convex if and only if e <= 1/2
    ("limacon", {"e": "0"}, "convexity", PROVED),
    ("limacon", {"e": "1/2"}, "convexity", PROVED),
    ("limacon", {"e": "0.500001"}, "convexity", REFUTED),
    ("limacon", {"e": "99/100"}, "convexity", REFUTED),
    ("limacon", {"e": "99/100"}, "smoothness", PROVED),
    # convex if and only if |e| <= 1/10
    ("lobes", {"e": "1/10"}, "convexity", PROVED),
    ("lobes", {"e": "0.100001"}, "convexity", REFUTED),
    ("lobes", {"e": "-1/10"}, "convexity", PROVED),
    ("lobes", {"e": "-0.100001"}, "convexity", REFUTED),
    # convex if and only if the squares of the coefficients are within a factor of 2
    ("matchstick", {"mu_a": "1", "mu_b": "1.41421"}, "convexity", PROVED),
    ("matchstick", {"mu_a": "1", "mu_b": "1.41422"}, "convexity", REFUTED),
    ("matchstick", {"mu_a": "1.41421", "mu_b": "1"}, "convexity", PROVED),
    ("matchstick", {"mu_a": "1.41422", "mu_b": "1"}, "convexity", REFUTED),
    # convex if and only if 0 <= c <= 6
    ("quartic", {"c": "6"}, "convexity", PROVED),
    ("quartic", {"c": "6.000001"}, "convexity", REFUTED),
    ("quartic", {"c": "2"}, "convexity", PROVED),
    ("quartic", {"c": "0"}, "convexity", PROVED),
    ("quartic", {"c": "-0.000001"}, "convexity", REFUTED),
    # convex if and only if -27/8 <= c <= 9/4
    ("drucker1949", {"c": "9/4"}, "convexity", PROVED),
    ("drucker1949", {"c": "2.250001"}, "convexity", REFUTED),
    ("drucker1949", {"c": "0"}, "convexity", PROVED),
    ("drucker1949", {"c": "-27/8"}, "convexity", PROVED),
    ("drucker1949", {"c": "-3.375001"}, "convexity", REFUTED),
    # p-norms: curvature zero (p > 2) or infinite (p < 2) on the axes
    ("superellipse", {"p": "3/2"}, "convexity", PROVED),
    ("superellipse", {"p": "2"}, "convexity", PROVED),
    ("superellipse", {"p": "4"}, "convexity", PROVED),
    ("superellipse", {"p": "4"}, "smoothness", PROVED),
    ("superellipse", {"p": "3/2"}, "smoothness", PROVED),
    ("hosford", {"m": "4"}, "convexity", PROVED),
    # flows that meet the normality rule at one value only
    ("radial-flow", {"mu_a": "1/5", "mu_b": "1/5"}, "normality", PROVED),
    ("radial-flow", {"mu_a": "0.2", "mu_b": "0.200001"}, "normality", REFUTED),
    ("rotated-flow", {"delta": "0"}, "normality", PROVED),
    ("rotated-flow", {"delta": "0.000001"}, "normality", REFUTED),
    ("rotated-flow", {"delta": "3/2"}, "dissipation", PROVED),
    # strongly asymmetric, still a standard law
    ("antoni2007", {"mu_a_plus": "1000", "mu_a_minus": "1/1000"}, "convexity", PROVED),
    ("shifted-ellipse", {"mu_a": "1/5", "shift": "0.199999"}, "origin", PROVED),
    ("shifted-ellipse", {"mu_a": "1/5", "shift": "0.199999"}, "dissipation", PROVED),
]

LOBES: list[tuple[int, str, Verdict]] = [
    (1, "1/2", PROVED),
    (1, "0.500001", REFUTED),
    (2, "1/5", PROVED),
    (2, "0.200001", REFUTED),
    (4, "1/17", PROVED),
    (4, "-1/17", PROVED),
    (4, "0.058825", REFUTED),
    (5, "1/26", PROVED),
    (5, "0.038463", REFUTED),
]

OUTSIDE: list[tuple[str, dict[str, str]]] = [
    ("superellipse", {"p": "1"}),  # diamond: corners
    ("hosford", {"m": "1"}),  # hexagon: corners
    ("limacon", {"e": "1"}),  # cardioid: a cusp at the origin
    ("lobes", {"e": "-1"}),  # three loops that meet at the origin
    ("quartic", {"c": "-2"}),  # two crossing strips: unbounded
    ("drucker1949", {"c": "27/4"}),  # unbounded section
    ("shifted-ellipse", {"mu_a": "1/5", "shift": "1/5"}),  # origin on the boundary
]
