"""What the engines look at: one law's derived forms, and the exact checks that turn a find into a refutation."""

from duhem.examination.case import Case
from duhem.examination.curve import CurveCase

__all__ = ["Case", "CurveCase"]
