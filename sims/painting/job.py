"""Everything that one painting job is given, before any world is simulated."""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int, PRNGKeyArray, UInt32

from jaxpaint.decisions.thresholds import Thresholds
from jaxpaint.mapping.canvas import Canvas
from jaxpaint.mapping.raycast import MappingSettings
from opt.wbc import ControllerSettings, RobotLimits
from sims.noise import NoisePreset
from sims.paint import Brush
from sims.robots import Robot
from sims.scenes.scene import Scene
from sims.sensors import Camera

# One control step [s].
CONTROL_PERIOD = 0.02


class Job(eqx.Module):
    """What all worlds share; every leaf is traced.

    picture: canvas points of the strokes in order [m], stroke: which stroke each belongs to. views: camera
    positions on the canvas (u, v) [m], view_distance before it; stops: u of the base at each view [m]. seed: key
    data of the job's random numbers. speed: of the brush [m/s].
    """

    robot: Robot
    limits: RobotLimits
    scene: Scene
    canvas: Canvas
    camera: Camera
    noise: NoisePreset
    brush: Brush
    thresholds: Thresholds
    settings: ControllerSettings
    mapping: MappingSettings
    picture: Float[Array, "points 2"]
    stroke: Int[Array, " points"]
    views: Float[Array, "views 2"]
    stops: Float[Array, " views"]
    view_distance: Float[Array, ""]
    speed: Float[Array, ""]
    dt: Float[Array, ""]
    seed: UInt32[Array, "2"]

    def key(self, world: Int[Array, ""], purpose: int) -> PRNGKeyArray:
        """A world's random numbers for one purpose: they depend on its index, not on who runs beside it."""
        key = jax.random.fold_in(jax.random.wrap_key_data(self.seed), world)
        return jax.random.fold_in(key, purpose)


# Purposes of random numbers.
START, SLIP, DEPTH, SCAN, APPROACH, PAINT = range(6)


def base_before(canvas: Canvas, u: Float[Array, ""], home: Float[Array, "2"]) -> Float[Array, "3"]:
    """Base pose (x, y, yaw) that faces the canvas at `u` [m] with its best brush place on it."""
    spot = canvas.center + u * canvas.u_axis
    c, s = jnp.cos(canvas.yaw), jnp.sin(canvas.yaw)
    x, y = spot[0] - c * home[0] + s * home[1], spot[1] - s * home[0] - c * home[1]
    return jnp.stack([x, y, canvas.yaw])
