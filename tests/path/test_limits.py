"""What is too large is refused before there is memory for it, and what is no path is one clear error."""

import tracemalloc

import numpy as np
import pytest

import duhem
from duhem import InputError, Path
from duhem.law.table_file import MOST_NUMBERS, read_table
from duhem.path import scene_file

HEAD = 'law = "coulomb"\nstiffness = 1.0\n[parameters]\nmu = 0.3\n[path]\n'
HEX = "0x" + "f" * 4000


def refused(attempt, words):
    """The refusal of an attempt that asks for less than ten megabytes."""
    tracemalloc.start()
    try:
        with pytest.raises(InputError, match=words):
            attempt()
        assert tracemalloc.get_traced_memory()[1] < 10_000_000
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize(
    "attempt",
    [
        lambda: Path.circle(1.0, turns=1e9),
        lambda: Path.circle(1.0, turns=1.7e308, points=9_000_000),
        lambda: Path.circle(1.0, points=MOST_NUMBERS),
        lambda: Path.cycle([1.0, 1.0], cycles=4_000_000),
        lambda: Path.random(seed=1, points=6_000_000),
        lambda: Path.random(seed=1, points=1_000, dimension=100_000),
        lambda: Path.linear([[0.0, 0.0]] * 11, pressure=-1.0).refined(500_000),
        lambda: Path.linear([[0.0] * 6] * 11).refined(170_000),
    ],
)
def test_knots_are_counted_before_they_are_made(attempt):
    refused(attempt, "knots are too many")


@pytest.mark.parametrize("number", [16**4000, -(16**4000), 10**30, 2.5, True, "3", None, [3]], ids=lambda x: type(x).__name__)
def test_a_count_is_a_whole_number(number):
    path = Path.linear([[0.0, 0.0], [1.0, 1.0]], pressure=-1.0)
    for attempt in (
        lambda: Path.cycle(1.0, cycles=number),
        lambda: Path.circle(1.0, points=number),
        lambda: Path.random(seed=number, points=3),
        lambda: path.refined(number),
    ):
        refused(attempt, "give a whole number")


@pytest.mark.parametrize(
    "number", [[1.0], [1.0, 2.0], "a", None, True, 16**4000, float("nan"), float("inf"), 1j, {}], ids=lambda x: type(x).__name__
)
def test_a_circle_has_numbers(number):
    for attempt in (lambda: Path.circle(number), lambda: Path.circle(1.0, turns=number), lambda: Path.circle(1.0, start=number)):
        refused(attempt, "finite numbers|give one number")


@pytest.mark.parametrize(
    "attempt",
    [
        lambda: Path.linear([[0, 0], [1, 1]], pressure=[-1.0, [-2.0]]),
        lambda: Path.linear([[0, 0], [1, 1]], pressure=[-1.0, -2.0, -3.0]),
        lambda: Path.random(seed=1, points=4, pressure=[[-1.0, -2.0], [-1.0]]),
        lambda: Path.random(seed=1, points=4, scale=[1.0, 2.0, 3.0]),
        lambda: Path.cycle([1.0, 2.0], mean=[1.0, 2.0, 3.0]),
        lambda: Path.cycle([[1.0, 2.0]]),
        lambda: Path.cycle([1e308, 1.0], mean=[1e308, 1.0]),
        lambda: Path.circle(1e308, centre=(1e308, 1e308)),
        lambda: Path.random(seed=1, points=100, scale=1e308),
        lambda: Path.circle(1.0, chords="no"),
        lambda: Path([[0, 0], [1, 1]], None, [0, 1]),
        lambda: Path(np.zeros((2, 2)), np.zeros(3), np.arange(2.0)),
        lambda: Path.from_csv(["t.csv"]),
    ],
)
def test_what_makes_no_path(attempt):
    refused(attempt, "path|file|finite")


@pytest.mark.parametrize(
    "body",
    [
        f'kind = "circle"\nradius = {HEX}',
        f'kind = "random"\nseed = {HEX}\npoints = 5',
        f'kind = "cycle"\namplitude = 1\ncycles = {HEX}',
        'kind = "cycle"\namplitude = []\ncycles = 2',
        f'kind = "linear"\npoints = [[0, 0], [{HEX}, 1]]',
        f"kind = {HEX}",
        f'kind = "linear"\npoints = [[0, 0], [1, 1]]\n[method]\nsubsteps = {HEX}',
        'kind = "circle"\nradius = 1.0\nstart = [0, 1]',
        'kind = "circle"\nradius = 1.0\nchords = "no"',
    ],
)
def test_a_scene_says_where(body):
    with pytest.raises(InputError) as fault:
        scene_file.reads(f"{HEAD}{body}\npressure = -1.0\n", where="s.toml")
    assert all(each.where.startswith("s.toml:") for each in fault.value.faults)


@pytest.mark.parametrize("stress", ['"a"', "[[0.0], [1, 2]]", "{ a = 1 }", "true", "[[1.0, 2.0]]", HEX])
def test_the_stress_of_a_scene_is_a_list_of_numbers(stress):
    text = (
        f'law = "coulomb"\nstress = {stress}\nstiffness = 1.0\n[parameters]\nmu = 0.3\n[path]\nkind = "linear"\npoints = [[0, 0], [1, 1]]\n'
    )
    with pytest.raises(InputError) as fault:
        scene_file.reads(f"{text}pressure = -1.0\n", where="s.toml")
    assert [each.where for each in fault.value.faults][-1].startswith("s.toml:2:")


