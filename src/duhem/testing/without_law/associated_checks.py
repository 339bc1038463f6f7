"""What only associated laws without hardening satisfy, asked for by name: a good routine of another law may fail these."""

from __future__ import annotations

import numpy as np

from duhem.testing.checks import routine_checks
from duhem.testing.checks.query import NothingToCheck
from duhem.testing.checks.registry import Finding
from duhem.testing.without_law.history import HistoryQuery
from duhem.testing.without_law.registry import register

__all__: list[str] = []

_EPS = float(np.finfo(np.float64).eps)
_MOREAU = "Moreau (1965), Bull. Soc. Math. France 93, 273-299"


@register(
    "associated-symmetry",
    statement="of an associated law, with hardening or without: the consistent tangent is symmetric",
    formula="C = C^T",
    source="Simo and Taylor (1985), Comput. Methods Appl. Mech. Eng. 48, 101-118",
    tolerance="d^2 (accuracy + 8 eps), in the metric of k",
    demanded=False,
)
def symmetry(h: HistoryQuery) -> Finding:
    given = h.here.tangent
    if given is None:
        raise NothingToCheck("the routine returns no tangent")
    c, d = h.whitened(given), given.shape[1]
    return Finding(np.abs(c - np.swapaxes(c, 1, 2)).max(axis=(1, 2)), np.full(len(c), d * d * (h.accuracy + 8.0 * _EPS)))


@register(
    "associated-non-expansiveness",
    statement="of an associated law without hardening: two stresses come no farther apart",
    formula="|P(x) - P(y)| <= |x - y|",
    source=_MOREAU,
    tolerance="u + u' + 8 eps |x - y|",
    demanded=False,
    again=True,
)
def non_expansiveness(h: HistoryQuery) -> Finding:
    return routine_checks.non_expansiveness(h)


@register(
    "associated-potential",
    statement="of an associated law without hardening: the step derives from a potential",
    formula="sum over a cycle x_1, x_2, x_3 of P(x_i) . k^-1 (x_i+1 - x_i) <= 0",
    source="Rockafellar (1970), Convex Analysis, Theorem 24.8; P = grad(|x|^2 - dist^2)/2",
    tolerance="sum of (u_i + 8 eps |P(x_i)|) |x_i+1 - x_i|",
    demanded=False,
    again=True,
)
def potential(h: HistoryQuery) -> Finding:
    return routine_checks.potential(h)


@register(
    "associated-ray",
    statement="of an associated law without hardening: a longer or shorter slip in the same direction ends at the same stress",
    formula="P(sigma + t (sigma_tr - sigma)) = sigma for all t >= 0",
    source=_MOREAU,
    tolerance="u (1 + |1 - t|) + u'",
    demanded=False,
    again=True,
)
def ray(h: HistoryQuery) -> Finding:
    return routine_checks.ray(h)


@register(
    "isotropic-plastic-work",
    statement="without kinematic hardening: what slips does so along the stress",
    formula="sigma . (du - k^-1 d sigma) >= 0",
    source="Drucker (1951), Proc. First US Natl. Congr. Appl. Mech., 487-491",
    tolerance="2 u (|sigma| + |k du|)",
    demanded=False,
)
def plastic_work(h: HistoryQuery) -> Finding:
    before, after = h.steps
    asked = (after.strain - before.strain) @ h.case.stiffness
    lost = -h.inner(after.stress, h.slip_of(before, after))
    most = 2.0 * h.error(before.stress, after.stress, asked) * (h.length(after.stress) + h.length(asked))
    worst, bound = np.full(len(h.case), -np.inf), np.zeros(len(h.case))
    for loss, allowed in zip(lost.reshape(-1, len(h.case)), most.reshape(-1, len(h.case)), strict=True):
        more = ~(loss - allowed <= worst - bound)
        worst, bound = np.where(more, loss, worst), np.where(more, allowed, bound)
    return Finding(worst, bound)
