"""Runs of samples for which something holds."""

import numpy as np
from jaxtyping import Bool, Int


def runs(holds: Bool[np.ndarray, " samples"]) -> Int[np.ndarray, "runs 2"]:
    """First sample of each run, and the first one after it."""
    steps = np.diff(np.concatenate([[False], holds, [False]]).astype(int))
    return np.flatnonzero(steps).reshape(-1, 2)
