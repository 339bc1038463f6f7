"""The pytest plugin: routines, laws and scenes as tests.  Nothing of duhem is imported until one of them is met.

**A routine**, one node a check (``test_friction.py::update[feasibility]``), the cases drawn once for all of them:

    @pytest.mark.duhem(law="orthotropic", parameters={"mu_a": 0.2, "mu_b": 0.1}, accuracy=1e-9)
    def update(trial, pressure, stiffness):  # any name: the marker makes it a test
        ...

The marker takes the arguments of :func:`duhem.testing.conformance`, and ``most_flagged``, the share of increments that the
routine may flag as not solved (0 if left out; the node ``[flagged]``).  ``expected_failed_checks`` maps the name of a check to the
reason why it fails: one that passes is a failure, and what it explains may fail with it.  ``pytest.mark.xfail`` on a routine says
that one node of it fails, whichever: it is told as expected, the others as they are.  A routine that fixtures make is handed to
``duhem_check``:

    @pytest.mark.duhem(law="coulomb")
    def test_friction_in_c(duhem_check, compiled):
        duhem_check(compiled.update)

**Files** ``*.duhem.toml``, and those that match a pattern of the ini option ``duhem_files``: of a criterion file a node a claim
(``oval.duhem.toml::convexity``), which passes where the claim is proved; of a scene a node ``simulate``, which passes where no
step is flagged.

A marker or a file that cannot be used is one test that errs (``update``, ``oval.duhem.toml::read``): it hides no results of others.

**Snapshots**: ``duhem_snapshot(law)`` compares a law with what ``--duhem-update`` has kept beside the test.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import FunctionType
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from duhem.path.scene import Scene
    from duhem.testing.failures.report import Report
    from duhem.testing.snapshots import Entry


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("duhem", "laws and update routines (duhem)")
    group.addoption("--duhem-effort", choices=("quick", "normal", "thorough"), default="normal", help="steps that each claim may cost")
    group.addoption("--duhem-claims", metavar="A,B", help="only these claims of criterion files")
    group.addoption("--duhem-profile", choices=("dev", "ci", "deep"), help="how many cases a routine is put to, and whether drawn anew")
    group.addoption("--duhem-undecided", choices=("fail", "xfail"), help="what a claim is that is neither proved nor refuted")
    group.addoption("--duhem-update", action="store_true", help="keep what snapshots find now")
    parser.addini("duhem_files", "patterns of criterion and scene files beside *.duhem.toml", type="args", default=[])
    parser.addini("duhem_undecided", "fail or xfail, as --duhem-undecided", default="fail")


def pytest_configure(config: pytest.Config) -> None:
    takes = "law, parameters, accuracy, checks, expected_failed_checks, most_flagged, ..."
    config.addinivalue_line("markers", f"duhem({takes}): an update routine that is put to the checks of a law (duhem.testing)")


def pytest_pycollect_makeitem(collector: pytest.Module | pytest.Class, name: str, obj: object) -> list[pytest.Item] | None:
    function = obj.__func__ if isinstance(obj, staticmethod) else obj
    if not isinstance(function, FunctionType) or "pytestmark" not in vars(function):
        return None
    marks = [mark for mark in function.pytestmark if mark.name == "duhem"]  # type: ignore[attr-defined]
    if not marks or "duhem_check" in function.__code__.co_varnames[: function.__code__.co_argcount]:
        return None
    from duhem.testing.in_pytest import check_items

    return check_items(collector, name, function, marks)


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    if "duhem_check" in metafunc.fixturenames:
        from duhem.testing.in_pytest import names_of_checks

        metafunc.parametrize("duhem_check", names_of_checks(metafunc.definition), indirect=True)


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    if file_path.suffix != ".toml":
        return None
    if not file_path.match("*.duhem.toml") and not any(file_path.match(pattern) for pattern in parent.config.getini("duhem_files")):
        return None
    from duhem.testing.in_pytest import TomlTests

    return TomlTests.from_parent(parent, path=file_path, looked_into=_looked_into)


@pytest.fixture
def duhem_check(request: pytest.FixtureRequest) -> Callable[..., Report]:
    """``duhem_check(update)`` puts a routine to the checks of the marker ``duhem``, one a node; it returns the report of all."""
    from duhem.testing.in_pytest import checked

    return checked(request)


@pytest.fixture
def duhem_snapshot(request: pytest.FixtureRequest) -> Callable[..., Entry]:
    """``duhem_snapshot(law, parameters=None, claims=None)`` fails where a law is not as it was kept; see ``duhem snapshot``.

    What is kept stands beside the test, in ``snapshots/<module>/<class>.<test>.json``, by the law and the values given;
    ``--duhem-update`` writes it.
    """
    from duhem.api.increments import project
    from duhem.testing.in_pytest import compared

    return compared(request, project)


def _looked_into(scene: Scene) -> Scene:
    from duhem.api.histories import looked_into

    return looked_into(scene)


__all__: list[Any] = []
