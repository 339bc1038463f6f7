"""Stiff and extreme increments, decade by decade: who is finite, feasible and accurate, and who is wrong without a word."""

from duhem.benchmark.extreme_cases.cases import AXES, ExtremeCase, cases
from duhem.benchmark.extreme_cases.stress import ExtremeCases, StressCases, Tally, stress

__all__ = ["AXES", "ExtremeCase", "ExtremeCases", "StressCases", "Tally", "cases", "stress"]
