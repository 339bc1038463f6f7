"""What a routine may do instead of what it should, and the answers it would give then: one suggestion each, in the order they are told."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from itertools import combinations
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from duhem.projection.result import Array
from duhem.testing.checks.query import NoReply
from duhem.testing.drawn.case import Region
from duhem.testing.failures.diagnosis import CLEAR, Probe, constant, suggested, suggests
from duhem.testing.failures.state_suggestions import IMPRECISE, roots

__all__ = ["needs_the_run"]

_FAR = 10.0  # times as far out as others: trial stresses of which that may be why they are answered otherwise
_FAR_OUT = 1e4  # times the trial stresses: where it is seen whether a routine corrects anything at all
_ALIKE = 1e-4  # of its value: what is closer is no other
_LISTED = 1e-3  # of the component that is wrong most: components with smaller errors are not told
_RIGHT = 1e-6  # of the stiffness: a tangent that is off by less counts as right
_SPREAD = np.logspace(-2.0, 2.0, 81)  # times the value of a parameter or a pressure: where another one is looked for


@suggests("stress")
def trial_stress(p: Probe) -> Iterator[tuple[str, Array]]:
    if p.kept:
        return
    far, corrected = _FAR_OUT * p.trial, False
    with suppress(NoReply):
        corrected = bool((p.query.ask(far)[0].stress != far).any())
    yield f"the routine returns the trial stress without a correction{' of these, but farther out it does' if corrected else ''}", p.trial


suggested("stress", no_stress=lambda p: [("every stress returned is zero", np.zeros_like(p.trial))])


@suggests("stress")
def radial_return(p: Probe) -> Iterator[tuple[str, Array]]:
    reach = p.query.region.reach(p.trial, p.pressure)
    scaled = np.where(reach[:, None] < 1.0, reach[:, None] * p.trial, p.trial)
    yield "radial return: the trial stress is scaled to the boundary, but this is not the closest point", scaled
    wrong = p.query.length(p.returned - p.closest) > p.query.unit(p.reply)
    if wrong.any() and (nearest := reach[wrong].max()) > 0.0:
        said = (
            f"radial return of trial stresses that lie {1.0 / nearest:.3g} times as far out as the boundary or farther, not of nearer ones"
        )
        yield said, np.where(reach[:, None] <= nearest, scaled, p.closest)


_METRICS: dict[str, Callable[[Array], Array]] = {
    "the identity instead of": lambda k: np.eye(len(k)),
    "only the diagonal of": lambda k: np.diag(np.diag(k)),
    "the inverse of": lambda k: 0.5 * (np.linalg.inv(k) + np.linalg.inv(k).T),
}


@suggests("stress")
def another_metric(p: Probe) -> Iterator[tuple[str, Array]]:
    for said, metric in _METRICS.items():
        yield f"the closest point is computed with {said} the stiffness", p.projected(stiffness=metric(p.stiffness))


def _exchanges(p: Probe) -> Iterator[tuple[str, list[int]]]:
    """Yield each two forces by their names, with the order of all forces in which these two are exchanged."""
    forces = p.query.region.law.forces
    for i, j in combinations(range(len(forces)), 2):
        order = [*range(len(forces))]
        order[i], order[j] = j, i
        yield f"{forces[i]} and {forces[j]}", order


@suggests("stress")
def metric_of_exchanged_entries(p: Probe) -> Iterator[tuple[str, Array]]:
    for both, order in _exchanges(p):
        said = f"the closest point is taken with the entries of the stiffness for {both} exchanged"
        yield said, p.projected(stiffness=p.stiffness[np.ix_(order, order)])


@suggests("stress")
def exchanged_parameters(p: Probe) -> Iterator[tuple[str, Array]]:
    values = p.query.region.parameters
    for a, b in combinations(values, 2):
        if values[a] != values[b]:
            yield f"{a} and {b} are exchanged", p.projected(parameters={a: values[b], b: values[a]})


@suggests("stress")
def exchanged_components(p: Probe) -> Iterator[tuple[str, Array]]:
    for both, order in _exchanges(p):
        turned = p.stiffness[np.ix_(order, order)]
        yield f"{both} are exchanged in the set", p.projected(p.trial[:, order], stiffness=turned)[:, order]
        yield f"{both} are exchanged in the answer", p.closest[:, order]


@suggests("stress")
def first_call(p: Probe) -> Iterator[tuple[str, Array]]:
    for what, given in p.kept:
        yield f"{what} of the first call of the run, whatever it is", p.projected(**given)


def needs_the_run(diagnoses: Mapping[str, str]) -> bool:
    """Return whether the likeliest diagnosis shows only after other calls, and so not by one increment alone."""
    return next(iter(diagnoses), "") == first_call.__name__


@suggests("stress")
def another_parameter(p: Probe) -> Iterator[tuple[str, Array]]:
    region = p.query.region
    for name, value in region.parameters.items():
        for other in (x for i in _moved(p)[:1] for x in roots(_levels(p, i, name), (value or 1.0) * _SPREAD)):
            if value and abs(other / value - 1.0) < _ALIKE:
                continue  # digits are lost, and no other value is taken
            factor = f", {other / value:.4g} times its value" if value else ""
            yield f"{name} is taken as {other:.6g}, not {value:.6g}{factor}", p.projected(parameters={name: other})


@suggests("stress")
def another_pressure(p: Probe) -> Iterator[tuple[str, Array]]:
    if p.query.region.law.pressure is None:
        return
    given = p.pressure
    at = _moved(p)
    taken = np.array([next(roots(_levels(p, i), -max(abs(given[i]), np.abs(p.returned[i]).max()) * _SPREAD), np.nan) for i in at])
    if (same := constant(taken)) is not None:
        known = np.ptp(given[at]) > 0.0  # else it may be what another one becomes
        told = "whatever it is" if known else f"not {given[at[0]]:.6g}"
        yield f"the pressure is taken as {same:.6g}, {told}", p.projected(pressure=np.full_like(given, min(same, 0.0)))
    if (factor := constant(taken / given[at])) is not None and factor > 0.0:
        yield f"the pressure is taken {factor:.6g} times as large", p.projected(pressure=factor * given)
    if (shift := constant(taken - given[at])) is not None:
        yield f"a stress is built in: the pressure is taken with {shift:+.6g}", p.projected(pressure=np.minimum(given + shift, 0.0))


@suggests("stress")
def opposite_sign(p: Probe) -> Iterator[tuple[str, Array]]:
    slips = (p.closest != p.trial).any(axis=1, keepdims=True)
    yield "the stress has the opposite sign", -p.closest
    yield "the stress has the opposite sign where there is slip", np.where(slips, -p.closest, p.trial)
    yield "the trial stress is taken with the opposite sign", p.projected(-p.trial)


@suggests("stress")
def lost_sign(p: Probe) -> Iterator[tuple[str, Array]]:
    yield "the signs of the forces are lost", p.projected(np.abs(p.trial))
    yield "the signs of the forces are lost in the answer", np.abs(p.closest)


@suggests("stress")
def too_far(p: Probe) -> Iterator[tuple[str, Array]]:
    q, way = p.query, p.closest - p.trial
    share = constant(np.where(_slipping(p), q.inner(p.returned - p.trial, way) / q.inner(way, way), np.nan))
    if share is not None:
        yield f"the correction is {share:.6g} times what leads to the closest point", p.trial + share * way


@suggests("stress")
def multiple_of_the_answer(p: Probe) -> Iterator[tuple[str, Array]]:
    q, slips = p.query, _slipping(p)
    factor = constant(np.where(slips & _wrong(p), q.inner(p.returned, p.closest) / q.inner(p.closest, p.closest), np.nan))
    if factor == 0.0:
        yield "the stress is zero if there is slip", np.where(slips[:, None], 0.0, p.trial)
    elif factor is not None:
        yield f"the stress is {factor:.6g} times the closest point where there is slip", np.where(slips[:, None], factor, 1.0) * p.closest


@suggests("stress")
def one_newton_step(p: Probe) -> Iterator[tuple[str, Array]]:
    region = p.query.region
    normal, level = region.slope(p.trial, p.pressure)[0], region.level(p.trial, p.pressure)
    way = normal @ p.stiffness
    once = p.trial - (level / np.einsum("ij,ij->i", normal, way))[:, None] * way
    yield "only one step of Newton's method is done from the trial stress", np.where((level > 0.0)[:, None], once, p.trial)


@suggests("stress")
def component_by_component(p: Probe) -> Iterator[tuple[str, Array]]:
    n, d = p.trial.shape
    ends = [p.query.region.reach(np.tile(s * axis, (n, 1)), p.pressure) for axis in np.eye(d) for s in (1.0, -1.0)]
    cut = np.stack([np.clip(p.trial[:, i], -ends[2 * i + 1], ends[2 * i]) for i in range(d)], axis=1)
    yield "each component is limited separately", cut


@suggests("stress")
def forgotten_slip(p: Probe) -> Iterator[tuple[str, Array]]:
    before = np.linalg.solve(p.stiffness, p.trial.T).T[:, ::-1] @ p.stiffness  # as from_displacements gives it
    whole = p.trial + before
    yield "the previous slip is missing: the trial stress is computed from the total displacement", p.trial - whole + p.projected(whole)


@suggests("stress")
def imprecise(p: Probe) -> Iterator[tuple[str, Array]]:
    q, wrong = p.query, _wrong(p)
    off = (q.length(p.returned - p.closest) / q.length(p.closest))[wrong].max(initial=0.0)
    if 0.0 < off <= 1e-4:
        yield f"the answer is right to {off:.1g} of the stress only: {IMPRECISE}", p.returned


@suggests("stress")
def far_trials(p: Probe) -> Iterator[tuple[str, Array]]:
    reach, wrong = p.query.region.reach(p.trial, p.pressure), _wrong(p)
    right = ~wrong & (reach < 1.0) & np.isfinite(p.closest).all(axis=1)
    if not wrong.any() or not right.any() or not (nearest := reach[wrong].max()) > 0.0 or not _FAR * nearest <= reach[right].min():
        return
    said = f"trial stresses {1.0 / nearest:.3g} times as far out as the boundary are answered wrongly, and some "
    said += f"up to {1.0 / reach[right].min():.3g} times as far rightly"
    yield said, np.where((reach <= nearest)[:, None], p.returned, np.nan)  # no cause: what says what is done there comes first


def _wrong(p: Probe) -> NDArray[np.bool_]:
    return np.asarray(p.query.length(p.returned - p.closest) > CLEAR * p.query.unit(p.reply))


def _slipping(p: Probe) -> NDArray[np.bool_]:
    return np.asarray(p.query.length(p.closest - p.trial) > 1e-6 * p.query.length(p.trial))


def _moved(p: Probe) -> list[int]:
    """Return the increments whose answer is neither right nor the trial stress: it may lie on a boundary that is not that of K."""
    q, u = p.query, p.query.unit(p.reply)
    wrong = (q.length(p.returned - p.closest) > u) & (q.length(p.returned - p.trial) > u)
    return [int(i) for i in np.flatnonzero(wrong)]


Levels: TypeAlias = Callable[[Array], Array]


def _levels(p: Probe, i: int, parameter: str | None = None) -> Levels:
    """Return g at the stress returned for one increment as a function of values (M,) of a parameter or else of the pressure."""
    law, known, stress = p.query.region.law, p.query.region.parameters, p.returned[i]

    def level(values: Array) -> Array:
        region = Region(law, known if parameter is None else {**known, parameter: values})  # type: ignore[dict-item]
        return region.level(np.tile(stress, (len(values), 1)), values if parameter is None else p.pressure[i])

    return level


def _unlike_one(factor: float) -> str:
    """Return a factor with six digits, or as many as tell it from 1."""
    return next((said for n in range(6, 17) if float(said := f"{factor:.{n}g}") != 1.0), "1")


def _compliant(p: Probe, stress: Array) -> Array:
    """Return k^-1 stress (N, d)."""
    return np.asarray(np.linalg.solve(p.stiffness, stress.T).T)


suggested(
    "slip",
    opposite_slip=lambda p: [("the slip has the opposite sign", -p.slip)],
    no_slip=lambda p: [("the slip returned is always zero", np.zeros_like(p.trial))],
    slip_as_a_stress=lambda p: [("the slip returned is a stress: it is not divided by the stiffness", p.trial - p.returned)],
    slip_times_the_stiffness=lambda p: [
        (
            "the slip is the stiffness times what the stress lacks: a stiffness is taken for a compliance",
            (p.trial - p.returned) @ p.stiffness,
        )
    ],
    slip_of_the_closest_point=lambda p: [
        ("the slip is that of the closest point, but the stress is different", _compliant(p, p.trial - p.closest))
    ],
    slip_of_the_diagonal=lambda p: [
        ("the slip is computed with only the diagonal of the stiffness", (p.trial - p.returned) / np.diag(p.stiffness))
    ],
    slip_as_a_displacement=lambda p: [
        ("the elastic displacement is returned as slip", _compliant(p, p.returned)),
        ("the whole displacement is returned as slip", _compliant(p, p.trial)),
    ],
)


@suggests("slip")
def multiple_of_the_slip(p: Probe) -> Iterator[tuple[str, Array]]:
    right, given = p.slip, np.asarray(p.reply.slip)
    if (factor := constant(np.einsum("ij,ij->i", given, right) / np.einsum("ij,ij->i", right, right))) is not None:
        yield f"the slip is {_unlike_one(factor)} times what the stress lacks", factor * right


suggested("multiplier", opposite_multiplier=lambda p: [("the multiplier has the opposite sign", -p.multiplier)])


@suggests("multiplier")
def multiplier_with_a_shift(p: Probe) -> Iterator[tuple[str, Array]]:
    if (shift := constant(np.asarray(p.reply.multiplier) - p.multiplier)) is not None:
        yield f"the multiplier is off by {shift:+.6g} everywhere", p.multiplier + shift


@suggests("multiplier")
def multiple_of_the_multiplier(p: Probe) -> Iterator[tuple[str, Array]]:
    right = p.multiplier
    factor = constant(np.where(right > 0.0, np.asarray(p.reply.multiplier) / right, np.nan))
    if factor == 0.0:
        yield "the multiplier returned is always zero", np.zeros_like(right)
    elif factor is not None:
        yield f"the multiplier is {_unlike_one(factor)} times the slip over the gradient of g", factor * right


@suggests("multiplier")
def multiplier_of_another_g(p: Probe) -> Iterator[tuple[str, Array]]:
    right, size = p.multiplier, -p.query.region.level(np.zeros_like(p.trial), p.pressure)  # of g = N - R or N^p - R^p
    yield "the multiplier is the length of the slip, of a g whose gradient has length 1", _length(p.slip)
    yield "the multiplier is the length of (trial stress - stress): it is not divided by the stiffness", _length(p.trial - p.returned)
    if p.query.region.law.pressure is not None:
        yield "the multiplier is that of g divided by the pressure, not of g as it is written", right * np.abs(p.pressure)
    yield "the multiplier is that of g divided by its size, -g(0): of a gauge, not of g as it is written", right * size
    yield "the multiplier is that of g with its parts squared, not of g as it is written", right / (2.0 * size)
    yield "the multiplier is that of g with the root of its parts, not of g as it is written", right * 2.0 * np.sqrt(size)


def _length(vectors: Array) -> Array:
    return np.asarray(np.linalg.norm(vectors, axis=1))


suggested(
    "tangent",
    elastic_tangent=lambda p: [("the tangent is the elastic stiffness although there is slip", np.tile(p.stiffness, (len(p.trial), 1, 1)))],
    no_tangent=lambda p: [("the tangent is not set: it is zero", np.zeros_like(p.slopes))],
)


@suggests("tangent")
def continuum_tangent(p: Probe) -> Iterator[tuple[str, Array]]:
    way = p.gradient @ p.stiffness
    along = way[:, :, None] * way[:, None, :] / np.einsum("ij,ij->i", p.gradient, way)[:, None, None]
    slips = (p.returned != p.trial).any(axis=1)[:, None, None]
    said = "the tangent is the continuum tangent (k minus its part along the normal), not the consistent tangent of the finite step"
    yield said, np.where(slips, p.stiffness - along, p.stiffness)


suggested(
    "tangent",
    tangent_by_the_trial=lambda p: [
        ("the tangent is the derivative by the trial stress, not by the displacement", p.slopes @ np.linalg.inv(p.stiffness))
    ],
    opposite_tangent=lambda p: [("the tangent has the opposite sign", -p.slopes)],
    transposed_tangent=lambda p: [("the tangent is transposed", np.swapaxes(p.slopes, 1, 2))],
)


@suggests("tangent")
def secant(p: Probe) -> Iterator[tuple[str, Array]]:
    share = _length(p.returned) / _length(p.trial)
    yield "the tangent is a secant: the stiffness times stress over trial stress", share[:, None, None] * p.stiffness


@suggests("tangent")
def multiple_of_the_tangent(p: Probe) -> Iterator[tuple[str, Array]]:
    right, given = p.slopes, np.asarray(p.reply.tangent)
    factors = np.einsum("nij,nij->n", given, right) / np.einsum("nij,nij->n", right, right)
    if (factor := constant(factors, 1e-4)) is not None:
        yield f"the tangent is {factor:.4g} times the slope of the stress", factor * right


@suggests("tangent")
def components(p: Probe) -> Iterator[tuple[str, Array]]:
    """Last, as it says only where the tangents are wrong: of right ones it has no answer."""
    right, given, root = p.slopes, np.asarray(p.reply.tangent), np.sqrt(np.diag(p.stiffness))
    off = np.abs(given - right) / np.outer(root, root)
    most = off.max(axis=(1, 2), keepdims=True)
    places = [f"({i + 1}, {j + 1}), {given[0, i, j]:.6g} for {right[0, i, j]:.6g}" for i, j in np.argwhere(off[0] > _LISTED * most[0])]
    more = f"; and {len(places) - 6} more" if len(places) > 6 else ""
    if len(places) < off[0].size:
        said = f"the tangent is wrong in {len(places)} of {off[0].size} components: {'; '.join(places[:6])}{more}"
        yield said, np.where(most > _RIGHT, given, np.nan)
