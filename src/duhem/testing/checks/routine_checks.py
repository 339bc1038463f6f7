"""What every closest-point step has in common; u is the error in stress the routine is held to.

sigma = argmin over K(sigma_n) of |sigma_tr - sigma|, |s| = (s . k^-1 s)^1/2, slip = k^-1 (sigma_tr - sigma).  Each tolerance
follows from sigma = sigma* + e, |e| <= u, with sigma* the exact answer; a few units in the last place are added for the
rounding of the check itself.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from duhem.projection.result import Array
from duhem.testing.checks.query import NothingToCheck, Query, Reply
from duhem.testing.checks.registry import Finding, register, worst

__all__: list[str] = []

_EPS = float(np.finfo(np.float64).eps)
_SCALES = 3  # cases, in one of which some rows are asked with another stiffness
_WAYS = 1.0, 0.1, 0.01  # of the stress's length times the sine of the lean, which is best where K is round about the origin
_MOREAU = "Moreau (1965), Bull. Soc. Math. France 93, 273-299"
_LAW = "Antoni et al. (2007), Eq. 36"
_BESIDE = (4.0, 64.0, 1024.0)  # times u: so far from the stress gradients are taken, the second and third at kinks alone
_WITHIN = tuple(4.0**-i for i in range(8))  # times u: where slopes change sooner than that far from the stress
_ALONG = 1.0 - 1e-6  # cosine of a slip along the normal


@register(
    statement="the multiplier is never negative, zero where the trial is admissible, and the slip over the gradient of g as it is written",
    formula="lambda >= 0; sigma_tr in K => lambda = 0; k^-1 (sigma_tr - sigma) = lambda dg/dsigma",
    source="Antoni et al. (2007), Eq. 36; at corners F. H. Clarke (1983), Optimization and Nonsmooth Analysis, section 2.3",
    tolerance="sign: none; zero: lambda |grad g| <= 2 u, the slip that rounding of the boundary explains; size: |sigma_tr - sigma| within "
    "2 u of lambda times the slopes of g along it within 4 u of the stress, at a kink within 1024 u, if the stress is on the boundary and "
    "the slip normal to it; where the gradient vanishes on the boundary there is "
    "none, and where some of those slopes are not positive (the tip of a cone, a K that thin) there is no one multiplier",
)
def multiplier(q: Query) -> Finding:
    found = q.here
    given = found.multiplier
    if given is None:
        raise NothingToCheck("the routine returns no multiplier")
    amount = np.where(given >= 0.0, given, np.inf)
    gradient = q.gradient(found)
    with np.errstate(all="ignore"):
        size = np.where(amount == 0.0, 0.0, amount * q.dual_length(gradient))
    allowed = 2.0 * q.unit(found)
    free = q.certainly((size > allowed) & np.isfinite(amount), found.trial, outside=False)
    none = _vanishing(q, found)
    wrong = free | ~np.isfinite(given) & ~(given > 0.0) & ~(none & np.isnan(given)) | (amount != given) & ~np.isnan(given)
    return Finding(np.where(wrong, size, np.where(none, 0.0, _lacking(q, found, given))), allowed)


def _vanishing(q: Query, found: Reply) -> NDArray[np.bool_]:
    """Return where (N,) the gradient at a stress that slips is 0 on the boundary: it doubles, of one piece of g, within what u allows."""
    asked, u = found.corrector, q.unit(found)
    length = q.length(asked)
    gradient, piece = q.region.slope(found.stress, q.pressure)
    with np.errstate(all="ignore"):
        step = (_BESIDE[0] * u / length)[:, None] * asked
        beside = [q.dual_length(q.region.slope(found.stress + s * step, q.pressure, choices=piece)[0]) for s in (1.0, -1.0)]
    return np.asarray((length > 2.0 * u) & (np.fmax(*beside) >= 2.0 * q.dual_length(gradient)))


def _lacking(q: Query, found: Reply, amount: Array) -> Array:
    """By how much the length of the slip misses what a multiplier (N,) makes of the slopes of g; 0 where that is not known.

    Of a stress off the boundary, or a slip that is not normal to it, other checks tell, and no multiplier would do.
    """
    asked = found.corrector
    length, u = q.length(asked), q.unit(found)
    with np.errstate(all="ignore"):
        way = asked / length[:, None]
        least, most, kink = _slopes(q, found.stress, way, _BESIDE[0] * u)
        for share in _BESIDE[1:]:
            if not kink.any():
                break
            low, high, _ = _slopes(q, found.stress, way, share * u)
            least, most = np.where(kink, np.minimum(least, low), least), np.where(kink, np.maximum(most, high), most)
        steep = q.dual_length(q.gradient(found))
        there = np.abs(q.region.level(found.stress, q.pressure)) <= _BESIDE[0] * u * np.maximum(steep, most)
        normal = kink | (least >= _ALONG * steep)
        off = np.maximum(length - amount * most, amount * least - length)
        known = (length > 2.0 * u) & there & normal & (least > 0.0) & np.isfinite(most) & np.isfinite(off)
        for share in _WITHIN:
            if not (known & (off > 2.0 * u)).any():
                break
            low, high, _ = _slopes(q, found.stress, way, share * u)
            least, most = np.fmin(least, low), np.fmax(most, high)
            off = np.maximum(length - amount * most, amount * least - length)
    return np.where(known, np.maximum(off, 0.0), 0.0)


def _slopes(q: Query, stress: Array, way: Array, near: Array) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Return the least and greatest slope (N,) of g along ``way`` at and ``near`` the stress, and where its formula changes its piece."""
    n, d = stress.shape
    beside = np.concatenate([np.zeros((1, n, d)), *(s * np.broadcast_to(x, (1, n, d)) for x in (way, *q.axes) for s in (1.0, -1.0))])
    points = (stress + near[:, None] * beside).reshape(-1, d)
    gradient, pieces = q.region.slope(points, np.tile(q.pressure, len(beside)))
    slopes = np.einsum("snd,nd->sn", gradient.reshape(-1, n, d), way)
    around = pieces.reshape(len(beside), n, -1)
    return slopes.min(axis=0), slopes.max(axis=0), np.asarray((around != around[0]).any(axis=(0, 2)))


