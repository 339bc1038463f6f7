"""Lint, formatting, types and layers: the entries of .pre-commit-config.yaml, run as tests."""

import os
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parents[1]
HOOKS = [hook for repo in yaml.safe_load((ROOT / ".pre-commit-config.yaml").read_text("utf-8"))["repos"] for hook in repo["hooks"]]


@pytest.mark.parametrize(
    "hook", [pytest.param(hook, id=hook["id"], marks=[pytest.mark.slow(30)] * (hook["id"] == "mypy")) for hook in HOOKS]
)
def test_check_passes(hook: dict[str, str]) -> None:
    tool, *arguments = shlex.split(hook["entry"])
    program = shutil.which(tool, path=str(Path(sys.executable).parent))
    assert program, f'{tool} is not installed beside this Python: pip install -e ".[test]"'
    done = subprocess.run(
        [program, *arguments],
        cwd=ROOT,
        env=os.environ | {"PYTHONPATH": str(ROOT / "src"), "NO_COLOR": "1"},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    assert done.returncode == 0, f"{hook['entry']}\n{done.stdout}"
