"""Published laws of a stress tensor, written with invariants: against their formulas in floating point, and short."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import duhem
from duhem.expression.numpy_ import evaluate
from duhem.law.criterion_file import reads

FILES = sorted((Path(__file__).parent / "tensors").glob("*.toml"))


def _invariants(s: list[float]) -> tuple[float, float, float]:
    """I1, J2 and the Lode angle of principal stresses."""
    mean = sum(s) / 3
    d = [x - mean for x in s]
    j2 = sum(x * x for x in d) / 2
    return 3 * mean, j2, math.acos(min(1.0, max(-1.0, 1.5 * math.sqrt(3) * math.prod(d) / j2**1.5))) / 3


def _mohr_coulomb(s: list[float], phi: float, c: float) -> float:
    return max(s) - min(s) + (max(s) + min(s)) * math.sin(phi) - 2 * c * math.cos(phi)


def _drucker_prager(s: list[float], alpha: float, k: float, **_: float) -> float:
    i1, j2, _theta = _invariants(s)
    return math.sqrt(j2) + alpha * i1 - k


def _willam_warnke(s: list[float], e: float, a: float, k: float) -> float:
    """By the Lode angle (Menetrey and Willam 1995, Eq. 4)."""
    i1, j2, theta = _invariants(s)
    c = math.cos(theta)
    over = 4 * (1 - e**2) * c**2 + (2 * e - 1) ** 2
    return math.sqrt(2 * j2) * over / (2 * (1 - e**2) * c + (2 * e - 1) * math.sqrt(4 * (1 - e**2) * c**2 + 5 * e**2 - 4 * e)) + a * i1 - k


def _ottosen(s: list[float], a: float, b: float, k1: float, k2: float) -> float:
    i1, j2, theta = _invariants(s)
    return a * j2 + k1 * math.cos(math.acos(k2 * math.cos(3 * theta)) / 3) * math.sqrt(j2) + b * i1 - 1


def _bigoni_piccolroaz(s: list[float], M: float, pc: float, c: float, m: float, alpha: float, beta: float, gamma: float) -> float:
    i1, j2, theta = _invariants(s)
    f = (c - i1 / 3) / (pc + c)
    meridian = M * pc * math.sqrt(max((f - max(f, 0.0) ** m) * (2 * (1 - alpha) * f + alpha), 0.0))
    return max(math.sqrt(3 * j2) * math.cos(beta * math.pi / 6 - math.acos(gamma * math.cos(3 * theta)) / 3) - meridian, -f, f - 1)


def _lubliner(s: list[float], alpha: float, beta: float, gamma: float, sc: float) -> float:
    i1, j2, _theta = _invariants(s)
    return math.sqrt(3 * j2) + alpha * i1 + beta * max(max(s), 0.0) - gamma * max(-max(s), 0.0) - (1 - alpha) * sc


FORMULAS = {
    "mohr_coulomb_6": _mohr_coulomb,
    "drucker_prager": _drucker_prager,
    "drucker_prager_dilatancy": _drucker_prager,
    "willam_warnke_e06": _willam_warnke,
    "ottosen": _ottosen,
    "bigoni_piccolroaz_lode": _bigoni_piccolroaz,
    "lubliner_cdp": _lubliner,
}


@pytest.mark.slow
@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_the_words_say_what_was_published(path: Path) -> None:
    rng = np.random.default_rng(3)
    law = duhem.load(path)
    parameters = {name: float(span.value or 0.7) for name, span in law.parameters.items()}
    table = law.symbols()
    for s in rng.uniform(-1.5, 0.8, (5, 3)).tolist():
        here = {table[n]: v for n, v in zip(law.forces, s, strict=True)} | {table[n]: v for n, v in parameters.items()}
        assert float(evaluate(law.g, here)) == pytest.approx(FORMULAS[path.stem](s, **parameters), rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("name", ["mohr_coulomb_6", "drucker_prager", "willam_warnke_e06", "ottosen", "lubliner_cdp"])
def test_in_six_components_it_is_the_same_law(name: str) -> None:
    rng = np.random.default_rng(4)
    text = next(path for path in FILES if path.stem == name).read_text("utf-8")
    law = reads(text.replace('"principal"', '"3d"'))
    parameters = {n: float(span.value or 0.7) for n, span in law.parameters.items()}
    for xx, yy, zz, yz, xz, xy in rng.uniform(-1.0, 0.7, (5, 6)).tolist():
        s = np.linalg.eigvalsh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]).tolist()
        values = dict(zip(law.forces, (xx, yy, zz, yz, xz, xy), strict=True)) | parameters
        here = {x: values[n] for n, x in law.symbols().items()}
        assert float(evaluate(law.g, here)) == pytest.approx(FORMULAS[name](s, **parameters), rel=1e-9, abs=1e-9)


# What the hand-written formulas of the same laws in three principal stresses have of characters, flows and potentials included.
BY_HAND = {
    "mohr_coulomb_6": 232, "drucker_prager": 67, "drucker_prager_dilatancy": 271, "willam_warnke_e06": 318, "ottosen": 366,
    "bigoni_piccolroaz_lode": 544, "lubliner_cdp": 131,
}  # fmt: skip


def test_they_are_a_third_as_long() -> None:
    laws = {path.stem: path.read_text("utf-8") for path in FILES}
    assert {*laws} == {*BY_HAND}
    shortened = 0
    for text in laws.values():
        body = text.split("[parameters]")[0].split("pressure = false\n")[1]
        lines = [line.partition(" = ") for line in body.splitlines() if " = " in line]
        shortened += sum(len(value.strip('"')) + len(name) * (name not in ("g", "potential")) for name, _, value in lines)
    assert shortened <= sum(BY_HAND.values()) / 3


@pytest.mark.slow
@pytest.mark.parametrize("name", ["drucker_prager", "lubliner_cdp"])
def test_what_is_proved_of_them(name: str) -> None:
    found = duhem.verify(next(path for path in FILES if path.stem == name), claims=["origin", "convexity", "dissipation", "normality"])
    assert [row.verdict.value for row in found.results] == ["proved"] * 4


@pytest.mark.slow
def test_dilatancy_below_friction_is_convex_and_not_normal() -> None:
    path = next(path for path in FILES if path.stem == "drucker_prager_dilatancy")
    found = duhem.verify(path, claims=["origin", "convexity", "normality"])
    assert [row.verdict.value for row in found.results] == ["proved", "proved", "refuted"]
