"""Gradients are those of finite differences away from where a branch changes, and finite everywhere."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from jax.test_util import check_grads

from jaxpaint.steering import (
    CasterWheels,
    SteeredWheels,
    WheelMotion,
    differential,
    driven,
    limited,
    mecanum,
    wheel_commands,
)

CORNERS = np.array([(0.28, 0.22), (0.28, -0.22), (-0.28, 0.22), (-0.28, -0.22)])
ANGLE = np.array([0.3, -0.4, 0.9, 0.1])


def bases():
    position, one = jnp.asarray(CORNERS), jnp.asarray(1.0)
    return {
        "steered": SteeredWheels(position, 3 * one, 1.2 * one),
        "caster": CasterWheels(position, 0.05 * one, 3 * one, 1.2 * one),
        "mecanum": mecanum(position, 0.7 * one, 1.2 * one),
        "differential": differential(0.5 * one, 0.1 * one, 1.2 * one),
    }


def made(drive, twist, angle, dt):
    """All that a drive makes of a twist and angles: `driven` uses every one of its maps but one."""
    return driven(drive, twist, angle, dt), drive.readiness(twist, angle)


@pytest.mark.parametrize("name", ["steered", "caster", "mecanum", "differential"])
def test_they_are_those_of_finite_differences(x64, name):
    drive = bases()[name]
    angle, twist = jnp.asarray(ANGLE[: drive.size]), jnp.asarray([0.8, 0.3, 0.4])
    angles, twists = (
        jnp.stack([angle, angle]),
        jnp.stack([0.2 * twist, 4 * twist]),
    )  # without limits, and at them

    def smooth(twist, angle):  # a residual that is 0 has no derivative
        done, ready = made(drive, twist, angle, jnp.asarray(0.1))
        return done.motion, done.angle, done.odometry.twist, done.scale, ready

    differs(jax.vmap(smooth), twists, angles)


@pytest.mark.parametrize("name", ["steered", "caster", "mecanum"])  # two wheels always agree
def test_what_wheels_disagree_by_has_gradients_too(x64, name):
    drive = bases()[name]
    motion = WheelMotion(*jnp.asarray(np.random.default_rng(0).normal(size=(3, drive.size))))
    differs(lambda m: drive.odometry(m), motion)


def test_commands_and_geometry_have_gradients(x64):
    angle, one = jnp.asarray(ANGLE), jnp.asarray(1.0)

    def commanded(twist, position, offset):
        command = wheel_commands(SteeredWheels(position, 3 * one, 1.2 * one), twist, angle)
        casters = CasterWheels(position, offset, 3 * one, 1.2 * one)
        return command.angle, command.speed, limited(casters, twist, angle), casters.rates(twist, angle)

    differs(commanded, jnp.asarray([0.3, 0.1, 0.2]), jnp.asarray(CORNERS), jnp.asarray(0.05))


def differs(function, *args):
    """Holds forward and reverse derivatives against central differences."""
    check_grads(jax.jit(function), args, order=1, modes=("fwd", "rev"), atol=1e-6, rtol=1e-6, eps=1e-6)


@pytest.mark.parametrize("name", ["steered", "caster", "mecanum", "differential"])
@pytest.mark.parametrize("mode", [jax.jacrev, jax.jacfwd])
def test_they_are_finite_at_zero_and_where_branches_change(x64, name, mode):
    drive = bases()[name]
    across = [0.0, 0.2, 0.0]  # a quarter turn from wheels at 0
    about_an_axis = 0.5 * np.array([CORNERS[0, 1], -CORNERS[0, 0], 1.0])
    twists = jnp.asarray(np.array([np.zeros(3), [1e-4, 0.0, 0.0], across, about_an_axis]))
    angle, dt = jnp.zeros(drive.size), jnp.asarray(0.02)

    def total(twist, angle):  # what is not finite in one part is not finite in the sum
        return sum(leaf.sum() for leaf in jax.tree.leaves(made(drive, twist, angle, dt)))

    gradient = mode(total, argnums=(0, 1))
    found = jax.jit(jax.vmap(lambda twist: gradient(twist, angle)))(twists)
    assert all(np.isfinite(leaf).all() for leaf in jax.tree.leaves(found))
