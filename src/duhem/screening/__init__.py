"""Campaigns: many laws and parameter sets at once, one table of verdicts."""

from __future__ import annotations

from duhem.screening.entry import campaign
from duhem.screening.increments import Increments, Trials
from duhem.screening.summary import Summary

__all__ = ["Increments", "Summary", "Trials", "campaign"]
