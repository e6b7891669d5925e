"""A small network, and clouds of a corner, for all tests of AGN."""

import jax
import numpy as np
import pytest

from nets.agn import AGN, AGNSettings

SMALL = AGNSettings(
    features=6, width=6, heads=2, pooled=3, nearest=6, further=4, groups=6, coplanar=8, beside=4
)


@pytest.fixture(scope="session")
def network():
    return AGN.of(SMALL, key=jax.random.key(3))


def corner(count: int, noise: float, seed: int = 0):
    """Points [count, 3] of two faces that meet at a right angle at y = 0, a metre wide each, and the same
    without their errors.
    """
    rng = np.random.default_rng(seed)
    along, up = rng.uniform(-1, 1, count), rng.uniform(0, 1, count)
    faces = np.stack([np.abs(along), along, up], axis=1) / [2**0.5, 2**0.5, 1]
    normal = np.stack([-np.ones(count), np.sign(along), np.zeros(count)], axis=1) / 2**0.5
    return faces + noise * rng.standard_normal((count, 1)) * normal, faces
