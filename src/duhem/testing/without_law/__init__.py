"""What can be asked of a routine of which no law is known."""

from duhem.testing.without_law.suite import FreeRun, free_check, free_checks, free_violation

__all__ = ["FreeRun", "free_check", "free_checks", "free_violation"]