@register(
    statement="the routine answers every increment with finite stresses",
    formula="sigma in R^d",
    source="an unnoticed nan makes all later results wrong",
    tolerance="none",
)
def answers(q: Query) -> Finding:
    bad = np.asarray(~np.isfinite(q.here.stress).all(axis=1))
    for found in q.some.first:
        bad[q.some.rows] |= ~np.isfinite(found.stress).all(axis=1) & q.some.sound
    return Finding(bad.astype(np.float64), np.zeros(len(bad)))


@register(
    statement="the stress is admissible",
    formula="g(sigma, sigma_n) <= 0",
    source=_LAW,
    tolerance="g <= u |grad g|: sigma lies within u of K (exact for convex g, first order otherwise); beyond it, judged in 60 digits, "
    "there and at u from there: towards 0, against the slip and against grad g, which may vanish on the boundary",
)
def feasibility(q: Query) -> Finding:
    found = q.here
    gradient = q.gradient(found)
    with np.errstate(all="ignore"):
        allowed = q.unit(found) * q.dual_length(gradient)
    level = q.region.level(found.stress, q.pressure)
    allowed = np.where(level <= 0.0, np.fmax(allowed, 0.0), allowed)  # inside K nothing rests on a gradient, which a root may lack
    out = q.certainly(~(level <= allowed), found.stress, outside=True)
    for way in (found.stress, found.corrector, gradient @ q.case.stiffness) if out.any() else ():
        size, u = q.length(way), q.unit(found)
        with np.errstate(all="ignore"):
            near = found.stress - np.fmin(u / size, 1.0 if way is found.stress else np.inf)[:, None] * way
        beside = out & np.isfinite(near).all(axis=1)
        out &= ~q.certainly(beside, np.where(beside[:, None], near, 0.0), outside=False)
    allowed, level = np.where(out, allowed, np.fmax(allowed, 0.0)), np.where(out, level, np.fmin(level, 0.0))
    bad, said = ~(level <= allowed), np.full(len(level), "", dtype=object)
    if bad.any():
        share = level / q.dual_length(gradient) / q.length(found.stress)
        said[bad] = [
            f"measured {g:.3g}, allowed {most:.3g}: out of K by {x:.2g} of the stress"
            for g, most, x in zip(level[bad], allowed[bad], share[bad], strict=True)
        ]
    return Finding(level, allowed, said, q.region.unknown(found.stress, q.pressure))


