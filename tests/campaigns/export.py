"""How good an exported C routine is: python -m tests.campaigns.export

    python -m tests.campaigns.export                    the built-in laws
    python -m tests.campaigns.export coulomb hill48     these, of the atlas too
    python -m tests.campaigns.export --group metals     a group of the atlas
    python -m tests.campaigns.export --no-suite         without the property tests
    python -m tests.campaigns.export --points 100000    of all laws, the atlas's too: so many increments held against duhem.project
    python -m tests.campaigns.export --points 900 --fortran    the same called by Fortran, as Abaqus calls it, and loading paths

A row a law, at the simplest admitted values of its parameters; exit code 1 where an answer is wrong.

unsolved   how many of the trial stresses, 1.05 to 10 times beyond K, with three stiffnesses, have the status 2; the status 5, no tangent
apart      how far the stresses are from those of duhem.project, relative to the trial, and the tangents from differences
suite      the checks of duhem.testing over the whole domain of the parameters but for exponents, with the share that is not solved

With --points: at how many increments the routine and duhem.project both have an answer, and both a tangent; how far the stresses lie
apart at most, relative to the trial, and the tangents, relative to the stiffness, but where the stress has no derivative and the tangent
is one of several; how many either alone has an answer to, and how many either alone has a tangent to; that nothing slips, where the
simplest parameters leave K no end; and the routine's processor time an increment, of the quickest block.

With --fortran, FRIC or UMAT, called by a subroutine in Fortran: that it has the numbers of the C routine to the last bit (with status 5
the stiffness for a tangent, and PNEWDT < 1 where nothing is solved); and ten loading paths through slip, along edges and back, each
increment of which is held against duhem.project: how many, how many ask for a shorter step, how many slip, and how far the stresses lie
apart at most.  Of laws with a state, UMAT alone: stress, STATEV and DDSDDE along paths of so many points against duhem.simulate.
"""

from __future__ import annotations

import argparse
import ctypes
import sys
import time
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from subprocess import CalledProcessError
from tempfile import TemporaryDirectory

import numpy as np
import sympy as sp

import duhem
from duhem.errors import DuhemError
from duhem.export.routine import routine
from duhem.export.source_files import c_file, fortran_file, identifier, places
from duhem.export.state_routine import state_routine
from duhem.law import catalogue
from duhem.law.atlas.entry import entries
from duhem.law.formula_law import Criterion
from duhem.law.state import prescribed
from duhem.path.state_path import StateHistory
from duhem.path.state_step import StateLaw
from duhem.projection.result import Array, Status
from duhem.proof.verification import verify
from duhem.testing import checks_for, conformance, pressures
from tests.campaigns.increments import at_simplest, pressure_of, trials
from tests.export.shared_library import OPTIMISED, Compiled, compiled, compiler, shared, with_fortran

__all__ = ["agreement", "called_by_fortran", "measured", "state_agreement"]

_STRESS, _TANGENT, _BLOCK = 1e-12, 1e-9, 10_000
_MANY = """
void many(long count, const double *trial, double pressure, const double *stiffness, double *stress, double *tangent, int *status);

void many(long count, const double *trial, double pressure, const double *stiffness, double *stress, double *tangent, int *status)
{{
    double slip[{d}], dissipation;
    for (long i = 0; i < count; i++)
        status[i] = {name}_increment(
            trial + {d} * i, pressure, stiffness, 0, stress + {d} * i, slip, &dissipation, tangent + {d} * {d} * i);
}}
"""
_DRIVER = """
subroutine drive(steps, fresh, first, increment, press, props, nprops, initial, nstatv, stress, tangent, state, energy, cut) &
    bind(c, name="drive")
  use, intrinsic :: iso_c_binding, only: c_double, c_int
  implicit none
  integer(c_int), value :: steps, nprops, nstatv
  integer(c_int) :: fresh(steps)
  real(c_double) :: first({d}, steps), increment({d}, steps), press(steps), props(nprops), initial(nstatv), stress({d}, steps), &
    tangent({d}, {d}, steps), state(nstatv, steps), energy(2, steps), cut(steps), tau({d}), total({d}), statev(nstatv), none(160)
  integer :: i, whole(4)
  character(len=80) :: word = "MATERIAL"
  none = 0
  whole = 1
  do i = 1, steps
    if (fresh(i) == 1) then
      tau = first(:, i)
      total = 0
      statev = initial
    end if
    energy(:, i) = 0
    tangent(:, :, i) = 0
    cut(i) = 1
    call {called}
    if (cut(i) >= 1) total = total + increment(:, i)
    stress(:, i) = tau
    state(:, i) = statev
  end do
end subroutine"""  # increments one after the other, from ``first`` where they are fresh
_CALLED = {
    "umat": """umat(tau, statev, tangent(:, :, i), energy(1, i), energy(2, i), none(1), none(2), none(3:), none(13:), none(23), total, &
      increment(:, i), none(24:25), press(i), none(26), none(27), none(28:), none(30:), word, {direct}, {shears}, {d}, nstatv, &
      props, nprops, none(32:34), none(35:43), cut(i), none(44), none(45:53), none(54:62), 1, 1, 1, 1, whole, 1)""",  # PRESS is DTIME
    "fric": """fric(whole(1), tau, tangent(:, :, i), none(1:10), none(11:20), energy(1, i), energy(2, i), none(21:40), cut(i), statev, &
      increment(:, i), none(41:50), press(i), none(51), none(52), total, 1, 1, none(53:54), none(55), 1, word, word, word, 1, 1, &
      1, none(61:63), none(64:66), none(67:70), none(71:72), none(73:), {d}, 3, 1, nstatv, word, props, nprops)""",
}
_WRONG, _SETTLED, _TURNED = 1e-7, 1e-3, 5e-3


