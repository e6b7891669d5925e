"""What is kept for gradients changes none; truncated ones go no further back."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.compiling import batched
from opt.plan import Samples
from opt.trajectory import TrajectoryController
from sims.backward import Backward
from sims.limits import robot_limits
from sims.noise import noise_preset
from sims.odometry import no_slip
from sims.robots import load_robot
from sims.rollout import run_block, start
from sims.worlds import Kinematic, standing

RECORDS, DT = 4, 0.02


def slope(backward):
    """Of the joints at the end to what is commanded at each step. [rows, joints]"""
    robot = load_robot()
    limits, noise = robot_limits(robot, clearance=False), noise_preset("s1-simulation").odometry

    def end(speeds):
        zero = jnp.zeros((len(speeds), 10))
        plan = Samples(
            jnp.concatenate([zero[:, :9], speeds, zero[:, :1]], axis=1), jnp.asarray(DT), jnp.asarray(0.0)
        )
        follow = TrajectoryController(limits.chain, plan, jnp.asarray(0.0), jnp.asarray(10.0))
        world = standing(jnp.zeros(3), robot.home, no_slip(4), 4)
        state, _ = run_block(
            follow,
            Kinematic(),
            limits,
            noise,
            jnp.asarray(DT),
            start(follow, Kinematic(), world),
            jax.random.key(0),
            records=RECORDS,
            backward=backward,
        )
        return state.world.arm.sum()

    run = batched(jax.value_and_grad(end), in_axes=(0,), chunk=8)
    rng = np.random.default_rng(0)
    value, found = run(jnp.asarray(0.1 * rng.normal(size=(1, 4 * RECORDS + 2, 9)), jnp.float32))
    assert np.isfinite(value).all()
    return np.asarray(found[0])


@pytest.fixture(scope="module")
def full():
    return slope(Backward())


@pytest.mark.parametrize("keep", ["steps", "records"])
def test_what_is_kept_changes_nothing(full, keep):
    assert np.abs(full).max() > 0.01
    np.testing.assert_allclose(slope(Backward(keep=keep)), full, rtol=1e-5, atol=1e-7)


def test_truncated_gradients_see_the_last_records_alone(full):
    cut = slope(Backward(truncate=2))
    first = 4 * (RECORDS - 2)
    assert not np.abs(cut[: first - 1]).max()
    np.testing.assert_allclose(cut[first + 1 :], full[first + 1 :], rtol=1e-5, atol=1e-7)


@pytest.mark.parametrize("wrong", [{"keep": "some"}, {"truncate": -1}])
def test_other_ways_are_refused(wrong):
    with pytest.raises(ValueError, match="allowed"):
        Backward(**wrong)
