"""What is drawn of a law can be read: nothing overlaps, arrows are whole, and an axis says what its numbers count."""

from __future__ import annotations

import re

import pytest

import duhem
from duhem.law import catalogue
from duhem.law.atlas.entry import groups

pytest.importorskip("matplotlib")

from duhem.portrait.pictures import plot
from tests.long import mostly_long
from tests.oracles.legible import faults

OF_RATES = ("bingham", "garofalo", "norton-hoff", "perzyna", "rate-and-state", "stribeck")  # they have no K
EVERY = [*catalogue.names(), *(name for group in groups().values() for name in group if name not in OF_RATES)]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("law", "planes"), mostly_long([("tresca-tensor", "deviatoric"), *((law, ()) for law in EVERY)], ("tresca-tensor", "deviatoric"))
)
def test_portraits_are_legible(law: str, planes: str) -> None:
    assert faults(plot(law, planes=planes)[0].figure) == []


@pytest.mark.slow
@pytest.mark.parametrize("law", mostly_long(["lobes", "limacon", "quartic", "wedge", "hjiaj", "radial-flow"]))
def test_witnesses_are_legible(law: str) -> None:
    places = plot(law, witness=True)
    assert sum("refuted" in place.get_title() for place in places) >= 1 and faults(places[0].figure) == []


@pytest.mark.slow
@pytest.mark.parametrize("letters", mostly_long([12, 40]), ids=str)
def test_names_of_many_letters_keep_to_their_own_panel(letters: int) -> None:
    forces = ("s" * letters, "w" * letters)
    axes = plot(duhem.Criterion(name="l", g=f"norm({', '.join(forces)}) - 0.3*abs(sigma_n)", forces=forces))
    assert faults(axes[0].figure) == []
    sizes = {words.get_fontsize() for place in axes for words in (place.xaxis.label, place.yaxis.label, place.title)}
    assert (sizes == {10.0}) == (letters == 12)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("wide", "high", "unit", "said"),
    [
        (1e6, 1e-3, "Pa", ("MPa", "mPa")),
        pytest.param(1e6, 1e-6, "", ("$10^{6}$ unit of stress", "$10^{-6}$ unit of stress"), marks=pytest.mark.long),
        (2e-6, 5.0, "", ("$10^{-6}$ unit of stress", "unit of stress")),
        pytest.param(3e4, 4e-5, "MPa", ("MPa", "$10^{-6}$ MPa"), marks=pytest.mark.long),
        (3e6, 1e6, "Pa", ("MPa", "MPa")),
        pytest.param(9e5, 4e6, "", ("$10^{6}$ unit of stress",) * 2, marks=pytest.mark.long),
    ],
)
def test_what_an_axis_says_is_where_its_numbers_stand_also_where_axes_are_not_to_one_scale(wide, high, unit, said) -> None:
    axes = plot(duhem.Criterion(name="l", g=f"norm(x/{wide!r}, y/{high!r}) - 1", forces=("x", "y"), pressure=None), unit=unit)[0]
    power = {"MPa": 1e6, "mPa": 1e-3} if unit == "Pa" else {}
    for axis, counted, size in ((axes.xaxis, said[0], wide), (axes.yaxis, said[1], high)):
        assert axis.get_label_text().endswith(f" [{counted}]")
        scale = power.get(counted) or float(re.sub(r"\$10\^\{(.*)\}\$.*", r"1e\1", counted) if "$" in counted else 1.0)
        texts = {tick.get_loc(): tick.label1.get_text().replace("\N{MINUS SIGN}", "-") for tick in axis.get_major_ticks()}
        shown = {at: float(re.findall(r"-?[\d.]+", text)[0]) for at, text in texts.items()}
        assert len(set(shown.values())) > 2
        assert [number * scale for number in shown.values()] == pytest.approx(list(shown), abs=1e-9 * size)


def test_an_arrow_is_drawn_whole_or_not_at_all() -> None:
    (axes,) = plot(duhem.Criterion(name="strip", g="abs(sigma_a - sigma_b) - 1", pressure=None), unit="Pa")
    (a, b), (c, d) = axes.get_xlim(), axes.get_ylim()
    (arrows,) = (each for each in axes.collections if hasattr(each, "U"))
    x, y = arrows.X + arrows.U, arrows.Y + arrows.V
    assert len(x) > 8 and ((a <= x) & (x <= b) & (c <= y) & (y <= d)).all()
