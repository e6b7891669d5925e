"""The robot's body, read from the geoms of a compiled model: spheres for clearance, and the footprint."""

from collections.abc import Sequence
from itertools import product

import jax.numpy as jnp
import mujoco
import numpy as np

from jaxpaint.kinematics import Spheres
from sims.robots.model import body_frames, carrier, floor_frame, link_frames, matrix

# A box is cut into cells, a sphere around each: cubes of its thinnest side, larger ones where these would be
# more than so many, but none larger than this [m].
_CELLS, _CELL = 16, 0.2
_PICTURE_GROUP = 2  # geoms of this group are there to be looked at: MuJoCo Menagerie's convention


def spheres_from_model(model: mujoco.MjModel, joints: Sequence[int], *, brush: bool = False) -> Spheres:
    """The body, or the brush alone, as spheres that ride on `joints`: together they hold all of it.

    Capsules and cylinders become rows of spheres, at most a radius apart: 0.12 radii too large around the
    axis, 0.62 at a cylinder's flat ends. Meshes become such rows along their longest side. Boxes are cut into
    cells of a sphere each: 0.37 sides of a cubic cell too large, 0.1 m at most, or 0.14 m beside a plate.
    Everything else is one sphere. Left out: geoms of group 2 (pictures). The brush is what has a name, or a
    body with a name, that begins with `brush`: it touches the wall on purpose.
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
    points = _base_corners(model, joints, base_size)
    (x0, y0), (x1, y1) = points[:, :2].min(0), points[:, :2].max(0)
    return np.array([[x1, y1], [x0, y1], [x0, y0], [x1, y0]])


def base_top(model: mujoco.MjModel, joints: Sequence[int], base_size: int) -> float:
    """How high what the arm does not carry reaches above the floor [m]."""
    return float(_base_corners(model, joints, base_size)[:, 2].max())


def _base_corners(model: mujoco.MjModel, joints: Sequence[int], base_size: int) -> np.ndarray:
    """Corners of the boxes around each of the base's geoms, and its origin. [n, 3], base frame, m."""
    bodies = body_frames(model)
    to_base = np.linalg.inv(floor_frame(model, joints[base_size - 1]))
    corners = [np.zeros((1, 3))]
    for geom in range(model.ngeom):
        body = int(model.geom_bodyid[geom])
        if carrier(model, body, joints) != base_size - 1:
            continue
        box = model.geom_aabb[geom, :3] + model.geom_aabb[geom, 3:] * _corner_signs()
        corners.append(_moved(to_base @ bodies[body] @ _geom_frame(model, geom), box))
    return np.concatenate(corners)


def _is_brush(model: mujoco.MjModel, geom: int) -> bool:
    body = model.body(int(model.geom_bodyid[geom]))
    return model.geom(geom).name.startswith("brush") or body.name.startswith("brush")


def _cover(model: mujoco.MjModel, geom: int) -> tuple[np.ndarray, float]:
    """Points [n, 3] in the geom's frame and their radius."""
    size, kind = model.geom_size[geom], mujoco.mjtGeom(int(model.geom_type[geom]))
    if kind == mujoco.mjtGeom.mjGEOM_CAPSULE:
        radius, half = float(size[0]), float(size[1])
        count = int(np.ceil(2 * half / radius)) + 1
        points = np.linspace([0, 0, -half], [0, 0, half], count)
        return points, float(np.hypot(radius, half / max(count - 1, 1)))
    if kind == mujoco.mjtGeom.mjGEOM_CYLINDER:
        return _row(np.zeros(3), 2, float(size[1]), float(size[0]))
    if kind == mujoco.mjtGeom.mjGEOM_BOX:
        return _cells(size)
    if kind == mujoco.mjtGeom.mjGEOM_MESH:
        return _row_around(_vertices(model, geom))
    return np.zeros((1, 3)), float(model.geom_rbound[geom])


def _vertices(model: mujoco.MjModel, geom: int) -> np.ndarray:
    mesh = model.geom_dataid[geom]
    first, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
    return np.asarray(model.mesh_vert[first : first + count], float)


def _row_around(vertices: np.ndarray) -> tuple[np.ndarray, float]:
    """Spheres in a row along the longest side of the vertices' box, around a cylinder that holds them."""
    low, high = vertices.min(0), vertices.max(0)
    axis = int(np.argmax(high - low))
    across = float(np.linalg.norm(np.delete(vertices - (low + high) / 2, axis, 1), axis=1).max())
    return _row((low + high) / 2, axis, float(high[axis] - low[axis]) / 2, across)


def _row(middle: np.ndarray, axis: int, half: float, radius: float) -> tuple[np.ndarray, float]:
    """A cylinder along an axis, cut into lengths of at most its radius: the middles, and what holds each."""
    count = max(int(np.ceil(2 * half / max(radius, 1e-3) - 1e-9)), 1)
    points = np.tile(middle, (count, 1))
    points[:, axis] += half * (2 * np.arange(count) + 1 - count) / count
    return points, float(np.hypot(radius, half / count))


def _cells(half: np.ndarray) -> tuple[np.ndarray, float]:
    """A box, cut into cells: their middles, and half their diagonal."""
    side = 2 * float(half.min())
    while _counts(half, side).prod() > _CELLS:
        side *= 1.05
    counts = _counts(half, min(side, _CELL))
    places = [h * (2 * np.arange(n) + 1 - n) / n for h, n in zip(half, counts, strict=True)]
    return np.array(list(product(*places))), float(np.linalg.norm(half / counts))


def _counts(half: np.ndarray, side: float) -> np.ndarray:
    return np.maximum(np.ceil(2 * half / max(side, 1e-3) - 1e-9), 1).astype(int)


def _corner_signs() -> np.ndarray:
    return np.array(list(product((-1, 1), repeat=3)), dtype=float)


def _geom_frame(model: mujoco.MjModel, geom: int) -> np.ndarray:
    return matrix(model.geom_pos[geom], model.geom_quat[geom])


def _moved(T: np.ndarray, points: np.ndarray) -> np.ndarray:
    return points @ T[:3, :3].T + T[:3, 3]
