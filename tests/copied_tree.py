"""A copy of the checkout to which something is added, and what its commands then say."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

__all__ = ["Tree"]

ROOT = Path(__file__).parents[1]


@dataclass(frozen=True)
class Tree:
    """Source and tests, copied to ``path``."""

    path: Path

    @classmethod
    def copied(cls, folder: Path) -> Tree:
        """A copy in an empty folder, with the bytecode there is: what is not changed then is not compiled anew."""
        for name in ("src", "tests"):
            shutil.copytree(ROOT / name, folder / name)
        shutil.copy(ROOT / "pyproject.toml", folder)
        return cls(folder)

    def write(self, file: str, text: str) -> None:
        """One new file; none may be overwritten."""
        path = self.path / file
        assert not path.exists(), f"{file} is there already"
        path.write_text(text, "utf-8")

    def insert(self, file: str, after: str, row: str) -> None:
        """One row, in the place after the only line that begins with ``after``, as deep as that line."""
        path = self.path / file
        lines = path.read_text("utf-8").splitlines()
        places = [n for n, line in enumerate(lines) if line.strip().startswith(after)]
        assert len(places) == 1, f"{file}: {len(places)} lines begin with {after!r}"
        depth = len(lines[places[0]]) - len(lines[places[0]].lstrip())
        lines.insert(places[0] + 1, " " * depth + row)
        path.write_text("\n".join(lines) + "\n", "utf-8")

    def enter(self, file: str, table: str, entry: str) -> None:
        """One entry, the first, in a table that is written on one line."""
        path = self.path / file
        text = path.read_text("utf-8")
        found = re.findall(rf"^{table}\b.* = \(", text, flags=re.M)
        assert len(found) == 1, f"{file}: {len(found)} tables {table}"
        path.write_text(text.replace(found[0], f"{found[0]}{entry}, "), "utf-8")

    def run(self, *arguments: str) -> str:
        """Standard output of `python ARGUMENTS` on the copy; the command must succeed."""
        paths = os.pathsep.join([str(self.path / "src"), str(self.path)])
        environment = os.environ | {"PYTHONPATH": paths}
        command = [sys.executable, *arguments]
        done = subprocess.run(command, cwd=self.path, env=environment, capture_output=True, text=True, timeout=180)
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout
