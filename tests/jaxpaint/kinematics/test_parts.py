"""Few parts for a body: their smooth gaps are near the true ones, and have the slopes they say."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.compiling import batched
from jaxpaint.kinematics import forward, frames, own_gap_slope, plane_gap_slope, sphere_centers
from jaxpaint.trajectories import own_gap_at
from sims.robots import body_parts, load_robot


@pytest.fixture(scope="module")
def robot():
    return load_robot()


@pytest.fixture(scope="module")
def parts(robot):
    return body_parts(robot)


@pytest.fixture(scope="module")
def postures(robot):
    """Home, and others than those by which the parts were chosen."""
    drawn = np.random.default_rng(11).uniform(-np.pi, np.pi, (300, 6))
    q = np.concatenate([np.zeros((300, 3)), drawn], axis=1)
    q[:, :3] = [0.3, -0.2, 0.5]
    return jnp.asarray(np.concatenate([np.asarray(robot.at_home(jnp.zeros(3)))[None], q]), jnp.float32)


def test_the_gap_is_near_that_of_all_spheres_and_above_it_by_less_than_the_least_gap_kept(
    robot, parts, postures
):
    assert sum(x.size for x in parts.ignored) < 150
    home = robot.at_home(jnp.zeros(3))

    def both(robot, parts, home, q):
        ours = own_gap_slope(robot.chain, parts, frames(robot.chain, q), jnp.float32(1e-3)).value
        return ours, own_gap_at(robot.chain, robot.body_and_brush, home, q)

    ours, true = batched(both, in_axes=(None, None, None, 0))(robot, parts, home, postures)
    near = np.asarray(true) > -0.02
    assert near.sum() > 100
    assert (ours - true)[near].max() < 0.01 and (ours - true)[near].min() > -0.02


def test_the_wall_is_as_far_as_from_all_spheres_of_the_body(robot, parts, postures):
    point, axis = jnp.asarray([0.9, 0.1, 0.8]), jnp.asarray([0.8, 0.6, 0.0])

    def both(robot, parts, q):
        gap = plane_gap_slope(
            robot.chain,
            parts.skin,
            frames(robot.chain, q),
            point,
            axis,
            jnp.float32(np.inf),
            jnp.float32(1e-3),
        )
        center = sphere_centers(robot.chain, robot.spheres, q)
        return gap.value, (((point - center) * axis).sum(-1) - robot.spheres.radius).min()

    ours, true = batched(both, in_axes=(None, None, 0))(robot, parts, postures)
    np.testing.assert_allclose(ours, true, atol=0.008)


def test_slopes_are_derivatives(x64, robot, parts, postures):
    def doubles(tree):
        return jax.tree.map(
            lambda x: jnp.asarray(x, jnp.float64) if jnp.issubdtype(x.dtype, jnp.floating) else x, tree
        )

    chain, parts, q = doubles(robot.chain), doubles(parts), doubles(postures[:20])
    pose = forward(chain, q[0])
    blend, reach = jnp.asarray(0.005), jnp.asarray(0.6)

    def gaps(chain, parts, q):
        links = frames(chain, q)
        own = own_gap_slope(chain, parts, links, blend)
        wall = plane_gap_slope(chain, parts.skin, links, pose.p, pose.R[:, 2], reach, blend)
        return jnp.stack([own.value, wall.value]), jnp.stack([own.slope, wall.slope])

    def both(chain, parts, q):
        return gaps(chain, parts, q)[1], jax.jacrev(lambda q: gaps(chain, parts, q)[0])(q)

    said, found = batched(both, in_axes=(None, None, 0))(chain, parts, q)
    np.testing.assert_allclose(said, found, atol=1e-9)
    assert np.abs(said).max() > 0.1
