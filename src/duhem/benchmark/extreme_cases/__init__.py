"""Stiff and extreme increments, decade by decade: who is finite, feasible and accurate, and who is wrong without a word."""

from duhem.benchmark.extreme_cases.cases import AXES, Case, cases
from duhem.benchmark.extreme_cases.stress import Result, Row, stress

__all__ = ["AXES", "Case", "Result", "Row", "cases", "stress"]
