"""What a camera sees of the operating area."""

import numpy as np
from jaxtyping import Bool, Float

from jaxpaint.planning.area import OperatingArea
from jaxpaint.planning.cameras import Cameras, ViewSettings
from jaxpaint.planning.surroundings import Surroundings

# An echo as near to a line of sight as this blocks it: as far apart as beams are at some metres. So near to
# the line's end it is the surface: noise, and an outline that cuts corners off [m].
_THICK, _END = 0.03, 0.12


def footprints(
    cameras: Cameras,
    area: OperatingArea,
    field: tuple[float, float],
    around: Surroundings,
    s: ViewSettings,
) -> Bool[np.ndarray, "cameras points"]:
    """Which samples of the area each camera sees well.

    In the picture (width and height at distance 1 in `field` [m]) but for a rim of half the overlap and half
    the samples' spacing, at a depth and an incidence that the camera measures well, and not behind what the
    lidar saw.
    """
    line = area.points - cameras.place[:, None]
    x, y, z = np.moveaxis(np.einsum("cpi,cij->cpj", line, cameras.rotation), -1, 0)
    rim = (s.overlap + area.spacing) / 2
    inside = (np.abs(x) <= z * field[0] / 2 - rim) & (np.abs(y) <= z * field[1] / 2 - rim)
    good = (z >= s.depths[0]) & (z <= s.depths[1])
    facing = -np.einsum("cpi,pi->cp", line, area.normals) >= np.cos(s.incidence) * np.linalg.norm(
        line, axis=-1
    )
    sees = inside & good & facing
    return sees & ~_blocked(cameras, area, around, sees)


def _blocked(cameras: Cameras, area: OperatingArea, around: Surroundings, sees) -> Bool[np.ndarray, "c p"]:
    """Which lines of sight pass something that the lidar saw before the surface."""
    blocked = np.zeros_like(sees)
    for echoes, top in ((around.walls, np.inf), (around.clutter, around.top)):
        for echo in _before(echoes, area):
            along = area.points[None, :, :2] - cameras.place[:, None, :2]
            length = np.maximum(np.linalg.norm(along, axis=-1), 1e-9)
            offset = echo - cameras.place[:, None, :2]
            way = (offset * along).sum(-1) / length
            aside = np.abs(offset[..., 0] * along[..., 1] - offset[..., 1] * along[..., 0]) / length
            height = cameras.place[:, None, 2] + way / length * (
                area.points[:, 2] - cameras.place[:, None, 2]
            )
            blocked |= (way > 0) & (way < length - _END) & (aside < _THICK) & (height < top)
    return blocked


def _before(echoes: Float[np.ndarray, "n 2"], area: OperatingArea) -> Float[np.ndarray, "m 2"]:
    """Echoes that are not of the surface itself, but on its robot's side and near enough to matter."""
    if not len(echoes):
        return echoes
    echoes = np.unique(np.round(echoes / _THICK), axis=0) * _THICK  # one of many in the same place is enough
    floor, first = np.unique(area.points[:, :2], axis=0, return_index=True)
    offset = echoes[:, None] - floor
    nearest = np.linalg.norm(offset, axis=-1).argmin(1)
    mine = offset[np.arange(len(echoes)), nearest]
    out = (mine * area.normals[first[nearest], :2]).sum(-1)
    aside = np.linalg.norm(mine, axis=-1)
    return echoes[(out > _END) & (out > 0.5 * aside) & (aside < 1.5)]
