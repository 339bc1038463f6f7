"""What follows symbolically from a law's formula: potential, state laws, evolution law, increment."""

from duhem.derivation import derivation_sheet, printing  # noqa: F401 (how a derivation is shown)
from duhem.derivation.derive import derive
from duhem.derivation.equation import Derivation, Equation
from duhem.derivation.potential import SupportFunction
from duhem.derivation.support_function import support_function

__all__ = ["Derivation", "Equation", "SupportFunction", "derive", "support_function"]
