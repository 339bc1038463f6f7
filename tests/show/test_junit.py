"""JUnit's XML: only what its schema has, where it has it; and whatever a name holds, an XML parser reads it."""

from __future__ import annotations

import pytest

from duhem.show.junit import JUnitCase, JUnitSuite, Outcome, as_xml
from tests.oracles.junit_schema import read


def test_a_suite_counts_its_cases() -> None:
    cases = [
        JUnitCase("a", seconds=0.25),
        JUnitCase("b", Outcome.FAILED, "why", "more\nlines", seconds=1.0),
        JUnitCase("c", Outcome.SKIPPED),
    ]
    root = read(as_xml([JUnitSuite("one", tuple(cases), {"seed": "7"}), JUnitSuite("two", ())]))
    one, two = root
    counted = ("tests", "failures", "errors", "skipped", "time")
    assert [one.get(name) for name in counted] == ["3", "1", "0", "1", "1.250"]
    assert [two.get(name) for name in counted] == ["0", "0", "0", "0", None]
    assert {case.get("name"): [child.tag for child in case] for case in one.iter("testcase")} == {
        "a": [],
        "b": ["failure"],
        "c": ["skipped"],
    }
    failure = one.find(".//failure")
    assert failure is not None and failure.get("message") == "why" and failure.text == "more\nlines"


@pytest.mark.parametrize("name", ["<script>alert(1)</script>", 'a"b&c]]>', "nul \0 and \x1b[31m and \ud800", "turned \u202e about"])
def test_any_name_is_text(name: str) -> None:
    case = JUnitCase(name, Outcome.FAILED, name, name)
    (suite,) = read(as_xml([JUnitSuite(name, (case,), {name: name})]))
    shown = [suite.get("name"), *(x.get("name") for x in suite.iter("testcase")), *(x.get("value") for x in suite.iter("property"))]
    assert len(set(shown)) == 1 and shown[0] is not None and shown[0].isprintable()
    if name.isprintable():
        assert shown[0] == name
