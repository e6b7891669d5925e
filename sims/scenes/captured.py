"""A captured cloud as the wall."""

from dataclasses import dataclass

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float
from scipy import ndimage

from jaxpaint.clouds import Cloud
from jaxpaint.errors import InputError
from jaxpaint.mapping.canvas import Canvas
from sims.scenes.baking import Baked, bake
from sims.scenes.building import plaster, wooden_floor
from sims.scenes.canvases import CENTER_HEIGHT, make_canvas
from sims.scenes.charts import HeightChart
from sims.scenes.heightfield import HeightField
from sims.scenes.heightmap import HeightMap
from sims.scenes.orientation import Stance, find_wall
from sims.scenes.placing import Place, find_place
from sims.scenes.scene import Scene
from sims.scenes.textures import AbstractTexture, Photograph

# What stands further in front of the wall is where the robot drives; what is further behind is another room.
_IN_FRONT, _BEHIND = 1.2, 0.5
_STAND_OFF = 0.05


@dataclass(frozen=True)
class CaptureReport:
    """What was made of a capture, guesses included, for the person who has to judge it. Lengths in m.

    up: the capture's axis that points up, up_guessed where nobody said so. side: what told the robot's side
    of the wall. lean: angle by which the wall was off the vertical before it was levelled [rad].
    plane_share: share of the capture that lies in the wall's plane. points, missing: of the file. used:
    points that the surface was made from; the others are hidden, stray, steep, or further than 1.2 m in
    front of the wall. cell: pitch of the height map. width: standard deviation of the smoothing window.
    noise_rms: spread of the wall's points about planes in such windows, so that a bent wall's bend within a
    window counts too. residual_rms, residual_p95: the wall's points from the surface; scene_residual_rms:
    all points used. height: of the lowest captured point above the floor; height_guessed where nobody said
    so. clearance: of the canvas from what is not free plane. T_map_capture: from the capture's axes to the
    map.
    """

    name: str
    up: str
    up_guessed: bool
    side: str
    scale: float
    height: float
    height_guessed: bool
    lean: float
    plane_share: float
    points: int
    missing: int
    used: int
    cell: float
    width: float
    jitter: float
    noise_rms: float
    residual_rms: float
    residual_p95: float
    scene_residual_rms: float
    free_area: float
    canvas_size: tuple[float, float]
    clearance: float
    T_map_capture: Float[np.ndarray, "4 4"]

    def lines(self) -> list[str]:
        """The report as lines that a person reads, millimetres and degrees."""
        guess = {True: " (guessed)", False: ""}
        return [
            f"{self.name}: {self.points} points, {self.missing} missing, {self.used} on the surface; "
            f"scale {self.scale:g}",
            f"up {self.up}{guess[self.up_guessed]}, seen from {self.side} side, "
            f"levelled by {np.rad2deg(abs(self.lean)):.1f} degrees, "
            f"lowest point {self.height:.2f} m above the floor{guess[self.height_guessed]}",
            f"wall: {self.plane_share:.0%} of the points, {self.free_area:.2f} m2 of free plane; "
            f"surface {1e3 * self.residual_rms:.1f} mm rms from the points, their own noise "
            f"{1e3 * self.noise_rms:.1f} mm, smoothed over {1e3 * self.width:.0f} mm",
            f"canvas {self.canvas_size[0]:.2f} x {self.canvas_size[1]:.2f} m, "
            f"{1e3 * self.clearance:.0f} mm from the nearest thing that is not free plane",
        ]


@dataclass(frozen=True)
class CapturedWall:
    """The scene, the canvas on its free plane, and the report."""

    scene: Scene
    canvas: Canvas
    report: CaptureReport


def captured(
    cloud: Cloud,
    *,
    up: str | None = None,
    height: float | None = None,
    canvas_size: tuple[float, float] | None = None,
) -> CapturedWall:
    """Turns a capture so that its largest upright plane is the wall at x = 0, and bakes it to a surface.

    up: the capture's axis that points up, such as "-y"; None guesses. height: of the lowest captured point
    above the floor [m]; None puts the middle of the canvas 1.1 m high. canvas_size [m]: None takes the
    largest that fits. The middle of the canvas lies at y = 0. Raises InputError where no wall or no place
    is found.
    """
    if height is not None and not np.isfinite(height):
        raise InputError(f"--wall-height: {height} found, a finite length in metres is allowed")
    stance = find_wall(cloud, up)
    points = cloud.points @ stance.R_wall_capture.T - np.array([stance.offset, 0.0, 0.0])
    near = (points[:, 0] > -_IN_FRONT) & (points[:, 0] < _BEHIND)
    baked = bake(points[near], cloud.name)
    place = find_place(baked, canvas_size, cloud.name)
    # Some stray point is always lower than anything that was there.
    lowest = float(np.percentile(points[:, 2], 0.05))
    rise = CENTER_HEIGHT - place.v if height is None else height - lowest
    colours = None if cloud.colours is None else cloud.colours[near]
    scene = _scene(baked, place, rise, _texture(baked, points[near], colours, place, rise), cloud.name)
    canvas = make_canvas(place.size, (_in_front(baked, place), 0.0, place.v + rise, 0.0))
    return CapturedWall(scene, canvas, _report(cloud, stance, baked, place, rise, lowest, height is None))