def stiffnesses(d: int) -> list[Array]:
    """One number, one a force, and coupled."""
    apart = np.geomspace(1.0, 10.0, d)
    return [np.eye(d), np.diag(apart), np.diag(apart) + 0.3 * (np.ones((d, d)) - np.eye(d))]


def measured(name: str, suite: bool) -> tuple[list[str], bool]:
    """The cells of a law, and whether something in them is wrong."""
    try:
        law = at_simplest(name)
        routine(law)
        run = compiled(law, options=OPTIMISED)
    except DuhemError as reason:
        return [str(reason).partition(";")[0], "-", "-"], False
    asked, pressure = trials(law), pressure_of(law)
    unsolved = unknown = far = turned = 0.0
    for k in stiffnesses(asked.shape[1]):
        known = duhem.project(law, asked, pressure, k)
        given = [run.one(trial, pressure or 0.0, k, ()) for trial in asked]
        state, stress = (np.array([row[i] for row in given]) for i in (0, 1))
        unsolved += float(((state > 1) & (state < 5)).sum()) / (3 * len(asked))
        unknown += float((state == 5).sum()) / (3 * len(asked))
        off = np.abs(stress - known.stress).max(axis=1) / np.abs(asked).max(axis=1)
        far = max(far, float(off[(known.status <= Status.SLIP) & ((state <= 1) | (state == 5))].max(initial=0.0)))
        turned = max(
            turned, *(_turned(run, trial, pressure or 0.0, k, row[4]) for trial, row in zip(asked, given, strict=True) if row[0] == 1), 0.0
        )
    cells = [f"{100 * unsolved:.1f} %, {100 * unknown:.1f} %", f"{far:.0e}, {turned:.0e}", _suite(name) if suite else "-"]
    return cells, far > _WRONG or turned > _TURNED or cells[2].startswith("FAILS")


class _Driven:
    """FRIC or UMAT, called by Fortran; stresses in the order of the law."""

    def __init__(self, library: ctypes.CDLL, there: Sequence[int], initial: Array) -> None:
        self.run, self.there, self.initial = library.drive, there, initial
        whole, place = ctypes.c_int, ctypes.c_void_p
        self.run.argtypes, self.run.restype = [whole, *[place] * 5, whole, place, whole, *[place] * 5], None

    def __call__(self, props: Array, fresh: Array, first: Array, increment: Array, press: Array) -> tuple[Array, ...]:
        """Stress, tangent, state, energies and PNEWDT after each increment."""
        (n, d), there = increment.shape, self.there
        given = np.zeros((2, n, d))
        given[0][:, there], given[1][:, there] = first, increment
        marks, loads = fresh.astype(np.int32), np.ascontiguousarray(press)
        stress, tangent, state = np.empty((n, d)), np.empty((n, d, d)), np.empty((n, len(self.initial)))
        energy, cut = np.empty((n, 2)), np.empty(n)
        before = (x.ctypes.data for x in (marks, given[0], given[1], loads, props))
        after = (x.ctypes.data for x in (stress, tangent, state, energy, cut))
        self.run(n, *before, len(props), self.initial.ctypes.data, len(self.initial), *after)
        return stress[:, there], np.swapaxes(tangent, 1, 2)[:, there][:, :, there], state, energy, cut

    def with_stiffness(self, k: Array) -> Array:
        """PROPS of a law without parameters."""
        own = np.empty_like(k)
        own[np.ix_(self.there, self.there)] = k
        return own.ravel()


