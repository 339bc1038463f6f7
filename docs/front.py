"""The picture of the first page and of README.md, computed from two laws: `python -m docs.front` draws it again."""

from fractions import Fraction
from pathlib import Path

import duhem
from duhem.portrait import plot
from duhem.show import figure

PLACE = Path(__file__).parent / "_static" / "front.svg"
PAPER = {"mu_a_plus": "1/5", "mu_a_minus": "2/25", "mu_b_plus": "3/25", "mu_b_minus": "3/20"}
DENTED = {"mu": 1, "e": "4/5"}


def paint(left, right):
    plot("antoni2007", parameters=PAPER, planes="sigma_a,sigma_b", trial=[0.25, 0.12], pressure=-1.0, axes=[left])
    left.set_title("antoni2007, an increment: every claim proved")
    witness = duhem.verify("limacon", DENTED, claims="convexity")["convexity"].witness
    plot("limacon", parameters=DENTED, planes="sigma_a,sigma_b", pressure=-1.0, axes=[right])
    right.set_title("limacon, e = 0.8: convexity refuted")
    points = {role: [float(Fraction(point[force])) for force in ("sigma_a", "sigma_b")] for role, point in witness.points.items()}
    right.plot(*zip(points["p"], points["q"], strict=True), color="#D55E00", dashes=(6, 2), marker="o", markeredgecolor="black", zorder=5)
    right.plot(*points["midpoint"], color="#D55E00", marker="X", markersize=8, markeredgecolor="black", zorder=6)
    for role, (x, y) in points.items():
        right.annotate(role, (x, y), xytext=(9, 5), textcoords="offset points")
    for legend in [*left.figure.legends]:  # one of each law; one is enough
        legend.remove()
    figure.legend_below([left])


if __name__ == "__main__":
    figure.drawn(paint, PLACE, panels=2, columns=2, size=(4.6, 4.4))
