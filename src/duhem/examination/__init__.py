"""What the engines look at: one law's derived forms, and the exact checks that turn a find into a refutation."""

from duhem.examination.case import Case

__all__ = ["Case"]
