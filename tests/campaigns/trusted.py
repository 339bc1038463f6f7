"""What must be trusted of the kernel for one proof: the lines of code of the functions that run while it is confirmed.

    python -m tests.campaigns.trusted FOLDER          certificates, as ``duhem verify --certificate`` writes them
    python -m tests.campaigns.trusted antoni2007 puck  laws, which are verified first

A fault in a function that does not run cannot make a proof pass.  So of each proof that ``recheck`` confirms are counted the functions of
the kernel that ran, whole, with what stands outside of functions in the modules that they are from.  Comments, docstrings and blank
lines do not count.  For each rule its proofs are counted, with the median and the greatest number of lines.
"""

from __future__ import annotations

import ast
import io
import json
import sys
import tokenize
from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from statistics import median
from types import FrameType
from typing import Any

import duhem
import duhem.proof.kernel
from duhem.proof.kernel import certificate
from duhem.proof.kernel.claims import BY_CONSTRUCTION

__all__ = ["Trusted", "trusted"]

_KERNEL = Path(duhem.proof.kernel.__file__).parent
_NO_CODE = (tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.ENDMARKER)
_SAYS_NOTHING = (ast.Module, ast.ClassDef, ast.FunctionDef)  # what may begin with a docstring


@dataclass(frozen=True)
class _Source:
    """A module of the kernel, by its lines of code."""

    path: Path

    @cached_property
    def tree(self) -> ast.Module:
        return ast.parse(self.path.read_text("utf-8"))

    @cached_property
    def code(self) -> set[int]:
        """The numbers of the lines that hold code."""
        tokens = tokenize.generate_tokens(io.StringIO(self.path.read_text("utf-8")).readline)
        lines = {n for t in tokens if t.type not in _NO_CODE for n in range(t.start[0], t.end[0] + 1)}
        for node in ast.walk(self.tree):
            if isinstance(node, _SAYS_NOTHING) and ast.get_docstring(node, clean=False) is not None:
                lines -= set(range(node.body[0].lineno, (node.body[0].end_lineno or 0) + 1))
        return lines

    @cached_property
    def functions(self) -> Mapping[int, set[int]]:
        """The lines of each function or lambda, by the line that it begins with."""
        found = dict[int, set[int]]()
        for node in ast.walk(self.tree):
            if isinstance(node, ast.FunctionDef | ast.Lambda):
                first = min([node.lineno, *(d.lineno for d in getattr(node, "decorator_list", []))])
                found.setdefault(first, set()).update(set(range(first, (node.end_lineno or first) + 1)) & self.code)
        return found

    @cached_property
    def outside(self) -> set[int]:
        """The lines in no function."""
        return self.code.difference(*self.functions.values())


_SOURCES = {str(path): _Source(path) for path in _KERNEL.glob("*.py")}


@dataclass(frozen=True)
class Trusted:
    """A proof of a law, and how many ``lines`` of the kernel must be right for it."""

    law: str
    claim: str
    rule: str
    lines: int


def trusted(name: str, document: Mapping[str, Any]) -> Iterator[Trusted]:
    """Each proof in a certificate that is confirmed, asked anew after those before it."""
    settled = set[str]()
    for row in sorted(document["claims"], key=lambda row: certificate.CLAIMS.index(row["claim"])):
        if row["rule"] is None:
            continue
        ran = set[tuple[str, int]]()

        def note(frame: FrameType, event: str, _: Any, ran: set[tuple[str, int]] = ran) -> None:
            if event == "call" and frame.f_code.co_filename in _SOURCES:
                ran.add((frame.f_code.co_filename, frame.f_code.co_firstlineno))

        law = certificate.stated(document["law"], row["evidence"].get(certificate.OVER))
        sys.setprofile(note)
        try:
            against = certificate.objection(row["claim"], row["rule"], frozenset(settled), law, row["evidence"])
        finally:
            sys.setprofile(None)
        if not against:
            settled.add(row["claim"])
            yield Trusted(name, row["claim"], row["rule"], _lines(ran))


def _lines(ran: set[tuple[str, int]]) -> int:
    by_module = defaultdict[str, set[int]](set)
    for path, first in ran:
        by_module[path] |= _SOURCES[path].functions.get(first, set())
    return sum(len(lines | _SOURCES[path].outside) for path, lines in by_module.items())


def _certificates(given: list[str]) -> Iterator[tuple[str, Mapping[str, Any]]]:
    for name in given:
        if Path(name).is_dir():
            yield from ((path.stem, json.loads(path.read_text("utf-8"))) for path in sorted(Path(name).glob("*.json")))
        else:
            yield name, duhem.verify(name).certificate()


if __name__ == "__main__":
    asked = (proof for name, document in _certificates(sys.argv[1:]) for proof in trusted(name, document))
    found = [proof for proof in asked if proof.rule != BY_CONSTRUCTION]
    rules = defaultdict[tuple[str, str], list[int]](list)
    for proof in found:
        rules[proof.claim, proof.rule].append(proof.lines)
    print(f"the kernel: {sum(len(source.code) for source in _SOURCES.values())} lines of code")
    for (claim, rule), lines in sorted(rules.items()):
        print(f"{claim:12} {rule:20} {len(lines):5} proofs, median {median(lines):6.0f}, greatest {max(lines):6}")
    most = max(found, key=lambda proof: proof.lines)
    print(f"{len(found)} proofs, median {median(p.lines for p in found):.0f}, greatest {most.lines}: {most.claim} of {most.law}")
