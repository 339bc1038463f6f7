"""What passed, failed or was skipped as the XML that readers of JUnit take, valid by the schema of Jenkins (junit-10.xsd)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from xml.etree import ElementTree

from duhem.show.page import printable

__all__ = ["JUnitCase", "JUnitSuite", "Outcome", "as_xml"]


class Outcome(StrEnum):
    """How a case ended; values are the words of the XML."""

    PASSED = "passed"
    FAILED = "failure"
    SKIPPED = "skipped"


@dataclass(frozen=True)
class JUnitCase:
    """One row: ``message`` says in a sentence why it failed or was skipped, ``text`` what else there is to say of that."""

    name: str
    outcome: Outcome = Outcome.PASSED
    message: str = ""
    text: str = ""
    output: str = ""
    seconds: float | None = None


@dataclass(frozen=True)
class JUnitSuite:
    """Cases that belong together, and ``properties`` of them all: the schema has none of a case."""

    name: str
    cases: tuple[JUnitCase, ...]
    properties: Mapping[str, str] = field(default_factory=dict)


def as_xml(suites: Iterable[JUnitSuite]) -> str:
    """The document; letters that XML has no way to write stand as Python writes them."""
    root = ElementTree.Element("testsuites", name="duhem")
    for suite in suites:
        known = [case.seconds for case in suite.cases if case.seconds is not None]
        count = {kind: str(sum(case.outcome is kind for case in suite.cases)) for kind in Outcome}
        counts = {"tests": str(len(suite.cases)), "failures": count[Outcome.FAILED], "errors": "0", "skipped": count[Outcome.SKIPPED]}
        time = {"time": f"{sum(known):.3f}"} if known else {}
        made = ElementTree.SubElement(root, "testsuite", {"name": printable(suite.name)} | counts | time)
        about = ElementTree.SubElement(made, "properties")
        for key, value in suite.properties.items():
            ElementTree.SubElement(about, "property", name=printable(key), value=printable(value))
        for case in suite.cases:
            _write(made, suite.name, case)
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode")


def _write(suite: ElementTree.Element, name: str, case: JUnitCase) -> None:
    time = {} if case.seconds is None else {"time": f"{case.seconds:.3f}"}
    made = ElementTree.SubElement(suite, "testcase", {"classname": printable(name), "name": printable(case.name)} | time)
    if case.outcome is not Outcome.PASSED:
        said = ElementTree.SubElement(made, case.outcome.value, message=printable(case.message))
        said.text = printable(case.text) or None
    if case.output:
        ElementTree.SubElement(made, "system-out").text = printable(case.output)