@register(
    statement="an admissible stress does not change",
    formula="P(P(sigma_tr)) = P(sigma_tr)",
    source=_MOREAU,
    tolerance="u + u': sigma lies within u of K, and its own answer within u' of its closest point",
    again=True,
)
def idempotence(q: Query) -> Finding:
    here, again = q.here, q.second[0]
    return Finding(q.length(again.stress - here.stress), q.unit(here) + q.unit(again))


@register(
    statement="the distance between two stresses does not increase",
    formula="|P(x) - P(y)| <= |x - y|",
    source=_MOREAU,
    tolerance="u + u' + 8 eps |x - y|",
    again=True,
)
def non_expansiveness(q: Query) -> Finding:
    a, b, _ = q.first
    apart = q.length(a.trial - b.trial)
    return Finding(q.length(a.stress - b.stress), (1.0 + 8.0 * _EPS) * apart + q.unit(a) + q.unit(b))


@register(
    statement="the eigenvalues of the tangent lie in [0, k]; here for finite steps",
    formula="|P(x) - P(y)|^2 <= (P(x) - P(y)) . k^-1 (x - y)",
    source=_MOREAU,
    tolerance="(u + u')(2 |P(x) - P(y)| + |x - y| + u + u') + 8 eps |P(x) - P(y)| |x - y|",
    again=True,
)
def firmness(q: Query) -> Finding:
    a, b, _ = q.first
    moved, asked = a.stress - b.stress, a.trial - b.trial
    error, m, s = q.unit(a) + q.unit(b), q.length(moved), q.length(asked)
    return Finding(m * m - q.inner(moved, asked), error * (2.0 * m + s + error) + 8.0 * _EPS * m * s)


@register(
    statement="the step derives from a potential, so its tangent is symmetric; here for finite steps",
    formula="sum over a cycle x_1, x_2, x_3 of P(x_i) . k^-1 (x_i+1 - x_i) <= 0",
    source="Rockafellar (1970), Convex Analysis, Theorem 24.8; P = grad(|x|^2 - dist^2)/2",
    tolerance="sum of (u_i + 8 eps |P(x_i)|) |x_i+1 - x_i|",
    again=True,
)
def potential(q: Query) -> Finding:
    total, allowed = np.zeros(len(q.case)), np.zeros(len(q.case))
    for here, there in zip(q.first, [*q.first[1:], q.here], strict=True):
        step = there.trial - here.trial
        total += q.inner(here.stress, step)
        allowed += (q.unit(here) + 8.0 * _EPS * q.length(here.stress)) * q.length(step)
    return Finding(total, allowed)


def _leaning(q: Query, found: Reply, slip: Array, unit: Array) -> Iterator[Array]:
    """Points of K (N, d) beside an answer, where k ``slip`` (N, d) leans off the normal by more than ``unit`` (N,); else the stress itself.

    A slip that is not normal to the boundary at the answer dissipates more at some point of K nearby, however little it leans: along the
    boundary the power grows with the first power of the way, and K falls away with the second.  Points that are drawn find a slip that
    leans a little only where they happen to lie there.

    With L^-1 the shadow of a stress in the metric of k^-1 and n = L^T grad g, the slip's shadow less its part along n says which
    way; a point outside K is drawn back to it on its ray from the origin.
    """
    stress = found.stress
    with np.errstate(all="ignore"):
        normal, shadow = q.gradient(found) @ q.axes.T, q.shadow(slip)
        normal = normal / np.linalg.norm(normal, axis=1)[:, None]
        lean = shadow - np.einsum("ij,ij->i", shadow, normal)[:, None] * normal
        size = np.linalg.norm(lean, axis=1)
        way = (q.length(stress) / q.length(slip))[:, None] * lean @ q.axes
    rows = np.flatnonzero((size > 2.0 * unit) & np.isfinite(way).all(axis=1) & way.any(axis=1))
    if not rows.size:
        return
    there = np.concatenate([stress[rows] + share * way[rows] for share in _WAYS])  # all at once: a reach costs its calls, not its rays
    reach = q.region.reach(there, np.tile(q.pressure[rows], len(_WAYS)))
    for drawn_back in np.split(np.minimum(reach, 1.0)[:, None] * there, len(_WAYS)):
        points = stress.copy()
        points[rows] = drawn_back
        yield points


