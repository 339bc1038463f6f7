"""Several laws at once, a line each, and the exit code of all of them."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from duhem.screening.campaign import VerdictLine, as_text

Run = Callable[..., tuple[int, str, str]]


@pytest.mark.slow
def test_several_laws_have_a_line_each(run: Run, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """In their order, from whichever process each comes; what is wrong with one is said in its line."""
    monkeypatch.chdir(tmp_path)
    for name, law in (("ball", "norm(sigma_a, sigma_b) - 1"), ("dent", "sigma_a**3 - 3*sigma_a*sigma_b**2 - 1")):
        (tmp_path / f"{name}.toml").write_text(f'[criterion]\nname = "{name}"\npressure = false\ng = "{law}"\n')
    (tmp_path / "broken.toml").write_text("[criterion]\nname =")
    with (tmp_path / "dent.toml").open("a") as file:
        file.write('expect = { convexity = "proved" }\n')
    code, out, err = run("verify", "limacon", "*.toml", "coulomb", "--claims", "convexity,origin", "--workers", "2")
    assert out.splitlines() == [
        "limacon: refuted convexity; proved origin",
        "ball.toml: proved origin, convexity",
        "broken.toml: no verdict: broken.toml:2: invalid value; correct the TOML syntax",
        "dent.toml: refuted convexity; proved origin",
        "coulomb: proved origin, convexity",
    ]
    assert (code, err) == (4, "duhem: dent.toml: convexity is refuted, where proved is expected\n")
    (tmp_path / "dent.toml").write_text((tmp_path / "dent.toml").read_text().replace('"proved"', '"refuted"'))
    assert run("verify", "dent.toml", "ball.toml", "--claims", "convexity", "--workers", "1")[::2] == (0, "")
    by_construction = run("verify", "coulomb", "limacon", "--claims", "state_laws,origin", "--workers", "1")[1]
    assert by_construction == "coulomb: proved origin; by construction state_laws\nlimacon: proved origin; by construction state_laws\n"
    for arguments, said in (
        (["coulomb", "no*.toml"], "no file matches"),
        (["coulomb", "none.toml"], "there is no file"),
        (["coulomb", "colomb"], "unknown law"),
        (["ball.toml", "--workers", "2"], "give several laws"),
    ):
        code, out, err = run("verify", *arguments)
        assert (code, out) == (2, "") and said in err


def test_the_exit_code_of_several_laws(run: Run, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    class Pool:
        def __init__(self, campaign: Any, workers: int) -> None:
            self.campaign = campaign

        def __enter__(self) -> Any:
            return self

        def __exit__(self, *_: object) -> None:
            pass

        def texts(self, rows: Any) -> Iterator[str]:
            for number in reversed(rows[0]):
                line = (self.campaign.row(number).name.shown, "{}", "origin", verdicts[number - 1], "by hand", None, None, 0, 0.0, None)
                yield as_text([VerdictLine(number, *line)])

    monkeypatch.setattr("duhem.screening.pool.Pool", Pool)
    for verdicts, strict, code in (
        (["proved", "undecided"], [], 0),
        (["proved", "undecided"], ["--strict"], 3),
        (["undecided", "refuted"], ["--strict"], 1),
        (["proved", "not_applicable"], ["--strict"], 0),
        (["refuted", "refuted"], ["--expect", "origin=refuted"], 0),
        (["refuted", "proved"], ["--expect", "origin=refuted"], 1),
    ):
        found, out, err = run("verify", "coulomb", "box", "--claims", "origin", *strict)
        said = [verdict.replace("_", " ") for verdict in verdicts]
        assert found == code and out.splitlines() == [f"{law}: {word} origin" for law, word in zip(("coulomb", "box"), said, strict=True)]
        assert err == ("duhem: box: origin is proved, where refuted is expected\n" if "--expect" in strict and code else "")
    monkeypatch.chdir(tmp_path)
    law = 'duhem.Criterion(name="mine", g="norm(sigma_a, sigma_b) - 1", pressure=None, expect={"origin": "refuted"})'
    (tmp_path / "own_laws.py").write_text(f"import duhem\n\nmine = {law}\n")
    for verdicts, option, said in (
        (["refuted", "proved"], [], ""),
        (["proved", "proved"], [], "duhem: own_laws:mine: origin is proved, where refuted is expected\n"),
        (["proved", "proved"], ["--expect", "origin=proved"], ""),
    ):
        code, out, err = run("verify", "own_laws:mine", "box", "--claims", "origin", *option)
        assert (code, err) == (int(bool(said)), said) and out == f"own_laws:mine: {verdicts[0]} origin\nbox: {verdicts[1]} origin\n"
