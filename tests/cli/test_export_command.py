"""duhem export: what it writes and refuses."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest

Run = Callable[..., tuple[int, str, str]]
DISC = '[criterion]\nname = "disc"\ng = "norm(sigma_a, sigma_b) - mu*abs(sigma_n)"\n[parameters]\nmu = { positive = true }\n'


@pytest.fixture
def run(run: Run) -> Run:
    """Exit code, standard output and standard error of `duhem export ARGUMENTS`."""
    return partial(run, "export")


@pytest.mark.slow
def test_it_prints_or_writes_the_same(run: Run, tmp_path: Path) -> None:
    (tmp_path / "disc.toml").write_text(DISC)
    law = str(tmp_path / "disc.toml")
    code, out, err = run(law, "--to", "c")
    assert (code, err) == (0, "") and "int disc_increment(" in out and "dissipation  proved, checked" in out
    assert run(law, "--to", "c", "--out", str(tmp_path / "disc.c")) == (0, "", f"duhem: wrote the source to {tmp_path / 'disc.c'}\n")
    assert (tmp_path / "disc.c").read_text() == out
    code, out, _ = run(law, "--to", "fortran", "--set", "mu=0.3")
    assert code == 0 and "subroutine fric(" in out and "mu = 3/10" in out


@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "why"),
    [
        (["radial-flow", "--to", "c"], "its own flow direction"),
        (["wedge", "--to", "c"], "formula"),
        (["quartic", "--to", "c"], "convexity is refuted"),
        (["superellipse", "--to", "fortran"], "--set p=VALUE"),
        (["coulomb", "--to", "c", "--set", "nu=1"], "nu"),
        (["coulomb", "--to", "c", "--out", "nowhere/coulomb.c"], "directory"),
    ],
)
def test_what_cannot_be_written_is_one_line(run: Run, arguments: list[str], why: str) -> None:
    code, out, err = run(*arguments)
    assert (code, out) == (2, "") and why in err and err.count("\n") == 1


def test_the_law_is_not_written_over(run: Run, tmp_path: Path) -> None:
    (tmp_path / "disc.toml").write_text(DISC)
    code, _, err = run(str(tmp_path / "disc.toml"), "--to", "c", "--out", str(tmp_path / "." / "disc.toml"))
    assert code == 2 and "overwritten" in err and (tmp_path / "disc.toml").read_text() == DISC
