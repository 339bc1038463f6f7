"""The atlas: every published law loads, is short, names its source, and keeps verdicts that verifying it gives."""

import json
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import duhem
from duhem.errors import InputError
from duhem.law import catalogue
from duhem.law.atlas.entry import ASKED, AtlasEntry, entries, entry, file_of, groups
from duhem.proof.claims import CLAIMS
from tests.campaigns import regions
from tests.campaigns.atlas import found, kept
from tests.long import mostly_long

Run = Callable[..., tuple[int, str, str]]

ENTRIES = {each.name: each for each in entries()}
QUICK = ("byerlee", "de-saxce-feng", "derjaguin", "howe-cutkosky", "orowan", "yamada-sun", "zmitrowicz-indefinite")


def test_python_has_the_atlas_by_name() -> None:
    assert dict(duhem.atlas()) == ENTRIES and duhem.atlas()["hill90"].verdicts["convexity"] == "refuted"
    for group, names in groups().items():
        assert tuple(duhem.atlas(group)) == names
    assert "hil90" not in duhem.atlas() and duhem.atlas().get("hil90") is None
    with pytest.raises(KeyError, match="did you mean hill90"):
        duhem.atlas()["hil90"]
    with pytest.raises(InputError, match="no group 'x'"):
        duhem.atlas("x")


def test_names_are_one_of_a_kind() -> None:
    names = [name for of_group in groups().values() for name in of_group]
    assert len(names) == len(set(names)) >= 60
    assert not {*names} & {*catalogue.names()}


@pytest.mark.parametrize("said", ENTRIES.values(), ids=ENTRIES)
def test_an_entry_says_where_it_stands_and_what_holds(said: AtlasEntry) -> None:
    file = file_of(said.name)
    assert file is not None
    text = file.read_text("utf-8")
    assert len(text.splitlines()) <= 40
    assert max(len(line) for line in text.splitlines() if not line.startswith('"--')) <= 250  # what a campaign writes is as long as it is
    assert said.summary and said.source and said.equation
    assert {*said.claims} <= {*CLAIMS}
    assert (
        {*said.verdicts}
        == {*ASKED, *(["state_laws"] if "[energy]" in text else []), *(["thermal"] if "[heat]" in text else [])}
        <= {*CLAIMS}
    )
    assert {*said.verdicts.values()} <= {verdict.value for verdict in duhem.Verdict}
    assert said.note or all(said.verdicts[claim] != "refuted" for claim in said.claims if claim in ("convexity", "dissipation", "origin"))


@pytest.mark.slow
@pytest.mark.parametrize("name", ENTRIES)
def test_an_entry_is_a_law(name: str) -> None:
    assert duhem.load(name).name == name


@pytest.mark.parametrize("name", mostly_long(ENTRIES, "howe-cutkosky"))
def test_a_law_of_the_atlas_is_its_file(name: str) -> None:
    assert duhem.load(name) == duhem.load(name.replace("-", "_")) == duhem.load(str(file_of(name)))


@pytest.mark.slow
@pytest.mark.parametrize("name", mostly_long(ENTRIES, *QUICK))
def test_the_verdicts_are_those_that_verifying_gives(name: str) -> None:
    """What is kept as open may be decided by now: the campaign writes it."""
    new = found(ENTRIES[name])
    decided = {claim: verdict for claim, verdict in ENTRIES[name].verdicts.items() if verdict not in ("tested", "undecided")}
    assert new.verdicts == new.verdicts | decided
    assert not new.witnesses


def test_a_verdict_that_is_not_so_is_seen() -> None:
    said = entry("zmitrowicz-indefinite")
    wrong = AtlasEntry(**{**vars(said), "verdicts": {**said.verdicts, "dissipation": "proved"}})
    assert found(wrong).contradictions == ("dissipation",)