@register(
    statement="no admissible stress dissipates more with this slip",
    formula="(sigma_tr - sigma) . k^-1 (tau - sigma) <= 0 for all tau in K",
    source=f"{_LAW}; Moreau (1977), J. Differ. Equ. 26, 347-374",
    tolerance="u (|sigma_tr - sigma| + |tau - sigma| + u) + 8 eps |sigma_tr - sigma| (|tau| + |sigma|); tau is in K in 60 digits: two "
    "points drawn, and points beside the answer where the slip leans off the normal",
)
def variational_inequality(q: Query) -> Finding:
    found = q.here
    slip, u = found.corrector, q.unit(found)
    size = q.length(slip)

    def more_at(tau: Array) -> tuple[Array, Array]:
        way = tau - found.stress
        value = q.inner(slip, way)
        allowed = u * (size + q.length(way) + u) + 8.0 * _EPS * size * (q.length(tau) + q.length(found.stress))
        return np.where(~(value <= allowed) & ~q.certainly(~(value <= allowed), tau, outside=False), 0.0, value), allowed

    return worst(map(more_at, (q.case.inside, q.case.beside, *_leaning(q, found, slip, u))))


@register(
    statement="slip occurs only on the boundary",
    formula="lambda g(sigma, sigma_n) = 0",
    source=_LAW,
    tolerance="sigma lies within u of the boundary where g >= -u |grad g| (exact for convex g), or within 2 u on the way to the trial",
)
def complementarity(q: Query) -> Finding:
    found = q.here
    slip, u = found.corrector, q.unit(found)
    size = q.length(slip)
    with np.errstate(all="ignore"):
        ahead = found.stress + (3.0 * u / size)[:, None] * slip
    may = (size > 3.0 * u) & np.isfinite(ahead).all(axis=1)
    ahead = np.where(may[:, None], ahead, 0.0)
    steep = q.dual_length(q.gradient(found))
    may &= q.region.level(found.stress, q.pressure) < -u * np.where(np.isfinite(steep), steep, 0.0)
    clear = q.certainly(may & (q.region.level(ahead, q.pressure) <= 0.0), ahead, outside=False)
    return Finding(np.where(clear, 3.0 * u, 0.0), 2.0 * u)


@register(
    statement="the step dissipates",
    formula="sigma . slip >= 0",
    source="Antoni et al. (2007), Eqs. 22, 36: Clausius-Duhem",
    tolerance="u (|sigma| + |sigma_tr - sigma| + u) + 8 eps |sigma| |sigma_tr - sigma|",
)
def dissipation(q: Query) -> Finding:
    return Finding(*_loss(q, q.here))


def _loss(q: Query, found: Reply) -> tuple[Array, Array]:
    """Return -sigma . slip (N,) and what it may be (N,)."""
    slip, u = found.corrector, q.unit(found)
    size, reach = q.length(slip), q.length(found.stress)
    return -q.inner(found.stress, slip), u * (size + reach + u) + 8.0 * _EPS * size * reach


@register(
    statement="the returned slip agrees with the difference between trial stress and stress",
    formula="k slip = sigma_tr - sigma",
    source="Antoni et al. (2007), Eqs. 25, 31",
    tolerance="2 u",
)
def slip(q: Query) -> Finding:
    found = q.here
    return Finding(q.length(_returned(found) @ q.case.stiffness - found.corrector), 2.0 * q.unit(found))