def _scene(baked: Baked, place: Place, rise: float, texture: AbstractTexture, name: str) -> Scene:
    surface = HeightMap(
        depth=jnp.asarray(baked.depth, dtype=float),
        valid=jnp.asarray(baked.valid),
        left=jnp.asarray(baked.lattice.left - place.u, dtype=float),
        low=jnp.asarray(baked.lattice.low + rise, dtype=float),
        cell=jnp.asarray(baked.lattice.cell, dtype=float),
    )
    wall = HeightField(
        surface=surface,
        near=jnp.asarray(baked.depth.min() - 0.02, dtype=float),
        far=jnp.asarray(baked.depth.max() + 0.02, dtype=float),
        texture=texture,
        empty=jnp.zeros(baked.depth.shape, bool),
    )
    return Scene((wall, wooden_floor()), HeightChart.of(surface), name)


def _texture(
    baked: Baked,
    points: Float[np.ndarray, "N 3"],
    colours: Float[np.ndarray, "N 3"] | None,
    place: Place,
    rise: float,
) -> AbstractTexture:
    """The captured colours by cell, gaps taken from the nearest cell; plaster where the file had none."""
    if colours is None:
        return plaster()
    shape = baked.lattice.shape
    index = baked.lattice.index(points[baked.used])[0]
    count = np.bincount(index, minlength=shape[0] * shape[1]).reshape(shape)
    sums = [
        np.bincount(index, colours[baked.used, channel], shape[0] * shape[1]).reshape(shape)
        for channel in range(3)
    ]
    image = np.stack(sums, axis=-1) / np.maximum(count, 1)[..., None]
    nearest = ndimage.distance_transform_edt(count == 0, return_distances=False, return_indices=True)
    return Photograph(
        image=jnp.asarray(image[tuple(nearest)], dtype=float),
        left=jnp.asarray(baked.lattice.left - place.u, dtype=float),
        low=jnp.asarray(baked.lattice.low + rise, dtype=float),
        cell=jnp.asarray(baked.lattice.cell, dtype=float),
    )


def _in_front(baked: Baked, place: Place) -> float:
    """x of a canvas just in front of all that it covers [m]."""
    lattice = baked.lattice
    column, row = (
        round((place.u - lattice.left) / lattice.cell),
        round((place.v - lattice.low) / lattice.cell),
    )
    across, up = (int(np.ceil(0.5 * side / lattice.cell)) for side in place.size)
    covered = baked.depth[max(row - up, 0) : row + up + 1, max(column - across, 0) : column + across + 1]
    return float(covered.min()) - _STAND_OFF


def _report(
    cloud: Cloud, stance: Stance, baked: Baked, place: Place, rise: float, lowest: float, height_guessed: bool
) -> CaptureReport:
    transform = np.eye(4)
    transform[:3, :3] = stance.R_wall_capture
    transform[:3, 3] = [-stance.offset, place.u, rise]
    return CaptureReport(
        name=cloud.name,
        up=stance.up,
        up_guessed=stance.guessed,
        side=stance.side,
        scale=cloud.scale,
        height=lowest + rise,
        height_guessed=height_guessed,
        lean=stance.lean,
        plane_share=stance.share,
        points=len(cloud.points),
        missing=cloud.missing,
        used=int(baked.used.sum()),
        cell=baked.lattice.cell,
        width=baked.width,
        jitter=baked.jitter,
        noise_rms=baked.noise,
        residual_rms=baked.residuals[0],
        residual_p95=baked.residuals[1],
        scene_residual_rms=baked.residuals[2],
        free_area=place.free,
        canvas_size=place.size,
        clearance=place.clearance,
        T_map_capture=transform,
    )
