"""What a law is: a frozen value over a formula or a boundary curve, its domains, its file, and the catalogue of all of them.

Nothing is imported until it is used: naming the laws of the catalogue must not cost an import of SymPy.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

__all__ = ["FORCES", "POSITIVE", "PRESSURE", "REAL", "Criterion", "Domain", "ParametricCriterion", "YieldSurface", "criterion"]

if TYPE_CHECKING:
    from duhem.law.curve_law import ParametricCriterion
    from duhem.law.domain import POSITIVE, REAL, Domain
    from duhem.law.formula_law import FORCES, PRESSURE, Criterion, YieldSurface, criterion


def __getattr__(name: str) -> Any:
    if name in __all__:
        from duhem.law import curve_law, domain, formula_law

        return next(getattr(module, name) for module in (formula_law, domain, curve_law) if name in module.__all__)
    raise AttributeError(f"module 'duhem.law' has no attribute {name!r}")
