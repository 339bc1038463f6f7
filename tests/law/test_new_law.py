"""The acceptance test of the architecture: a new law is one file, and everything picks it up without a second edit."""

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
NEW_LAW = '''\
"""Friction with tilted axes: g = |(sigma_a + tilt sigma_b, sigma_b)|/mu - |sigma_n|.

Forces: two tangential stresses; pressure sigma_n <= 0 in compression.  Verdicts: every claim holds.  Source: made up.
"""

from duhem.law import Domain, criterion
from duhem.expression import Norm


@criterion(parameters={"tilt": Domain.between(0, "1/2")}, source="made up")
def tilted_ellipse(sigma_a, sigma_b, sigma_n, mu, tilt):
    """Friction with tilted axes."""
    return Norm(sigma_a + tilt * sigma_b, sigma_b) / mu - abs(sigma_n)
'''


@pytest.fixture(scope="module")
def source(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of src with one file more."""
    copy = tmp_path_factory.mktemp("with_new_law") / "src"
    shutil.copytree(ROOT / "src", copy, ignore=shutil.ignore_patterns("__pycache__"))
    (copy / "duhem" / "law" / "builtin" / "tilted_ellipse.py").write_text(NEW_LAW, "utf-8")
    return copy


def run(source: Path, *arguments: str) -> str:
    """Standard output of `python ARGUMENTS` on the copied source; the command must succeed."""
    done = subprocess.run(
        [sys.executable, *arguments], cwd=ROOT, env=os.environ | {"PYTHONPATH": str(source)}, capture_output=True, text=True, timeout=180
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_the_law_is_one_file_of_at_most_fifteen_lines() -> None:
    assert len(NEW_LAW.splitlines()) <= 15


def test_list(source: Path) -> None:
    assert "tilted-ellipse" in run(source, "-m", "duhem", "list")


def test_derive(source: Path) -> None:
    assert "tilt" in run(source, "-m", "duhem", "derive", "tilted-ellipse")


def test_verify(source: Path) -> None:
    report = json.loads(run(source, "-m", "duhem", "verify", "tilted-ellipse", "--format", "json"))
    assert report["generalized_standard"] is True
    assert report["dissipative"] is True


def test_the_tests_over_all_laws_take_it_up_and_pass(source: Path) -> None:
    said = run(source, "-m", "pytest", "-p", "no:cacheprovider", "-q", "-k", "tilted-ellipse or tilted_ellipse", "tests/law/test_laws.py")
    passed = re.search(r"(\d+) passed", said)
    assert passed and int(passed[1]) >= 2, said
