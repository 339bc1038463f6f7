"""The pages in docs keep their word: what they show is run, their links lead somewhere, and what is made from code is whole."""

import json
import re
import subprocess
import sys
import tomllib
from dataclasses import replace
from pathlib import Path

import jsonschema
import pytest
import yaml
from click.testing import CliRunner
from docs import generated

import duhem
from duhem.cli import cli
from duhem.cli.output import MEANINGS
from duhem.expression import WORDS
from duhem.law import catalogue
from duhem.law.atlas.entry import entries
from duhem.path import scene_file
from duhem.path.scene_file import CHOICES, KIND_KEYS, KINDS, SECTIONS, template
from duhem.screening import file as campaign_file
from tests.long import mostly_long
from tests.pages import ROOT, agrees, broken_links, in_order, run_page

DOCS = ROOT / "docs"
PAGES = sorted(page for page in DOCS.rglob("*.md") if not {"_build", "notebooks", "paper"} & set(page.relative_to(DOCS).parts))
RUN = [
    f"{page.relative_to(DOCS)}" for page in PAGES if {"console", "python"} & {language for language, _ in in_order(page.read_text("utf-8"))}
]


@pytest.mark.slow
@pytest.mark.parametrize("page", mostly_long(RUN, "how-to/read-json.md"))
def test_what_a_page_says_happens(page: str, tmp_path: Path) -> None:
    run_page((DOCS / page).read_text("utf-8"), tmp_path)


def test_an_output_that_is_another_is_seen() -> None:
    assert agrees("a\n…\nb  1.20 s\nc …\n", "a\nx\ny\nb  3.40 s\nc and more\n")
    assert not agrees("a\n…\nb\n", "a\nx\nb\nc\n") and not agrees("a …\nb\n", "a\nx\nb\n")


def test_links_lead_somewhere() -> None:
    assert {page.name: broken for page in PAGES if (broken := list(broken_links(page)))} == {}


def test_every_page_is_in_a_table_of_contents() -> None:
    listed = {
        (page.parent / f"{name}.md").resolve()
        for page in PAGES
        for block in re.findall(r"^```\{toctree\}\n(.*?)^```", page.read_text("utf-8"), flags=re.M | re.S)
        for name in block.split()
    }
    assert [page for page in PAGES if page not in listed] == [DOCS / "index.md"]


@pytest.mark.parametrize("page", generated.PAGES, ids=lambda page: page.stem)
def test_a_page_holds_what_the_code_says_now(page: Path) -> None:
    kept = page.read_text("utf-8")
    assert generated.filled(kept) == kept, "run python -m docs.generated"


def test_what_a_page_says_otherwise_than_the_code_is_replaced() -> None:
    made = generated.filled("a\n<!-- generated: exit-codes -->\nb\n")
    assert made.startswith("a\n<!-- generated: exit-codes -->\n\n| code |") and made.endswith("<!-- end of exit-codes -->\nb\n")
    assert generated.filled(made.replace("something refuted", "something else")) == made == generated.filled(made)


def test_what_is_made_from_code_is_whole() -> None:
    places = "\n".join(page.read_text("utf-8") for page in PAGES)
    made = {name: text for name, text in re.findall(r"^<!-- generated: (.+) -->\n(.+?)^<!-- end of \1 -->$", places, flags=re.M | re.S)}
    assert set(made) == set(generated.PARTS)
    assert all(f"| `{word}` |" in made["words"] for word in WORDS)
    assert all(f"| `{law.name}` |" in made["atlas"] for law in entries())
    assert all(f"## {name}\n" in made["laws"] for name in catalogue.names() if catalogue.shipped(name))
    assert all(f"| `{key}` |" in made["scene"] for keys in SECTIONS.values() for key in keys)
    for section, keys in campaign_file.KEYS.items():
        (told,) = re.findall(rf"^\[+{section}\]((?:.|\n)*?)(?=^\[+(?!{section})\w|^```)", made["campaign"], flags=re.M)
        assert [key for key in keys if not re.search(rf"(^|; or ){key} = ", told, flags=re.M)] == []
    assert all(f"| {code} | {plain} |" in made["exit-codes"] for code, plain in MEANINGS.items())
    assert list(re.findall(r"^## duhem (\S+)$", made["commands"], flags=re.M)) == list(cli.commands)
    assert all(f"\n### {name}\n" in made["python"] for name in duhem.__all__ if callable(getattr(duhem, name)))


def test_a_law_says_its_units() -> None:
    assert all(re.search(r"\bForces?: .*(unit|Pa)\b", generated._law(name)) for name in catalogue.names() if catalogue.shipped(name))


def test_the_help_says_every_exit_code() -> None:
    said = ", ".join(f"{code} {meaning}" for code, meaning in MEANINGS.items())
    assert said in " ".join((cli.help or "").split())


def test_every_key_of_a_scene_is_explained() -> None:
    keys = {(kind, key) for kind, (_, needs, may) in KINDS.items() for key in (*needs, *may, "pressure")}
    used = {f"{kind} {key}" if f"{kind} {key}" in KIND_KEYS else key for kind, key in keys}
    assert used == set(KIND_KEYS)
    assert set(CHOICES) <= {"kind", *KIND_KEYS, *(key for section in SECTIONS.values() for key in section)}


