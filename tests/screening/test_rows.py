"""Which rows a campaign has: every one from its number alone, exact, and what is wrong with one is wrong with no other."""

import json
from fractions import Fraction
from importlib import import_module

import pytest

import duhem
from duhem import InputError
from duhem.screening import file
from duhem.screening.campaign import asked, given

HEAD = '[campaign]\nclaims = ["origin", "convexity"]\n'
LIMACON = '[[rows]]\nlaw = "limacon"\n'


def rows(folder, text):
    campaign = file.reads(HEAD + text, folder=folder)
    return [campaign.row(number) for number in range(1, len(campaign) + 1)]


def values(found):
    return [dict(row.values) for row in found]


def test_a_grid_has_every_combination_the_last_axis_first(tmp_path):
    found = rows(tmp_path, f"{LIMACON}grid = {{ mu = [0.3, 0.4], e = [0.1, '1/3', 0.6] }}\n")
    assert [row.number for row in found] == [1, 2, 3, 4, 5, 6]
    assert values(found) == [{"mu": mu, "e": e} for mu in ("3/10", "2/5") for e in ("1/10", "1/3", "3/5")]


def test_blocks_follow_each_other_and_globs_are_sorted(tmp_path):
    for name in "ba":
        (tmp_path / f"{name}.toml").write_text(f'[criterion]\nname = "{name}"\ng = "norm(sigma_a, sigma_b) - abs(sigma_n)"\n')
    found = rows(tmp_path, f'[[rows]]\nlaws = ["coulomb", "*.toml"]\n{LIMACON}set = {{ mu = 0.3, e = 0.5 }}\n')
    assert [row.name.shown for row in found] == ["coulomb", "a.toml", "b.toml", "limacon"]
    assert [row.law().name for row in found] == ["coulomb", "a", "b", "limacon"]
    assert values(found)[-1] == {"mu": "3/10", "e": "1/2"}


@pytest.mark.slow
def test_a_draw_keeps_the_constraints_and_each_point_comes_from_its_number(tmp_path, monkeypatch):
    monkeypatch.setattr(import_module("duhem.screening.campaign"), "_TRIES", 30)
    text = '[[rows]]\nlaw = "law.toml"\ndraw = { n = 10, seed = 3, mu = [0, 2] }\n'
    law = '[criterion]\nname = "o"\nforces = ["x"]\npressure = false\ng = "abs(x) - mu"\nconstraints = ["mu < e"]\n[parameters]\n'
    (tmp_path / "law.toml").write_text(f"{law}mu = {{ positive = true }}\ne = {{ min = 0, max = 1 }}\n")
    found = rows(tmp_path, text)
    drawn = [{name: Fraction(value) for name, value in row.values.items()} for row in found]
    assert all(0 < point["mu"] < point["e"] <= 1 for point in drawn) and len({point["mu"] for point in drawn}) == 10
    campaign = file.reads(HEAD + text, folder=tmp_path)
    assert dict(campaign.row(7).values) == dict(found[6].values)
    assert values(rows(tmp_path, text.replace("seed = 3", "seed = 4"))) != values(found)
    nowhere = rows(tmp_path, text.replace("mu = [0, 2]", "mu = [2, 3]").replace("n = 10", "n = 1"))
    assert "none of 30 random draws" in nowhere[0].fault


def test_a_table_is_read_as_it_is_written_and_a_malformed_line_is_one_row(tmp_path):
    digits = "0.30000000000000000000000000001"
    (tmp_path / "c.csv").write_text(f"mu,id,e\n{digits},one,0.1\n0.3,two,x\n0.3\n\n0.3,four,0.9\n0.3,five,7\n")
    text = f'{LIMACON}table = "c.csv"\ncolumns = ["mu", "e"]\n'
    found = rows(tmp_path, text)
    assert values(found)[0] == {"mu": f"{Fraction(digits)}", "e": "1/10"}
    campaign = file.reads(HEAD + text, folder=tmp_path)
    lines = [asked(campaign, number) for number in range(1, 6)]
    assert [each[0].verdict for each in lines] == ["proved", None, None, "refuted", None]
    assert "'x' is not a number" in lines[1][0].error and "1 cell for 3 columns" in lines[2][1].error and "outside" in lines[4][0].error
    assert [line.claim for line in lines[0]] == ["convexity", "origin"] and json.loads(lines[3][0].witness)["parameters"]["e"] == "9/10"


