"""Steps of laws with a state from one knot to the next: implicit, extrapolated, and as many of these as an accuracy takes.

An implicit step has an error of first order.  Extrapolated (Richardson, 1911; Deuflhard, 1983), the ends chi_j of n_j implicit steps of
equal length make sum w_j chi_j, w_j = product over i of n_j/(n_j - n_i), with an error of the order of how many they are; it is put back
into K by an implicit step without time.  Each implicit step satisfies, whatever the energy,

    work = d psi + s dT + dissipation + own dissipation,   work = sigma . du,   dissipation = Y . (lambda h + dt r),

where the own dissipation, 1/2 d . psi'' d of a quadratic energy, and what a bound takes away as its reaction, is ``numerical``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from duhem.path.state_question import Drive, StateQuestion
from duhem.path.state_step import Advanced, Flags, own_dissipation
from duhem.projection.result import Array

__all__ = ["Made", "accurate", "extrapolated", "implicit"]

_MOST_RUNS = 6  # of 1, 2, 3 ... steps
_LONGER = (8.0, 8.0, 8.0, 4.0, 2.0, 1.2, 0.8)  # the next part, after so many runs: most are made by five of them
_LEAST = 2.0**-27  # of a step of the path: the first part is as short as that, and the one across a place where flow begins or ends
_FASTEST = 2.0**-44  # no part is shorter: what relaxes after a fast load needs such
_MOST_PARTS = 4_000
_SAFE = 0.1  # of the accuracy, which one part may be off by as it seems
_ROUNDED = 1e-13  # of a variable: no difference
_SEEN = 1e-10  # of all the energies of which psi is made: of a change that is less, rounding hides a part


class Made(NamedTuple):
    """A step: where it ends, and (N,) what it adds to dissipation, work, numerical, s dT and heat; ``multiplier`` (N, S)."""

    end: Advanced
    multiplier: Array
    added: tuple[Array, ...]


def implicit(asked: StateQuestion, base: Array, given: Array, dt: float, others: Sequence[Array], tangent: bool = False) -> Made:
    """The implicit step."""
    law, end = asked.law, asked.advance(base, given, dt, others, tangent)
    by, o = end.chi - base, law.observables
    inner = by[:, o : o + law.internal]
    dissipation = (end.forces * end.flow[:, law.order]).sum(axis=1)
    work = (end.observed * by[:, :o]).sum(axis=1)
    numerical = end.numerical + (end.reaction * inner).sum(axis=1)
    if law.law.temperature is None:
        warmed = heat = np.zeros(len(base))
    else:
        warmed = end.entropy * by[:, -1]
        heat = end.chi[:, -1] * (end.entropy - law.stored(base, others)[2]) - dissipation
    return Made(end, end.multiplier, (dissipation, work, numerical, warmed, heat))


class _Divided(NamedTuple):
    """A step in equal parts: what it comes to, and in each part (N, 1 + S + internal) whether something flows, which criteria
    are active and which variables held; ``faint``, whether what flows is rounding, as at the end of a relaxation."""

    made: Made
    patterns: list[Flags]
    faint: list[bool]

    def alike(self, before: _Divided, whole: _Divided) -> list[bool]:
        """Of each part, whether it goes on as ``before``, or as the ``whole`` in one step where rounding flowed before.

        A part in which rounding flows goes on as either.
        """
        loose = before.faint[-1]
        flows, unknown = (whole if loose else before).patterns[-1][:, :1], loose and whole.faint[-1]
        right = np.concatenate([flows, before.patterns[-1][:, 1:]], axis=1)
        return [bool((each == right)[:, int(unknown or faint) :].all()) for each, faint in zip(self.patterns, self.faint, strict=True)]


def _divided(asked: StateQuestion, base: Array, to: Drive, dt: float, n: int) -> _Divided:
    at, parts, inner = base, [], slice(asked.law.observables, asked.law.observables + asked.law.internal)
    for i in range(1, n + 1):
        given, others = to(i / n)
        parts.append(implicit(asked, at, given, dt / n, others))
        at = parts[-1].end.chi
    ends = [part.end for part in parts]
    end = replace(
        ends[-1],
        failed=np.logical_or.reduce([each.failed for each in ends]),
        worst=np.maximum.reduce([each.worst for each in ends]),
    )
    added = tuple(np.sum(gains, axis=0) for gains in zip(*(part.added for part in parts), strict=True))
    patterns = [np.concatenate([(each.flow != 0.0).any(axis=1, keepdims=True), each.multiplier > 0.0, each.held], axis=1) for each in ends]
    faint = [bool((np.abs(each.flow) <= _ROUNDED * np.abs(each.chi[:, inner])).all() and each.flow.any()) for each in ends]
    return _Divided(Made(end, np.sum([part.multiplier for part in parts], axis=0), added), patterns, faint)


def _weights(parts: Sequence[int]) -> Array:
    """w_j = product of n_j/(n_j - n_i) over the other i."""
    return np.array([np.prod([n / (n - m) for m in parts if m != n]) for n in parts])


def extrapolated(asked: StateQuestion, base: Array, to: Drive, dt: float) -> Made:
    """The step of second order, 2 chi_halves - chi_whole."""
    return _joined(asked, [_divided(asked, base, to, dt, n) for n in (1, 2)], to)


def _joined(asked: StateQuestion, runs: Sequence[_Divided], to: Drive) -> Made:
    """sum w_j chi_j, put back into K; where bounds do not hold the same variables all along, or are passed, the last run alone."""
    law, (given, others), ends = asked.law, to(1.0), [run.made.end for run in runs]
    o, finest = law.observables, ends[-1].chi
    weights = np.repeat(_weights([len(run.patterns) for run in runs])[:, None], len(finest), axis=1)
    beside = np.einsum("jn,jnz->nz", weights, [end.chi for end in ends])
    held = np.array([pattern[:, 1 + len(law.criteria) :] for run in runs for pattern in run.patterns])
    beside[:, o : o + law.internal] = np.where(held.all(axis=0), finest[:, o : o + law.internal], beside[:, o : o + law.internal])
    inner = beside[:, o : o + law.internal]
    stopped = ((inner < law.low) | (inner > law.high) | (held.any(axis=0) & ~held.all(axis=0))).any(axis=1)
    beside[stopped], weights[:, stopped] = finest[stopped], 0.0
    weights[-1, stopped] = 1.0
    back = implicit(asked, beside, given, 0.0, others)
    added = [
        np.einsum("jn,jn->n", weights, gains) + more for *gains, more in zip(*(run.made.added for run in runs), back.added, strict=True)
    ]
    added[2] += sum(w * own_dissipation(law, end.chi, beside, others) for w, end in zip(weights, ends, strict=True))
    sums = np.einsum("jn,jns->ns", weights, [run.made.multiplier for run in runs]) + back.multiplier
    ended = replace(
        back.end,
        failed=np.logical_or.reduce([back.end.failed, *(end.failed for end in ends)]),
        worst=np.maximum.reduce([back.end.worst, *(end.worst for end in ends)]),
        held=back.end.held | ends[-1].held,
        flow=np.where(back.end.flow != 0.0, back.end.flow, ends[-1].flow),
    )
    return Made(ended, sums, tuple(added))


def accurate(asked: StateQuestion, base: Array, to: Drive, dt: float, accuracy: float, stored: float) -> Made:
    """The step of one point in parts, each with an estimated error below the ``accuracy``, relative to ``stored``, the most of psi so far.

    A part is extrapolated from 1, 2, 3 ... implicit steps until leaving out the first of these runs hardly changes it.  That says
    nothing where flow begins or ends within a part: all runs may then agree by chance.  Such a part is made shorter, until what is on
    both sides of that place has parts of its own; the one across it is so short that its error, of second order in it, is rounding.
    """
    at, part, size, before, total = base, 0.0, _LEAST, None, None
    (psi,) = asked.law.stored(base, to(0.0)[1])[0]
    for _ in range(_MOST_PARTS):
        size = 1.0 - part if part + size > 1.0 - min(_LEAST, size) else size
        runs, apart, same, shortest = list[_Divided](), np.inf, [True], size <= 2.0 * _LEAST

        def within(share: float, part: float = part, size: float = size) -> tuple[Array, Sequence[Array]]:
            return to(min(1.0, part + size * share))

        while apart > _SAFE * accuracy and len(runs) < _MOST_RUNS and all(same):
            runs.append(_divided(asked, at, within, size * dt, len(runs) + 1))
            if runs[-1].made.end.failed[0]:
                break
            same = [True] if shortest or before is None else runs[-1].alike(before, runs[0])
            apart = _apart(asked, at, runs, within, size, stored, psi) if len(runs) > 1 else np.inf
        if not all(same):
            size = max(_LEAST, size * (same.index(False) or 0.25) / len(runs))
        elif (lost := bool(runs[-1].made.end.failed[0])) or apart > _SAFE * accuracy:
            if (lost and shortest) or size <= _FASTEST:
                return _failed(runs[-1].made, runs[-1].made.end.worst if lost else np.full(1, np.nan))
            size = max(_LEAST, 0.1 * size) if lost else max(_FASTEST, 0.1 * size if shortest else 0.4 * size)
        else:
            made = _joined(asked, runs, within)
            total = made if total is None else _after(total, made)
            if made.end.failed[0] or part + size >= 1.0:
                return total
            at, part, before = made.end.chi, part + size, runs[-1]
            stored = max(stored, abs(float(made.end.psi[0]) - psi))
            size *= _LONGER[len(runs)]
    assert total is not None
    return _failed(total, np.full(1, np.nan))


def _failed(made: Made, worst: Array) -> Made:
    return made._replace(end=replace(made.end, failed=np.ones(1, dtype=np.bool_), worst=worst))


def _after(one: Made, other: Made) -> Made:
    """Two steps, one after the other."""
    end = replace(other.end, worst=np.maximum(one.end.worst, other.end.worst), held=one.end.held | other.end.held)
    return Made(end, one.multiplier + other.multiplier, tuple(a + b for a, b in zip(one.added, other.added, strict=True)))


def _apart(asked: StateQuestion, base: Array, runs: Sequence[_Divided], to: Drive, part: float, stored: float, begun: float) -> float:
    """How much leaving out the first run changes: in the measure of psi'', and a temperature and what has no energy by themselves.

    These are relative to what they are, or come to in all of the step if they go on as in this ``part`` of it.
    """
    law, chi = asked.law, np.array([run.made.end.chi[0] for run in runs])
    counts = [len(run.patterns) for run in runs]
    whole, fewer = _weights(counts) @ chi, _weights(counts[1:]) @ chi[1:]
    size = np.maximum(np.abs(whole), np.abs(base[0]))
    apart = np.maximum(np.abs(whole - fewer) - _ROUNDED * size, 0.0)
    psi, _, hessian = law.free_energy(whole[None], to(1.0)[1])
    bent = np.abs(hessian[0])
    free, warm = ~bent.any(axis=1), np.zeros(len(size), dtype=np.bool_)
    warm[law.observables + law.internal :] = True
    alone = free | warm
    come = np.maximum(size, np.abs(whole - base[0]) / part)
    own = np.divide(apart, come, out=np.zeros_like(size), where=alone & (come > 0.0)).max()
    bent[alone], bent[:, alone] = 0.0, 0.0
    lost, most = float(apart @ bent @ apart), max(2.0 * max(stored, abs(float(psi[0]) - begun)), _SEEN * float(size @ bent @ size))
    spent = np.array([run.made.added[0][0] for run in runs])
    missed, most_spent = abs(float(_weights(counts) @ spent - _weights(counts[1:]) @ spent[1:])), float(np.abs(spent).max())
    with np.errstate(divide="ignore", invalid="ignore"):
        pairs = (lost, most), (missed - _ROUNDED * most_spent, max(most, most_spent / part))
        energies = [0.0 if less <= 0.0 else less / much for less, much in pairs]
    found = float(max(own, np.sqrt(energies[0]), energies[1]))
    return found if np.isfinite(found) else np.inf
