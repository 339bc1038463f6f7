"""Stresses given as tables are read by the names of their columns; masked entries are no numbers; memory's layout changes nothing."""

import importlib
from collections import OrderedDict
from types import MappingProxyType

import numpy as np
import pytest

import duhem
from duhem import InputError, Path, Paths
from duhem.expression.given_array import columns

TRIAL = np.array([[1.0, 0.5], [2.0, -0.25], [0.1, 3.0]])  # sigma_a, sigma_b: not alike, so that a wrong order shows
MU = {"mu_a_plus": 0.2, "mu_a_minus": 0.08, "mu_b_plus": 0.12, "mu_b_minus": 0.15}


def stress(trial, pressure=-1.0, **more):
    return duhem.project("antoni2007", trial, pressure, [1.0, 2.0], MU, **more).stress


@pytest.fixture(scope="module")
def expected():
    return stress(TRIAL)


class Frame:
    """What a data frame offers and nothing else: labels in ``columns``, columns by label, and the whole as an array."""

    def __init__(self, **content):
        self.content = content
        self.columns = list(content)

    def __getitem__(self, label):
        return self.content[label]

    def __array__(self, dtype=None, copy=None):
        return np.stack([np.asarray(column) for column in self.content.values()], axis=-1)


def frame(library, content):
    if library == "stand-in":
        return Frame(**content)
    found = pytest.importorskip(library, reason=f"{library} is not installed")
    if library == "pyarrow":
        return found.table(content)
    if library == "xarray":
        return found.Dataset({name: ("row", column) for name, column in content.items()})
    return found.DataFrame(content)


LIBRARIES = ("stand-in", "pandas", "polars", "pyarrow", "xarray")
A, B = TRIAL.T


@pytest.mark.parametrize("library", LIBRARIES)
def test_a_table_is_read_by_name_in_any_order(library, expected):
    for content in ({"sigma_a": A, "sigma_b": B}, {"sigma_b": B, "sigma_a": A}):
        assert np.array_equal(stress(frame(library, content)), expected)


@pytest.mark.parametrize("library", LIBRARIES)
@pytest.mark.parametrize(
    ("content", "words"),
    [
        ({"sigma_b": B, "x": A}, "no column sigma_a and no column x is asked for"),
        ({"sigma_a": A}, "there is no column sigma_b"),
        ({"sigma_b": B, "sigma_a": A, "sigma_n": -A}, "no column sigma_n is asked for"),
    ],
)
def test_what_is_missing_and_what_is_besides_is_one_error(library, content, words):
    with pytest.raises(InputError, match=words) as fault:
        stress(frame(library, content))
    assert fault.value.where == "trial" and "sigma_a, sigma_b, in any order" in fault.value.remedy


def test_other_tables_by_name(expected):
    records = np.array([(b, a) for a, b in TRIAL], dtype=[("sigma_b", "f8"), ("sigma_a", "f8")])
    for table in (records, {"sigma_b": B, "sigma_a": A.tolist()}, MappingProxyType(OrderedDict(sigma_b=B, sigma_a=A))):
        assert np.array_equal(stress(table), expected)
    assert np.array_equal(stress({"sigma_b": 0.5, "sigma_a": 1.0}), expected[:1])
    assert np.array_equal(stress({"ｓigma_b": B, "sigma_a": A}), expected)  # the names in their normal form


def test_a_series_and_an_array_with_labels(expected):
    class Series:
        index, values = ("sigma_b", "sigma_a"), np.array([0.5, 1.0])

        def __array__(self, dtype=None, copy=None):
            return self.values

    class Labelled:
        """As xarray.DataArray: the forces along the first dimension."""

        dims, coords = ("force", "row"), {"force": np.array(["sigma_b", "sigma_a"]), "row": np.arange(3)}

        def __array__(self, dtype=None, copy=None):
            return np.stack([B, A])

    assert np.array_equal(stress(Series()), expected[:1])
    assert np.array_equal(stress(Labelled()), expected)