def test_verdicts_are_kept_in_the_file() -> None:
    file = file_of("orowan")
    assert file is not None
    text = file.read_text("utf-8")
    assert kept(text, entry("orowan").verdicts) == text
    changed = kept(text, {"origin": "refuted"})
    assert 'verdicts = { origin = "refuted" }' in changed and changed.count("\n") == text.count("\n")


ASKED_OF = [(name, options) for name, said in ENTRIES.items() for options in said.regions]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "options"), mostly_long(ASKED_OF, ("abaqus-linear", "--over K=0:2"), ("tsai-wu", "--over f12=-2:2")))
def test_the_regions_are_those_that_are_found(name: str, options: str) -> None:
    answer = regions.answered(name, options)
    assert answer is not None and answer.told == ENTRIES[name].regions[options]


def test_regions_are_kept_in_the_file_and_asked_for() -> None:
    file = file_of("abaqus-linear")
    assert file is not None
    text = file.read_text("utf-8")
    assert regions.kept(text, entry("abaqus-linear").regions) == text
    assert '"--over K=0:2" = "x"' in regions.kept(text, {"--over K=0:2": "x"})
    own, asked = regions.questions(["abaqus-linear"])
    assert own == ("abaqus-linear", "", "", asked[3]) and asked[1:] == ("--over K=0:2", entry("abaqus-linear").regions["--over K=0:2"],
                                                                        "for K between 0.778 and 1")  # fmt: skip
    assert regions.answered("abaqus-linear", "") is None  # no free shape parameter
    wrong = regions.answered("abaqus-linear", "--over Q=0:1")
    assert wrong is not None and wrong.found is None and "unknown parameter 'Q'" in wrong.told


def lubliner(p: Any, gamma: float = 10.0) -> Any:
    alpha, beta, top = 4 / 33, 23 / 3, p.max()
    return mises(p) + alpha * p.sum() + beta * max(top, 0.0) - gamma * max(-top, 0.0) - (1 - alpha)


def hu(p: Any) -> Any:
    (x, y), s90, sb = p, 0.91, 1.035
    x2, x4 = 4 * 0.21 / 1.21, 4 * 0.69 / (1.69 * s90**4)
    return x**4 - x2 * x**3 * y + (sb**-4 - 1 + x2 - s90**-4 + x4) * x**2 * y**2 - x4 * x * y**3 + (y / s90) ** 4 - 1


def cazacu_barlat(p: Any, c: float = -2.598) -> Any:
    return (mises(p) ** 2 / 3) ** 1.5 - c * np.prod(p - p.mean()) - 1


def mises(p: Any) -> Any:
    return np.sqrt(1.5 * np.sum((p - p.mean(axis=-1, keepdims=True)) ** 2, axis=-1))


@pytest.mark.parametrize(
    ("g", "p", "q"),
    [
        (lubliner, (0.0223, 0.0223, -0.7645), (-0.0223, -0.0223, -1.2755)),
        (hu, (1.0407317083, 0.389884678), (1.0462202875, 0.4600892844)),
        (cazacu_barlat, (6.6, 6.4, 0), (0.2, -10.7, 0)),
    ],
)
def test_points_of_the_notes_are_a_chord_that_leaves_the_set(g: Callable[[Any], Any], p: Any, q: Any) -> None:
    """By formulas that share nothing with the files."""
    p, q = np.array(p), np.array(q)
    assert g(p) <= 0 and g(q) <= 0 and g((p + q) / 2) > 1e-12


