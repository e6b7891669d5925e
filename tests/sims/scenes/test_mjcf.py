"""The scene and its MuJoCo model are one place: rays through both agree."""

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest

from sims.scenes import WALLS, Box, Plain, PlaneChart, Scene, Sphere, make_wall, scene_mjcf


def _mujoco_distances(scene, origins, directions):
    model = mujoco.MjModel.from_xml_string(scene_mjcf(scene))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    geom = np.zeros(1, dtype=np.int32)
    rays = zip(origins, directions, strict=True)
    return np.array(
        [mujoco.mj_ray(model, data, start, along, None, 1, -1, geom, None) for start, along in rays]
    )


def _compare(scene, spread=0.8):
    generator = np.random.default_rng(6)
    origins = generator.uniform([-1.5, -0.6, 0.5], [-1.0, 0.6, 1.8], (400, 3))
    directions = np.column_stack([np.ones(400), generator.uniform(-spread, spread, (400, 2))])
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    hits = jax.jit(jax.vmap(scene.raycast))(jnp.asarray(origins), jnp.asarray(directions))
    met = np.asarray(hits.valid)
    assert met.mean() > 0.5
    return np.abs(_mujoco_distances(scene, origins, directions) - np.asarray(hits.distance))[met]


@pytest.mark.parametrize("kind", WALLS)
def test_walls_are_where_mujoco_finds_them(x64, kind):
    assert _compare(make_wall(kind)).max() < 1e-5


def test_boxes_and_spheres_too(x64):
    grey = Plain(jnp.asarray([0.5, 0.5, 0.5]))
    wall = make_wall("flat")
    turn = jnp.asarray([[0.6, -0.8, 0.0], [0.8, 0.6, 0.0], [0.0, 0.0, 1.0]])
    box = Box(jnp.asarray([-0.4, 0.3, 1.0]), turn, jnp.asarray([0.2, 0.1, 0.3]), grey)
    ball = Sphere(jnp.asarray([-0.5, -0.4, 1.2]), jnp.asarray(0.25), grey)
    scene = Scene((*wall.primitives, box, ball), wall.chart, "objects")
    assert isinstance(scene.chart, PlaneChart)
    assert _compare(scene, spread=0.5).max() < 1e-5


def test_a_captured_wall_is_a_height_field(captured_wall):
    errors = _compare(captured_wall.scene, spread=0.3)
    # MuJoCo joins the cells by triangles, we by a spline; at the rim of the box they differ by its depth.
    assert np.percentile(errors, 90) < 1e-3
