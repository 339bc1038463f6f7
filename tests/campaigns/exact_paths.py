"""Exact paths against 30 digits on as many random polygons as asked for: python -m tests.campaigns.exact_paths 100"""

import sys

import numpy as np

from tests.oracles.path import drive
from tests.path.test_exact_path import exact, polygon


def worst(seed: int) -> float:
    """The largest relative error of stress, multiplier, dissipation and work along one path."""
    mu, k, path = polygon(seed)
    history = exact(mu, k, path)
    reference = [[*map(float, stress), float(a), float(b), float(c)] for stress, a, b, c in drive(path.values, mu, 1.0, k)]
    found = np.column_stack([history.stress, history.multiplier, history.dissipation, history.work])[1:]
    scale = np.maximum(np.abs(found).max(axis=0), [mu.max(), mu.max(), 1e-300, 1e-300, 1e-300])
    return float((np.abs(found - reference) / scale).max())


if __name__ == "__main__":
    errors = {seed: worst(seed) for seed in range(int(sys.argv[1]) if len(sys.argv) > 1 else 100)}
    seed = max(errors, key=lambda s: errors[s])
    print(f"{len(errors)} paths of six segments, one step a segment: largest error {errors[seed]:.1e} (seed {seed})")
    sys.exit(errors[seed] > 1e-12)
