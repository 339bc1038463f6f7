"""Criterion and scene files as tests: a node a claim, and one for a run.

What cannot be asked is a test that errs: where a module or a run ended instead, the results of others would be hidden.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator
from functools import cached_property
from pathlib import Path
from typing import Any, TypeAlias

import pytest

from duhem.errors import DuhemError, InputError
from duhem.law.catalogue import load
from duhem.law.placed_toml import parsed, text_of
from duhem.path.scene import Scene
from duhem.path.scene_file import MOST_BYTES, reads
from duhem.path.simulate import parts
from duhem.proof.report import sentences
from duhem.proof.verdict import Verdict
from duhem.proof.verification import Verification, verify, wanted_claims
from duhem.show.page import Page

__all__ = ["TomlTests", "UnusableTest", "group", "group_marks"]

LookedInto: TypeAlias = Callable[[Scene], Scene]
"""As :func:`duhem.api.histories.looked_into`, which this room does not know."""


class TomlTests(pytest.File):
    """A criterion file or a scene; which of them, its tables say."""

    def __init__(self, *, looked_into: LookedInto, **whole: Any) -> None:
        super().__init__(**whole)
        self.looked_into = looked_into

    def collect(self) -> Iterator[pytest.Item]:
        try:
            text = text_of(self.path, "criterion or scene file", MOST_BYTES)
            document = parsed(text, str(self.path)).document
            if "criterion" in document:
                self.law = load(self.path)
                asked = self.config.getoption("--duhem-claims")
                named = None if asked is None else dict.fromkeys(name.strip() for name in asked.split(",") if name.strip())
                for claim in wanted_claims(named, self.law, "--duhem-claims"):
                    yield ClaimTest.from_parent(self, name=claim)
            elif "path" in document:
                scene = reads(text, str(self.path), self.path.parent)
                yield SceneTest.from_parent(self, name="simulate", scene=scene)
            else:
                remedy = "write a [criterion] (duhem init NAME) or a scene with a [path]"
                raise InputError("this is neither a criterion file nor a scene", where=f"{self.path}", remedy=remedy)
        except DuhemError as fault:
            yield UnusableTest.from_parent(self, name="read", said=str(fault))

    @cached_property
    def verification(self) -> Verification | DuhemError:
        """The verdicts on the claims that are selected, found once for all their nodes, or why there are none."""
        claims = [item.name for item in self.session.items if item.parent is self]
        try:
            return verify(self.law, claims=claims, effort=self.config.getoption("--duhem-effort"))
        except DuhemError as fault:
            return fault


class ClaimTest(pytest.Item):
    """Whether a claim is proved of a law."""

    parent: TomlTests

    def __init__(self, **whole: Any) -> None:
        super().__init__(**whole)
        group(self, self.parent.nodeid)

    def runtest(self) -> None:
        found = self.parent.verification
        if isinstance(found, DuhemError):
            pytest.fail(str(found), pytrace=False)
        result = found[self.name]
        told = result.to_dict()
        told |= {"witness": told["witness"] and json.dumps(told["witness"], sort_keys=True)}
        parts = ("verdict", "method", "scope", "trust", "witness")
        self.user_properties += [(f"duhem_{part}", told[part]) for part in parts if told[part] is not None]
        if result.verdict is Verdict.PROVED:
            return
        if result.verdict is Verdict.NOT_APPLICABLE:
            pytest.skip(result.detail)
        said = f"{self.parent.law.name}: {result.claim} is {result.verdict}: {result.detail}"
        said += "".join(f"\n  {line}" for sentence in sentences(result.witness) for line in Page(None).hanging(sentence))
        undecided = self.config.getoption("--duhem-undecided") or self.config.getini("duhem_undecided")
        if result.verdict is not Verdict.REFUTED and undecided == "xfail":
            pytest.xfail(said)
        pytest.fail(said, pytrace=False)

    def reportinfo(self) -> tuple[Path, int | None, str]:
        return self.path, None, f"{self.parent.law.name}: {self.name}"


class SceneTest(pytest.Item):
    """Whether a scene runs to its end without a step that is flagged; nothing is written."""

    parent: TomlTests

    def __init__(self, *, scene: Scene, **whole: Any) -> None:
        super().__init__(**whole)
        self.scene = scene
        group(self, self.parent.nodeid)

    def runtest(self) -> None:
        try:
            scene = self.parent.looked_into(self.scene)
            if scene.many:
                if ended := sum(part.ended_early() for part in parts(scene.batch(), scene.method, scene.threads)):
                    pytest.fail(f"{ended} points end early, at a step without a reliable answer or outside a declared range", pytrace=False)
                return
            history = scene.run()
        except DuhemError as fault:
            pytest.fail(str(fault), pytrace=False)
        self.user_properties += [("duhem_method", history.method), ("duhem_why", history.why)]

    def reportinfo(self) -> tuple[Path, int | None, str]:
        return self.path, None, f"{self.path.name}: simulate"


# -- what the tests of duhem carry -------------------------------------------------------------------------------------


def group(item: pytest.Item, name: str) -> None:
    """Mark a test; with ``--dist loadgroup`` those of one ``name`` ask for one worker (xdist 3.8 splits them under pytest 9.2)."""
    item.add_marker("duhem")
    for mark in group_marks(item.config, name):
        item.add_marker(mark)


def group_marks(config: pytest.Config, name: str) -> list[pytest.MarkDecorator]:
    """Return the marker of a group; none without xdist, which alone knows it."""
    if not config.pluginmanager.hasplugin("xdist"):
        return []
    return [pytest.mark.xdist_group(re.sub(r"[][@]", "-", name))]  # xdist looks for brackets and @ itself


class UnusableTest(pytest.Item):
    """A marker or file of which no test can be made, and the line that says why."""

    def __init__(self, *, said: str, line: int | None = None, **whole: Any) -> None:
        super().__init__(**whole)
        self.said, self.line = said, line
        group(self, self.nodeid)

    def setup(self) -> None:
        pytest.fail(self.said, pytrace=False)

    def runtest(self) -> None:
        """There is nothing to run."""

    def reportinfo(self) -> tuple[Path, int | None, str]:
        return self.path, self.line, self.name
