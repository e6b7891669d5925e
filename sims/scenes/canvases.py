"""Where the picture goes on a wall: the default place, and the place a user asks for."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from jaxpaint.errors import InputError
from jaxpaint.mapping.canvas import Canvas
from sims.scenes.charts import AbstractChart, CylinderChart, FoldChart
from sims.scenes.scene import Scene

# The default drawing, in metres of arc length across and metres up.
DRAWING_WIDTH, DRAWING_HEIGHT = 2.4, 0.6
CENTER_HEIGHT = 1.1
_STAND_OFF = 0.05
_MAX_DEPTH = 1.5
# Things that reach further out of a wall than this are not hung over or stood before it [m].
_MAX_OBJECT, _SAME = 0.5, 0.002
_MIN_SHARE = 0.5
_PROBES, _FINE_PROBES = 9, 81


def default_canvas(scene: Scene) -> Canvas:
    """The canvas of the default drawing, 2.4 m of arc length wide, just in front of all that it covers."""
    width = _chord(scene.chart, DRAWING_WIDTH)
    lead = scene.chart.point(jnp.asarray([0.5 * DRAWING_WIDTH, CENTER_HEIGHT], dtype=float))
    middle = scene.chart.point(jnp.asarray([0.0, CENTER_HEIGHT], dtype=float))
    x = float(jnp.minimum(lead[0], middle[0])) - _STAND_OFF
    size, far = (width, DRAWING_HEIGHT), (x - _MAX_OBJECT, float(middle[1]), CENTER_HEIGHT, 0.0)
    nearest = float(jnp.min(_distances(scene, make_canvas(size, far))))
    # Rays that start inside of a thing, or behind it, would not know that it hides the wall.
    ahead = far[0] + nearest - _STAND_OFF
    return make_canvas(size, (ahead if ahead < x - _SAME else x, *far[1:]))


def canvas_for(
    scene: Scene,
    size: tuple[float, float] | None = None,
    pose: tuple[float, float, float, float] | None = None,
    *,
    default: Canvas | None = None,
) -> Canvas:
    """The canvas a user asked for; what is left open comes from `default`, or else from the wall's kind.

    size: width and height [m]. pose: x, y, z of the middle [m] and heading of the rays [rad]. Raises
    InputError where fewer than half of the canvas' rays meet a surface within 1.5 m. A canvas out of the
    robot's reach is no bad input: its world fails and says so.
    """
    base = default_canvas(scene) if default is None else default
    size = size if size is not None else (float(base.size[0]), float(base.size[1]))
    x, y, z = (float(value) for value in base.center)
    pose = pose if pose is not None else (x, y, z, float(base.yaw))
    _check_numbers(size, pose)
    canvas = make_canvas(size, pose)
    share = share_on_wall(scene, canvas)
    if share < _MIN_SHARE:
        raise InputError(
            f"--canvas-size, --canvas-pose: {share:.0%} of the canvas at ({pose[0]:.2f}, {pose[1]:.2f}, "
            f"{pose[2]:.2f}) m lies on the {scene.name} wall, within {_MAX_DEPTH} m along its rays; at least "
            f"{_MIN_SHARE:.0%} is needed"
        )
    return canvas


def make_canvas(size: tuple[float, float], pose: tuple[float, float, float, float]) -> Canvas:
    """A canvas from plain numbers: width, height [m]; x, y, z [m] and yaw [rad]."""
    return Canvas(
        center=jnp.asarray(pose[:3], dtype=float),
        yaw=jnp.asarray(pose[3], dtype=float),
        size=jnp.asarray(size, dtype=float),
    )


def share_on_wall(scene: Scene, canvas: Canvas) -> float:
    """Share of a coarse grid of the canvas' rays that meet a surface within 1.5 m."""
    uv = jnp.asarray(_grid(_PROBES), dtype=float) * canvas.size
    return float(_share_met(scene, canvas.to_map(uv), canvas.ray))


def _distances(scene: Scene, canvas: Canvas) -> Float[Array, "N"]:
    """Lengths of a grid of the canvas' rays, two or three centimetres apart [m]."""
    uv = jnp.asarray(_grid(_FINE_PROBES), dtype=float) * canvas.size
    return _cast(scene, canvas.to_map(uv), canvas.ray)


@jax.jit
def _cast(scene: Scene, origins: Float[Array, "N 3"], direction: Float[Array, "3"]) -> Float[Array, "N"]:
    return jax.vmap(scene.raycast, in_axes=(0, None))(origins, direction).distance


def _grid(count: int) -> np.ndarray:
    steps = np.linspace(-0.5, 0.5, count)
    return np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)


@jax.jit
def _share_met(scene: Scene, origins: Float[Array, "N 3"], direction: Float[Array, "3"]) -> Float[Array, ""]:
    hits = jax.vmap(scene.raycast, in_axes=(0, None))(origins, direction)
    return jnp.mean(hits.valid & (hits.distance <= _MAX_DEPTH))


def _chord(chart: AbstractChart, arc: float) -> float:
    """Straight width of a symmetric strip of that arc length about u = 0 [m]."""
    if isinstance(chart, CylinderChart):
        return float(2 * chart.radius * jnp.sin(0.5 * arc / chart.radius))
    if isinstance(chart, FoldChart):
        return float(arc * jnp.sin(0.5 * chart.interior))
    return arc


def _check_numbers(size: tuple[float, float], pose: tuple[float, float, float, float]) -> None:
    if not all(np.isfinite(value) and value > 0 for value in size):
        raise InputError(f"--canvas-size: {size[0]} {size[1]} found, two lengths above 0 m are allowed")
    if not all(np.isfinite(value) for value in pose):
        raise InputError(f"--canvas-pose: {' '.join(map(str, pose))} found, four finite numbers are allowed")
