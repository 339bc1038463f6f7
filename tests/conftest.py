"""Hypothesis profiles: `ci` (the default) repeats itself exactly; HYPOTHESIS_PROFILE or --hypothesis-profile chooses another.

`dev` draws anew each time, `deep` does so a hundred times longer.
"""

import os

from hypothesis import settings

settings.register_profile("ci", derandomize=True, deadline=None, database=None)
settings.register_profile("dev", deadline=None)
settings.register_profile("deep", deadline=None, max_examples=10_000)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "ci"))
