"""The components of a stress and its invariants, written out in the components as formulas of the vocabulary.

Tension is positive, stresses in one unit.  ``3d`` is the symmetric tensor sigma with the components xx, yy, zz, yz, xz, xy; ``plane``
is plane stress, the same tensor with sigma_zz = sigma_yz = sigma_xz = 0; ``principal`` are its principal stresses 1, 2, 3 in no order.

Each shear component stands once among the forces.  Its work-conjugate is the engineering strain gamma_xy = 2 epsilon_xy, so that
sum_i sigma_i d_i over the listed components is the inner product sigma : epsilon of the tensors.  The derivative of g by the listed
sigma_xy is twice the tensor's component, a shear strain again: the normality rule in the listed components is the tensor's.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from duhem.errors import InputError
from duhem.expression.spelling import spelled

__all__ = ["INVARIANTS", "KINDS", "Stress"]

KINDS: Mapping[str, tuple[str, ...]] = {
    "3d": ("xx", "yy", "zz", "yz", "xz", "xy"),
    "plane": ("xx", "yy", "xy"),
    "principal": ("1", "2", "3"),
}


@dataclass(frozen=True)
class Stress:
    """The stress tensor ``name`` (so that its components are name_xx ...) of one of the ``KINDS``."""

    name: str
    kind: str

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or not self.name.isidentifier():
            raise InputError(f"{self.name!r} is no name of a stress", remedy="use letters, digits and underscores")
        object.__setattr__(self, "name", spelled(self.name))
        if not isinstance(self.kind, str) or self.kind not in KINDS:
            raise InputError(f"{self.kind!r} is no kind of stress", remedy=f"kinds are: {', '.join(KINDS)}")

    @property
    def components(self) -> tuple[str, ...]:
        """The names of the forces that a law of this stress has."""
        return tuple(f"{self.name}_{end}" for end in KINDS[self.kind])

    @property
    def shears(self) -> tuple[bool, ...]:
        """Which of the components are shear stresses, whose conjugate is an engineering strain."""
        return tuple(len(set(end)) == 2 for end in KINDS[self.kind])

    @property
    def unit_stiffness(self) -> tuple[float, ...]:
        """Stress a conjugate, where one number, 1, is the stiffness of the tensors: 1/2 for a shear, whose conjugate is 2 epsilon."""
        return tuple(0.5 if shear else 1.0 for shear in self.shears)

    def written_out(self, word: str, index: int | None = None) -> str:
        """An invariant as a formula in the components; ``index`` from 1 is that of ``principal``, the greatest first."""
        return _principal(self, index) if index is not None else INVARIANTS[word].text(self)


@dataclass(frozen=True)
class Invariant:
    """A word that takes a stress; ``text`` gives its formula, ``indexed`` says that it takes a number as well."""

    text: Callable[[Stress], str]
    meaning: str
    indexed: bool = False


def _trace(stress: Stress) -> str:
    normal = stress.components[:2] if stress.kind == "plane" else stress.components[:3]
    return " + ".join(normal)


def _det(stress: Stress) -> str:
    if stress.kind == "plane":
        x, y, xy = stress.components
        raise InputError("det of plane stress is 0", remedy=f"that in the plane is {x}*{y} - {xy}**2")
    x, y, z, *shear = stress.components
    return f"{x}*{y}*{z}" + (_shear_terms(x, y, z, *shear) if shear else "")


def _shear_terms(x: str, y: str, z: str, yz: str, xz: str, xy: str) -> str:
    """What shear adds to the product of the diagonal in a determinant."""
    return f" + 2*{yz}*{xz}*{xy} - {x}*{yz}**2 - {y}*{xz}**2 - {z}*{xy}**2"


def _second(stress: Stress) -> str:
    """A sum of squares, so that its sign and curvature are seen."""
    x, y, *rest = stress.components
    if stress.kind == "plane":
        return f"(({x} - {y})**2 + {x}**2 + {y}**2)/6 + {rest[0]}**2"
    z, *shear = rest
    return f"(({x} - {y})**2 + ({y} - {z})**2 + ({z} - {x})**2)/6" + "".join(f" + {s}**2" for s in shear)


def _third(stress: Stress) -> str:
    if stress.kind == "plane":
        x, y, xy = stress.components
        return f"({x} + {y})*(9*{xy}**2 - (2*{x} - {y})*(2*{y} - {x}))/27"
    x, y, z, *shear = stress.components
    deviator = [f"(2*{a} - {b} - {c})" for a, b, c in ((x, y, z), (y, z, x), (z, x, y))]
    return f"{'*'.join(deviator)}/27" + (_shear_terms(*(f"{s}/3" for s in deviator), *shear) if shear else "")


def _cos3theta(stress: Stress) -> str:
    return f"3*sqrt(3)/2*({_third(stress)})/({_second(stress)})**(3/2)"


def _lode(stress: Stress) -> str:
    return f"acos({_cos3theta(stress)})/3"


def _principal(stress: Stress, index: int) -> str:
    if stress.kind == "3d":
        greatest = f"eigmax({', '.join(stress.components)})"
        least = f"eigmax({', '.join(f'-{x}' for x in stress.components)})"  # less its negative
        return {1: greatest, 2: f"{_trace(stress)} - {greatest} + {least}", 3: f"-{least}"}[index]
    if stress.kind == "plane":
        x, y, xy = stress.components
        if index == 3:
            raise InputError("the third principal stress of plane stress is 0", remedy="1 and 2 are those in the plane, the greater first")
        return f"({x} + {y})/2 {'+' if index == 1 else '-'} norm(({x} - {y})/2, {xy})"
    listed = ", ".join(stress.components)
    greatest, least = f"max({listed})", f"min({listed})"
    return {1: greatest, 2: f"{_trace(stress)} - {greatest} - {least}", 3: least}[index]


INVARIANTS: Mapping[str, Invariant] = {
    "I1": Invariant(_trace, "trace"),
    "tr": Invariant(_trace, "trace"),
    "det": Invariant(_det, "determinant"),
    "J2": Invariant(_second, "half the square of the deviator, s:s/2"),
    "J3": Invariant(_third, "determinant of the deviator"),
    "cos3theta": Invariant(_cos3theta, "3*sqrt(3)/2*J3/J2**(3/2), 1 in triaxial tension, -1 in compression"),
    "lode": Invariant(_lode, "Lode angle acos(cos3theta)/3 (rad), from 0 to pi/3"),
    "principal": Invariant(_trace, "principal stress 1, 2 or 3, the greatest first", indexed=True),
}
