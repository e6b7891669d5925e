"""What the robot looks with as it moves, and what it takes its own odometry to be worth."""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxpaint.localisation import DriftModel, Outline
from jaxpaint.steering import AbstractDrive, WheelMotion
from sims.odometry import OdometryNoise
from sims.parameters import scalar
from sims.sensors import Camera, Lidar

# The camera's small picture, 424 x 240 pixels: in that mode it measures from 105 mm on, where the large one
# needs 195 mm; the wall is 125 mm away while the brush touches it.
_NEAR = {"fx": 223.4, "fy": 216.48, "cx": 211.5, "cy": 119.5, "near": 0.105}
# Of the scanner's 541 beams every ninth is matched: neighbours say the same.
_BEAMS = 61


class Sight(eqx.Module):
    """outline: what the lidar saw of the place before the job. drift: how the errors of odometry grow, as its
    maker states them. lidar: 1 where scans are matched with the outline, depth: 1 where the wall beside the
    brush is looked at, strokes: 1 where those laid before are, else 0. scanner: the beams that are matched.
    camera: the mode in which it looks at the wall.
    """

    outline: Outline
    drift: DriftModel
    lidar: Float[Array, ""] = eqx.field(converter=scalar, default=1.0)
    depth: Float[Array, ""] = eqx.field(converter=scalar, default=1.0)
    strokes: Float[Array, ""] = eqx.field(converter=scalar, default=1.0)
    camera: Camera = eqx.field(default_factory=lambda: Camera(width=424, height=240, decimation=1, **_NEAR))
    scanner: Lidar = eqx.field(default_factory=lambda: Lidar(beams=_BEAMS))


def drift_of(noise: OdometryNoise, drive: AbstractDrive) -> DriftModel:
    """How odometry drifts in the first metre ahead, and as the robot turns and steers.

    Each wheel's own errors, of which odometry's fit makes a twist, and the random walk.
    """
    angle = jnp.zeros(drive.size, noise.radius.dtype)
    speed = drive.rolled(jnp.asarray([1.0, 0.0, 0.0], angle.dtype), angle)

    def fitted(off):
        return drive.odometry(WheelMotion(angle + off[0], speed * (1 + off[1]), 0 * angle)).twist

    share = jax.jacobian(fitted)(jnp.stack([angle, angle]))
    along, across, yaw = (share**2 * jnp.stack([noise.steering, noise.radius])[:, None] ** 2).sum((1, 2))
    return DriftModel(
        along=along + noise.walk**2,
        across=across + noise.walk**2,
        yaw=yaw + noise.yaw_walk**2,
        turn_position=jnp.zeros_like(along),
        turn_yaw=along,
        steer_position=noise.scrub**2,
        steer_yaw=noise.yaw_scrub**2,
    )
