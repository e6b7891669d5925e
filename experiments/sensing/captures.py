"""Depth pictures of a real Kinect and of renderings, and the planes in them, marked by hand."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float
from PIL import Image

from jaxpaint.clouds import read_cloud
from jaxpaint.clouds.pcd import read_pcd
from jaxpaint.errors import InputError
from sims.sensors.plane_residual import PlaneResidual, plane_residual


@dataclass(frozen=True)
class Mark:
    """A plane: pixels from `left` up to `right` and from `top` up to `bottom`. fitted: whether the noise is
    fitted to it too, and not only its residual shown.
    """

    name: str
    left: int
    right: int
    top: int
    bottom: int
    fitted: bool = True


@dataclass(frozen=True)
class Source:
    """Pictures of one camera. focal: [px]. baseline: [m], with which depth is told as disparity.
    marks: the same planes in all `files`, which were taken one after another.
    """

    name: str
    files: tuple[str, ...]
    focal: float
    baseline: float
    marks: tuple[Mark, ...]

    @property
    def focal_baseline(self) -> float:
        """Disparity [px] times depth [m]."""
        return self.focal * self.baseline


@dataclass(frozen=True, eq=False)
class Patch:
    """A mark in a picture, counted from 0. distance: along the optical axis, mean [m]. fitted: see `Mark`."""

    name: str
    picture: int
    residual: PlaneResidual
    distance: float
    fitted: bool


KINECT = Source(
    "kinect",
    ("clouds/pcl_capture0001.pcd", "clouds/pcl_capture0002.pcd"),
    focal=525.0,
    baseline=0.075,
    marks=(
        # To the right of it, in the upper corner, the wall is 20 mm off one plane in both pictures.
        Mark("wall", 310, 560, 40, 170),
        Mark("board", 330, 430, 300, 420),
        Mark("box", 515, 570, 340, 420),
    ),
)
"""A first Kinect; its maker's nominal focal length, by which the clouds were made, and baseline."""

RENDERED = Source(
    "rgbd frames",
    tuple(f"rgbd/o3d_depth_0000{number}.png" for number in range(5)),
    focal=525.0,
    baseline=0.075,
    marks=(
        Mark("wall, left", 285, 330, 60, 280),
        Mark("wall, middle", 335, 430, 25, 95),
        Mark("wall, right", 490, 600, 30, 170),
        # Seen so slanted that whole steps lie between rows, and rows come in pairs: no fit to neighbours.
        Mark("floor, far", 150, 370, 400, 430, fitted=False),
        Mark("floor, near", 120, 580, 432, 462, fitted=False),
    ),
)
"""Renderings with simulated noise: told in the disparity of a Kinect, which they imitate."""

FRAGMENT = "clouds/o3d_fragment.pcd"
# Free plaster between lamp and picture: ranges of x and of y [m].
_PLASTER = tuple(
    (x, y) for x in ((1.75, 2.2), (2.2, 2.65)) for y in ((0.95, 1.43), (1.43, 1.91), (1.91, 2.4))
)

FILES = (*KINECT.files, *RENDERED.files, FRAGMENT)
"""All that is read, below the folder of the data."""


def missing_file(folder: Path) -> str | None:
    """The first of FILES that is not there."""
    return next((name for name in FILES if not (folder / name).is_file()), None)


def depths(source: Source, folder: Path) -> list[Float[np.ndarray, "height width"]]:
    """Depth of each picture [m], NaN or 0 where there is none."""
    return [_depth(folder / name) for name in source.files]


def patches(source: Source, pictures: list[Float[np.ndarray, "height width"]]) -> list[Patch]:
    """The residual of each marked plane, picture by picture."""
    return [_patch(source, mark, k, depth) for k, depth in enumerate(pictures) for mark in source.marks]


def fragment_residuals(folder: Path) -> Float[np.ndarray, "patches"]:
    """Root mean square distance of each patch of plaster to its plane [m].

    The cloud is fused from many pictures: from where a point was seen, and from how far, is not in it.
    """
    points = read_cloud(folder / FRAGMENT).points
    return np.array([_off_plane(points, x, y) for x, y in _PLASTER])


def _depth(path: Path) -> Float[np.ndarray, "height width"]:
    if path.suffix == ".pcd":
        records = read_pcd(path)
        if records.shape is None:
            raise InputError(f"{path}: found rows without order, allowed: an organised cloud")
        return records.points[:, 2].reshape(records.shape)
    return np.asarray(Image.open(path), float) / 1000  # millimetres


def _patch(source: Source, mark: Mark, picture: int, depth: Float[np.ndarray, "height width"]) -> Patch:
    inside = depth[mark.top : mark.bottom, mark.left : mark.right]
    residual = plane_residual(inside, source.focal_baseline)
    return Patch(mark.name, picture, residual, source.focal_baseline / residual.disparity, mark.fitted)


def _off_plane(
    points: Float[np.ndarray, "N 3"], x: tuple[float, float], y: tuple[float, float]
) -> np.floating:
    inside = (points[:, 0] > x[0]) & (points[:, 0] < x[1]) & (points[:, 1] > y[0]) & (points[:, 1] < y[1])
    part = points[inside]
    return np.sqrt(np.linalg.eigvalsh(np.cov(part.T))[0])