def test_a_number_as_small_or_as_large_as_is_read_is_read_from_a_table_too(tmp_path):
    (tmp_path / "c.csv").write_text("mu,e\n1e-400,0\n1.5e400,0\n1e-401,0\n")
    small, large, beyond = rows(tmp_path, f'{LIMACON}table = "c.csv"\n')
    assert small.law().parameters["mu"].value == Fraction("1e-400") and large.law().parameters["mu"].value == Fraction("1.5e400")
    with pytest.raises(InputError, match="the number 1e-401 is too long or too large"):
        beyond.law()


def test_parquet_gives_the_same_rows_as_csv(tmp_path):
    pyarrow = pytest.importorskip("pyarrow")
    from pyarrow import parquet

    parquet.write_table(pyarrow.table({"mu": [0.1, 0.3], "e": [0.5, None]}), tmp_path / "c.parquet")
    (tmp_path / "c.csv").write_text("mu,e\n0.1,0.5\n0.3,\n")
    first, second = (values(rows(tmp_path, f'{LIMACON}table = "c.{kind}"\n')) for kind in ("csv", "parquet"))
    assert first == second == [{"mu": "1/10", "e": "1/2"}, {"mu": "3/10", "e": ""}]


WRONG = {
    "no rows": ("", "the file has no \\[\\[rows\\]\\]"),
    "unknown key": (f"{LIMACON}gird = {{}}\n", ":5:1: unknown key 'gird'.*grid"),
    "unknown law": ('[[rows]]\nlaw = "limaçom"\n', "4:1: unknown law"),
    "a file that is not there": ('[[rows]]\nlaws = ["a.toml"]\n', "no file 'a.toml'"),
    "code": ('[[rows]]\nlaw = "os:sep"\n', "would import code"),
    "an empty glob": ('[[rows]]\nlaws = ["*.tml"]\n', "no file matches"),
    "unknown parameter": (f"{LIMACON}grid = {{ nu = [1] }}\n", "5:10: unknown parameter 'nu'"),
    "no number": (f'{LIMACON}grid = {{ mu = ["a"] }}\n', "5:16: 'a' is not a number"),
    "two kinds": (f"{LIMACON}grid = {{ mu = [1] }}\ndraw = {{ n = 1, seed = 1 }}\n", "grid and draw"),
    "no end": (f"{LIMACON}draw = {{ n = 1, seed = 1 }}\n", "mu has no end"),
    "no seed": (f"{LIMACON}draw = {{ n = 1 }}\n", "draw has no seed"),
    "a column of nothing": (f'{LIMACON}table = "t.csv"\n', "'id' is no parameter"),
    "no such column": (f'{LIMACON}table = "t.csv"\ncolumns = ["m"]\n', "no column 'm'"),
    "twice": (f"{LIMACON}set = {{ mu = 1 }}\ngrid = {{ mu = [1] }}\n", "6:1: mu is given twice"),
    "drawn and set": (f"{LIMACON}set = {{ mu = 1 }}\ndraw = {{ n = 1, seed = 1, mu = [0, 1] }}\n", "mu is given twice"),
    "unknown claim": ("claims_ = 1\n", "unknown key 'claims_'"),
    "negative": (f"seconds = -1\n{LIMACON}", "seconds = -1"),
    "little memory": (f"memory = 0.49\n{LIMACON}", "memory = 0.49; give 0.5 or more: duhem itself needs this much"),
    "not a number": (f"seconds = nan\n{LIMACON}", "seconds = NaN; give a number"),
    "a list for one effort": (f'effort = ["quick"]\n{LIMACON}', "unknown effort"),
    "more rows than a length": (f"{LIMACON}draw = {{ n = 1{'0' * 30}, seed = 1, mu = [0, 1] }}\n", "there are more than"),
}


@pytest.mark.parametrize("case", WRONG)
def test_a_mistake_in_the_file_is_told_with_its_place(tmp_path, case):
    (tmp_path / "t.csv").write_text("mu,id\n1,2\n")
    text, said = WRONG[case]
    with pytest.raises(InputError, match=said):
        file.reads(HEAD + text, folder=tmp_path)


def test_a_program_gives_laws_and_values():
    block = given((("coulomb", None), ("limacon", {"mu": 0.1})))
    assert [dict(block.row(i, i + 1).values) for i in range(len(block))] == [{}, {"mu": "1/10"}]


@pytest.mark.parametrize("rows", [{"limacon": {"mu": 0.1}}, [("limacon",)], [("limacon", [0.1])], [("limacon", {}, 1)]])
def test_what_is_no_pair_is_refused_and_no_values_are_passed_over(rows):
    with pytest.raises(InputError, match=r"is no pair of|is no campaign"):
        duhem.campaign(rows, ["origin"])
