"""What every closest-point step has in common; u is the error in stress the routine is held to.

sigma = argmin over K(sigma_n) of |sigma_tr - sigma|, |s| = (s . k^-1 s)^1/2, slip = k^-1 (sigma_tr - sigma).  Each tolerance
follows from sigma = sigma* + e, |e| <= u, with sigma* the exact answer; a few units in the last place are added for the
rounding of the check itself.

Then what is asked of a run as a whole, that it visited something, that its routine keeps nothing between calls and spoils nothing; and
what a consistent tangent is.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np
from numpy.typing import NDArray

from duhem.projection.result import Array
from duhem.testing.checks.query import NothingToCheck, Query, Reply
from duhem.testing.checks.registry import Finding, Visited, register, worst

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
    """Return the least and greatest slope (N,) of g along ``way`` at and ``near`` the stress, and where its formula changes its piece.

    At such a kink the pieces around are asked at the stress too: at the node of a curve one has no slope, and near it a small one.
    """
    n, d = stress.shape
    beside = np.concatenate([np.zeros((1, n, d)), *(s * np.broadcast_to(x, (1, n, d)) for x in (way, *q.axes) for s in (1.0, -1.0))])
    points, pressure = (stress + near[:, None] * beside).reshape(-1, d), np.tile(q.pressure, len(beside))
    gradient, pieces = q.region.slope(points, pressure)
    slopes = np.einsum("snd,nd->sn", gradient.reshape(-1, n, d), way)
    around = pieces.reshape(len(beside), n, -1)
    least, most, kink = slopes.min(axis=0), slopes.max(axis=0), np.asarray((around != around[0]).any(axis=(0, 2)))
    if kink.any():
        there = q.region.slope(np.tile(stress, (len(beside), 1)), pressure, pieces)[0].reshape(-1, n, d)
        least = np.where(kink, np.fmin(least, np.fmin.reduce(np.einsum("snd,nd->sn", there, way), axis=0)), least)
    return least, most, kink


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


# -- a run as a whole --------------------------------------------------------------------------------------------------

_LEAST_SEEN = 0.01  # of the increments without a law, whose sizes are drawn by what the routine itself shows
_MOST = 0.75  # of the increments that slip: who gives up more has shown what is left, not the rule
_ALONE = 3  # cases, in one of which a row is asked in a call of its own
_APART = 5  # cases, in one of which some rows are asked in calls of one size, one after the other
_CROWD, _MANY = 5, 300  # the case of a run in which some rows are asked so often in one call: more than the 256 of a block


def _visited(visited: Visited) -> str | None:
    shares = visited.shares
    found = visited.searched
    if raised := [said for said in found if said not in ("range", "none")]:
        return f"the search for the elastic range failed: {raised[0]}"
    least = 0.0 if visited.forces else _LEAST_SEEN
    missing = [name for name in ("slip", "stick")[: 1 if visited.creeps else 2] if shares and shares[name] <= least]
    if not missing:
        given_up = f"{visited.given_up:.2%} of the slipping increments are flagged as not solved, and therefore not tested"
        unknown = "no elastic range was found, so that the size of the increments says nothing of the routine (in Python: scale=STRAIN)"
        return given_up if visited.given_up > _MOST else unknown if found and not found["range"] else None
    few = f"only {shares[missing[0]]:.2g} of them " if shares[missing[0]] else "nothing "
    what = few + {"slip": "slipped", "stick": "stuck"}[missing[0]]
    seen = ", ".join(f"{name} {share:.3g}" for name, share in shares.items())
    return f"{what} in {visited.increments} increments; visited: {seen}"


@register(
    statement="the run contains increments that stick and increments that slip, and the routine solves most of those that slip",
    formula="sigma_tr in K(sigma_n) for some, and not for others",
    source="if nothing slips, a test passes for any routine",
    tolerance="flagged increments do not count; at most three in four of the slipping increments may be flagged",
    whole=_visited,
)
def vacuity(q: Query) -> Finding:
    none = np.zeros(len(q.here.trial))
    return Finding(none, none)


@register(
    statement="the same increment has the same answer, alone, together with others, and after others",
    formula="P(sigma_tr) = P(sigma_tr)",
    source="state that is kept between calls or shared between rows makes an answer depend on the order of the calls",
    tolerance="2 u",
    again=True,
)
def repeatability(q: Query) -> Finding:
    return compared(q, q.here.stress, q.again.stress, 2.0 * q.unit(q.here), _asked_otherwise(q))


def _asked_otherwise(q: Query) -> Iterator[tuple[Array, str]]:
    """Yield further answers to the trial, each with words on how it was asked."""
    if q.by_turns(_APART):
        _, close, *trials, _, last = q.apart
        here = q.here
        sticks = q.region.surely_inside(close.trial, q.pressure) & (q.length(here.stress - here.trial) <= q.unit(here))
        yield here.stress + np.where(sticks[:, None], close.stress - close.trial, 0.0), " of a trial stress close by, which sticks as well"
        for found in (*trials, last):
            yield found.stress, " when asked in calls of one size, one after the other"
    if q.turn == _CROWD and len(q.case) > 1:  # copies of one increment do not tell one row from another
        crowd = q.ask(*[q.case.trial] * -(-_MANY // len(q.case)))
        for found in crowd:
            yield found.stress, f" when asked in a call of {len(crowd) * len(q.case)} increments"


def compared(q: Query, here: Array, again: Array, allowed: Array, otherwise: Iterable[tuple[Array, str]] = ()) -> Finding:
    """The stresses answered to the trial, and those when asked again and ``otherwise``; of one row that asked alone too."""
    apart, how = q.length(_apart(again, here)), np.full(len(here), "", dtype=object)
    if q.by_turns(_ALONE):
        row, alone = q.alone
        at = slice(row, row + 1)
        if isinstance(alone, str):
            apart[row], how[row], otherwise = np.inf, f"; asked as one increment alone, {alone}", ()
        elif not (off := q.length(_apart(alone.stress, here[at]))[0]) <= apart[row]:
            apart[row], how[row] = off, " between the answer among others and that to the increment alone"
    for stress, asked in otherwise:
        farther = q.length(_apart(stress, here))
        worse = ~(farther <= apart)
        apart, how = np.where(worse, farther, apart), np.where(worse, asked, how)
    said = [f"measured {x:.3g}, allowed {most:.3g}{more}" for x, most, more in zip(apart, allowed, how, strict=True)]
    return Finding(apart, allowed, np.array(said, dtype=object))


def _apart(one: Array, other: Array) -> Array:
    """Return their difference, 0 where neither is finite: a nan twice is the same answer."""
    return np.where(~np.isfinite(one) & ~np.isfinite(other), 0.0, one - other)


@register(
    statement="the routine does not change its inputs and its earlier answers, and writes to no other memory",
    formula="sigma_tr, sigma_n and k after the call are those before it, and so are the answers to the calls before",
    source="the caller uses the trial stress, the pressure and the stiffness again, and keeps one answer during the next call",
    tolerance="none: to the last bit; of C and Fortran, all arguments that are not returned, and 64 bytes either side of each array; "
    "an answer may be the array that was given",
)
def inputs(q: Query) -> Finding:
    none = np.zeros(len(q.here.trial))
    if q.some.by_turns(_APART):
        _ = q.some.apart
    return Finding((q.overwritten != "").astype(np.float64), none, "overwritten: " + q.overwritten)


# -- the consistent tangent --------------------------------------------------------------------------------------------

_RESOLVED = 0.05  # of k: differences that disagree by more do not tell
_LEAST_STEP = 320.0  # times u: the shortest step of which rounding leaves a difference as good as that
_FINER = 12  # steps, each a quarter of the one before: the last is some thousand roundings long


@register(
    statement="the consistent tangent is symmetric and has eigenvalues in [0, k]",
    formula="C = C^T, 0 <= x . C x <= x . k x",
    source="Simo and Taylor (1985), Comput. Methods Appl. Mech. Eng. 48, 101-118",
    tolerance="d^2 (accuracy + 8 eps), in the metric of k",
)
def tangent(q: Query) -> Finding:
    c, finite = _tangent(q)
    off, allowed = _beyond(q, c)
    return Finding(np.where(finite, off, np.inf), allowed)


def _beyond(q: Query, c: Array) -> tuple[Array, Array]:
    """Return by how much tangents are not symmetric or leave [0, k] (N,), and by how much they may."""
    eigen = np.linalg.eigvalsh(0.5 * (c + np.swapaxes(c, 1, 2)))
    off, allowed = asymmetry(q, c)
    return np.maximum(off, np.maximum(-eigen.min(axis=1), eigen.max(axis=1) - 1.0)), allowed


def asymmetry(q: Query, c: Array) -> tuple[Array, Array]:
    """Return by how much tangents (N, d, d) in the metric of k are not symmetric (N,), and by how much they may be."""
    return np.abs(c - np.swapaxes(c, 1, 2)).max(axis=(1, 2)), np.full(len(c), c.shape[1] ** 2 * (q.accuracy + 8.0 * _EPS))


@register(
    statement="the consistent tangent agrees with finite differences of the routine where these are accurate (not near a flat point of K)",
    formula="C du = d sigma",
    source="Simo and Taylor (1985), Comput. Methods Appl. Mech. Eng. 48, 101-118",
    tolerance="what the differences at h and h/2, either way, disagree by (twice), + 16 u/h, with h the geometric mean of u and "
    "|sigma_tr| + |sigma|, or 320 u where they disagree by k/20 and neither way agrees with the tangent; what they are off by there, where "
    "smaller steps one way come ten times closer (K may be thinner than h), or where at all of them the two ways disagree by a quarter "
    "of it (no slope); any in [0, k] within 4 u of the boundary, where it jumps",
    again=True,
)
def slope(q: Query) -> Finding:
    here, (c, finite) = q.here, _tangent(q)
    u = q.unit(here)
    h = np.sqrt(u * (q.length(here.trial) + q.length(here.stress)))
    h = np.where(h > 0.0, h, 1e5 * u)  # no stress at all: small beside K
    h = np.where(h > 0.0, h, 1.0)
    worst = np.where(finite, 0.0, np.inf)
    rows, d = np.arange(len(c)), len(q.axes)
    for i in range(d) if q.whole is None else [(q.rows + q.turn) % d]:  # of some rows among others, one axis each
        axis, column = np.broadcast_to(q.axes[i], (len(c), d)), c[rows, :, i]
        slopes, step, kink = _differences(q, h, axis), h, np.ones(len(c), dtype=np.bool_)
        off, spread, near = _misses(slopes, column)
        ratio = off / (2.0 * spread + 16.0 * u / h + 8.0 * _EPS)
        if (unresolved := q.sound & (ratio <= 1.0) & (spread > _RESOLVED) & (near > _RESOLVED) & (_LEAST_STEP * u < h)).any():
            least = np.where(unresolved, _LEAST_STEP * u, h)
            off_then, spread, _ = _misses(_differences(q, least, axis), column)
            seen = unresolved & (spread <= _RESOLVED)
            off, step = np.where(seen, off_then, off), np.where(seen, least, h)
            ratio = np.where(seen, off / (2.0 * spread + 16.0 / _LEAST_STEP + 8.0 * _EPS), ratio)
        for _ in range(_FINER):
            if not (q.sound & ~(ratio <= 1.0)).any():
                break
            step = step / 4.0
            slopes = _differences(q, step, axis)
            near = _misses(slopes, column)[2]
            ratio = np.where(near <= off / 10.0, np.minimum(ratio, 1.0), ratio)
            kink &= np.linalg.norm(slopes[:2].mean(axis=0) - slopes[2:].mean(axis=0), axis=1) >= off / 4.0
        ratio = np.where(kink, np.minimum(ratio, 1.0), ratio)
        worst = np.maximum(worst, ratio)
    if (q.sound & finite & ~(worst <= 1.0)).any():
        off, allowed = _beyond(q, c)
        worst = np.where(finite & (off <= allowed) & _at_the_end(q), np.minimum(worst, 1.0), worst)
    return Finding(worst, np.ones(len(worst)))


def _misses(slopes: Array, column: Array) -> tuple[Array, Array, Array]:
    """Of slopes (4, N, d): what a column (N, d) misses of their mean, what they differ from it, what it misses of the nearer way."""
    middle, apart = slopes.mean(axis=0), np.linalg.norm(slopes - column, axis=2)
    spread = np.linalg.norm(slopes - middle, axis=2).max(axis=0)
    return np.linalg.norm(column - middle, axis=1), spread, np.minimum(apart[:2].max(axis=0), apart[2:].max(axis=0))


def _at_the_end(q: Query) -> NDArray[np.bool_]:
    """Where the trial lies within 4 u of the end of K and comes back so near: k from inside, and outside what curvature makes of it."""
    here, (n, d) = q.here, q.case.trial.shape
    u = q.unit(here)
    ways = np.vstack([q.axes, -q.axes])
    around = (here.trial[:, None, :] + 4.0 * u[:, None, None] * ways).reshape(n * 2 * d, d)
    outside = (q.region.level(around, np.repeat(q.pressure, 2 * d)) > 0.0).reshape(n, 2 * d).any(axis=1)
    return np.asarray((q.length(here.stress - here.trial) <= 4.0 * u) & (outside | (u == 0.0)))


def _differences(q: Query, h: Array, axis: Array) -> Array:
    """Slopes (4, N, d) of the routine along an axis a row (N, d), in the metric of k, by differences at h and h/2, either way."""
    here, shares = q.here, (1.0, 0.5, -1.0, -0.5)
    found = q.ask(*(here.trial + s * h[:, None] * axis for s in shares))
    return np.stack([q.shadow(beside.stress - here.stress) / (s * h[:, None]) for s, beside in zip(shares, found, strict=True)])


def _tangent(q: Query) -> tuple[Array, NDArray[np.bool_]]:
    """Return the routine's tangents (N, d, d) in the metric of k, with 0 in place of those that are not finite, and which are (N,)."""
    given = q.here.tangent
    if given is None:
        raise NothingToCheck("the routine returns no tangent")
    c = q.whitened(given)
    finite = np.asarray(np.isfinite(c).all(axis=(1, 2)))
    return np.where(finite[:, None, None], c, 0.0), finite
