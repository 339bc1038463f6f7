"""Increments asked of each row: counted, held against the disc's own formulas, and what is wrong with one row is that row's."""

import json

import numpy as np
import pytest

import duhem
from duhem import InputError
from duhem.screening import Increments, Trials, file
from duhem.screening.campaign import Campaign, Claimed, asked, given

HEAD = '[campaign]\nask = "increments"\n'
ROWS = '[[rows]]\nlaw = "coulomb"\ngrid = { mu = [0.5, 2] }\n[[rows]]\nlaws = ["coulomb"]\n'
DRAWN = "[increments]\nn = 50\nseed = 3\n"


def lines(campaign):
    return [line for number in range(1, len(campaign) + 1) for line in asked(campaign, number)]


def test_what_is_drawn_slips_as_the_disc_says(tmp_path):
    """Of norm(t) - mu |sigma_n| and k = 4: a slip dissipates mu |sigma_n| (|t| - mu |sigma_n|)/4, and |t|/(mu |sigma_n|) is drawn."""
    campaign = file.reads(f"{HEAD}{ROWS}{DRAWN}pressure = -3\nstiffness = 4\n", folder=tmp_path, project=duhem.project)
    small, large, open_ = lines(campaign)
    assert open_.verdict is None and "no value is given for mu" in open_.error
    chance = np.random.default_rng(3)
    chance.normal(size=(50, 2))  # the directions
    far = 10.0 ** chance.uniform(-1, 2, size=50)
    for line, radius in ((small, 1.5), (large, 6.0)):
        found = json.loads(line.witness)
        assert (line.claim, line.verdict, line.steps, line.error) == ("increments", "ok", 50, None)
        assert (
            found["statuses"] == {"stick": int(np.sum(far < 1.0)), "slip": int(np.sum(far > 1.0))} and min(found["statuses"].values()) > 9
        )
        assert found["dissipation"]["sum"] == pytest.approx(np.sum(np.maximum(far - 1.0, 0.0)) * radius**2 / 4.0, rel=1e-5)
        worst = found["worst"]
        assert worst["pressure"] == -3.0 and worst["residual"] == max(found["residuals"].values()) < 1e-12
        assert np.min(np.abs(np.hypot(*worst["trial"]) / radius - far)) < 1e-4 * np.hypot(*worst["trial"])


def test_given_increments_are_those_and_a_flagged_one_is_named(tmp_path):
    """K of x y < 1 is no convex set: beyond it the closest point is not vouched for."""
    (tmp_path / "law.toml").write_text('[criterion]\nname = "cross"\nforces = ["x", "y"]\npressure = false\ng = "x**2*y**2 - 1"\n')
    (tmp_path / "t.csv").write_text("y,x\n0.5,0.5\n2,2.5\n0,3\n")
    text = f'{HEAD}[[rows]]\nlaws = ["law.toml", "coulomb"]\n[increments]\ntable = "t.csv"\n'
    campaign = file.reads(text, folder=tmp_path, project=duhem.project)
    cross, missing = lines(campaign)
    found = json.loads(cross.witness)
    assert cross.verdict == "flagged" and found["statuses"]["stick"] == 2 and found["worst"]["trial"] == [2.5, 2.0]
    assert found["worst"]["status"] not in ("stick", "slip") and "no value is given for mu" in missing.error
    values = Trials(("sigma_a",), ((1.0,),))
    (line,) = lines(Campaign((given((("coulomb", {"mu": 1}),)),), Increments(duhem.project, trials=values)))
    assert "no column sigma_b" in line.error
    told = {Increments(duhem.project, 5, seed).told() for seed in (1, 2)} | {Increments(duhem.project, trials=values).told()}
    assert len(told) == 3


@pytest.mark.long
def test_the_table_is_the_same_from_two_processes_and_the_summary_counts(tmp_path):
    (tmp_path / "c.toml").write_text(HEAD + ROWS + DRAWN)
    one, two = (duhem.campaign(tmp_path / "c.toml", workers=n, project=duhem.project) for n in (1, 2))
    assert [line[:9] for line in one.lines] == [line[:9] for line in two.lines]
    assert one.verdicts == {("increments", "ok"): 2, ("increments", "none"): 1} and one.refuted == 0
    assert one.commands[3] == f"duhem campaign {tmp_path / 'c.toml'} --row=3"


WRONG = {
    "nothing drawn": ("[increments]\n", "give either n and seed"),
    "both": ('[increments]\nn = 1\ntable = "t.csv"\n', "give either n and seed"),
    "no seed": ("[increments]\nn = 1\n", "has no seed"),
    "no number": ("[increments]\nn = true\nseed = 1\n", ":6:1: n = True"),
    "pressed": (f"{DRAWN}pressure = 1\n", "pressure = 1"),
    "method": (f"{DRAWN}method = 'newtn'\n", "unknown method 'newtn'.*newton"),
    "convex": (f"{DRAWN}convex = 'no'\n", ":8:1: "),
    "matrix": (f"{DRAWN}stiffness = [[1, 0], [1]]\n", "no square matrix"),
    "no table": ('[increments]\ntable = "none.csv"\n', "none.csv"),
    "claims too": (None, "claims is for claims"),
    "another": ("[incremnts]\n", "unknown section 'incremnts'"),
}


@pytest.mark.parametrize("case", WRONG)
def test_a_mistake_in_the_file_is_told_with_its_place(tmp_path, case):
    text, said = WRONG[case]
    rows = '[[rows]]\nlaws = ["coulomb"]\n'
    whole = f'{HEAD}claims = ["origin"]\n{rows}' if text is None else f"{HEAD}{rows}{text}"
    with pytest.raises(InputError, match=said):
        file.reads(whole, folder=tmp_path, project=duhem.project)


def test_what_is_asked_is_asked_for(tmp_path):
    rows = '[[rows]]\nlaws = ["coulomb"]\n'
    with pytest.raises(InputError, match="not asked for"):
        file.reads(f"{rows}{DRAWN}", folder=tmp_path, project=duhem.project)
    with pytest.raises(InputError, match="unknown ask"):
        file.reads(f'[campaign]\nask = "os:system"\n{rows}', folder=tmp_path)
    with pytest.raises(InputError, match=r'ask = "increments" needs an argument that is missing; give project=duhem\.project'):
        file.reads(f"{HEAD}{rows}{DRAWN}", folder=tmp_path)
    with pytest.raises(InputError, match="give either count and seed"):
        Increments(duhem.project)
    with pytest.raises(InputError, match="claims and ask are both given"):
        duhem.campaign(["coulomb"], ["origin"], ask=Claimed(("origin",)))
