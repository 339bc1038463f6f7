"""Docstrings as reStructuredText: the package writes formulas in plain text, indented, with | | for sizes and * for products."""

import re

_KEPT = re.compile(r"(``.+?``|:[a-z:]+:`[^`]+`)")  # what is marked up already


def as_restructured_text(app, what, name, obj, options, lines):
    """Escape what Sphinx would take for markup, and make indented paragraphs literal blocks (an event of autodoc)."""
    made, literal = [], False
    for line in lines:
        indented = line.startswith("    ")
        if indented and not literal and (not made or not made[-1].strip()) and not _within_list(made):
            made += ["::", ""]
            literal = True
        elif line.strip() and not indented:
            literal = False
        made.append(line if literal else _escaped(line))
    lines[:] = made


def _within_list(made):
    last = next((line for line in reversed(made) if line.strip()), "")
    return last.lstrip().startswith("- ")


def _escaped(line):
    parts = _KEPT.split(line)
    return "".join(part if index % 2 else re.sub(r"([|*]|_(?!\w))", r"\\\1", part) for index, part in enumerate(parts))
