"""Stiff and extreme increments, decade by decade: who is finite, feasible and accurate, and who is wrong without a word."""

from duhem.benchmark.extreme_cases import figure  # noqa: F401 (how a result is drawn)
from duhem.benchmark.extreme_cases.cases import AXES, ExtremeCase, cases
from duhem.benchmark.extreme_cases.inquiry import StressCases
from duhem.benchmark.extreme_cases.stress import ExtremeCases, Tally, stress

__all__ = ["AXES", "ExtremeCase", "ExtremeCases", "StressCases", "Tally", "cases", "stress"]
