"""README.md keeps its word: its outputs are what the program prints today, its files and snippets run, its commands are CI's."""

import os
import re
import shlex
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from duhem.cli import cli
from tests.pages import ROOT, agrees, broken_links
from tests.pages import blocks as blocks_of

README = (ROOT / "README.md").read_text("utf-8")


def blocks(language: str) -> list[str]:
    """The fenced blocks of one language, in order."""
    return blocks_of(README, language)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder that holds README's TOML blocks, each under the name its first line gives."""
    for text in blocks("toml"):
        (tmp_path / text.splitlines()[0].removeprefix("# ")).write_text(text, "utf-8")
    monkeypatch.setenv("PYTHONPATH", str(ROOT / "src"), prepend=os.pathsep)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_there_are_blocks_to_check() -> None:
    assert blocks("console") and blocks("toml") and blocks("python")


@pytest.mark.slow
@pytest.mark.parametrize("block", blocks("console"), ids=lambda block: block.splitlines()[0].removeprefix("$ "))
@pytest.mark.usefixtures("folder")
def test_output_is_what_the_program_prints(block: str, run: Callable[..., tuple[int, str, str]]) -> None:
    prompt, _, expected = block.partition("\n")
    dollar, program, *arguments = shlex.split(prompt)
    assert (dollar, program) == ("$", "duhem")
    code, said, wrong = run(*arguments)
    assert code in (0, 1), wrong
    assert agrees(expected, said), said


@pytest.mark.slow
@pytest.mark.parametrize("snippet", blocks("python"), ids=lambda snippet: snippet.splitlines()[0])
@pytest.mark.usefixtures("folder")
def test_python_snippet_runs(snippet: str) -> None:
    done = subprocess.run([sys.executable, "-W", "error", "-c", snippet], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr


def test_two_commands_set_it_up_and_the_second_is_ci() -> None:
    commands = [line for block in blocks("sh") for line in block.splitlines()]
    assert len(commands) == 2
    assert (ROOT / ".ci" / "run").read_text("utf-8").splitlines()[-1] == commands[1]


def test_every_command_named_exists_and_every_command_is_named() -> None:
    named = set(re.findall(r"(?:`|&& |^\$ )duhem ([a-z]+)", README, flags=re.M))
    assert "verify" in named
    assert named == set(cli.commands)


def test_links_lead_somewhere() -> None:
    assert "](" in README
    assert list(broken_links(ROOT / "README.md")) == []
