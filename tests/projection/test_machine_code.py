"""Machine code that is kept runs without numba, to the bit as through it, or not at all."""

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from duhem.projection import code_cache, file_cache
from tests.long import mostly_long

TEXT = """
from math import frexp, ldexp
import numpy as np


def own(x, power):
    room = np.empty(2)
    room[0], room[1] = x * 3.0 ** power, frexp(x)[0]
    return room[0] + ldexp(room[1], 3)


def run(given, pair, power, negative, out):
    room = np.empty(len(given))
    for i in range(len(given)):
        room[i] = own(given[i], power)
        out[i] = room[i] * pair[0] + pair[1]
        if negative:
            out[i] = -out[i]
"""
GIVEN = np.linspace(0.1, 7.0, 23)


def called(run: Any, given: Any = GIVEN) -> bytes:
    out = np.empty(len(given))
    run(given, (0.1, 2.0), 0.7, True, out)
    return out.tobytes()


@pytest.fixture(scope="module")
def through_numba(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Path, bytes]]:
    """The folder in which a first process has kept what it compiled, and what it computed."""
    pytest.importorskip("numba")
    folder = tmp_path_factory.mktemp("kept")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("DUHEM_CACHE_DIR", str(folder))
        yield folder, called(code_cache.compiled_text.__wrapped__(TEXT, "run"))


def found(folder: Path) -> Path:
    (path,) = folder.glob("*.o")
    return path


SECOND = """
import sys
import numpy as np
from duhem.projection.code_cache import compiled_text
out = np.empty(23)
compiled_text({text!r}, "run")(np.linspace(0.1, 7.0, 23), (0.1, 2.0), 0.7, True, out)
assert "numba" not in sys.modules, "numba"
sys.stdout.buffer.write(out.tobytes())
"""

AFTERWARDS = """
import numba  # that parts of it are loaded does not disturb it
space = {{}}
exec({text!r}, space)
space["own"] = numba.njit(space["own"])
again = np.empty(23)
numba.njit(space["run"])(np.linspace(0.1, 7.0, 23), (0.1, 2.0), 0.7, True, again)
assert abs(again - out).max() < 1e-12
"""


@pytest.mark.slow
@pytest.mark.parametrize("script", mostly_long([SECOND, SECOND + AFTERWARDS], SECOND), ids=["alone", "and numba afterwards"])
def test_a_second_process_computes_the_same_without_numba(script: str, through_numba: tuple[Path, bytes]) -> None:
    folder, before = through_numba
    environment = {**os.environ, "DUHEM_CACHE_DIR": str(folder)}
    done = subprocess.run([sys.executable, "-c", script.format(text=TEXT)], capture_output=True, env=environment)
    assert done.returncode == 0, done.stderr.decode()
    assert done.stdout == before


@pytest.mark.slow
def test_what_is_kept_is_run_where_numba_was_imported_too(through_numba: tuple[Path, bytes], monkeypatch: pytest.MonkeyPatch) -> None:
    _, before = through_numba
    run = code_cache.compiled_text.__wrapped__(TEXT, "run")
    monkeypatch.setitem(run.__dict__, "_by_numba", None)  # not to be called
    assert called(run) == before


@pytest.mark.slow
def test_arguments_of_other_kinds_are_compiled_for_by_themselves(through_numba: tuple[Path, bytes]) -> None:
    folder, before = through_numba
    first = found(folder)
    many = np.linspace(0.1, 7.0, 46)
    many[::2] = GIVEN
    assert called(code_cache.compiled_text.__wrapped__(TEXT, "run"), many[::2]) == before
    (other,) = set(folder.glob("*.o")) - {first}
    assert code_cache.kept(other, "run") is not None
    other.unlink()


