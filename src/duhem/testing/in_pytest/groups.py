"""What every test of duhem's carries: the marker ``duhem``, and where xdist is, the group of those that share their work."""

from __future__ import annotations

import re

import pytest

__all__ = ["group", "group_marks"]


def group(item: pytest.Item, name: str) -> None:
    """Mark a test; with ``--dist loadgroup`` those of one ``name`` ask for one worker (xdist 3.8 splits them under pytest 9.2)."""
    item.add_marker("duhem")
    for mark in group_marks(item.config, name):
        item.add_marker(mark)


def group_marks(config: pytest.Config, name: str) -> list[pytest.MarkDecorator]:
    """The marker of a group; none without xdist, which alone knows it."""
    if not config.pluginmanager.hasplugin("xdist"):
        return []
    return [pytest.mark.xdist_group(re.sub(r"[][@]", "-", name))]  # xdist looks for brackets and @ itself