def called_by_fortran(law: Criterion, texts: Sequence[str], names: Sequence[str], initial: Array) -> _Driven:
    """The FRIC or UMAT of a C and a Fortran file, with the ``initial`` STATEV."""
    kind, d = "umat" if law.pressure is None else "fric", len(names)
    driver = _DRIVER.format(d=d, called=_CALLED[kind].format(d=d, direct=d - d // 2, shears=d // 2))
    with TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        return _Driven(with_fortran(Path(folder), *texts, driver), places(law, names), initial)


def _paths(law: Criterion, k: Array, run: _Driven, count: int = 10) -> tuple[str, bool]:
    """Loading paths through slip, half of them where components are equal, and back, then at random; and whether a stress is wrong."""
    chance, ends = np.random.default_rng(3), trials(law, count)
    way = ends[len(ends) // 3 :][:count]  # twice as far as K
    normal = np.arange(way.shape[1]) if law.stress is None else np.flatnonzero(~np.array(law.stress.shears))
    way[1::2, normal[1:2]] = way[1::2, normal[:1]]
    way[3::4, np.setdiff1d(np.arange(way.shape[1]), normal)] = 0.0
    size = np.linalg.norm(way, axis=1)[:, None, None] / np.sqrt(way.shape[1])
    legs = [np.repeat(share * way[:, None] / 4, n, axis=1) for share, n in ((1, 6), (-1, 10))]
    asked = np.concatenate([*legs, 0.3 * size * chance.standard_normal((count, 6, way.shape[1]))], axis=1).reshape(-1, way.shape[1])
    press = np.ones(len(asked)) if law.pressure is None else chance.uniform(0.5, 2.0, len(asked))
    fresh = np.arange(len(asked)) % 22 == 0
    strain = asked @ np.linalg.inv(k)
    stress, tangent, _, _, cut = run(run.with_stiffness(k), fresh, np.zeros_like(asked), strain, press)
    before = np.where(fresh[:, None], 0.0, np.roll(stress, 1, axis=0))
    known = duhem.project(law, before + strain @ k, None if law.pressure is None else -press, k)
    solved = (cut >= 1.0) & (known.status <= Status.SLIP)
    far = np.abs(stress - known.stress)[solved].max(initial=0.0) / np.abs(ends).max()
    finite = np.isfinite(stress).all() and np.isfinite(tangent).all()
    said = f"{len(asked)} on paths, {int((cut < 1.0).sum())} cut, {int((known.status == Status.SLIP).sum())} slip, {far:.0e}"
    return said, bool(far > _STRESS or not finite)


def state_agreement(name: str, points: int) -> tuple[str, bool]:
    """The row of a law with a state whose UMAT goes along the same paths as duhem.simulate, and whether they are too far apart."""
    law = catalogue.load_formula(duhem.load(name))
    values = {n: float(x.value) for n, x in at_simplest(name).parameters.items() if x.value is not None and n not in law.variables}
    try:
        done = verify(law, claims=["convexity"])
        texts, made = (c_file(done), fortran_file(done)), state_routine(law)
    except DuhemError as reason:
        return f"no UMAT: {str(reason).partition(';')[0]}", False
    own, names, steps = StateLaw.of(law, None), prescribed(law), 20
    o, i, chance = own.observables, own.internal, np.random.default_rng(5)
    ways = np.cumsum(0.5 * chance.normal(size=(points // steps, steps + 1, o)), axis=1)
    ways -= ways[:, :1]
    known = duhem.simulate(law, duhem.Paths.linear(ways, time=np.arange(steps + 1.0)), parameters=values, tangent=True)
    assert isinstance(known, StateHistory) and known.tangent is not None
    props, run = np.array([values[n] for n in made.parameters]), called_by_fortran(law, texts, names, known.state[0, 0, o : o + i].copy())
    increments = np.diff(ways, axis=1).reshape(-1, o)
    fresh = np.arange(len(increments)) % steps == 0
    *found, energy, cut = run(props, fresh, np.zeros_like(increments), increments, np.ones(len(increments)))
    there = (known.stress, known.tangent, known.state[..., o : o + i])
    going = np.logical_and.accumulate(cut.reshape(-1, steps) >= 1.0, axis=1).ravel()  # simulate divides no step, and goes on
    going &= np.isfinite(known.stress[:, 1:]).all(axis=2).ravel()
    both = [(mine[going], theirs[:, 1:].reshape(mine.shape)[going]) for mine, theirs in zip(found, there, strict=True)]
    apart = [float(np.abs(mine - theirs).max(initial=0.0) / np.abs(theirs).max(initial=1.0)) for mine, theirs in both]
    spent = np.abs(energy[:, 1] - np.diff(known.dissipation, axis=1).ravel())[going].max(initial=0.0)
    flow = (np.diff(known.state[..., o : o + i], axis=1) != 0.0).any(axis=2).ravel()[going].sum()
    said = f"{apart[0]:.0e}, {apart[1]:.0e}, STATEV {apart[2]:.0e}, SPD {spent:.0e}  "
    said += f"{int(going.sum())} of {len(increments)} along {len(ways)} paths, {flow} flow"
    return said, bool(apart[0] > _STRESS or apart[1] > _TANGENT or apart[2] > _STRESS or spent > 1e-10)


def agreement(name: str, points: int, fortran: bool = False) -> tuple[str, bool]:
    """The row of a law whose routine and duhem.project answer the same ``points`` increments, and whether they are too far apart."""
    try:
        law = at_simplest(name)
        if law.variables and fortran:
            return state_agreement(name, points)
        done = verify(law, claims=["convexity"])
        text = c_file(done)
    except DuhemError as reason:
        return f"not exported: {str(reason).partition(';')[0]}", False
    d, pressure, ways, own = len(law.forces), pressure_of(law), stiffnesses(len(law.forces)), identifier(law.name)
    with TemporaryDirectory() as folder:
        file = Path(folder) / f"{own}.c"
        file.write_text(text + _MANY.format(d=d, name=own), "utf-8")
        many = shared([file], *OPTIMISED, with_=compiler("CC", "cc", "gcc", "clang")).many
    subroutine = called_by_fortran(law, (text, fortran_file(done)), law.forces, np.zeros(1)) if fortran else None
    place = ctypes.c_void_p
    many.argtypes, many.restype = [ctypes.c_long, place, ctypes.c_double, *[place] * 4], None
    every = trials(law, -(-points // 9))[: points // 3]
    counts, stresses, tangents, quickest, slips = Counter[str](), 0.0, 0.0, np.inf, False
    for k in ways:
        for start in range(0, len(every), _BLOCK):
            asked = np.ascontiguousarray(every[start : start + _BLOCK])
            stress, tangent, status = np.empty_like(asked), np.empty((len(asked), d, d)), np.empty(len(asked), np.int32)
            began = time.thread_time()
            many(len(asked), asked.ctypes.data, pressure or 0.0, *(x.ctypes.data for x in (k, stress, tangent, status)))
            quickest = min(quickest, (time.thread_time() - began) / len(asked))
            known = duhem.project(law, asked, pressure, k, tangent=True)
            assert known.tangent is not None
            here, there = (status < 2) | (status > 3), (known.status <= Status.SLIP) | (known.status == Status.OUTSIDE)
            far = np.abs(stress - known.stress).max(axis=1) / np.abs(asked).max(axis=1)
            turned = np.abs(tangent - known.tangent).max(axis=(1, 2)) / np.abs(k).max()
            known_here, known_there = np.isfinite(tangent).all(axis=(1, 2)), np.isfinite(known.tangent).all(axis=(1, 2))
            both = here & there
            told = {"both": both, "tangents": both & known_here & known_there, "C alone": here & ~there, "Python alone": there & ~here}
            told |= {"tangent of C alone": both & known_here & ~known_there, "tangent of Python alone": both & known_there & ~known_here}
            told["one of several"] = told["tangents"] & (turned > _TANGENT)
            for row in np.flatnonzero(told["one of several"]):
                told["one of several"][row] = _several(law, asked[row], pressure, k)
            if subroutine is not None:
                answered, ones = (status < 2) | (status == 5), np.ones(len(asked))
                carried, slope, _, _, cut = subroutine(subroutine.with_stiffness(k), ones, asked, 0.0 * asked, ones)
                expected = np.where((status == 5)[:, None, None], k, np.swapaxes(tangent, 1, 2))  # symmetric but for rounding
                alike = (carried == stress).all(axis=1) & (slope == expected).all(axis=(1, 2))
                told["OTHERS IN FORTRAN"] = np.where(answered, ~alike, False) | ((cut < 1.0) == answered)
            slips |= bool((known.slip[both] != 0.0).any())
            stresses = max(stresses, float(far[both].max(initial=0.0)))
            tangents = max(tangents, float(turned[told["tangents"] & ~told["one of several"]].max(initial=0.0)))
            counts.update({said: int(rows.sum()) for said, rows in told.items() if rows.any()})
    said = ", ".join([f"{counts[what]} {what}" for what in sorted(counts)] + ["nothing slips"] * (not slips))
    wrong = stresses > _STRESS or tangents > _TANGENT or counts["OTHERS IN FORTRAN"] > 0
    if subroutine is not None:
        on_paths, bad = _paths(law, ways[-1], subroutine)
        said, wrong = f"{said}; {on_paths}", wrong or bad
    return f"{stresses:.0e}, {tangents:.0e}  {1e9 * quickest:5.0f} ns  {said}", wrong


def _several(law: Criterion, trial: Array, pressure: float | None, k: Array) -> bool:
    """Whether the tangents beside a trial are not one: the stress has no derivative there."""
    axes = 1e-6 * np.abs(trial).max() * np.eye(len(trial))
    beside = duhem.project(law, trial + np.vstack([axes, -axes]), pressure, k, tangent=True).tangent
    return bool(np.nanmax(np.ptp(beside, axis=0)) > _SETTLED * np.abs(k).max())


def _turned(run: Compiled, trial: Array, pressure: float, k: Array, tangent: Array) -> float:
    """How far the tangent is from the slope of the answers, over the stiffness, where differences at h and h/2, either way, agree."""
    h, shares = 1e-5 * np.abs(trial).max(), np.array([1.0, 0.5, -1.0, -0.5])
    inverse, off = np.linalg.inv(k), 0.0
    here = run.one(trial, pressure, k, ())[1]
    for i, axis in enumerate(np.eye(len(trial))):
        slopes = np.array([(run.one(trial + s * h * axis, pressure, k, ())[1] - here) / (s * h) for s in shares])
        middle = slopes.mean(axis=0)
        if np.abs(slopes - middle).max() <= _SETTLED:
            off = max(off, float(np.nan_to_num(np.abs((tangent @ inverse)[:, i] - middle).max(), nan=9.0)))
    return off


def _suite(name: str) -> str:
    """Every check, of the tangent those that duhem's own are put to: with a pressure, the slope where differences resolve it."""
    law = _open(name)
    try:
        run = compiled(law, options=OPTIMISED)
    except DuhemError as reason:
        return str(reason).partition(";")[0]
    rest = [check for check in checks_for(law) if check.name not in ("slope", "multiplier")]
    reports = [conformance(law, run, checks=rest, max_examples=20)]
    pressed = pressures().filter(bool) if law.pressure else None
    reports.append(conformance(law, run, checks=["slope"], pressure=pressed, max_examples=2, rows=40))
    failed = [failure.check.name for report in reports for failure in report.failures]
    flagged = f"{100 * sum(r.flagged for r in reports) / sum(r.points for r in reports):.1f} % unsolved"
    return f"FAILS {', '.join(failed)}; {flagged}" if failed else f"{sum(len(r.passed) for r in reports)} pass; {flagged}"


def _open(name: str) -> Criterion:
    """The law with as many parameters left as can be arguments."""
    law, simple = catalogue.load_formula(duhem.load(name)), at_simplest(name)
    try:
        routine(law)
    except DuhemError:
        powers = {str(x) for power in law.g.atoms(sp.Pow) for x in power.exp.free_symbols}
        return law.fix({n: simple.parameters[n].value for n in powers if n in law.parameters})
    return law


def main(arguments: Sequence[str]) -> int:
    """Run the campaign; 1 where an answer is wrong."""
    parser = argparse.ArgumentParser(prog="python -m tests.campaigns.export", description="exported routines, compiled and tested")
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--group")
    parser.add_argument("--no-suite", action="store_true")
    parser.add_argument("--points", type=int)
    parser.add_argument("--fortran", action="store_true")
    asked = parser.parse_args(arguments)
    known = [] if asked.group else list(catalogue.names())
    names = asked.names or known + [each.name for each in entries(asked.group) if asked.group or asked.points]
    wrong = []
    for name in names:
        if asked.points:
            try:
                row, bad = agreement(name, asked.points, asked.fortran)
            except CalledProcessError:
                row, bad = "a compiler refuses it", True
            wrong += [name] * bad
            print(f"{name:<22} {row}{'  APART' * bad}", flush=True)
            continue
        cells, bad = measured(name, not asked.no_suite)
        wrong += [name] * bad
        print(f"{name:<22} {cells[0]:<15} {cells[1]:<16} {cells[2]}{'  WRONG' * bad}", flush=True)
    print(f"{len(names)} laws, wrong: {', '.join(wrong) or 'none'}")
    return bool(wrong)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