@pytest.mark.parametrize("library", ["pandas", "xarray"])
def test_those_of_the_libraries(library, expected):
    found = pytest.importorskip(library, reason=f"{library} is not installed")
    if library == "pandas":
        assert np.array_equal(stress(found.Series({"sigma_b": 0.5, "sigma_a": 1.0})), expected[:1])
        assert np.array_equal(stress(found.DataFrame(TRIAL)), expected)  # without names, as an array
        assert np.array_equal(stress(TRIAL, found.Series([-1.0] * 3, index=["p", "q", "r"])), expected)
        frame = found.DataFrame(TRIAL, columns=["sigma_a", "sigma_b"], index=[3, 1, 2])
        assert np.array_equal(stress(frame, found.Series([-1.0] * 3, index=[3, 1, 2])), expected)
        with pytest.raises(InputError, match="its rows have other labels"):
            stress(frame, found.Series([-1.0] * 3, index=[1, 2, 3]))
        with pytest.raises(InputError, match="not real numbers"):
            stress(found.DataFrame({"sigma_a": ["1", "2"], "sigma_b": [1.0, 2.0]}))
    else:
        array = found.DataArray(TRIAL[:, ::-1].T, dims=("force", "row"), coords={"force": ["sigma_b", "sigma_a"]})
        assert np.array_equal(stress(array), expected) and np.array_equal(stress(array.T), expected)
        assert np.array_equal(stress(found.DataArray(TRIAL)), expected)


def test_names_that_are_none_or_twice():
    with pytest.raises(InputError, match="only some of the columns have a name"):
        columns({"sigma_a": A, 3: B}, "trial")
    with pytest.raises(InputError, match="'μ' is there twice"):
        columns({"\u00b5": A, "\u03bc": B}, "trial")
    with pytest.raises(InputError, match="differ in length"):
        stress({"sigma_a": A, "sigma_b": B[:2]})
    with pytest.raises(InputError, match="no column sigma_a, sigma_b"):
        stress({})


class Column:
    """A column as xarray has them: along named dimensions, whose entries may have labels."""

    def __init__(self, values, *dims, **coords):
        self.values, self.dims, self.coords = np.asarray(values), dims, coords

    def __array__(self, dtype=None, copy=None):
        return self.values


class Index(list):
    """Labels of rows, as pandas has them."""

    def equals(self, other):
        return self == other


class Rows(Column):
    """A column as pandas has them."""

    def __init__(self, values, *labels):
        self.values, self.index = np.asarray(values), Index(labels)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ({("s", "sigma_a"): B, ("s", "sigma_b"): A}, "trial: the columns are named at several levels"),
        ({"sigma_a": A, ("sigma_b", 0): B}, "trial: the columns are named at several levels"),
        ({"sigma_a": A > 1.0, "sigma_b": B}, r"trial\['sigma_a'\]: these are not real numbers"),
        ({"sigma_a": A, "sigma_b": np.array(["2020", "2021", "2022"], "M8[Y]")}, r"trial\['sigma_b'\]: these are not real numbers"),
        ({"sigma_a": A, "sigma_b": B.astype(object)}, r"trial\['sigma_b'\]: these are not real numbers"),
        ({"sigma_a": A, "sigma_b": B.astype([("x", "f8")])}, r"trial\['sigma_b'\]: these are not real numbers"),
        ({"sigma_a": Column(A, "p"), "sigma_b": Column(B, "q")}, "rows of 'sigma_b' have other labels than those of 'sigma_a'"),
        ({"sigma_a": Column(A, "p", p=[1, 2, 3]), "sigma_b": Column(B, "p", p=[1, 3, 2])}, "rows of 'sigma_b' have other labels"),
        ({"sigma_a": Rows(A, 1, 2, 3), "sigma_b": Rows(B, 1, 3, 2)}, "rows of 'sigma_b' have other labels"),
        ({"sigma_a": TRIAL, "sigma_b": TRIAL}, r"trial has the shape \(3, 2, 2\)"),
    ],
)
def test_columns_that_are_none(content, words):
    for table in (content, Frame(**content)) if all(isinstance(label, str) for label in content) else (content,):
        with pytest.raises(InputError, match=words):
            stress(table)


def test_labels_of_rows_and_of_forces(expected):
    assert np.array_equal(stress({"sigma_b": Rows(B, 1, 2, 3), "sigma_a": Rows(A, 1, 2, 3)}), expected)
    both = {"row": Column(["p", "q", "r"], "row"), "force": Column(["sigma_b", "sigma_a"], "force")}
    beside = {"named": Column(["sigma_b", "sigma_a"], "force")}
    for coords in (both, beside):
        assert np.array_equal(stress(Column(TRIAL[:, ::-1], "row", "force", **coords)), expected)
    table = Column(TRIAL, "row", "force", row=np.arange(3))
    assert np.array_equal(stress(table, Column([-1.0] * 3, "row", row=np.arange(3))), expected)
    with pytest.raises(InputError, match="pressure: its rows have other labels"):
        stress(table, Column([-1.0] * 3, "row", row=np.arange(3)[::-1]))