def _returned(found: Reply) -> Array:
    if found.slip is None:
        raise NothingToCheck("the routine returns no slip: k^-1 (sigma_tr - sigma) satisfies this by definition")
    return found.slip


@register(
    statement="work = stored + dissipated energy + numerical loss of the implicit step",
    formula="sigma . du = d psi + sigma . slip + du_e . k du_e/2",
    source="Antoni et al. (2007), Eqs. 22-31, discrete",
    tolerance="2 u (2 |sigma| + |d sigma| + 2 u) + 32 eps (|sigma| + |start| + |sigma_tr|)^2, the start a stress of K",
)
def energy(q: Query) -> Finding:
    found, start = q.here, q.case.inside
    moved = _returned(found) @ q.case.stiffness  # k times the slip
    asked = found.trial - start
    elastic = asked - moved
    stored = 0.5 * (q.inner(found.stress, found.stress) - q.inner(start, start))
    left = q.inner(found.stress, asked) - stored - q.inner(found.stress, moved) - 0.5 * q.inner(elastic, elastic)
    u, size = q.unit(found), q.length(found.stress)
    whole = size + q.length(start) + q.length(found.trial)
    return Finding(np.abs(left), 2.0 * u * (2.0 * size + q.length(elastic) + 2.0 * u) + 32.0 * _EPS * whole * whole)


@register(
    statement="rate independence: a longer or shorter slip in the same direction ends at the same stress",
    formula="P(sigma + t (sigma_tr - sigma)) = sigma for all t >= 0",
    source=_MOREAU,
    tolerance="u (1 + |1 - t|) + u'",
    again=True,
)
def ray(q: Query) -> Finding:
    here, there = q.here, q.second[1]
    allowed = q.unit(here) * (1.0 + np.abs(1.0 - q.case.stretch)) + q.unit(there)
    return Finding(q.length(there.stress - here.stress), allowed)


@register(
    statement="rate independence: the stress depends on the shape of the stiffness, not on its size",
    formula="P(sigma_tr; c k) = P(sigma_tr; k) for c > 0",
    source="the minimum of (sigma_tr - sigma) . (c k)^-1 (sigma_tr - sigma)/2 is where that of k is",
    tolerance="2 u (c is a power of two)",
    again=True,
)
def stiffness_scale(q: Query) -> Finding:
    if "stiffness" in q.fixed:
        raise NothingToCheck("the stiffness is fixed, so no other stiffness is tested")
    if not q.by_turns(_SCALES):
        raise NothingToCheck(f"tested in one of {_SCALES} cases")
    here = q.here
    there = q.ask(q.case.trial, stiffness=q.case.stiffness * q.case.factor)[0]
    return Finding(q.length(there.stress - here.stress), 2.0 * q.unit(here))


@register(
    statement="twice the load gives twice the stress: the routine contains no fixed stress",
    formula="P(c sigma_tr; c sigma_n) = c P(sigma_tr; sigma_n) for c > 0, where K(c sigma_n) = c K(sigma_n)",
    source="Antoni et al. (2007), Eq. 35: the gauge is positively homogeneous",
    tolerance="2 u (c is a power of two)",
    again=True,
)
def homogeneity(q: Query) -> Finding:
    if not q.region.homogeneous:
        raise NothingToCheck(f"K of {q.region.law.name} does not scale with the pressure")
    if not q.scales:
        raise NothingToCheck("the pressure is fixed, so no other pressure is tested")
    here, there = q.here, q.larger
    return Finding(q.length(there.stress / q.case.factor - here.stress), 2.0 * q.unit(here))


@register(
    statement="along a loading path the total dissipation is never negative",
    formula="sum over the steps of sigma . slip >= 0",
    source="Antoni et al. (2007), Eqs. 22, 23",
    tolerance="the sum of what each step is allowed",
    again=True,
)
def path(q: Query) -> Finding:
    losses = np.array([_loss(q, found) for found in q.along_the_path()])
    return worst(np.cumsum(losses, axis=0)) if len(losses) else Finding(*np.zeros((2, len(q.case))))