def deviatoric(shape: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """A gauge from its values by the cosine of the angle from the greatest stress, in [1/2, 1]."""

    def gauge(points: Any) -> Any:
        size = mises(points) / np.sqrt(1.5)
        return size * shape((points.max(axis=1) - points.mean(axis=1)) * np.sqrt(1.5) / size)

    return gauge


def argyris(ratio: float) -> Callable[[Any], Any]:
    return deviatoric(lambda x: (1 + ratio + (1 - ratio) * (4 * x**3 - 3 * x)) / (2 * ratio))


def willam_warnke(e: float) -> Callable[[Any], Any]:
    def shape(x: Any) -> Any:
        root = np.sqrt(4 * (1 - e * e) * x * x + 5 * e * e - 4 * e)
        return (4 * (1 - e * e) * x * x + (2 * e - 1) ** 2) / (2 * (1 - e * e) * x + (2 * e - 1) * root)

    return deviatoric(shape)


def cpb06(k: float, a: int) -> Callable[[Any], Any]:
    def gauge(points: Any) -> Any:
        s = points - points.mean(axis=1, keepdims=True)
        return np.sum((np.abs(s) - k * s) ** a, axis=1) ** (1 / a)

    return gauge


def yld89(a: float) -> Callable[[Any], Any]:
    """With M = 2 and h = p = 1; the points are the stresses xx, yy and xy."""

    def gauge(points: Any) -> Any:
        x, y, t = points.T
        k1, k2 = (x + y) / 2, np.hypot((x - y) / 2, t)
        return np.sqrt(np.maximum(a * (k1 + k2) ** 2 + a * (k1 - k2) ** 2 + (2 - a) * 4 * k2**2, 0))

    return gauge


@pytest.mark.parametrize(
    ("gauge", "convex"),
    [
        (argyris(0.778), True), (argyris(0.77), False), (argyris(9 / 7), True), (argyris(1.3), False),
        (willam_warnke(0.5), True), (willam_warnke(0.48), False),
        (cpb06(1.5, 2), True), (cpb06(-1.75, 4), True), (cpb06(1, 3), True), (yld89(2), True), (yld89(4), True), (yld89(4.2), False),
    ],
)  # fmt: skip
def test_the_ends_that_the_files_keep_are_those_of_random_chords(gauge: Callable[[Any], Any], convex: bool) -> None:
    """A gauge is convex if that of a sum is no more than the sum of both; points close to each other see shallow dents."""
    one, step = np.random.default_rng(0).normal(size=(2, 100_000, 3))
    other = one + 0.3 * step
    excess = gauge(one + other) - gauge(one) - gauge(other)
    assert bool(excess.max() <= 1e-9) is convex


def test_an_entry_that_there_is_not() -> None:
    with pytest.raises(InputError, match="the atlas has no law 'nothing'"):
        entry("nothing")
    with pytest.raises(InputError, match=r"the atlas has no group 'metal'; groups are: composites"):
        entries("metal")
    with pytest.raises(InputError, match="did you mean orowan"):
        duhem.load("orovan")


def test_list_has_a_line_a_group_and_lists_a_group(run: Run) -> None:
    code, out, _ = run("list")
    assert code == 0
    assert [line.split()[:3] for line in out.splitlines()[-len(groups()) :]] == [[g, str(len(n)), "published"] for g, n in groups().items()]
    code, out, _ = run("list", "--group", "contact")
    assert code == 0
    assert tuple(line.split()[0] for line in out.splitlines()) == groups()["contact"]
    assert run("list", "--group", "nothing")[0] == 2


def test_the_atlas_is_printed(run: Run) -> None:
    code, out, _ = run("atlas", "--format", "json")
    assert code == 0
    assert [law["name"] for law in json.loads(out)] == [*ENTRIES]
    assert json.loads(out)[0] == ENTRIES[json.loads(out)[0]["name"]].to_dict()
    for form in ("text", "markdown"):
        code, out, _ = run("atlas", "--group", "friction", "--format", form)
        assert code == 0
        assert all(name in out for name in groups()["friction"])
        assert "howe-cutkosky" not in out
        (row,) = [line for line in out.splitlines() if line.replace("`", "").split()[:1] == ["orowan"] or line.startswith("| `orowan`")][:1]
        assert row.count("proved") == 5


def test_the_verbs_take_a_name_of_the_atlas(run: Run) -> None:
    assert run("verify", "derjaguin", "--claims", "origin")[0] == 0
    code, out, _ = run("project", "orowan", "--set", "mu=0.3", "--set", "k=1", "--trial", "2", "0", "--pressure", "-10")
    assert code == 0 and "1" in out
