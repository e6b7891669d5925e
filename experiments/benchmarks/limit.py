"""How many floating-point operations a second this machine's cores do at most, as far as a program gets."""

import numpy as np

from experiments.benchmarks.compare import rate

_SIZE = 1024


def product_rate() -> float:
    """Operations a second of a matrix product in float32 by numpy's library, on all cores."""
    left, right = np.random.default_rng(0).normal(size=(2, _SIZE, _SIZE)).astype(np.float32)
    return rate(lambda: left @ right, 2 * _SIZE**3)
