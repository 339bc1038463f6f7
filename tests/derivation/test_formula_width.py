"""The width of formulas, estimated without TeX."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from duhem.derivation.typeset import width

# what each has that the others have not
FORMULAS = (
    r"\dot u^{\mathrm{in}}_{a} = \mu_{a}^{+}\,\left|\sigma_{n}\right| - 3",
    r"\left\| \frac{\left\langle \sigma_{a} \right\rangle_{+}}{\mu_{a}} + \frac{\left\langle \sigma_{a} \right\rangle_{-}}{2}\right\|_2",
    r"\begin{cases} \frac{\sigma_{a}}{\mu^{2}} & \text{for}\: \sigma_{a} \geq 0,\; x < 1 \\[2pt] \infty & \text{otherwise} \end{cases}",
    r"\left(\begin{matrix}\Delta u_{a}\\\Delta u_{b}\end{matrix}\right) = \left(\begin{matrix}k_{a}\,x + y\\0\end{matrix}\right)",
    r"\sqrt[3]{\frac{\sqrt{\mathrm{Xc}\,\mathrm{Yc} + y}}{4\,\mathrm{Xc}^{2}} + \frac{\left(s_{1} - s_{3}\right)^{m}}{2}}",
    r"\operatorname{atan_2}\left(x, y\right) + \cosh{\left(\alpha\,x \right)} \quad\text{for}\; \theta \in \left[- \pi, \pi\right]",
    r"\mathsf{A}_{12} = \frac{2000000\,\sqrt[30]{15165845}\,\mathsf{A}_{3}^{\frac{29}{30}}}{1875359305573830149842260922001268}",
    r"\left(\frac{\frac{a}{b} + \frac{c}{d}}{\frac{e}{f}}\right)^{\frac{1}{m}} \Rightarrow \max\left(\phi, \Phi_C^{*}\right)",
)  # fmt: skip


@pytest.mark.skipif(shutil.which("pdflatex") is None, reason="pdflatex is not installed")
def test_no_formula_is_wider_than_estimated_and_none_much_narrower(tmp_path: Path) -> None:
    boxes = [rf"\setbox0\hbox{{$\displaystyle {formula}$}}\typeout{{wide \the\wd0}}" for formula in FORMULAS]
    document = [r"\documentclass{article}\usepackage{amsmath}\begin{document}", *boxes, r"\end{document}"]
    (tmp_path / "widths.tex").write_text("\n".join(document), encoding="utf-8")
    subprocess.run(["pdflatex", "-interaction=batchmode", "-halt-on-error", "widths.tex"], cwd=tmp_path, capture_output=True, check=True)
    measured = [float(pt) / 10 for pt in re.findall(r"wide ([\d.]+)pt", (tmp_path / "widths.log").read_text("utf-8"))]
    assert len(measured) == len(FORMULAS)
    for formula, wide in zip(FORMULAS, measured, strict=True):
        assert 0.98 * wide <= width(formula) <= 1.3 * wide, formula


def test_what_stands_above_something_takes_no_room_of_its_own() -> None:
    assert width(r"\frac{a + b + c}{d}") == width(r"\frac{d}{a + b + c}") < width(r"\frac{a + b + c}{d} + 1")
    assert width(r"x_{12}^{3}") == width(r"x_{12}") < width(r"x_{123}")
