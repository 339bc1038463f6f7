"""What is read of files that are kept: what was written there, and nothing else."""

import os
import shutil
from pathlib import Path

import pytest

from duhem.projection import file_cache

CONTENT = b"one\ntwo\n"


def test_what_was_written_is_read(tmp_path: Path) -> None:
    file_cache.written(tmp_path / "one.o", CONTENT)
    assert file_cache.read(tmp_path / "one.o") == CONTENT
    assert [path.name for path in tmp_path.iterdir()] == ["one.o"]


def test_a_file_that_stands_for_another_is_not_read(tmp_path: Path) -> None:
    file_cache.written(tmp_path / "one.o", CONTENT)
    shutil.copy(tmp_path / "one.o", tmp_path / "two.o")
    assert file_cache.read(tmp_path / "two.o") is None


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes here")
def test_what_is_no_file_is_neither_waited_for_nor_read_without_end(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "endless").symlink_to("/dev/zero")
    (tmp_path / "itself").symlink_to("itself")
    (tmp_path / "folder").mkdir()
    assert [file_cache.read(path) for path in sorted(tmp_path.iterdir())] == [None] * 4


def test_what_is_too_long_is_not_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(file_cache, "_MOST", 80)
    file_cache.written(tmp_path / "one", b"x" * 15)
    assert file_cache.read(tmp_path / "one") == b"x" * 15
    file_cache.written(tmp_path / "one", b"x" * 16)
    assert file_cache.read(tmp_path / "one") is None
