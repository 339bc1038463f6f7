"""Stiff and extreme increments, decade by decade: who is finite, feasible and accurate, and who is wrong without a word."""

from duhem.benchmark.extreme_cases.stress import AXES, ExtremeCase, ExtremeCases, StressCases, Tally, cases, stress

__all__ = ["AXES", "ExtremeCase", "ExtremeCases", "StressCases", "Tally", "cases", "stress"]
