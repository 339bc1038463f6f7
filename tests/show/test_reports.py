"""Every report keeps to the width it is given and says the same at each; a terminal gives its own."""

import os
import re
import subprocess
import sys
from collections.abc import Callable
from functools import cache

import pytest
import sympy as sp

import duhem
from duhem.benchmark.extreme_cases import AXES, ExtremeCases, Refusal, Tally
from duhem.benchmark.measurement import Measurement, Spread, Target
from duhem.benchmark.work_precision import WorkPrecision
from duhem.micromodel.experiment import STEEL_ON_ALUMINIUM
from duhem.omitted import LeftOut
from duhem.projection import report as increment
from duhem.proof.report import as_text
from duhem.show.page import Page
from duhem.show.printing import draw, latex, markdown, text
from tests.long import mostly_long

WIDTHS = (60, 96, 200)
COORDINATE = re.compile(r"\w+ [=~] -?[\d.]+(E-?\d+)?( = -?[\d/]+)?(?=,|$)")
METHODS = ("closed-form", "closed-form, numba", "newton", "cvxpy CLARABEL", "cvxpy SCS")
COMMON = {
    "law": "antoni2007",
    "subject": "mu_a_plus = 0.2, mu_a_minus = 0.08, mu_b_plus = 0.12, mu_b_minus = 0.15; stiffness 1, 2",
    "machine": {"processor": "Some Processor", "processors_usable": 2, "system": "Linux", "python": "3.11", "versions": {"numpy": "2.4.6"}},
    "left_out": (LeftOut("cvxpy ECOS", "not installed, pip install ecos"), LeftOut("axis seam distance", "a law in 1 force has none " * 3)),
    "interrupted": True,
}


def work_precision() -> WorkPrecision:
    spread, errors = Spread(1.2e-5, 4.5e-4, 3.2e-3, 5), {"stress": 2e-16, "slip": 3.5e-4}
    rows = [Measurement("increment", m, f"tolerance 1e-{i:02}", errors, spread, i) for i, m in enumerate(METHODS)]
    rows += [Measurement("path", "exact", "4 steps a segment", {"stress": 1e-15}, spread)]
    rows += [Measurement("increment", "cvxpy SCS", "", failure="SolverError: the solver gave up, as it often does, without a word " * 2)]
    rows += [Measurement("throughput", "newton", "N = 1000", seconds=spread, note="2000 points: its cost a point does not fall with N")]
    rows += [Measurement("throughput", "newton", "extra memory", {"megabytes": 0.25})]
    targets = (
        Target("closed form (numba) / memory bandwidth", 3.25, "<=", 5.0),
        Target("CVXPY", None, ">=", 1e4, "numba is not installed"),
    )
    return WorkPrecision(**COMMON, repeats=5, rows=tuple(rows), targets=targets, reference={"increment": 1e-72, "path": "K has no end"})


def extreme_cases() -> ExtremeCases:
    rows = [
        Tally(axis, f"1e{e}", e, m, 4, 4, 3, i % 2, 15.5 - i, 3.25, i, 1, "ArithmeticError: overflow" if e == 8 and i == 1 else None)
        for axis in AXES
        for e in (0, 8, 290)
        for i, m in enumerate(METHODS)
    ]
    refused = (Refusal("trial nan", "newton", "trial[2, 1]", False, "answered [0.0, 0.0]"),)
    return ExtremeCases(**COMMON, rows=tuple(rows), refusals=refused, reference=1e-60)


@cache
def verified(name: str = "rotated-flow") -> Callable[[Page], str]:
    done = duhem.verify(name)
    return lambda page: as_text(done, page)


def projected() -> Callable[[Page], str]:
    law = duhem.load("antoni2007").fix({"mu_a_plus": 0.2, "mu_a_minus": 0.08, "mu_b_plus": 0.12, "mu_b_minus": 0.15})
    done = duhem.project(law, [0.3, 0.2], -1.0, 1.0, tangent=True)
    return lambda page: increment.text(law, [0.3, 0.2], -1.0, done, page)


REPORTS: dict[str, Callable[[], Callable[[Page], str]]] = {
    "verify": verified,
    "project": projected,
    "bench": lambda: lambda page: text(work_precision(), page),
    "stress": lambda: lambda page: text(extreme_cases(), page),
    "experiment": lambda: lambda page: text(STEEL_ON_ALUMINIUM, page, scatter=sp.Rational(1, 100)),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(REPORTS, "verify", "bench"))
def test_a_report_keeps_to_its_width_and_loses_nothing(name: str) -> None:
    shown = REPORTS[name]()
    said = {width: shown(Page(width)) for width in (None, *WIDTHS)}
    for width in WIDTHS:
        for line in said[width].splitlines():
            whole = COORDINATE.sub("coordinate", line)  # never torn apart, however long its fraction
            assert len(line) <= width or len(whole.split()) <= 2, f"{line!r} is wider than {width}"
        lost = [word for word in set(said[None].split()) if said[width].split().count(word) < said[None].split().count(word)]
        assert [word for word in lost if not set(word) <= {"-"}] == []  # a rule is as long as its table is wide


