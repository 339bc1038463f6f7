"""What follows symbolically from a law's formula: potential, state laws, evolution law, increment."""

from duhem.derivation import printing  # noqa: F401 (how a derivation is shown)
from duhem.derivation.derive import derive
from duhem.derivation.equation import Derivation, Equation
from duhem.derivation.support_function import SupportFunction, support_function

__all__ = ["Derivation", "Equation", "SupportFunction", "derive", "support_function"]
