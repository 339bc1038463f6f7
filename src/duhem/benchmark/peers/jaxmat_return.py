"""jaxmat, return mapping of materials in JAX, all points at once: the yield surfaces that it has, under isotropic elasticity.

The law is held to the surface by its values: g + Y = sigma_eq(s1, s2, s3) at many stresses, Y = -g(0).  One step from a stress-free state
with the strain k^-1 trial, k = 2 mu I + lambda 1 1^T on principal stresses, ends at the closest point (associated flow, no hardening).
In doubles, and with the tolerance that jaxmat has; what is compiled is compiled anew for each number of points.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np
import sympy as sp

from duhem.benchmark.peers.peer import PeerOptions, answered
from duhem.errors import InputError
from duhem.expression.numpy_ import compiled
from duhem.projection.increment import Increment
from duhem.projection.method import Method
from duhem.projection.result import Array, Solution

__all__ = ["JAXMAT"]

_SAME = 1e-12  # of the yield stress


def _differences(s: Array) -> Array:
    return np.abs(s - np.roll(s, -1, axis=1))


def _power_mean(s: Array, a: float) -> Array:
    return np.asarray((_differences(s) ** a).sum(axis=1) / 2.0) ** (1.0 / a)


def _surface(question: Increment) -> tuple[str, float, float] | None:
    """The surface of jaxmat that the law is, its exponent (0 for none) and the yield stress; None for no such surface."""
    law = question.law
    return None if len(law.forces) != 3 or law.pressure is not None else _surface_of(question.g, law.force_symbols())


@lru_cache(maxsize=64)
def _surface_of(formula: sp.Expr, forces: tuple[sp.Symbol, ...]) -> tuple[str, float, float] | None:
    """Looked for once a law, and not where the routine is timed."""
    g = compiled(formula, forces)
    limit = -float(g(0.0, 0.0, 0.0))
    if not limit > 0.0:
        return None
    stresses = np.random.default_rng(7).normal(size=(60, 3)) * limit
    values = g(*stresses.T) + limit
    roots = {float(1 / node.exp) for node in formula.atoms(sp.Pow) if node.exp.is_Rational and 0 < node.exp < 1}
    known: list[tuple[str, float, Array]] = [
        ("vonMises", 0.0, _power_mean(stresses, 2.0)),
        ("Tresca", 0.0, _differences(stresses).max(axis=1)),
        *(("Hosford", a, _power_mean(stresses, a)) for a in sorted(roots)),
    ]
    for name, a, equivalent in known:
        if np.abs(values - equivalent).max() <= _SAME * np.abs(equivalent).max():
            return name, a, limit
    return None


def _moduli(stiffness: Array) -> tuple[float, float] | None:
    """Young's modulus and Poisson's number of k = 2 mu I + lambda 1 1^T, else None."""
    twice_mu, lame = stiffness[0, 0] - stiffness[0, 1], stiffness[0, 1]
    if not np.array_equal(stiffness, twice_mu * np.eye(3) + lame):
        return None
    mu = twice_mu / 2.0
    return float(mu * (3.0 * lame + 2.0 * mu) / (lame + mu)), float(lame / (2.0 * (lame + mu)))


def _applies(question: Increment) -> str | None:
    if _surface(question) is None:
        return "its surfaces in principal stresses are those of von Mises, Tresca and Hosford"
    if _moduli(question.stiffness) is None:
        return 'its elasticity is isotropic, give --stiffness "1 1 1"'
    return None


def _solve(question: Increment, options: PeerOptions) -> Solution:
    if options.tolerance is not None:
        raise InputError("jaxmat is compiled once a process, with its own tolerance", where="tolerance", remedy="leave it out")
    surface, moduli = _surface(question), _moduli(question.stiffness)
    assert surface is not None and moduli is not None  # as applies has it
    import jax
    import jax.numpy as jnp
    from jaxmat.tensors import SymmetricTensor2

    n = len(question.trial)
    strain, axes = np.zeros((n, 3, 3)), np.arange(3)
    strain[:, axes, axes] = np.linalg.solve(question.stiffness, question.trial.T).T
    with jax.enable_x64(True):
        material, update = _material(*surface, *moduli)
        try:
            tensor, _ = update(SymmetricTensor2(tensor=jnp.asarray(strain)), material.init_state(n), 0.0)
        except RuntimeError as fault:  # of one point, and there is no answer to any
            raise ArithmeticError(_said(fault)) from None
        stress = np.array(tensor.tensor, dtype=np.float64)[:, axes, axes]
    return answered(question, stress, np.zeros(n, dtype=bool))


def _said(fault: RuntimeError) -> str:
    """The sentence of an error, which stands among the stacks inside and outside of what was compiled."""
    lines = [line for line in str(fault).splitlines() if line.startswith("equinox.EquinoxRuntimeError: ")]
    return (lines or [str(fault)])[-1].removeprefix("equinox.EquinoxRuntimeError: ").partition(". ")[0]


@lru_cache(maxsize=4)
def _material(name: str, a: float, limit: float, young: float, poisson: float) -> tuple[Any, Callable[..., Any]]:
    import equinox as eqx
    import jaxmat.materials as jm

    elasticity = jm.LinearElasticIsotropic(E=young, nu=poisson)
    constant = jm.VoceHardening(sig0=limit, sigu=limit, b=0.0)
    if name == "vonMises":  # it has a routine of its own, with one unknown
        material = jm.vonMisesIsotropicHardening(elasticity=elasticity, yield_stress=constant)
    else:
        surface = jm.Hosford(a=a) if name == "Hosford" else jm.Tresca()
        material = jm.GeneralIsotropicHardening(elasticity=elasticity, yield_stress=constant, plastic_surface=surface)
    return material, eqx.filter_jit(eqx.filter_vmap(material.constitutive_update, in_axes=(0, 0, None)))


JAXMAT = Method("jaxmat", _applies, _solve, PeerOptions)