def test_a_scene_to_start_from_runs_as_do_the_paths_it_names(tmp_path: Path) -> None:
    text = template("slide")
    assert scene_file.reads(text).run().stress.shape == (31, 2)
    (tmp_path / "path.csv").write_text("u_a,u_b,sigma_n\n0,0,-1e6\n1e-3,0,-1e6\n", "utf-8")
    others = re.findall(r'^#   (kind = "(\w+)".*)$', text, flags=re.M)
    assert {kind for _, kind in others} == set(KINDS) - {"linear"}
    head, tail = text[: text.index("kind =")], text[text.index("[method]") :]
    for line, kind in others:
        keys = re.sub(r" {2,}", "\n", line.split("   with")[0])
        pressure = "" if kind == "table" else "pressure = -1e6\n"
        assert len(scene_file.reads(f"{head}{keys}\n{pressure}{tail}", folder=tmp_path).run().stress) > 10


# -- JSON ------------------------------------------------------------------------------------------------------


def held(name: str, given: object) -> None:
    """Hold what is printed to its schema, in which every object says all of its keys."""
    schema = json.loads((generated.SCHEMAS / f"{name}.schema.json").read_text("utf-8"))
    jsonschema.Draft202012Validator.check_schema(schema)
    jsonschema.Draft202012Validator(schema).validate(json.loads(json.dumps(given)))


@pytest.mark.slow
def test_verifications_and_certificates_are_as_their_schemas_say() -> None:
    two = duhem.Criterion(name="two", parameters={"mu": duhem.POSITIVE}, surfaces=(
        duhem.YieldSurface(g="norm(sigma_a, sigma_b) - mu*abs(sigma_n)"), duhem.YieldSurface(g="sigma_a - 1", flow=("1", "0")),
    ), domain={"sigma_n": duhem.Domain.between(-9, 0)})  # fmt: skip
    for law, claims in ((two, "origin"), ("wedge", "state_laws"), ("stribeck", "dissipation"), ("limacon", "convexity")):
        done = duhem.verify(law, claims=claims)
        held("verify", done.to_dict())
        held("certificate", done.certificate())
    held("verify", replace(done, effort="quick", interrupted=True).to_dict())
    together = duhem.verify("coulomb", claims="origin", coupled=True)
    held("verify", together.to_dict())
    held("certificate", together.certificate())
    assert done["convexity"].witness is not None


def test_a_key_that_no_schema_has_is_seen() -> None:
    with pytest.raises(jsonschema.ValidationError):
        held("verify", duhem.verify("coulomb", claims="origin").to_dict() | {"new": 1})


def test_the_atlas_is_as_its_schema_says() -> None:
    for law in entries():
        held("atlas", law.to_dict())


@pytest.mark.parametrize("law", mostly_long(["coulomb", "tresca"], "coulomb"))
def test_an_increment_is_as_its_schema_says(law: str) -> None:
    asked = {"coulomb": ["--trial", "1", "0", "--pressure", "-1"], "tresca": ["--trial", "1", "0", "-1"]}[law]
    value = {"coulomb": "mu=0.3", "tresca": "yield_stress=1"}[law]
    done = CliRunner().invoke(cli, ["project", law, "--set", value, *asked, "--tangent", "--format", "json"])
    held("project", json.loads(done.output))


@pytest.mark.long
def test_a_fit_is_as_its_schema_says() -> None:
    points = {"sigma_a": [0.2, -0.08, 0.0, 0.0, 0.14], "sigma_b": [0.0, 0.0, 0.12, -0.15, 0.085], "sigma_n": [-1.0] * 5}
    held("identify", duhem.identify(points).to_dict())


@pytest.mark.slow
@pytest.mark.parametrize("law", mostly_long(["coulomb", "limacon"], "coulomb"))
def test_a_mended_law_is_as_its_schema_says(law: str) -> None:
    held("mend", duhem.mend(law, "auto", {"e": "0.8"} if law == "limacon" else {}).to_dict())


@pytest.mark.long
def test_the_pages_are_built_without_a_warning(tmp_path: Path) -> None:
    pytest.importorskip("sphinx", reason="the extra docs is not installed")
    command = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", str(DOCS), str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    page = (tmp_path / "theory.html").read_text("utf-8")
    assert page.count("<math") > 50 and not re.search(r'(src|href)="https?://(?!doi|github)', page)  # nothing is fetched


# -- packaging -------------------------------------------------------------------------------------------------


def test_the_oldest_versions_are_those_that_the_project_allows() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    extras = project["optional-dependencies"]
    asked = [
        *project["dependencies"],
        *(each for extra in ("parquet", "plot", "notebooks", "report", "fast", "test") for each in extras[extra]),
    ]
    pins = (ROOT / ".ci" / "oldest.txt").read_text("utf-8").split("\n#")[0].splitlines()[1:]  # behind them: what they need
    assert pins == sorted({each.replace(">=", "==") for each in asked if not each.startswith("duhem[")})


def test_actions_run_what_is_run_here() -> None:
    jobs = yaml.safe_load((ROOT / ".github" / "workflows" / "checks.yml").read_text("utf-8"))["jobs"]
    for job in ("newest", "oldest"):
        assert jobs[job]["steps"][-1] == {"run": ".ci/run"}
    assert jobs["oldest"]["env"]["PIP_CONSTRAINT"].endswith("/.ci/oldest.txt")
    least = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["requires-python"].removeprefix(">=")
    assert jobs["oldest"]["steps"][1]["with"]["python-version"] == least == jobs["newest"]["strategy"]["matrix"]["python"][0]
