"""A UMAT from its source: what Abaqus offers it, the order of its components, and routines that crash, hang, print or end."""

from __future__ import annotations

from inspect import stack
from pathlib import Path
from time import monotonic

import numpy as np
import pytest

from duhem.errors import InputError
from duhem.testing import MaterialState, Report, conformance
from duhem.testing.failures.report import as_junit, as_sheet
from duhem.testing.foreign import umat
from duhem.testing.routines import Unfinished
from tests.export.shared_library import compiler
from tests.long import mostly_long

HEAD = """
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <stddef.h>
#include <unistd.h>
void xit_(void);
void rotsig_(const double *, const double *, double *, const int *, const int *, const int *);
void sinv_(const double *, double *, double *, const int *, const int *);
void sprinc_(const double *, double *, const int *, const int *, const int *);
void sprind_(const double *, double *, double *, const int *, const int *, const int *);
void stdb_abqerr_(const int *, const char *, const int *, const double *, const char *, size_t, size_t);
void getvrm_(const char *, double *, char *, char *, int *, const int *, const int *, const int *, const int *);
void umat_(double *stress, double *statev, double *ddsdde, double *sse, double *spd, double *scd, double *rpl, double *ddsddt,
           double *drplde, double *drpldt, double *stran, double *dstran, double *time, double *dtime, double *temp, double *dtemp,
           double *predef, double *dpred, char *cmname, int *ndi, int *nshr, int *ntens, int *nstatv, double *props, int *nprops,
           double *coords, double *drot, double *pnewdt, double *celent, double *dfgrd0, double *dfgrd1, int *noel, int *npt, int *layer,
           int *kspt, int *jstep, int *kinc, size_t length)
{
    const int n = *ntens;
"""
# each component clipped at 1, modulus 2, its tangent, and its energies
CLIPPED = """
    for (int i = 0; i < n; i++) {
        const double trial = stress[i] + 2 * dstran[i], before = stress[i];
        stress[i] = trial > 1 ? 1 : trial < -1 ? -1 : trial;
        ddsdde[(n + 1) * i] = trial == stress[i] ? 2 : 0;
        *sse += (stress[i] * stress[i] - before * before) / 4;
        *spd += stress[i] * (trial - stress[i]) / 2;
    }
}
"""


@pytest.fixture
def source(tmp_path: Path):  # type: ignore[no-untyped-def]
    compiler("CC", "cc", "gcc", "clang")

    def made(first: str, rest: str = CLIPPED) -> Path:
        file = tmp_path / f"umat{len(list(tmp_path.iterdir()))}.c"
        file.write_text(HEAD + first + rest, "utf-8")
        return file

    return made


def judged(file: Path, **options: object) -> Report:
    return conformance(None, umat(file, ntens=2, nstatv=1, seconds=2.0), max_examples=2, rows=6, tries=5, seed=1, **options)  # type: ignore[arg-type]


def test_a_right_umat_passes_with_its_energies(source) -> None:  # type: ignore[no-untyped-def]
    report = judged(source(""))
    assert report.ok and {"slope", "energy", "dissipation", "stored-energy"} <= {*report.passed}, str(report)
    left = judged(source("double none[2]; sse = spd = none;")).left_out
    assert {"energy", "dissipation", "stored-energy"} <= {*left} and "none that is not 0" in left["energy"]


@pytest.mark.long
def test_a_dissipation_of_the_step_alone_is_told(source) -> None:  # type: ignore[no-untyped-def]
    report = judged(source("", CLIPPED.replace("*spd +=", "*spd =")))
    assert "does not add it to what it is given (SPD = SPD + ...)" in str(report.failure_of("dissipation")), str(report)


def test_a_balance_without_a_stored_energy_is_left_out(source) -> None:  # type: ignore[no-untyped-def]
    report = judged(source("double none; sse = &none;"))
    assert report.ok and "dissipation" in report.passed and "no stored energy" in report.left_out["energy"], str(report)


