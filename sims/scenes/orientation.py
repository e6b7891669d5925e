"""How a captured cloud stands: which way is up, and which of its planes is the wall.

Every near-vertical point votes with its own normal for a heading and an offset, as in a Hough transform:
the same cloud always gives the same wall, without a random draw.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.spatial import cKDTree

from jaxpaint.clouds import Cloud
from jaxpaint.errors import InputError

# Unit vectors by the names that --up takes.
AXES = {
    sign + name: float(sign + "1") * np.eye(3)[index] for index, name in enumerate("xyz") for sign in "+-"
}
_NEIGHBOURS = 30
_SPARSE_POINTS = 15_000
_IN_PLANE = 0.05
_MAX_LEAN = np.deg2rad(12.0)


@dataclass(frozen=True)
class Stance:
    """Where the wall is in the capture.

    R_wall_capture: turns the capture's axes into wall axes (z up, the robot looks along +x at the wall).
    offset: x of the wall's plane after turning [m]. up: the axis, by name, that was taken as up; guessed or
    given. side: what told the robot's side of the plane. lean: angle by which the plane was off the
    vertical before the cloud was levelled [rad]. share: share of the sparse cloud's points that lie in the
    plane.
    """

    R_wall_capture: Float[np.ndarray, "3 3"]
    offset: float
    up: str
    guessed: bool
    side: str
    lean: float
    share: float


def find_wall(cloud: Cloud, up: str | None = None) -> Stance:
    """The largest near-vertical plane that faces the sensor, and the turn that puts it in front of the robot.

    up: x, y, z with an optional sign, or None to guess. Raises InputError for any other name, and where no
    plane stands upright.
    """
    points, normals = _sparse_normals(cloud)
    axis = _guess_up(cloud, points, normals) if up is None else parse_axis(up)
    upright = np.abs(normals @ AXES[axis]) < np.sin(_MAX_LEAN) + 0.05
    if upright.sum() < 50:
        raise InputError(f"{cloud.name}: no upright plane found with up = {axis}; try another --up")
    normal, offset = _largest_plane(points[upright], normals[upright], AXES[axis])
    normal, offset, share = _refine(points, normals, normal, offset)
    sign, side = _robot_side(cloud, points, normal, offset)
    normal, offset = sign * normal, sign * offset
    lean = float(np.arcsin(np.clip(normal @ AXES[axis], -1, 1)))
    if abs(lean) > _MAX_LEAN:
        raise InputError(
            f"{cloud.name}: the largest plane leans {np.rad2deg(lean):.0f} degrees with up = {axis}"
        )
    return Stance(wall_axes(normal, AXES[axis]), -offset, axis, up is None, side, lean, share)


def parse_axis(name: str) -> str:
    """The canonical name, sign first, of an axis given as x, +x or -x."""
    axis = name if name[:1] in ("+", "-") else "+" + name
    if axis not in AXES:
        raise InputError(f"--up: '{name}' found, allowed: x, y, z, +x, +y, +z, -x, -y, -z")
    return axis


def _sparse_normals(cloud: Cloud) -> tuple[Float[np.ndarray, "M 3"], Float[np.ndarray, "M 3"]]:
    """About evenly spread points of the cloud, and their unit normals on the sensor's side."""
    points = thin(cloud.points, _SPARSE_POINTS)
    _, neighbours = cKDTree(points).query(points, k=min(_NEIGHBOURS, len(points)))
    local = points[neighbours] - points[neighbours].mean(axis=1, keepdims=True)
    _, vectors = np.linalg.eigh(np.einsum("nki,nkj->nij", local, local))
    normals = vectors[:, :, 0]
    facing = np.sum(normals * (cloud.viewpoint - points), axis=1)
    return points, np.where(facing[:, None] < 0, -normals, normals)


def thin(points: Float[np.ndarray, "N 3"], target: int) -> Float[np.ndarray, "M 3"]:
    """Means of the points in cubes, the cubes so large that at most about `target` remain."""
    side = float(np.prod(np.sort(np.ptp(points, axis=0))[1:] + 1e-9) / target) ** 0.5
    for _ in range(20):
        keys = np.floor((points - points.min(axis=0)) / side).astype(np.int64)
        _, index, count = np.unique(keys @ _strides(keys), return_inverse=True, return_counts=True)
        if len(count) <= 1.3 * target:
            break
        side *= 1.25
    sums = np.stack([np.bincount(index, points[:, axis], len(count)) for axis in range(3)], axis=1)
    return sums / count[:, None]


def _strides(keys: np.ndarray) -> np.ndarray:
    size = keys.max(axis=0) + 1
    return np.array([size[1] * size[2], size[2], 1])