@pytest.mark.parametrize("at", [0, 70, 300, -1, -2000])
def test_what_is_damaged_is_not_run(at: int, through_numba: tuple[Path, bytes], tmp_path: Path) -> None:
    whole = found(through_numba[0]).read_bytes()
    path = tmp_path / found(through_numba[0]).name
    path.write_bytes(whole)
    assert code_cache.kept(path, "run") is not None
    changed = bytearray(whole)
    changed[at] ^= 1
    for damaged in (bytes(changed), whole[: len(whole) // 2], b""):
        path.write_bytes(damaged)
        assert code_cache.kept(path, "run") is None
    path.unlink()
    assert code_cache.kept(path, "run") is None


def test_the_code_of_another_law_is_not_run(through_numba: tuple[Path, bytes], tmp_path: Path) -> None:
    path = tmp_path / f"other_{found(through_numba[0]).name}"
    path.write_bytes(found(through_numba[0]).read_bytes())
    assert code_cache.kept(path, "run") is None


@pytest.mark.parametrize(
    ("of", "to"), [(b"numba_frexp", b"numba_frexq"), (b'"function": "_ZN', b'"function": "_ZM'), (b'"calls"', b'"callt"')]
)
def test_what_calls_or_names_something_unknown_is_not_run(of: bytes, to: bytes, through_numba: tuple[Path, bytes], tmp_path: Path) -> None:
    rest = found(through_numba[0]).read_bytes().partition(b"\n")[2]
    assert of in rest.partition(b"\n")[0]
    path = tmp_path / "changed.o"
    file_cache.written(path, rest.replace(of, to, 1))
    assert code_cache.kept(path, "run") is None
    file_cache.written(path, rest)
    assert code_cache.kept(path, "run") is not None


def test_every_name_that_the_code_takes_from_elsewhere_is_looked_at(through_numba: tuple[Path, bytes]) -> None:
    head, _, code = found(through_numba[0]).read_bytes().partition(b"\n")[2].partition(b"\n")
    names = code_cache._undefined(code)
    assert {"numba_frexp", "numba_ldexp", "NRT_MemInfo_alloc_aligned", "pow", "PyArg_UnpackTuple"} <= set(names)
    assert all(name.encode() in head for name in names)
    with pytest.raises(ValueError, match="object file"):
        code_cache._undefined(b"MZ" + code[2:])


def test_another_processor_or_numba_has_code_of_its_own(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("numba")
    made_with = code_cache._made_with()
    assert made_with is not None
    text, known = Path("law.py"), code_cache.kinds((GIVEN, 1.0))
    places = {code_cache.place(text, "run", known), code_cache.place(text, "walk", known), code_cache.place(text, "run", ())}
    for k in range(len(made_with)):
        monkeypatch.setattr(code_cache, "_made_with", lambda k=k: (*made_with[:k], "other", *made_with[k + 1 :]))
        places.add(code_cache.place(text, "run", known))
    assert len(places) == 3 + len(made_with)


def read_only(given: Any) -> Any:
    given.flags.writeable = False
    return given


def test_kinds_are_as_fine_as_the_types_of_numba() -> None:
    numba = pytest.importorskip("numba")
    square, cube = np.ones((3, 3)), np.ones((2, 3, 4))
    bytes_ = np.zeros(8 * 4 + 1, dtype=np.int8)
    arrays = [
        square, square.T, square[:, :2], square[:2], square[:, :0], square[0], square[:, 0], read_only(np.ones(3)), cube, cube.T,
        cube[:, 0], np.ones(3, dtype=np.float32), np.ones(3, dtype=np.int8), np.ones(3, dtype=bool), np.ones((1, 1)),
        bytes_[1:].view(np.float64), np.float64(1.0), np.asfortranarray(np.ones((2, 3))), read_only(np.ones((2, 3)).T), np.ones(()),
    ]  # fmt: skip
    others: list[Any] = [1.0, 1, -(2**62), True, (), (1.0,), (1.0, 2.0), (1, 2.0), ((1.0,), 2.0), (square, square[0])]
    for a in [*arrays, *others]:
        for b in [*arrays, *others]:
            assert (code_cache.kinds([a]) == code_cache.kinds([b])) == (numba.typeof(a) == numba.typeof(b)), (a, b)


@pytest.mark.parametrize("one", [2**63, None, "text", np.float32(1.0), [1.0], np.ma.ones(2)])
def test_other_arguments_are_left_to_numba(one: Any) -> None:
    with pytest.raises(LookupError):
        code_cache.kinds([(1.0, one)])
