"""The robot's body, read from the geoms of a compiled model: spheres for clearance, and the footprint."""

from collections.abc import Sequence
from itertools import product

import jax.numpy as jnp
import mujoco
import numpy as np

from jaxpaint.kinematics import Spheres
from sims.robots.model import body_frames, carrier, link_frames, matrix

_EDGE_SPACING = 0.2  # [m] at most, between two points of a box's edge
_PICTURE_GROUP = 2  # geoms of this group are there to be looked at: MuJoCo Menagerie's convention


def spheres_from_model(model: mujoco.MjModel, joints: Sequence[int], *, brush: bool = False) -> Spheres:
    """The body, or the brush alone, as spheres that ride on `joints`.

    Capsules and cylinders become rows of spheres along their axis, a radius apart (a cylinder's flat ends
    gain a radius), boxes points along their edges, meshes rows along their longest side that hold all their
    vertices, everything else one sphere. Left out: geoms of group 2
    (pictures). The brush is what has a name, or a body with a name, that begins with `brush`: it touches the
    wall on purpose.
    """
    links, bodies = link_frames(model, joints), body_frames(model)
    frame, center, radius = [], [], []
    for geom in range(model.ngeom):
        link = carrier(model, int(model.geom_bodyid[geom]), joints)
        if link is None or model.geom_group[geom] == _PICTURE_GROUP or _is_brush(model, geom) != brush:
            continue
        points, r = _cover(model, geom)
        T = np.linalg.inv(links[link]) @ bodies[model.geom_bodyid[geom]] @ _geom_frame(model, geom)
        center.append(_moved(T, points))
        frame += [link] * len(points)
        radius += [r] * len(points)
    return Spheres(
        frame=jnp.asarray(np.array(frame, dtype=np.int32)),
        center=jnp.asarray(np.concatenate([*center, np.zeros((0, 3))])),
        radius=jnp.asarray(np.array(radius, dtype=float)),
    )


def footprint_from_model(model: mujoco.MjModel, joints: Sequence[int], base_size: int) -> np.ndarray:
    """Corners [4, 2] of the rectangle around what the arm does not carry, wheels at zero. Base frame, m."""
    bodies = body_frames(model)
    to_base = np.linalg.inv(bodies[model.jnt_bodyid[joints[base_size - 1]]])
    corners = [np.zeros((1, 3))]
    for geom in range(model.ngeom):
        body = int(model.geom_bodyid[geom])
        if carrier(model, body, joints) != base_size - 1:
            continue
        box = model.geom_aabb[geom, :3] + model.geom_aabb[geom, 3:] * _corner_signs()
        corners.append(_moved(to_base @ bodies[body] @ _geom_frame(model, geom), box))
    points = np.concatenate(corners)[:, :2]
    (x0, y0), (x1, y1) = points.min(0), points.max(0)
    return np.array([[x1, y1], [x0, y1], [x0, y0], [x1, y0]])


def _is_brush(model: mujoco.MjModel, geom: int) -> bool:
    body = model.body(int(model.geom_bodyid[geom]))
    return model.geom(geom).name.startswith("brush") or body.name.startswith("brush")


def _cover(model: mujoco.MjModel, geom: int) -> tuple[np.ndarray, float]:
    """Points [n, 3] in the geom's frame and their radius."""
    size, kind = model.geom_size[geom], mujoco.mjtGeom(int(model.geom_type[geom]))
    if kind in (mujoco.mjtGeom.mjGEOM_CAPSULE, mujoco.mjtGeom.mjGEOM_CYLINDER):
        radius, half = float(size[0]), float(size[1])
        count = int(np.ceil(2 * half / radius)) + 1
        return np.linspace([0, 0, -half], [0, 0, half], count), radius
    if kind == mujoco.mjtGeom.mjGEOM_BOX:
        return _edge_points(size), 0.0
    if kind == mujoco.mjtGeom.mjGEOM_MESH:
        return _row_around(_vertices(model, geom))
    return np.zeros((1, 3)), float(model.geom_rbound[geom])


def _vertices(model: mujoco.MjModel, geom: int) -> np.ndarray:
    mesh = model.geom_dataid[geom]
    first, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
    return np.asarray(model.mesh_vert[first : first + count], float)


def _row_around(vertices: np.ndarray) -> tuple[np.ndarray, float]:
    """Spheres in a row along the longest side of the vertices' box, the smallest that hold every vertex."""
    low, high = vertices.min(0), vertices.max(0)
    axis = int(np.argmax(high - low))
    across = float(np.linalg.norm(np.delete(vertices - (low + high) / 2, axis, 1), axis=1).max())
    count = int(np.ceil((high - low)[axis] / max(across, 1e-3))) + 1
    points = np.tile((low + high) / 2, (count, 1))
    points[:, axis] = np.linspace(low[axis], high[axis], count) if count > 1 else points[:, axis]
    nearest = np.linalg.norm(vertices[:, None] - points[None], axis=-1).min(axis=1)
    return points, float(nearest.max())


def _edge_points(half: np.ndarray) -> np.ndarray:
    rows = []
    for axis in range(3):
        count = int(np.ceil(2 * half[axis] / _EDGE_SPACING)) + 1
        for signs in product((-1, 1), repeat=2):
            edge = np.zeros((count, 3))
            edge[:, axis] = np.linspace(-half[axis], half[axis], count)
            edge[:, [k for k in range(3) if k != axis]] = np.array(signs) * np.delete(half, axis)
            rows.append(edge)
    return np.unique(np.concatenate(rows).round(9), axis=0)


def _corner_signs() -> np.ndarray:
    return np.array(list(product((-1, 1), repeat=3)), dtype=float)


def _geom_frame(model: mujoco.MjModel, geom: int) -> np.ndarray:
    return matrix(model.geom_pos[geom], model.geom_quat[geom])


def _moved(T: np.ndarray, points: np.ndarray) -> np.ndarray:
    return points @ T[:3, :3].T + T[:3, 3]
