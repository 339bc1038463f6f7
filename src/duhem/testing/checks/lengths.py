"""Lengths in the energy of a stiffness k = L L^T: |s|^2 = s . k^-1 s of a stress, and its dual of a slip and of gradients of g."""

from __future__ import annotations

import numpy as np

from duhem.projection.result import Array

__all__ = ["Lengths"]


class Lengths:
    """L (d, d) and its inverse are those of the case."""

    _lower: Array
    _inverse: Array

    def inner(self, a: Array, b: Array) -> Array:
        """a . k^-1 b (N,)."""
        return np.einsum("ij,ij->i", a @ self._inverse.T, b @ self._inverse.T)

    def length(self, a: Array) -> Array:
        """(a . k^-1 a)^1/2 (N,)."""
        return np.asarray(np.linalg.norm(a @ self._inverse.T, axis=1))

    def dual_length(self, slip: Array) -> Array:
        """(slip . k slip)^1/2 (N,), the dual length, of gradients of g too."""
        return np.asarray(np.linalg.norm(slip @ self._lower, axis=1))

    def whitened(self, matrices: Array) -> Array:
        """L^-1 C L^-T (N, d, d) of tangents C, k = L L^T."""
        return self._inverse @ matrices @ self._inverse.T

    @property
    def axes(self) -> Array:
        """d stresses of length 1 (d, d), orthogonal in the energy: the columns of L."""
        return self._lower.T

    def shadow(self, a: Array) -> Array:
        """L^-1 a, whose plain length is |a|."""
        return a @ self._inverse.T
