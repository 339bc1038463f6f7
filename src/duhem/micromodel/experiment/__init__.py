"""The friction test of the paper beside what the model predicts.  Source: Antoni et al. (2007), section 3."""

from duhem.micromodel.experiment import text  # noqa: F401 (how an experiment is shown)
from duhem.micromodel.experiment.friction_test import STEEL_ON_ALUMINIUM, Bracket, Consistency, Experiment, Prediction, Range

__all__ = ["STEEL_ON_ALUMINIUM", "Bracket", "Consistency", "Experiment", "Prediction", "Range"]
