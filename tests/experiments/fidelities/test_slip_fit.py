"""A random walk is found again from the moves that it made."""

import numpy as np
import pytest

from experiments.fidelities import Moves, fit_walk


def test_finds_the_walk_that_made_the_moves():
    rng = np.random.default_rng(0)
    way, turned = rng.uniform(0, 0.5, 4000), rng.uniform(0, 2, 4000)
    place = np.sqrt(2e-3**2 * way + 5e-4**2 * turned)
    heading = np.sqrt(4e-3**2 * way + 3e-3**2 * turned)
    error = rng.normal(size=(4000, 3)) * np.stack([place, place, heading], axis=1)
    walk = fit_walk(Moves(error, way, turned))
    assert walk.walk == pytest.approx(2e-3, rel=0.1) and walk.scrub == pytest.approx(5e-4, rel=0.15)
    assert walk.yaw_walk == pytest.approx(4e-3, rel=0.15) and walk.yaw_scrub == pytest.approx(3e-3, rel=0.1)
