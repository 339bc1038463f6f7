"""What the text of every benchmark has in common: what was measured above, what was left out below."""

from __future__ import annotations

from collections.abc import Sequence

from duhem.benchmark.study import Study
from duhem.show.page import Page

__all__ = ["report"]


def report(study: Study, facts: Sequence[str], parts: Sequence[Sequence[str]], page: Page) -> str:
    """Law and ``facts``, the parts, then what was left out and whether the run was stopped."""
    head = [*page.hanging(f"{study.law}: {study.subject}"), *(line for fact in facts for line in page.hanging(fact, rest=""))]
    stopped = ["Interrupted: this is what was done."] if study.interrupted else []
    return page.report([head, *parts, page.items("Left out", study.left_out), stopped])
