"""What bases are told."""

import numpy as np
import pytest

from experiments.fidelities import MOTIONS, move_length, random_moves, way_of


@pytest.mark.parametrize("motion", MOTIONS, ids=lambda motion: motion.name)
def test_wheels_turn_first_and_the_base_keeps_its_accelerations(motion):
    told, steer = motion.rows()
    assert len(told) == len(steer) == 600
    assert not told[:50].any() and np.abs(steer[:50]).sum() > 0 and not told[-1].any()
    assert np.abs(np.diff(told, axis=0)).max(axis=0) == pytest.approx([0, 0, 0], abs=0.0201)


def test_ways_end_where_the_twist_leads():
    ways = {motion.name: way_of(motion.rows()[0])[-1] for motion in MOTIONS}
    np.testing.assert_allclose(ways["straight"], [2.0, 0, 0], atol=1e-9)
    np.testing.assert_allclose(ways["spin"], [0, 0, 4.0], atol=1e-9)
    radius = 1.0  # of the arc: 0.2 m/s at 0.2 rad/s
    np.testing.assert_allclose(
        ways["arc"], [radius * np.sin(2.0), radius * (1 - np.cos(2.0)), 2.0], atol=1e-4
    )


def test_random_moves_go_from_rest_to_rest_and_a_seed_names_them():
    told, steer = random_moves(3, seed=4)
    assert told.shape == steer.shape == (3 * move_length(), 3)
    assert not told[move_length() - 1 :: move_length()].any()
    np.testing.assert_array_equal(told, random_moves(3, seed=4)[0])
    assert (told != random_moves(3, seed=5)[0]).any()