def _guess_up(cloud: Cloud, points: np.ndarray, normals: np.ndarray) -> str:
    """Up is the axis that walls are square to and floors lie across; its sign points from the floor up.

    Walls tell more than floors, as the wall is what was captured. Both axes within a wall's plane are
    square to its normal: z wins a near tie (maps and scanners), then y (cameras). A floor is seen from
    above and a ceiling from below, so where level planes lie tells the sign; with both or neither, z points
    up, and y down in a camera's frame, which looks along +z.
    """
    offsets = points - cloud.viewpoint
    looks_along_z = float(np.mean(offsets[:, 2] > 0)) > 0.99
    bonus = {"x": 0.0, "y": 0.08, "z": 0.15 if looks_along_z else 0.5}
    along = {name: np.abs(normals @ AXES["+" + name]) for name in "xyz"}
    fit = {name: float(np.mean(value < 0.15) + 0.8 * np.mean(value > 0.97)) for name, value in along.items()}
    best = max("zyx", key=lambda name: fit[name] + bonus[name])
    heights = offsets[along[best] > 0.97] @ AXES["+" + best]
    below, above = float(np.sum(heights < 0)), float(np.sum(heights > 0))
    if max(below, above) > max(0.02 * len(points), 4 * min(below, above)):
        return ("+" if below > above else "-") + best
    return "-y" if best == "y" and looks_along_z else "+" + best


def _largest_plane(points: np.ndarray, normals: np.ndarray, up: np.ndarray) -> tuple[np.ndarray, float]:
    """Heading and offset with most votes; every heading of two degrees counts points whose normal is near."""
    side = np.roll(up, 1) - up * (np.roll(up, 1) @ up)
    across = np.cross(up, side)
    best, found = 0.0, (side, 0.0)
    bin_width = 0.05
    for heading in np.deg2rad(np.arange(0, 360, 2)):
        normal = np.cos(heading) * side + np.sin(heading) * across
        near = normals @ normal > np.cos(np.deg2rad(15.0))
        if near.sum() <= best:
            continue
        offsets = points[near] @ normal
        index = np.floor((offsets - offsets.min()) / bin_width).astype(int)
        votes = np.convolve(np.bincount(index), [1.0, 1.0])
        if votes.max() > best:
            best = float(votes.max())
            found = (normal, offsets.min() + bin_width * float(votes.argmax()))
    return found


def _refine(
    points: np.ndarray, normals: np.ndarray, normal: np.ndarray, offset: float
) -> tuple[np.ndarray, float, float]:
    """Least squares on the plane's own points, with a band that narrows to the spread that is there."""
    band = 0.10
    near = np.ones(len(points), dtype=bool)
    for _ in range(10):
        residual = points @ normal - offset
        near = (np.abs(residual) < band) & (np.abs(normals @ normal) > np.cos(np.deg2rad(25.0)))
        if near.sum() < 10:
            break
        centre = points[near].mean(axis=0)
        vector = np.linalg.eigh(np.cov((points[near] - centre).T))[1][:, 0]
        normal = vector if vector @ normal > 0 else -vector
        offset = float(centre @ normal)
        spread = 1.4826 * float(np.median(np.abs(points[near] @ normal - offset)))
        band = float(np.clip(3.0 * spread, 0.02, 0.10))
    return normal, offset, float(near.mean())


def _robot_side(cloud: Cloud, points: np.ndarray, normal: np.ndarray, offset: float) -> tuple[float, str]:
    """Whether the robot stands where the normal points (+1) or on the other side (-1), and what tells.

    The sensor stood on that side. Where its place lies in the plane itself, as in a file whose origin is on
    the wall, objects tell: what was captured beside the plane hangs or stands in front of it. Else the wall
    faces -x, -y or -z, as walls do here.
    """
    stood = float(cloud.viewpoint @ normal - offset)
    if abs(stood) > _IN_PLANE:
        return float(np.sign(stood)), "the sensor's"
    beside = points @ normal - offset
    front, back = float(np.sum(beside > 2 * _IN_PLANE)), float(np.sum(beside < -2 * _IN_PLANE))
    if max(front, back) > max(0.01 * len(points), 3 * min(front, back)):
        return (1.0 if front > back else -1.0), "the objects'"
    return -float(np.sign(normal[np.argmax(np.abs(normal))])), "the negative axis'"


def wall_axes(normal: Float[np.ndarray, "3"], up: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3 3"]:
    """Rows: x into the wall, y to the robot's left, z up in the wall's plane, so that it stands upright."""
    x = -normal
    z = up - x * (up @ x)
    z = z / np.linalg.norm(z)
    return np.stack([x, np.cross(z, x), z])
