"""A robot on its wheels: it goes where wheels take it."""

import equinox as eqx
import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest

from sims.robots import robot_model
from sims.wheeled import wheeled_model
from tests.sims.wheeled.conftest import DT, STEPS, constant

TWISTS = [(0.2, 0.0, 0.0), (0.1, 0.15, 0.0), (0.15, 0.0, 0.3), (0.0, 0.0, 0.5)]


@pytest.fixture(scope="module")
def ridden(bench):
    return bench(*constant(*TWISTS))


def test_straight_on_odometry_is_right_to_a_thousandth(ridden):
    went, off = ridden.base[0, -1, 0], ridden.base[0, -1] - ridden.odometry[0, -1]
    assert went > 0.15
    assert np.abs(off[:2]).max() < 1e-3 * went + 2e-4 and abs(off[2]) < 5e-4


def test_crabwise_in_an_arc_and_on_the_spot_it_goes_about_where_it_is_told(bench, ridden):
    told, _ = constant(*TWISTS)
    yaw = np.cumsum(told[..., 2], axis=1) * DT
    c, s = np.cos(yaw), np.sin(yaw)
    way = np.stack([c * told[..., 0] - s * told[..., 1], s * told[..., 0] + c * told[..., 1]], axis=-1)
    end = np.concatenate([way.sum(1) * DT, yaw[:, -1:]], axis=1)
    np.testing.assert_allclose(ridden.base[:, -1], end, atol=0.03)
    assert np.abs(ridden.base[3, -1, :2]).max() < 0.02 and ridden.base[3, -1, 2] > 0.4


def test_turning_on_the_spot_slips_more_than_going_straight(ridden):
    off = np.abs(ridden.base[:, -1, 2] - ridden.odometry[:, -1, 2])
    assert off[3] > 5 * off[0]


def test_wheels_stay_on_the_floor_and_the_base_level(ridden):
    """Sunk by 0.6 mm at rest: no wheel is off the floor while none rises by that much."""
    assert np.abs(ridden.tilt[..., 0]).max() < 6e-4
    assert np.abs(ridden.tilt[..., 1:]).max() < 2e-3
    assert ridden.holds.all()


def test_at_rest_nothing_moves(bench):
    found = bench(*constant((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)))
    assert np.abs(found.base).max() < 2e-4 and np.ptp(found.base[:, 50:], axis=1).max() < 2e-5
    assert np.abs(found.arm[:, -1] - np.asarray(bench.robot.home)).max() < 2e-3


def test_wheels_that_are_not_what_odometry_takes_them_for(bench):
    """Wheels askew by a hundredth lead aside by a hundredth; wheels that roll further go further."""
    told, steer = constant((0.2, 0.0, 0.0), (0.2, 0.0, 0.0))
    askew, further = bench(told, steer, steering=0.01), bench(told, steer, radius=0.02)
    went = askew.base[0, -1]
    assert went[1] / went[0] == pytest.approx(0.01, rel=0.1)
    assert abs(askew.odometry[0, -1, 1]) < 2e-4
    assert further.base[0, -1, 0] / further.odometry[0, -1, 0] == pytest.approx(1.02, rel=2e-3)


def test_a_slippery_floor_slips_more(bench):
    physics = [eqx.tree_at(lambda p: p.friction, bench.fidelity.physics, jnp.asarray(f)) for f in (1.0, 0.3)]
    both = jax.tree.map(lambda *x: jnp.stack(x), *physics)
    spin = constant((0.0, 0.0, 0.5), (0.0, 0.0, 0.5))
    found = bench(*spin, physics=both)
    off = np.abs(found.base[:, -1, 2] - found.odometry[:, -1, 2])
    assert off[1] > 1.2 * off[0]


def test_a_sloping_floor_does_not_carry_it_away(bench):
    leaning = eqx.tree_at(lambda p: p.gravity, bench.fidelity.physics, jnp.asarray([0.3, 0.2, -9.8]))
    found = bench(*constant((0.0, 0.0, 0.0), (0.1, 0.0, 0.0)), physics=leaning)
    assert np.abs(found.base[0, -1, :2]).max() < 3e-3 and found.holds.all()


