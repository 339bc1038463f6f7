"""The atlas: every published law loads, is short, names its source, and keeps verdicts that verifying it gives."""

import json
from collections.abc import Callable

import pytest

import duhem
from duhem.errors import InputError
from duhem.law import catalogue
from duhem.law.atlas.entry import ASKED, AtlasEntry, entries, entry, file_of, groups
from duhem.proof.claims import CLAIMS
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
    assert max(map(len, text.splitlines())) <= 250
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
