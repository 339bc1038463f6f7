"""Convex laws at fixed parameters; how far a point is from optimal, by the law's formula in SymPy's own functions."""

from __future__ import annotations

from functools import cache

import numpy as np
import sympy as sp

import duhem
from duhem.projection.increment import Increment

R = sp.Rational
ANTONI = {"mu_a_plus": R(1, 5), "mu_a_minus": R(2, 25), "mu_b_plus": R(3, 25), "mu_b_minus": R(3, 20)}
CONVEX = [
    ("antoni2007", ANTONI),
    ("antoni2007-1d", {"mu_plus": R(1, 5), "mu_minus": R(1, 10)}),
    ("box", {"mu_a": R(1, 5), "mu_b": R(3, 10)}),
    ("polygon", {"mu": R(1, 5)}),
    ("coulomb", {"mu": R(1, 5)}),
    ("orthotropic", {"mu_a": R(1, 5), "mu_b": R(1, 1000)}),
    ("limacon", {"mu": R(1, 5), "e": R(1, 2)}),
    ("lobes", {"mu": R(1, 5), "e": R(1, 10)}),
    ("lobes", {"mu": R(1, 5), "e": R(-1, 10)}),
    ("matchstick", {"mu_a": R(1, 5), "mu_b": R(3, 20)}),
    ("quartic", {"mu": R(1, 5), "c": R(0)}),
    ("quartic", {"mu": R(1, 5), "c": R(6)}),
    ("drucker1949", {"k": R(1, 10), "c": R(9, 4)}),
    ("drucker1949", {"k": R(1, 10), "c": R(-27, 8)}),
    ("capped", {"mu": R(1, 5), "tau_max": R(1, 10)}),
    ("cohesive", {"mu": R(1, 5), "cohesion": R(1, 10)}),
    ("regularised", {"mu": R(1, 5), "c": R(1, 10)}),
    ("shifted-ellipse", {"mu_a": R(1, 5), "mu_b": R(1, 10), "shift": R(1, 10)}),
    ("von-mises", {"yield_stress": R(1, 10)}),
    ("tresca", {"yield_stress": R(1, 10)}),
    ("superellipse", {"mu_a": R(1, 5), "mu_b": R(1, 10), "p": R(101, 100)}),
    ("superellipse", {"mu_a": R(1, 5), "mu_b": R(1, 10), "p": R(3, 2)}),
    ("superellipse", {"mu_a": R(1, 5), "mu_b": R(1, 10), "p": R(50)}),
    ("hosford", {"yield_stress": R(1, 10), "m": R(11, 10)}),
    ("hosford", {"yield_stress": R(1, 10), "m": R(8)}),
]


def increment(law, trial, pressure=0.0, stiffness=1.0, **values):
    law = duhem.load(law)
    trial = np.atleast_2d(np.asarray(trial, dtype=float))
    n, d = trial.shape
    k = np.asarray(stiffness, dtype=float)
    k = k if k.ndim == 2 else np.diag(np.broadcast_to(k, (d,)))
    g = law.g.xreplace({law.symbols()[name]: R(value) for name, value in values.items()})
    diagonal = bool(np.all(k == np.diag(np.diag(k))))
    pressures = np.broadcast_to(np.asarray(pressure, dtype=float), (n,)).copy()
    return Increment(law, g, trial, pressures, k, diagonal, {name: float(value) for name, value in values.items()})


@cache
def written_out(g, names):
    """g by SymPy's own function, and so not by the code under test."""
    words = [{"Pos": lambda x: np.maximum(x, 0), "Neg": lambda x: np.maximum(-x, 0), "Norm": lambda *x: np.sqrt(sum(y * y for y in x))}]
    return sp.lambdify(names, g, [*words, "numpy"])


def level(question, stress):
    """g at stresses."""
    law = question.law
    g = written_out(question.g, (*law.force_symbols(), *([law.symbols()[law.pressure]] if law.pressure else [])))
    with np.errstate(over="ignore"):
        return g(*stress.T, *([question.pressure] if law.pressure else []))


def radii(question, directions):
    """How far K reaches along directions, by bisection; inf where it does not end."""
    low, high = np.zeros(len(directions)), np.full(len(directions), 1e3)
    endless = level(question, directions * high[:, None]) <= 0
    for _ in range(100):
        middle = (low + high) / 2
        inside = level(question, directions * middle[:, None]) <= 0
        low, high = np.where(inside, middle, low), np.where(inside, high, middle)
    return np.where(endless, np.inf, low)


def stiffnesses(d, rng):
    q, _ = np.linalg.qr(rng.standard_normal((d, d)))
    full = (q * np.geomspace(1.0, 1e6, d)) @ q.T
    return {"unit": np.eye(d), "diagonal": np.diag(np.geomspace(1.0, 1e3, d)), "full": (full + full.T) / 2}


def shortfall(question, got, points):
    """The worst of: stationarity, and the variational inequality over known points of K; relative, in the metric of k."""
    root = np.linalg.inv(np.linalg.cholesky(question.stiffness)).T
    size = np.linalg.norm(got.stress @ root, axis=1) + np.linalg.norm(question.trial @ root, axis=1)
    pushed = got.slip @ question.stiffness
    stationarity = np.linalg.norm((question.trial - pushed - got.stress) @ root, axis=1) / size
    excess = (got.slip @ points.T).max(axis=1) - (got.slip * got.stress).sum(axis=1)
    reach = np.linalg.norm(got.stress @ root, axis=1) + np.linalg.norm(points @ root, axis=1).max()
    with np.errstate(invalid="ignore"):
        variational = np.nan_to_num(excess / (np.linalg.norm(pushed @ root, axis=1) * reach))
    return max(stationarity.max(), variational.max())
