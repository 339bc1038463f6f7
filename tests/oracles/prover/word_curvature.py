"""What the words of the language are as functions of the forces, from what their arguments are: one theorem a word."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import sympy as sp

from duhem.expression import EigMax, Neg, Norm, Pos
from tests.oracles.prover.shape import Curvature, used

__all__ = ["WORDS", "greatest"]


def _convex_in_size(x: Curvature) -> bool:
    """Whether every convex function of |x| that increases is convex."""
    return x.affine or (x.convex and x.nonnegative) or (x.concave and x.nonpositive)


def _size(x: Curvature) -> Curvature:
    convex = _convex_in_size(x)
    return Curvature(convex=convex, quasiconvex=convex, nonnegative=True, rules=used(x, rule="|x| is convex"))


def _norm(*args: Curvature) -> Curvature:
    convex = all(map(_convex_in_size, args))
    rule = "a Euclidean norm of affine or of convex non-negative functions is convex"
    return Curvature(convex=convex, quasiconvex=convex, nonnegative=True, rules=used(*args, rule=rule))


def _ramp(x: Curvature) -> Curvature:
    rules = used(x, rule="a ramp of an affine function is convex")
    return x if x.nonnegative else Curvature(convex=x.convex, quasiconvex=x.quasiconvex, nonnegative=True, rules=rules)


def greatest(*args: Curvature) -> Curvature:
    """Of the greatest of several."""
    return Curvature(
        convex=all(x.convex for x in args),
        quasiconvex=all(x.quasiconvex for x in args),
        nonnegative=any(x.nonnegative for x in args),
        nonpositive=all(x.nonpositive for x in args),
        rules=used(*args, rule="a maximum of convex functions is convex"),
    )


def _exponential(x: Curvature) -> Curvature:
    rules = used(x, rule="exp is convex and increasing")
    return Curvature(convex=x.convex, quasiconvex=x.quasiconvex, nonnegative=True, rules=rules)


def _greatest_eigenvalue(*entries: Curvature) -> Curvature:
    """The greatest of n . A n over unit vectors n, which are affine where the entries are."""
    if not all(x.affine for x in entries):
        return Curvature()
    rules = used(*entries, rule="the greatest eigenvalue of a symmetric matrix is a convex function of it")
    return Curvature(convex=True, quasiconvex=True, rules=rules)


def _rising_bend(x: Curvature) -> Curvature:
    """asin and sinh: increasing and odd, convex from 0 on."""
    convex, concave = x.convex and x.nonnegative, x.concave and x.nonpositive
    rules = used(x, rule="asin and sinh are increasing, convex from 0 on")
    return Curvature(False, convex, concave, x.quasiconvex, x.nonnegative, x.nonpositive, rules)


def _arc_cosine(x: Curvature) -> Curvature:
    """acos x = pi/2 + asin(-x)."""
    convex, concave = x.concave and x.nonpositive, x.convex and x.nonnegative
    rules = used(x, rule="acos is decreasing, concave from 0 on")
    return Curvature(False, convex, concave, x.concave, nonnegative=True, rules=rules)


def _even_bend(x: Curvature) -> Curvature:
    """cosh: a convex function of |x|."""
    convex = _convex_in_size(x)
    return Curvature(convex=convex, quasiconvex=convex, nonnegative=True, rules=used(x, rule="cosh is convex and even"))


def _increasing(x: Curvature) -> Curvature:
    rules = used(x, rule="an increasing map keeps sublevel sets")
    return Curvature(quasiconvex=x.quasiconvex, nonnegative=x.nonnegative, nonpositive=x.nonpositive, rules=rules)


WORDS: Mapping[type, Callable[..., Curvature]] = {
    sp.Abs: _size, Norm: _norm, Pos: _ramp, Neg: lambda x: _ramp(x.negated()), sp.exp: _exponential, EigMax: _greatest_eigenvalue,
    sp.tanh: _increasing, sp.atan: _increasing, sp.asin: _rising_bend, sp.sinh: _rising_bend, sp.acos: _arc_cosine, sp.cosh: _even_bend,
}  # fmt: skip
