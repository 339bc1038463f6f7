"""Where results go: never over what is read, never through a link, whole or not at all."""

import errno
import os
from pathlib import Path

import pytest

from duhem import InputError
from duhem.show.place import check_place, check_places, write, written


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "law.toml").write_text("law")
    (tmp_path / "sub").mkdir()
    return tmp_path


@pytest.mark.parametrize(
    "spelled", ["law.toml", "./law.toml", "sub/../law.toml", "sub//..//law.toml", "{folder}/law.toml", "around/law.toml"]
)
def test_what_is_read_is_no_place_however_it_is_spelled(folder, spelled):
    (folder / "around").symlink_to(folder, target_is_directory=True)
    with pytest.raises(InputError, match="would be overwritten"):
        check_place(spelled.format(folder=folder), ["coulomb", "law.toml"])


def test_a_link_to_the_result_that_is_read_is_the_same_file(folder):
    (folder / "alias.toml").symlink_to("law.toml")
    os.link("law.toml", "second.toml")
    for read in ("alias.toml", "second.toml"):
        with pytest.raises(InputError, match="would be overwritten"):
            check_place("law.toml", [read])
    check_place("new.toml", ["law.toml", "alias.toml"])


def test_the_name_of_a_law_is_no_file(folder):
    check_place("coulomb", ["coulomb"])
    check_places(["a.csv", None, "b.csv"], ["coulomb"])


def test_no_name_is_no_place(folder):
    for attempt in (check_place, lambda file: check_places([None, file]), lambda file: write(file, "x")):
        with pytest.raises(InputError, match="no file is named"):
            attempt("")
    assert sorted(os.listdir()) == ["law.toml", "sub"]


def test_two_results_have_two_places(folder):
    with pytest.raises(InputError, match="two results"):
        check_places(["a.png", "sub/../a.png"])


@pytest.mark.parametrize(
    ("place", "said"), [("link", "link"), ("dangling", "link"), ("pipe", "a device or a pipe"), ("/dev/null", "a device")]
)
def test_links_and_devices_are_refused_and_left(folder, place, said):
    (folder / "link").symlink_to("law.toml")
    (folder / "dangling").symlink_to("nothing")
    os.mkfifo("pipe")
    for attempt in (check_place, lambda file: write(file, "x")):
        with pytest.raises(InputError, match=said):
            attempt(place)
    assert (folder / "law.toml").read_text() == "law" and (folder / "dangling").is_symlink() and not (folder / "nothing").exists()


def test_what_fails_half_way_leaves_what_was_there_and_nothing_beside(folder):
    def full():
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    before = sorted(os.listdir())
    with pytest.raises(InputError, match="No space left") as fault, written("law.toml") as beside:
        Path(beside).write_text("ha")
        full()
    assert "free disk space" in fault.value.remedy
    assert (folder / "law.toml").read_text() == "law" and sorted(os.listdir()) == before
    with pytest.raises(KeyboardInterrupt), written("law.toml") as beside:
        raise KeyboardInterrupt
    assert (folder / "law.toml").read_text() == "law" and sorted(os.listdir()) == before


def test_a_full_device_says_so(folder, monkeypatch):
    """What the system says of a full disk: here its device, which takes nothing, stands for the file beside."""
    if not os.path.exists("/dev/full"):
        pytest.skip("no /dev/full here")
    with pytest.raises(InputError, match="No space left on device"), written("law.toml"), open("/dev/full", "w") as stream:
        stream.write("x" * 100_000)
    assert (folder / "law.toml").read_text() == "law"


def test_what_is_written_is_whole_with_its_line_ends_and_the_rights_of_a_new_file(folder):
    before = os.umask(0o027)
    try:
        write("new.csv", "a\nb\r\nµ\n")
    finally:
        os.umask(before)
    assert (folder / "new.csv").read_bytes() == "a\nb\r\nµ\n".encode() and (folder / "new.csv").stat().st_mode & 0o777 == 0o640


def test_a_name_that_no_file_can_have_is_refused_and_a_long_one_is_not(folder):
    for name in ("x" * 5000, "a\0b"):
        with pytest.raises(InputError, match="duhem cannot write there"):
            check_place(name)
    write("µ" * 120 + ".csv", "whole")  # 244 of the 255 bytes that a name may have
    assert (folder / ("µ" * 120 + ".csv")).read_text() == "whole"
