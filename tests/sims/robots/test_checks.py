"""Robots that are read but cannot paint."""

import equinox as eqx
import jax.numpy as jnp
import pytest

from jaxpaint.errors import InputError
from sims.robots import check_can_paint, load_robot


@pytest.fixture(scope="module")
def robot():
    return load_robot()


def test_the_reference_paints(robot):
    check_can_paint(robot)


def test_five_joints_are_too_few(robot):
    with pytest.raises(InputError, match="has 5 joints; allowed: 6 or more"):
        check_can_paint(eqx.tree_at(lambda r: r.home, robot, robot.home[:5]))


def test_home_within_the_limits(robot):
    high = robot.home.at[2].set(4.0)
    with pytest.raises(InputError, match=r"'home' has 4 for 'elbow'; allowed: -3.14159 to 3.14159"):
        check_can_paint(eqx.tree_at(lambda r: r.home, robot, high))


def test_the_brush_points_ahead_at_home(robot):
    aside = robot.home.at[0].add(1.0)
    with pytest.raises(InputError, match=r"points along.*allowed: ahead of the base"):
        check_can_paint(eqx.tree_at(lambda r: r.home, robot, aside))


def test_what_touches_the_wall_is_called_brush(robot):
    handle = eqx.tree_at(
        lambda s: (s.frame, s.center, s.radius),
        robot.spheres,
        (
            jnp.append(robot.spheres.frame, 8),
            jnp.concatenate([robot.spheres.center, robot.chain.p_tool[None]]),
            jnp.append(robot.spheres.radius, 0.011),
        ),
    )
    with pytest.raises(InputError, match=r"behind joint 'wrist_3' reaches.*begins with 'brush'"):
        check_can_paint(eqx.tree_at(lambda r: r.spheres, robot, handle))
