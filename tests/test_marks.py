"""The command that finds stale marks counts what it should and names what is stale."""

from types import SimpleNamespace
from typing import Any

from tests.campaigns import marks


def test_stale_marks_are_named_and_each_file_keeps_a_quick_test() -> None:
    seconds = {"a.py::dear": 2.0, "a.py::fair": 0.2, "a.py::cheap": 0.1, "b.py::dear": 0.9, "b.py::dearer": 3.0, "c.py::only": 5.0}
    assert marks.stale(seconds, {"a.py::cheap"}, 0.3) == (["b.py::dearer", "a.py::dear"], ["a.py::cheap"])
    assert marks.stale(seconds, {"a.py::dear", "a.py::fair", "b.py::dearer"}, 0.3) == ([], [])


def test_all_cases_of_a_test_count(monkeypatch: Any) -> None:
    clock = iter([0.0, 1.0, 1.0, 3.5, 4.0, 4.25])
    monkeypatch.setattr(marks, "_spent", lambda: next(clock))
    meter = marks.Meter()
    for name, mark in (("x.py::test[1]", None), ("x.py::test[2]", "slow"), ("x.py::other", None)):
        item: Any = SimpleNamespace(nodeid=name, get_closest_marker=lambda _, mark=mark: mark)
        running = meter.pytest_runtest_protocol(item)
        next(running)
        try:
            running.send(True)
        except StopIteration as ended:
            assert ended.value is True
    assert meter.seconds == {"x.py::test": 3.5, "x.py::other": 0.25} and meter.marked == {"x.py::test"}
