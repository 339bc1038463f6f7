"""Stiff and extreme increments, decade by decade: who is finite, feasible and accurate, and who is wrong without a word."""

from duhem.extremes.cases import AXES, Case, cases
from duhem.extremes.stress import Result, Row, stress

__all__ = ["AXES", "Case", "Result", "Row", "cases", "stress"]