def test_what_abaqus_offers_is_there(source) -> None:  # type: ignore[no-untyped-def]
    """A stress of principal values 3, 2, 1 turned by an angle: its invariants, directions, and what turns it back."""
    text = """
    const int kind = 1, normal = 3, shear = 3;
    double s[6] = {2.5, 2.5, 1, 0.5, 0, 0}, turned[6], values[3], axes[9], p, q, none;
    const double c = sqrt(0.5), back[9] = {c, -c, 0, c, c, 0, 0, 0, 1};
    int code = 0, no = 0;
    sinv_(s, &p, &q, &normal, &shear);
    sprind_(s, values, axes, &kind, &normal, &shear);
    rotsig_(s, back, turned, &kind, &normal, &shear);
    getvrm_("S", &none, cmname, cmname, &code, &no, &no, &no, &no);
    const double found[13] = {p, q, values[0], values[1], values[2], fabs(axes[0] * axes[3]), turned[0],
                              turned[1], turned[2], turned[3], code, 0, 0};
    for (int i = 0; i < 13; i++) statev[i] = found[i];
}
"""
    material = umat(source(text, ""), nstatv=13)
    found = material.advance(material.virgin(1), np.zeros((1, 6)), None, 1.0).variables[0]
    assert found[:2].tolist() == pytest.approx([2.0, np.sqrt(3.0)]) and sorted(found[2:5]) == pytest.approx([1.0, 2.0, 3.0])
    assert (
        found[5] == pytest.approx(0.5)
        and sorted(found[6:8]) == pytest.approx([2.0, 3.0])
        and found[8:11].tolist() == pytest.approx([1.0, 0.0, 1.0])
    )


@pytest.mark.parametrize("end", ["xit_();", "{const int level = -3; stdb_abqerr_(&level, 0, 0, 0, 0, 0, 0);}", "*pnewdt = 0.25;"])
def test_an_end_of_the_analysis_is_an_increment_that_is_not_solved(source, end: str) -> None:  # type: ignore[no-untyped-def]
    file = source(f"if (dstran[0] > 1) {end}")
    for isolated in (True, False):
        material = umat(file, ntens=2, isolated=isolated)
        after = material.advance(material.virgin(2), np.array([[0.1, 0.0], [2.0, 0.0]]), None, 1.0)
        assert after.solved is not None and after.solved.tolist() == [True, False] and after.stress[0].tolist() == [0.2, 0.0]
    report = judged(file, most_flagged=0.0)
    assert not report.failures and not report.ok and report.flagged


@pytest.mark.long
def test_a_tangent_that_is_not_set_is_told(source) -> None:  # type: ignore[no-untyped-def]
    report = judged(source("double none[36]; ddsdde = none;"))
    assert report.failed == {"slope"} and "the tangent is not set: it is zero" in report.failures[0].diagnosis


@pytest.mark.parametrize(("ntens", "names"), [(6, "xx yy zz xy xz yz"), (4, "xx yy zz xy"), (3, "xx yy xy"), (2, "1 2")])
def test_names_of_components(source, ntens: int, names: str) -> None:  # type: ignore[no-untyped-def]
    material = umat(source("statev[0] = 10 * *ndi + *nshr;"), ntens=ntens, nstatv=1)
    assert material.components == tuple(names.split()) and np.allclose(material.elastic, 2.0 * np.eye(ntens))
    after = material.advance(material.virgin(1), np.zeros((1, ntens)), None, 1.0)
    assert after.variables[0, 0] == {6: 33, 4: 31, 3: 21, 2: 20}[ntens]


def test_a_temperature_is_given(source) -> None:  # type: ignore[no-untyped-def]
    material = umat(source("statev[0] = *temp;"), ntens=2, nstatv=1)
    begun = material.virgin(1)
    warm = MaterialState(begun.strain, begun.stress, begun.variables, begun.stored, begun.dissipated, temperature=np.array([350.0]))
    assert material.advance(warm, np.zeros((1, 2)), None, 1.0).variables[0, 0] == 350.0


BAD = {
    "crash": ("if (dstran[0] > 0.6) stress = 0;", "ended its process by SIGSEGV"),
    "exit": ("if (dstran[0] > 0.6) exit(3);", "ended its process with exit code 3"),
    "quiet end": ("if (dstran[0] > 0.6) exit(0);", "ended its process with exit code 0"),
    "last words": ('if (dstran[0] > 0.6) { printf("no convergence\\n"); fflush(stdout); abort(); }', "it printed: no convergence"),
    "hang": ("while (dstran[0] > 0.6) sleep(1);", "has not answered within 2 s"),
}


@pytest.mark.parametrize("first", ["*kinc == 1 && *jstep == 1", "time[1] == 0", "time[0] <= 0", "*kinc < 2"])
def test_a_state_may_be_set_to_zero_at_the_beginning(source, first: str) -> None:  # type: ignore[no-untyped-def]
    """Later increments say that they are later."""
    umat_file = source(f"if ({first}) statev[0] = 0; statev[0] += 1;")
    begun = umat(umat_file, nstatv=1, ntens=2)
    none = MaterialState(np.zeros((1, 2)), np.zeros((1, 2)), np.zeros((1, 1)), np.zeros(1), np.zeros(1))
    states = [none]
    for _ in range(3):
        states.append(begun.advance(states[-1], np.full((1, 2), 0.1), None, 0.5))
    assert [float(state.variables[0, 0]) for state in states] == [0, 1, 2, 3]