def test_the_arm_balances_its_weight_as_if_the_floor_were_level(bench):
    """It is bent by what a slope adds: that over its stiffness."""
    leans = np.array([[0.3, 0.2, -9.8], [-0.2, 0.3, -9.8], [0.0, 0.0, -9.8]])
    physics = [eqx.tree_at(lambda p: p.gravity, bench.fidelity.physics, jnp.asarray(g)) for g in leans]
    found = bench(*constant(*[(0.0, 0.0, 0.0)] * 3), physics=jax.tree.map(lambda *x: jnp.stack(x), *physics))
    weights = [_weight(bench, gravity) for gravity in leans]
    expected = -(np.array(weights[:2]) - weights[2]) / np.asarray(physics[0].position_gain[8:])
    np.testing.assert_allclose(found.arm[:2, -1] - found.arm[2, -1], expected, rtol=0.05, atol=5e-6)
    assert np.abs(expected).max() > 5e-5


def _weight(bench, gravity):
    """Of the arm's joints with the base level [N m]."""
    model = wheeled_model(robot_model())
    model.opt.gravity = gravity
    data = mujoco.MjData(model)
    data.qpos[15:] = bench.robot.home
    mujoco.mj_forward(model, data)
    return data.qfrc_bias[14:]


@pytest.mark.parametrize("friction", [0.3, 1.0])
def test_no_command_within_limits_is_too_much(bench, friction):
    """Base and arm at their fastest, one way and the other, by chance: what a controller never asks for."""
    rng, worlds, limits = np.random.default_rng(0), 8, bench.limits

    def by_chance(most):
        """As long as each lasts, 0.1 to 0.5 s, at its largest either way."""
        sign = rng.choice([-1.0, 1.0], (worlds, STEPS, len(most)))
        at = np.cumsum(rng.random((worlds, STEPS)) < DT / rng.uniform(0.1, 0.5, (worlds, 1)), axis=1)
        return np.take_along_axis(sign, at[..., None], axis=1) * np.asarray(most)

    told, arm = by_chance(limits.base_speed), by_chance(limits.arm_speed)
    physics = eqx.tree_at(lambda p: p.friction, bench.fidelity.physics, jnp.asarray(friction))
    found = bench(told, told, arm, physics=physics)
    assert all(np.isfinite(x).all() for x in found)
    assert np.abs(np.diff(found.base[..., :2], axis=1)).max() < 1.5 * float(limits.base_speed[0]) * DT
    assert np.abs(found.tilt[..., 0]).max() < 0.05 and np.abs(found.tilt[..., 1:]).max() < 0.1
    # The file has no end stops: an arm that is told to run into its limits runs past them, and comes back.
    assert np.abs(np.diff(found.arm, axis=1)).max() < 1.5 * float(limits.arm_speed.max()) * DT


def _stiff(physics):
    where = lambda p: (p.position_gain, p.force_limit)  # noqa: E731
    return eqx.tree_at(where, physics, (1e5 * physics.position_gain, 1e12 * physics.force_limit))


@pytest.mark.parametrize(
    ("name", "change"),
    [
        ("friction 0", lambda p: eqx.tree_at(lambda p: p.friction, p, jnp.zeros(()))),
        ("an absurd gain of motors without limits", _stiff),
        ("a weight that is no number", lambda p: eqx.tree_at(lambda p: p.gravity, p, jnp.full(3, jnp.nan))),
    ],
)
def test_what_breaks_is_seen_and_its_neighbours_are_as_they_were(bench, ridden, name, change):
    told, steer = constant(*TWISTS)
    good, count = bench.fidelity.physics, len(told)
    physics = jax.tree.map(lambda x: jnp.stack([x] * count), good)
    broken = jax.tree.map(lambda x, y: x.at[0].set(y), physics, change(good))
    fast = np.array(told)
    fast[0] *= 2.5  # far enough to be seen
    found = bench(fast, steer, physics=broken)
    assert not found.holds[0].all() and found.holds[1:].all()
    for a, b in zip(found, ridden, strict=True):
        np.testing.assert_array_equal(a[1:], b[1:])


def test_physics_are_traced(bench, ridden):
    before = bench.run.traces
    bench(*constant(*TWISTS), physics=jax.tree.map(lambda x: 1.01 * x, bench.fidelity.physics))
    assert bench.run.traces == before
