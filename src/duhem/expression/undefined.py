"""What a root of -1, a logarithm of 0 or a quotient by 0 becomes in SymPy where values are put in: no real number."""

import sympy as sp

__all__ = ["UNDEFINED"]

UNDEFINED = (sp.nan, sp.zoo, sp.oo, -sp.oo, sp.I)
