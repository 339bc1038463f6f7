"""Pages in Markdown keep their word: their blocks are read here, for README.md and for docs alike."""

import os
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

__all__ = ["ROOT", "agrees", "blocks", "broken_links", "in_order", "masked", "named", "run_page"]

ROOT = Path(__file__).parents[1]
_BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", flags=re.M | re.S)
_NAME = re.compile(r"^(?:#|!|/\*) ([\w-]+\.(?:toml|csv|py|c|f90))(?: \*/)?$")
_COMPILERS = ("cc", "gfortran")


def in_order(text: str) -> list[tuple[str, str]]:
    """The fenced blocks of a page, each with its language."""
    return _BLOCK.findall(text)


def blocks(text: str, language: str) -> list[str]:
    """The fenced blocks of one language, in order."""
    return [block for each, block in in_order(text) if each == language]


def named(block: str) -> str | None:
    """The file that a block is, if its first line says so in a comment."""
    found = _NAME.match(block.split("\n", 1)[0])
    return found[1] if found else None


def masked(output: str) -> str:
    """Output with the times at the ends of its lines masked."""
    return re.sub(r" +\d+\.\d+ s$", " TIME", output.strip(), flags=re.M)


def agrees(expected: str, printed: str) -> bool:
    """Whether output is what a page shows; a line with an ellipsis stands for any lines, one at an end for the rest of the line."""
    parts = re.split(r"(^…\n|…(?=\n))", masked(expected) + "\n", flags=re.M)
    pattern = "".join({"…\n": "(?:.*\n)*", "…": "[^\n]*"}.get(part, re.escape(part)) for part in parts)
    return re.fullmatch(pattern, masked(printed) + "\n") is not None


def run_page(text: str, folder: Path) -> None:
    """Do what a page says, block by block in ``folder``: write its files, run its commands and snippets, compare what is printed."""
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(ROOT / "src"), os.environ.get("PYTHONPATH", "")])}

    def run(*command: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(command, capture_output=True, text=True, timeout=240, cwd=folder, env=environment)

    for language, block in in_order(text):
        name = named(block)
        if name is not None:
            (folder / name).write_text(block.split("\n", 1)[1] if name.endswith(".csv") else block, "utf-8")
        if language == "console":
            prompt, _, expected = block.partition("\n")
            dollar, program, *arguments = shlex.split(prompt)
            assert (dollar, program) == ("$", "duhem"), prompt
            done = run(sys.executable, "-m", "duhem", *arguments)
            assert done.returncode in (0, 1), done.stderr
            assert agrees(expected, done.stdout), f"{prompt}\n{done.stdout}"
        elif language == "sh" and (command := shlex.split(block))[0] in _COMPILERS:
            if shutil.which(command[0]) is None:
                pytest.skip(f"there is no {command[0]} here")
            done = run(*command)
            assert done.returncode == 0, done.stderr
        elif language == "python":
            done = run(sys.executable, "-W", "error", *(["-c", block] if name is None else [name]))
            assert done.returncode == 0, f"{block}\n{done.stderr}"


def broken_links(page: Path) -> Iterator[str]:
    """The links of a page that lead to no file, or to no heading of one."""
    text = _BLOCK.sub("", page.read_text("utf-8"))
    for target in re.findall(r"\]\((?!https?:)([^)]+)\)", text):
        place, _, anchor = target.partition("#")
        leads_to = page.parent / place if place else page
        if not leads_to.exists() or (anchor and anchor not in _anchors(leads_to)):
            yield target


def _anchors(page: Path) -> set[str]:
    """The names of the headings of a page, as GitHub and MyST make them."""
    titles = re.findall(r"^#+ +(.*)$", _BLOCK.sub("", page.read_text("utf-8")), flags=re.M)
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}
