"""The catalogue: names without imports, one import per law, laws from files, modules and other distributions."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

import duhem
from duhem.errors import InputError
from duhem.expression import WORDS
from duhem.law import catalogue
from duhem.law.criterion_file import read, reads

LAWS = catalogue.names()


def modules_after(code: str) -> set[str]:
    """The modules a fresh process has imported after ``code``."""
    report = "\nimport json, sys; print(json.dumps(sorted(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code + report], capture_output=True, text=True, check=True)
    return set(json.loads(done.stdout.splitlines()[-1]))


def test_names_match_the_files() -> None:
    files = {p.stem.replace("_", "-") for p in Path(duhem.__path__[0], "law", "builtin").glob("[!_]*.*")}
    assert files
    assert files <= set(LAWS)
    assert {"antoni2007", "antoni2007-1d", "coulomb"} <= set(LAWS)


@pytest.mark.parametrize("name", LAWS)
def test_every_name_loads_a_law_of_that_name(name: str) -> None:
    law = duhem.load(name)
    assert law.name == name
    assert law.summary
    assert duhem.load(law) is law
    assert catalogue.summary(name)


def test_names_and_summaries_import_nothing_heavy() -> None:
    loaded = modules_after("from duhem.law import catalogue; assert [catalogue.summary(n) for n in catalogue.names()]")
    assert not {"sympy", "numpy", "duhem.law.formula_law", "duhem.law.builtin.lobes"} & loaded


@pytest.mark.slow
def test_only_the_law_asked_for_is_imported() -> None:
    loaded = modules_after("import duhem; duhem.load('coulomb'); duhem.load('lobes')")
    assert {m for m in loaded if m.startswith("duhem.law.builtin.")} == {"duhem.law.builtin.lobes"}


def test_underscores_name_the_same_law() -> None:
    assert duhem.load("antoni2007_1d") is duhem.load("antoni2007-1d")


def test_unknown_law_suggests_the_nearest() -> None:
    with pytest.raises(InputError, match=r"unknown law 'colomb'; did you mean coulomb"):
        duhem.load("colomb")


def test_path_and_text_of_a_path(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(catalogue.template("mine"), "utf-8")
    assert duhem.load(path) == duhem.load(str(path)) == read(path)


@pytest.mark.slow
def test_the_template_is_a_law_that_verifies() -> None:
    law = reads(catalogue.template("mine"))
    assert law.name == "mine"
    result = duhem.verify(law)
    assert result.generalized_standard is True
    assert result.dissipative is True


@pytest.mark.parametrize("name", ["", "a b", "../up", '"', "a\nb", "x" * 100])
def test_the_template_refuses_what_names_no_law(name: str) -> None:
    with pytest.raises(InputError):
        catalogue.template(name)


def test_module_and_attribute(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "mylaws_here.py").write_text(
        "import duhem\n@duhem.criterion\ndef thin(sigma_a, sigma_b, sigma_n, mu):\n    'Thin.'\n    return abs(sigma_a)/mu + sigma_n\n"
    )
    (tmp_path / "mylaws_broken.py").write_text("1/0\n")
    (tmp_path / "mylaws_ending.py").write_text("raise SystemExit(3)\n")
    monkeypatch.syspath_prepend(tmp_path)
    law = duhem.load("mylaws_here:thin")
    assert law.name == "thin"
    assert duhem.load("thin") is law
    assert "thin" in catalogue.names()
    assert catalogue.summary("thin") == "Thin."
    faults = {
        "mylaws_here:none": "cannot be imported",
        "mylaws_here:duhem": "not a Criterion",
        "mylaws_broken:x": "ZeroDivisionError",
        "mylaws_ending:x": "SystemExit: 3",
        "no_such_module:x": "cannot be imported",
        "a b:c": "not of the form",
    }
    for reference, words in faults.items():
        with pytest.raises(InputError, match=words):
            duhem.load(reference)


@pytest.mark.slow
def test_laws_of_other_distributions(tmp_path: Path) -> None:
    info = tmp_path / "outside-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: outside\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text("[duhem.criteria]\nouter = outside_laws:outer\n")
    (tmp_path / "outside_laws.py").write_text(
        "from duhem import Criterion, POSITIVE\n"
        "outer = Criterion(name='outer', g='norm(sigma_a, sigma_b)/mu + sigma_n', parameters={'mu': POSITIVE})\n"
    )
    code = (
        f"import sys; sys.path.insert(0, {str(tmp_path)!r})\n"
        "from duhem import load\n"
        "from duhem.law import catalogue\n"
        "assert 'outer' in catalogue.names() and catalogue.summary('outer') == 'from outside'\n"
        "assert 'outside_laws' not in sys.modules\n"
        "assert load('outer').name == 'outer'"
    )
    assert "outside_laws" in modules_after(code)


@pytest.mark.parametrize("nothing", [3, None, b"coulomb"])
def test_what_is_no_law(nothing: object) -> None:
    with pytest.raises(InputError, match="is no law"):
        duhem.load(nothing)  # type: ignore[arg-type]


def test_the_package_exports_what_it_lists() -> None:
    for name in duhem.__all__:
        assert getattr(duhem, name) is not None
    with pytest.raises(AttributeError):
        duhem.nothing  # noqa: B018


def test_the_template_names_every_word() -> None:
    lines = [line for line in catalogue.template("mine").splitlines() if line.startswith("#   abs ")]
    assert [sorted(line.removeprefix("#").split()) for line in lines] == [sorted(WORDS)]