def test_what_has_no_order_is_not_taken_in_one():
    for attempt in (
        lambda named: Paths.linear(named, pressure=-1.0),
        lambda named: Paths.scaled(Path.linear([[0.0, 0.0], [1.0, 1.0]]), named),
    ):
        with pytest.raises(InputError, match="nothing says in which order"):
            attempt(Frame(u_b=[0.0, 1.0], u_a=[0.0, 2.0]))
    with pytest.raises(InputError, match="nothing says in which order"):
        duhem.project("antoni2007", TRIAL, -1.0, Frame(sigma_b=[2.0], sigma_a=[1.0]), MU)
    with pytest.raises(InputError, match="nothing says in which order"):
        Path.linear(Frame(u_b=[0.0, 1.0], u_a=[0.0, 2.0]))


def test_masked_entries_are_refused_and_an_idle_mask_is_not(expected):
    masked = np.ma.masked_array(TRIAL, [[0, 0], [0, 1], [0, 0]])
    for attempt, place in (
        (lambda: stress(masked), r"trial\[1, 1\]"),
        (lambda: stress({"sigma_a": A, "sigma_b": masked[:, 1]}), r"trial\['sigma_b'\]\[1\]"),
        (lambda: stress(TRIAL, np.ma.masked_array([-1.0] * 3, [0, 0, 1])), r"pressure\[2\]"),
        (lambda: duhem.project("antoni2007", TRIAL, -1.0, np.ma.masked_array([1.0, 2.0], [1, 0]), MU), r"stiffness\[0\]"),
        (lambda: Path.linear(masked), r"points\[1, 1\]"),
        (lambda: Path.linear(TRIAL, pressure=np.ma.masked_array([-1.0] * 3, [0, 1, 0])), r"pressure\[1\]"),
        (lambda: duhem.identify(np.ma.masked_array([[0.1, 0.2, -1.0]] * 5, [[0, 0, 0]] * 4 + [[0, 1, 0]]), "coulomb"), r"\[4, 1\]"),
        (lambda: stress(np.ma.masked), "trial"),
        (lambda: stress([*TRIAL[:2], masked[1]]), r"trial\[2\]\[1\]"),
        (lambda: stress([(0.1, np.ma.masked)]), r"trial\[0\]\[1\]"),
        (lambda: stress({"sigma_a": A, "sigma_b": [0.1, np.ma.masked, 0.1]}), r"trial\['sigma_b'\]\[1\]"),
    ):
        with pytest.raises(InputError, match=f"{place} is masked"):
            attempt()
    assert np.array_equal(stress(np.ma.masked_array(TRIAL, False)), expected)


def test_memory_and_width_of_the_numbers_change_nothing(expected):
    fixed = TRIAL.copy()
    fixed.flags.writeable = False
    wide = np.repeat(np.repeat(TRIAL, 2, 0), 3, 1)
    apart = np.asfortranarray(wide)[::2, ::3]
    swapped = TRIAL.astype(">f8")
    for given in (fixed, apart, swapped, TRIAL[::-1][::-1], TRIAL.astype(np.longdouble), np.broadcast_to(TRIAL, (3, 2))):
        assert np.array_equal(stress(given), expected)
    single = TRIAL.astype(np.float32)
    assert np.array_equal(stress(single), stress(single.astype(np.float64)))
    assert stress(single).dtype == np.float64 and np.abs(stress(single) - expected).max() < 1e-6
    assert np.array_equal(fixed, TRIAL) and np.array_equal(apart, TRIAL)


def test_a_start_is_read_by_name():
    path = Path.linear([[0, 0], [1, 1]], pressure=-1.0)
    plain, named = (
        duhem.simulate("antoni2007", path, stiffness=1.0, parameters=MU, stress=start).stress
        for start in ([0.1, -0.05], {"sigma_b": -0.05, "sigma_a": 0.1})
    )
    assert np.array_equal(plain, named)


def test_no_library_of_tables_is_imported():
    module = importlib.import_module("duhem.expression.given_array")
    assert not {"pandas", "polars", "xarray", "pyarrow"} & {*vars(module)}
