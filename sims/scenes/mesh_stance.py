"""How a mesh stands: which way is up, and which of its sides is the wall."""

import numpy as np
from jaxtyping import Bool, Float

from jaxpaint.errors import InputError
from sims.scenes.mesh_files import TriangleMesh
from sims.scenes.orientation import AXES, Stance, parse_axis, wall_axes

_MAX_LEAN = np.deg2rad(20.0)
# A solid that stands has this share of its area upright.
_STANDING = 0.4
_SHEET, _SIDED = 0.7, 0.3
_NEAR = np.cos(np.deg2rad(15.0))
_BIN = 0.05
# An equal must be clearly better to displace a heading that was tried before, nearer to -x.
_BETTER = 1.02


def find_side(mesh: TriangleMesh, sound: Bool[np.ndarray, "F"], up: str | None = None) -> Stance:
    """The turn that puts a mesh's wall upright in front of the robot.

    A sheet, most of whose faces look one way and back, is turned by all of its faces together, however it
    waves. Of anything else the largest upright plane is the wall. Either way it is seen from where its faces
    look; where they do not agree, from the negative axis. sound: faces with an area. Raises InputError where
    nothing stands upright.
    """
    corners = mesh.corners[sound]
    normals = 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(normals, axis=1)
    normals /= area[:, None]
    values, vectors = np.linalg.eigh(np.einsum("n,ni,nj->ij", area, normals, normals) / area.sum())
    sheet = values[-1] > _SHEET
    axis = parse_axis(up) if up is not None else _guess_up(normals, area, vectors[:, -1] if sheet else None)
    if sheet:
        normal, side = _sided(vectors[:, -1], normals, area)
        share = float(area[np.abs(normals @ normal) > np.cos(np.deg2rad(30.0))].sum() / area.sum())
    else:
        normal, share = _largest_side(corners.mean(axis=1), normals, area, AXES[axis])
        side = "its faces'"
    lean = float(np.arcsin(np.clip(normal @ AXES[axis], -1, 1))) if share > 0 else np.inf
    if abs(lean) > _MAX_LEAN:
        others = ", ".join(name for name in "xyz" if name != axis[1])
        raise InputError(f"{mesh.name}: no upright surface found with up = {axis}; try --up with {others}")
    offset = float(np.sum(area * (corners.mean(axis=1) @ normal)) / area.sum())
    if not sheet:
        facing = normals @ normal > _NEAR
        offset = float((corners[facing] @ normal).max())
    return Stance(wall_axes(normal, AXES[axis]), -offset, axis, up is None, side, lean, share)


def _guess_up(
    normals: Float[np.ndarray, "F 3"], area: Float[np.ndarray, "F"], sheet: Float[np.ndarray, "3"] | None
) -> str:
    """The first of z, y and x with which the mesh stands: its sheet, or much of a solid's area, is upright.

    So a sheet that lies flat in its file is stood up about x, as a picture that is hung.
    """
    level = np.sin(_MAX_LEAN)
    if sheet is not None:
        return "+" + next((name for name in "zyx" if abs(sheet @ AXES["+" + name]) < level), "z")
    upright = {
        name: float(area[np.abs(normals @ AXES["+" + name]) < level].sum() / area.sum()) for name in "zyx"
    }
    return "+" + next(
        (name for name in "zyx" if upright[name] > _STANDING), max("zyx", key=lambda name: upright[name])
    )


def _sided(
    normal: Float[np.ndarray, "3"], normals: Float[np.ndarray, "F 3"], area: Float[np.ndarray, "F"]
) -> tuple[Float[np.ndarray, "3"], str]:
    """The sheet's normal on the side that its faces look to."""
    balance = float(np.sum(area * (normals @ normal)) / area.sum())
    if abs(balance) > _SIDED:
        return np.sign(balance) * normal, "its faces'"
    return -np.sign(normal[np.argmax(np.abs(normal))]) * normal, "the negative axis'"


def _largest_side(
    middles: Float[np.ndarray, "F 3"],
    normals: Float[np.ndarray, "F 3"],
    area: Float[np.ndarray, "F"],
    up: Float[np.ndarray, "3"],
) -> tuple[Float[np.ndarray, "3"], float]:
    """Mean normal of the upright plane with the largest area, and its share of the mesh; 0 where none is.

    Headings are tried outwards from the one that faces -x, so that a round column, of which all sides are
    alike, keeps its own.
    """
    first = next(-axis for axis in (AXES["+x"], AXES["+y"]) if abs(axis @ up) < 0.5)
    across = np.cross(up, first)
    best, found = 0.0, first
    for degrees in sorted(range(-178, 181, 2), key=abs):
        heading = np.cos(np.deg2rad(degrees)) * first + np.sin(np.deg2rad(degrees)) * across
        near = np.flatnonzero(normals @ heading > _NEAR)
        if area[near].sum() <= _BETTER * best:
            continue
        bins = np.floor(middles[near] @ heading / _BIN).astype(int)
        bins -= bins.min()
        votes = np.convolve(np.bincount(bins, area[near]), [1.0, 1.0])
        if votes.max() > _BETTER * best:
            best = float(votes.max())
            plane = near[np.isin(bins, [votes.argmax(), votes.argmax() - 1])]
            mean = (area[plane, None] * normals[plane]).sum(axis=0)
            found = mean / np.linalg.norm(mean)
    return found, best / float(area.sum())