@pytest.mark.slow
@pytest.mark.parametrize("bad", mostly_long(BAD, "hang", "last words"))
def test_a_bad_routine_is_answered_soon_and_quietly(source, bad: str, capfd: pytest.CaptureFixture[str]) -> None:  # type: ignore[no-untyped-def]
    text, words = BAD[bad]
    begun = monotonic()
    report = judged(source(text))
    assert not report.ok and words in str(report) and monotonic() - begun < 60.0
    assert capfd.readouterr() == ("", "")


def test_a_hang_in_the_search_for_the_elastic_range_ends_the_run(source) -> None:  # type: ignore[no-untyped-def]
    """Each case would search again, and wait as long."""
    begun = monotonic()
    endless = umat(source("while (dstran[0] > 0.6) sleep(1);"), ntens=2, nstatv=1, seconds=0.5)
    report = conformance(None, endless, max_examples=100, rows=6, seed=1)
    assert not report.ok and "the search for the elastic range, by increments of stress of 10" in str(report), str(report)
    assert monotonic() - begun < 20.0


@pytest.mark.parametrize("unit", [1e-20, 1e-12, 1e12, 1e20])
def test_the_elastic_range_is_found_in_any_unit(source, unit: float) -> None:  # type: ignore[no-untyped-def]
    text = CLIPPED.replace("2 * dstran", f"{2 * unit} * dstran").replace("? 2 : 0", f"? {2 * unit} : 0")
    scaled = source("", text.replace("> 1 ? 1", f"> {unit} ? {unit}").replace("< -1 ? -1", f"< {-unit} ? {-unit}"))
    report = conformance(None, umat(scaled, ntens=2, nstatv=1, energies=False), max_examples=2, rows=6, tries=5, seed=1)
    assert report.ok and report.visited["slip"] > 0.1 and report.visited["stick"] > 0.1, str(report)


def test_what_is_printed_stays_away_from_the_terminal(source, capfd: pytest.CaptureFixture[str]) -> None:  # type: ignore[no-untyped-def]
    assert judged(source('printf("iteration\\n"); fflush(stdout); fprintf(stderr, "error\\n");')).ok
    assert capfd.readouterr() == ("", "")


def test_a_source_that_is_none_is_told(source, monkeypatch: pytest.MonkeyPatch) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(InputError, match=r"(?s)refuses it:\n.*error.*mend the source"):
        umat(source("this is no C;"))
    with pytest.raises(InputError, match="there is no such file"):
        umat("none.f")
    fortran = source("").with_suffix(".f")
    fortran.write_text("      end\n", "utf-8")
    monkeypatch.setenv("PATH", "")
    monkeypatch.delenv("FC", raising=False)
    with pytest.raises(InputError, match="there is no compiler: none of gfortran"):
        umat(fortran)
    monkeypatch.setenv("FC", "no-such-compiler")
    with pytest.raises(InputError, match="there is no compiler: none of no-such-compiler is on the path"):
        umat(fortran)
    with pytest.raises(InputError, match="unknown order 'ansys'; give abaqus or voigt"):
        monkeypatch.undo()
        umat(source(""), order="ansys")


def test_an_interrupt_returns_what_is_known() -> None:
    calls = []

    def update(trial: np.ndarray, pressure: object, stiffness: np.ndarray) -> np.ndarray:
        calls.append(1)
        if len(calls) > 60:
            raise KeyboardInterrupt
        return np.clip(trial, -1.0, 1.0)

    report = conformance(None, update, stiffness=[1.0, 2.0], max_examples=50, rows=4, seed=1)
    assert not report.ok and report.interrupted and report.ended == "KeyboardInterrupt" and report.points > 0
    assert "ended before its end" in str(report) and '<testcase classname="mine" name="ended">' in as_junit({"mine": report})
    assert as_sheet(report).notes[0] == ("Ended before its end", ("KeyboardInterrupt",))


def test_a_routine_that_does_not_come_back_when_it_is_asked_what_it_does_instead_ends_the_run_with_what_was_found() -> None:
    def update(trial: np.ndarray, pressure: object, stiffness: np.ndarray) -> np.ndarray:
        if "diagnosed" in {frame.function for frame in stack()}:
            raise Unfinished("endless")
        return 2.0 * trial

    report = conformance("coulomb", update, {"mu": 0.3}, max_examples=2, rows=4, seed=1, checks=["feasibility"])
    assert report.failed == {"feasibility"} and report.ended == "Unfinished: endless" and not report.interrupted
