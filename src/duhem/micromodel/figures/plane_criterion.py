"""Figure 5: the asymmetric criterion beside an isotropic one, with the slip that goes with each stress."""

from __future__ import annotations

import numpy as np

from duhem.micromodel.figures.recipe import Recipe
from duhem.micromodel.figures.value import Arrows, Axis, Curve, Fact, Figure, Panel, Rule

__all__ = ["RECIPE", "criterion"]

_RAYS = 721
_SLIPS = 24


def criterion(
    mu_a_plus: float = 0.2, mu_a_minus: float = 0.08, mu_b_plus: float = 0.12, mu_b_minus: float = 0.15, mu_isotropic: float = 0.08
) -> Figure:
    """The boundary of K over |sigma_n| (Antoni et al. 2007, Eq. 35, Fig. 5), dimensionless.

    The curves are the laws' own formulas solved on rays; the arrows are the slips of :func:`duhem.project` on stresses
    outside, with equal stiffness in both directions: outward normals, by the normality rule (Eq. 36).
    """
    from duhem.law.catalogue import load
    from duhem.micromodel.figures.boundary import boundary
    from duhem.projection.projector import Projector

    law = load("antoni2007")
    parameters = {"mu_a_plus": mu_a_plus, "mu_a_minus": mu_a_minus, "mu_b_plus": mu_b_plus, "mu_b_minus": mu_b_minus}
    angle = np.linspace(0.0, 2.0 * np.pi, _RAYS)
    asymmetric = boundary(law, parameters, angle)
    isotropic = boundary(load("coulomb"), {"mu": mu_isotropic}, angle)
    reach = float(np.abs(asymmetric).max())
    around = np.linspace(0.0, 2.0 * np.pi, _SLIPS, endpoint=False)
    outside = boundary(law, parameters, around) * 1.5
    slipped = Projector.of(law, 1.0, parameters, "newton")(outside, -1.0)
    direction = slipped.slip / np.linalg.norm(slipped.slip, axis=1, keepdims=True)
    panel = Panel(
        Axis("sigma_a/|sigma_n|", r"$\sigma_a\,/\,|\sigma_n|$"),
        Axis("sigma_b/|sigma_n|", r"$\sigma_b\,/\,|\sigma_n|$"),
        (
            Rule("sigma_a = 0", "x", 0.0),
            Rule("sigma_b = 0", "y", 0.0),
            Arrows("slip direction", slipped.stress, direction, 0.17 * reach, None, "slip direction"),
            Curve("asymmetric", asymmetric[:, 0], asymmetric[:, 1], 0, "asymmetric, Eq. (35)"),
            Curve("isotropic", isotropic[:, 0], isotropic[:, 1], 1, rf"isotropic, $\mu = {mu_isotropic:g}$"),
        ),
        equal=True,
    )
    ends = boundary(law, parameters, np.pi * np.array([0.0, 1.0, 0.5, 1.5]))
    names = ("along +a", "along -a", "along +b", "along -b")
    facts = tuple(Fact(name, float(np.hypot(*end))) for name, end in zip(names, ends, strict=True))
    settings = {**parameters, "mu_isotropic": mu_isotropic}
    return Figure(RECIPE.title, "Antoni et al. (2007), Fig. 5, Eq. (35)", settings, (panel,), facts)


RECIPE = Recipe("5", "Asymmetric friction criterion beside an isotropic one", criterion)
