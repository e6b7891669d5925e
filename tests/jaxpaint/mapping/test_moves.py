"""Over what stands in the way, and no higher than that needs."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.mapping.moves import MoveSettings, move_pose, move_time, plan_move

OUT = jnp.array([-1.0, 0.0, 0.0])
ENDS = jnp.zeros(3), jnp.array([0.0, 1.0, 0.0])
SETTINGS = MoveSettings()
LIFT, MARGIN = float(SETTINGS.clearance), float(SETTINGS.margin)


def over(place: float, high: float):
    """The move over a post so far along the way and so high, and the brush on it, (t, 3) [m]."""
    post = jnp.array([[-high, place, 0.0]])
    yes = jnp.asarray(True)
    move = plan_move(ENDS, (OUT, OUT), post, jnp.ones(1, bool), SETTINGS, on_surface=(yes, yes), changes=~yes)
    time = jnp.linspace(0, move_time(move, SETTINGS), 2000)
    return move, np.asarray(jax.vmap(lambda t: move_pose(move, t, SETTINGS)[0])(time))


@pytest.mark.parametrize("high", [0.1, 0.2])
@pytest.mark.parametrize("place", [0.1, 0.3, 0.5, 0.9])
def test_a_post_is_cleared_by_the_margin(place, high):
    move, brush = over(place, high)
    at = np.interp(place, brush[:, 1], -brush[:, 0])
    assert at == pytest.approx(high + MARGIN, abs=2e-3)
    assert bool(move.broad) == (place in (0.1, 0.9))


def test_what_is_near_an_end_takes_no_high_arc():
    _, brush = over(0.9, 0.2)
    parabola = LIFT + (0.2 + MARGIN - LIFT) / (4 * 0.9 * 0.1)
    assert -brush[:, 0].min() < 0.68 * parabola


def test_a_point_beside_the_end_takes_no_arc_to_the_sky():
    """One that stands 10 mm from where the brush comes down cannot be gone over any better from above."""
    assert -over(0.99, 0.1)[1][:, 0].min() < LIFT + 0.4


@pytest.mark.parametrize("place", [0.5, 0.9])
def test_the_way_over_a_post_keeps_the_speed_and_the_acceleration(place):
    move, brush = over(place, 0.2)
    step = float(move_time(move, SETTINGS)) / (len(brush) - 1)
    velocity = np.diff(brush, axis=0) / step
    assert np.linalg.norm(velocity, axis=1).max() < 1.2 * float(SETTINGS.speed)
    # no jump of the velocity anywhere
    jumps = np.linalg.norm(np.diff(velocity, axis=0), axis=1) / step
    assert jumps.max() < 3 * float(SETTINGS.acceleration)