@pytest.mark.slow
@pytest.mark.parametrize("name", ["radial-flow", "rotated-flow", "limacon"])
@pytest.mark.parametrize("width", [40, 60, 96])
def test_a_coordinate_of_a_witness_stands_on_one_line(name: str, width: int) -> None:
    done = verified(name)
    said = done(Page(width))
    every = [m.group() for line in done(Page(None)).splitlines() for m in COORDINATE.finditer(line) if not m.group().startswith("g =")]
    assert len(every) > 4 and [coordinate for coordinate in every if coordinate not in said] == []


def test_long_names_of_an_increment_stand_in_columns() -> None:
    names = [f"component_of_the_stress_number_{i}_along_its_axis" for i in range(2)]
    pressure = "component_of_the_stress_across_the_interface"
    law = duhem.Criterion(
        "long", f"norm({', '.join(names)}) + mu*{pressure}", {"mu": duhem.Domain.fixed("1/2")}, forces=names, pressure=pressure
    )
    lines = increment.text(law, [3.0, 4.0], -1.0, duhem.project(law, [3.0, 4.0], -1.0), Page()).splitlines()
    assert max(map(len, lines)) <= 96
    fields = {line.split()[0]: line for line in lines if line.startswith(("  parameters", f"  {pressure}", "  method", "  status"))}
    assert len(fields) == 4 and {len(re.match(r"  \S+ +", line).group()) for line in fields.values()} == {len(pressure) + 4}
    table = [line for line in lines if line.startswith(("  force", f"  {names[0]}", f"  {names[1]}"))]
    assert len(table) == 3 and len({len(line) for line in table}) == 1


@pytest.mark.parametrize("width", [40, 50, 60, 96])
@pytest.mark.parametrize(("name", "pressure"), [("antoni2007", "sigma_n"), ("von-mises", None), ("cohesive", "sigma_n")])
def test_every_block_of_tangents_says_its_columns_where_it_is_folded(name: str, pressure: str | None, width: int) -> None:
    law = duhem.load(name)
    law = law.fix({parameter: 0.2 for parameter in law.parameters})
    trial = [0.3 + 0.1 * i for i in range(len(law.forces))]
    done = duhem.project(law, trial, -1.0 if pressure else None, 1.0, tangent=True)
    said = increment.text(law, trial, -1.0, done, Page(width))
    assert max(map(len, said.splitlines())) <= width
    part = said[said.index("Tangent d") : said.index("Optimality")]
    columns = [*(f"displacement along {force}" for force in law.forces), *([pressure] if done.tangent_pressure is not None else [])]
    blocks = part.count(f"  {law.forces[-1]} ")
    if blocks == 1:
        assert "displacement along" not in part  # one row a force below the title, which says the order
        return
    headings = [block.splitlines() for block in part.split("\n  by ")[1:]]
    assert len(headings) == blocks
    shown = " ".join(word for block in headings for line in block[: -len(law.forces)] for word in line.split())
    assert sorted(shown.split()) == sorted(" ".join(columns).split())


SAYING = [["list"], ["explain", "convexity"], ["verify", "coulomb", "--claims", "origin"]]


def piped(*arguments: str) -> str:
    return subprocess.run([sys.executable, "-m", "duhem", *arguments], capture_output=True, text=True, timeout=120).stdout


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="no pseudo-terminals")
@pytest.mark.parametrize("arguments", mostly_long(SAYING, SAYING[1]), ids=" ".join)
def test_a_terminal_is_as_wide_as_it_says(arguments: list[str]) -> None:
    ours, theirs = os.openpty()
    process = subprocess.Popen(
        [sys.executable, "-m", "duhem", *arguments], stdout=theirs, stderr=subprocess.DEVNULL, env=os.environ | {"COLUMNS": "60"}
    )
    os.close(theirs)
    shown = b""
    while chunk := _read(ours):
        shown += chunk
    os.close(ours)
    assert process.wait(120) == 0
    lines = shown.decode().replace("\r\n", "\n").splitlines()
    assert max(map(len, lines)) <= 60
    wide = piped(*arguments)
    assert max(map(len, wide.splitlines())) > 60

    def words(text: str) -> list[str]:  # without rules and times
        return [word for word in sorted(text.split()) if not set(word) <= set("-0123456789.")]

    assert words(" ".join(lines)) == words(wide)


def _read(terminal: int) -> bytes:
    try:
        return os.read(terminal, 65536)
    except OSError:  # Linux says so when the other side is closed
        return b""


@pytest.mark.slow
def test_what_programs_read_has_a_line_a_law() -> None:
    assert len(piped("list").splitlines()) == len({line.split()[0] for line in piped("list").splitlines()}) > 20


def test_a_value_that_nothing_shows_says_so() -> None:
    for show in (text, latex, markdown, draw):
        with pytest.raises(TypeError, match="int is not shown as"):
            show(3)


def test_a_long_fraction_is_short_in_the_scope_and_whole_in_json() -> None:
    exact = "1250019684171951/6250000000000000"
    values = {"mu_a_plus": "0.20000314946751216", "mu_a_minus": "1e30", "mu_b_plus": "1/3"}
    found = duhem.verify("antoni2007", values, claims="origin")
    (row,) = re.findall(r"^origin +proved.*$", as_text(found, Page(None)), flags=re.M)
    assert "all other parameters, mu_a_plus ~ 0.20000315, mu_a_minus = 1E+30, mu_b_plus = 1/3" in row
    assert exact in text(found)  # what the law states has it whole
    assert found.to_dict()["claims"][0]["scope"].startswith(f"all other parameters, mu_a_plus = {exact}, mu_a_minus = 1{'0' * 30}, ")