@pytest.mark.parametrize(
    ("content", "line", "words"),
    [
        ("time;u_a;u_b\n0;0;0\n1;0,5;1\n", 1, "separated by semicolons"),
        ("time\tu_a\tu_b\n0\t0\t0\n", 1, "separated by tabs"),
        ("time u_a u_b\n0 0 0\n", 1, "separated by blanks"),
        ("time|u_a|u_b\n0|0|0\n", 1, "separated by bars; separate numbers by commas, and write decimals with points"),
        ("0;0,5;0\n1;1;1\n", 1, "separated by semicolons"),
        ("time,u_a\n0,0\n1,−1\n", 3, "is not 2 numbers"),
        ("0,0,0\n1,1,1\n", 1, "there is no header"),
        ("# made by a rig\n\n0,0,0\n1,1,1\n", 3, "there is no header"),
        ("\ufeff\ufefftime,u_a,u_b\n0,0,0\n1,1,1\n", 1, r"'\\ufefftime' has an invisible character in its name"),
        ("time,u_a,u_\u200bb\n0,0,0\n1,1,1\n", 1, r"'u_\\u200bb' has an invisible character in its name"),
        ("time,u_a,u_a\n0,0,0\n1,1,1\n", 1, "'u_a' is there twice"),
        ("time,u_a\n0,0\n1,0,5\n2,1\n", 3, "is not 2 numbers; separate numbers by commas, and write decimals with points"),
        ("time,u_a\n0,zero\n1,1\n", 2, "is not 2 numbers"),
        ("time,u_a\n0,0\0\n1,1\n", 2, "not valid CSV"),
        ("time,u_a\n0," + "1" * 200_000 + "\n", 2, "not valid CSV"),
        ('time,u_a\n0,"1\n2,3"\n', 2, "no CSV|not CSV"),
        (b"\xff\xfet\x00", None, "UTF-8"),
        ("", None, "fewer than two rows"),
        ("time,u_a\n0,0\n", None, "fewer than two rows"),
    ],
)
def test_a_table_that_is_none_says_what_is_wrong(tmp_path, content, line, words):
    (tmp_path / "t.csv").write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(InputError, match=words) as fault:
        read_table(tmp_path / "t.csv")
    assert fault.value.where == f"{tmp_path / 't.csv'}{f':{line}' if line else ''}"


def test_a_scene_says_which_line_of_its_table_is_wrong(tmp_path):
    text = 'law = "coulomb"\nstiffness = 1.0\n[parameters]\nmu = 0.3\n[path]\nkind = "table"\nfile = "t.csv"\n'
    for content, place in (("time,u_a,u_b\n0,0,0\n1,0,5,1\n", ":3"), ("time;u_a\n", ":1"), ("a,b\n0,0\n1,1\n", ":1"), ("time,u_a\n", "")):
        (tmp_path / "t.csv").write_text(content)
        with pytest.raises(InputError) as fault:
            scene_file.reads(text, where="s.toml", folder=tmp_path)
        assert [each.where for each in fault.value.faults] == [f"{tmp_path / 't.csv'}{place}"]
    with pytest.raises(InputError) as fault:
        scene_file.reads(text.replace("t.csv", "none.csv"), where="s.toml", folder=tmp_path)
    assert "none.csv" in str(fault.value)


def test_a_table_is_read_with_comments_blank_lines_quotes_and_any_end_of_line(tmp_path):
    (tmp_path / "t.csv").write_bytes('\ufeff# a rig\r\n"u_a", sigma_n\r\n\r\n0,-1\r# end\r"1.5",-2\n'.encode())
    header, rows = read_table(tmp_path / "t.csv")
    assert header == ["u_a", "sigma_n"] and rows.tolist() == [[0.0, -1.0], [1.5, -2.0]]


def test_a_table_has_an_end(tmp_path, monkeypatch):
    monkeypatch.setattr("duhem.law.table_file.MOST_NUMBERS", 9)
    (tmp_path / "t.csv").write_text("u_a,u_b\n" + "0,1\n" * 5)
    with pytest.raises(InputError, match="more than 9 numbers"):
        read_table(tmp_path / "t.csv")


@pytest.mark.parametrize("stiffness", [1e150, 1e160, 1e165, 1e200, 1e290])
@pytest.mark.parametrize("method", ["implicit", "extrapolated", "exact"])
def test_a_stiffness_beyond_the_square_root_of_all_numbers_is_right_or_one_clear_error(stiffness, method):
    mu = {"mu_a_plus": 0.2, "mu_a_minus": 0.08, "mu_b_plus": 0.12, "mu_b_minus": 0.15}
    path = Path.linear([[0, 0], [1, 1], [0.5, -1]], pressure=-1.0)

    def run(k):
        return duhem.simulate("antoni2007", path, stiffness=[k, 2.0 * k], parameters=mu, method=method)

    try:
        found = run(stiffness).stress
    except InputError as fault:
        assert method == "exact" and stiffness > 1e155 and "overflow" in fault.what and fault.remedy
    else:
        assert np.abs(found - run(1e12).stress).max() < 1e-9
