"""The body's spheres against the shapes of the file: they hold all of it, and not much more."""

import mujoco
import numpy as np
import pytest
import trimesh

from sims.robots import robot_model
from sims.robots.body import base_top, spheres_from_model
from sims.robots.model import joints_to

# A shape, how many spheres at most, and how far they stick out at most [m].
SHAPES = {
    "box": ('type="box" size="0.375 0.3 0.1"', 12, 0.0765),
    "cube": ('type="box" size="0.3 0.3 0.3"', 27, 0.074),
    "housing": ('type="box" size="0.045 0.0125 0.0125"', 4, 0.01),
    "plate": ('type="box" size="0.5 0.4 0.005"', 20, 0.1415),
    "rod": ('type="box" size="0.5 0.01 0.01"', 16, 0.025),
    "capsule": ('type="capsule" size="0.05 0.2"', 9, 0.119 * 0.05),
    "short capsule": ('type="capsule" size="0.05 0.01"', 2, 0.119 * 0.05),
    "cylinder": ('type="cylinder" size="0.05 0.2"', 8, 0.619 * 0.05),
    "disc": ('type="cylinder" size="0.1 0.01"', 1, 0.0906),
    "ball": ('type="sphere" size="0.1"', 1, 1e-6),
    "mesh": ('type="mesh" mesh="bar"', 8, 0.11),
}
MODEL = """<mujoco><asset><mesh name="bar" vertex="{bar}"/></asset><worldbody><body><joint type="slide"/>
<geom mass="1" pos="0.1 0.2 0.3" euler="20 30 40" {shape}/></body></worldbody></mujoco>"""
BAR = " ".join(str(x) for x in trimesh.creation.box((0.06, 0.5, 0.12)).vertices.ravel())


def outside(model, p):
    """How far points are outside of the geom [m], in its axes."""
    kind, size = mujoco.mjtGeom(int(model.geom_type[0])), model.geom_size[0]
    if kind in (mujoco.mjtGeom.mjGEOM_BOX, mujoco.mjtGeom.mjGEOM_MESH):
        half = size if kind == mujoco.mjtGeom.mjGEOM_BOX else model.mesh_vert.max(0)
        return np.linalg.norm(np.maximum(np.abs(p) - half, 0), axis=1)
    across, along = np.hypot(p[:, 0], p[:, 1]), np.abs(p[:, 2])
    if kind == mujoco.mjtGeom.mjGEOM_CYLINDER:
        return np.hypot(np.maximum(across - size[0], 0), np.maximum(along - size[1], 0))
    half = size[1] if kind == mujoco.mjtGeom.mjGEOM_CAPSULE else 0.0
    return np.maximum(np.hypot(across, np.maximum(along - half, 0)) - size[0], 0)


@pytest.mark.parametrize("name", SHAPES)
def test_spheres_hold_the_shape_and_not_much_more(name, x64):
    shape, most, overshoot = SHAPES[name]
    model = mujoco.MjModel.from_xml_string(MODEL.format(shape=shape, bar=BAR))
    spheres = spheres_from_model(model, [0])
    R = np.zeros(9)
    mujoco.mju_quat2Mat(R, model.geom_quat[0])
    centers = (np.asarray(spheres.center) - model.geom_pos[0]) @ R.reshape(3, 3)
    radius = np.asarray(spheres.radius)
    assert len(radius) <= most
    rng = np.random.default_rng(0)
    box = model.geom_aabb[0, 3:]
    points = np.concatenate([rng.uniform(-box, box, (20000, 3)), box * rng.choice([-1, 1], (20000, 3))])
    points[20000:, 0] *= rng.uniform(-1, 1, 20000)  # edges and corners
    points = points[outside(model, points) < 1e-9]
    assert len(points) > 5000
    gap = np.linalg.norm(points[:, None] - centers, axis=-1) - radius
    assert gap.min(1).max() < 1e-6
    way = rng.normal(size=(3000, 3))
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    shell = (centers[:, None] + radius[:, None, None] * way).reshape(-1, 3)
    assert outside(model, shell).max() < overshoot


def test_the_reference_robots_body_takes_few_spheres_and_its_base_ends_at_the_pedestals_top():
    model = robot_model()
    joints = joints_to(model, int(model.site_bodyid[model.site("brush").id]))
    assert len(spheres_from_model(model, joints).radius) <= 80
    assert base_top(model, joints, 3) == pytest.approx(0.9)
