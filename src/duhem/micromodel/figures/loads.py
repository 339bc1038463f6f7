"""Figure 8, as a table: the tangential loads that were measured beside those the wedges give."""

from __future__ import annotations

from dataclasses import replace

import sympy as sp

from duhem.micromodel.experiment import STEEL_ON_ALUMINIUM
from duhem.micromodel.figures.recipe import Recipe
from duhem.micromodel.figures.value import Fact, Table

__all__ = ["RECIPE", "loads"]

_MISPRINT = 229


def loads(
    mu: float = 0.25,
    normal_load: float = float(STEEL_ON_ALUMINIUM.normal_load),
    measured_plus: float = float(STEEL_ON_ALUMINIUM.measured_plus),
    measured_minus: float = float(STEEL_ON_ALUMINIUM.measured_minus),
) -> Table:
    """Steady tangential loads along +t_a and -t_a under ``normal_load`` in N (Antoni et al. 2007, Fig. 8, Eqs. 13, 15).

    ``measured_plus`` and ``measured_minus`` are the measured coefficients, ``mu`` the local one that the prediction takes, which
    was not measured.  Of the record only these steady values stand in the text, not the curves.
    """
    test = replace(STEEL_ON_ALUMINIUM, normal_load=normal_load, measured_plus=measured_plus, measured_minus=measured_minus)
    found = test.predicted(mu)
    best, least = test.least_scatter()
    fitted = test.predicted(best.low)

    def row(sense: str, measured: sp.Rational, predicted: sp.Rational) -> tuple[str | float, ...]:
        sizes = (measured * test.normal_load, measured, predicted, predicted * test.normal_load, 100 * (predicted / measured - 1))
        return (sense, *map(float, sizes))

    remarks = (
        f"The text prints {_MISPRINT} N along -t_a beside the coefficient 0.29, which is 290 N: a misprint "
        "(duhem.micromodel.experiment.errata).",
        f"At mu = {float(best):.4g} both are off by the same, {float(least):.2g}, and at no mu by less: "
        f"{float(fitted.plus):.4g} and {float(fitted.minus):.4g}.",
    )
    columns = ("sense", "measured load (N)", "measured mu", "predicted mu", "predicted load (N)", "predicted above measured (%)")
    rows = (row("+t_a", test.measured_plus, found.plus), row("-t_a", test.measured_minus, found.minus))
    facts = (Fact("mu that meets both best", float(best)), Fact("misfit of the coefficients there", float(least)))
    settings = {"mu": mu, "normal_load": normal_load, "measured_plus": measured_plus, "measured_minus": measured_minus}
    return Table(RECIPE.title, "Antoni et al. (2007), Fig. 8, section 3.2", settings, columns, rows, remarks, facts)


RECIPE = Recipe("8", "Tangential loads measured on the wedge specimen beside the predicted ones", loads, drawn=False)
