"""The heat that bodies exchange with an interface: D_th = sum of (q_k . n_k/T_k) (T_k - T) >= 0 (Antoni et al. 2007, Eq. 22).

With q_k . n_k = h_k (T_k - T) it is the sum of h_k (T_k - T)^2/T_k.  What the interface takes up, T ds/dt = D_intr + sum of q_k . n_k,
gives the rate of its temperature, so that there is nothing to show of it.
"""

from __future__ import annotations

from fractions import Fraction

from duhem.proof.kernel.curvature import over
from duhem.proof.kernel.definedness import Reader
from duhem.proof.kernel.stated_law import StatedLaw

__all__ = ["heat_flows_downhill"]


def heat_flows_downhill(law: StatedLaw) -> bool:
    """Whether each conductance has a value and is >= 0 in all states with T > 0; that each T_k > 0 is in its range."""
    warm = {name: law.parameters[name].above(Fraction(0), True) for name, own in law.variables if own.kind == "temperature"}
    domain = over(law._replace(parameters={**law.parameters, **warm}))
    reader = Reader(domain)
    shown = (reader.undecided(h) is None and domain.never_negative(h) for _, h in law.heat)
    return bool(law.heat) and all(shown)
