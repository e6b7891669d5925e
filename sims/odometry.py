"""What the base really does, and what its odometry makes of it.

The wheel driver reports speed, and zero below its dead band: slow creep is not measured, which is what makes
halting worth while. Slip is proportional to travel; turning loaded modules on the spot scrubs.
"""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, PRNGKeyArray


class OdometryNoise(eqx.Module):
    """dead_band: rim speed below which zero is reported [m/s]. slip: standard deviation over worlds of the
    share of travel that is lost or gained [-]. curve: of the yaw per travel [rad/m]. turn: of the share of
    rotation lost or gained [-]. walk [m/sqrt(m)], yaw_walk [rad/sqrt(m)]: random walk along the way. scrub
    [m/rad], yaw_scrub [rad/rad]: random motion for each radian that the loaded modules turn.
    """

    dead_band: Float[Array, ""]
    slip: Float[Array, ""]
    curve: Float[Array, ""]
    turn: Float[Array, ""]
    walk: Float[Array, ""]
    yaw_walk: Float[Array, ""]
    scrub: Float[Array, ""]
    yaw_scrub: Float[Array, ""]


class Slip(eqx.Module):
    """One world's own errors: travel and rotation really made over commanded [-], yaw per travel [rad/m]."""

    travel: Float[Array, ""]
    rotation: Float[Array, ""]
    curve: Float[Array, ""]


def draw_slip(noise: OdometryNoise, *, key: PRNGKeyArray) -> Slip:
    """The errors of one world."""
    a, b, c = jax.random.normal(key, (3,), noise.slip.dtype)
    return Slip(1 + noise.slip * a, 1 + noise.turn * b, noise.curve * c)


def reported_speed(noise: OdometryNoise, speed: Float[Array, "w"]) -> Float[Array, "w"]:
    """Rim speeds as the wheel driver reports them."""
    return jnp.where(jnp.abs(speed) < noise.dead_band, 0.0, speed)


def true_motion(
    noise: OdometryNoise,
    slip: Slip,
    twist: Float[Array, "3"],
    turned: Float[Array, ""],
    shock: Float[Array, "3"],
    dt: Float[Array, ""],
) -> Float[Array, "3"]:
    """Displacement in the base frame (x, y [m], yaw [rad]) in one step of a twist that wheels without slip
    make.

    turned: mean angle that the modules turned in the step [rad]. shock: standard normal numbers.
    """
    travel = jnp.sqrt(twist[0] ** 2 + twist[1] ** 2 + 1e-16) * dt
    forward = twist * jnp.stack([slip.travel, slip.travel, slip.rotation]) * dt
    wander = jnp.sqrt(travel + 1e-16) * jnp.stack([noise.walk, noise.walk, noise.yaw_walk])
    scrub = turned * jnp.stack([noise.scrub, noise.scrub, noise.yaw_scrub])
    zero = jnp.zeros_like(travel)
    return forward + shock * (wander + scrub) + jnp.stack([zero, zero, slip.curve * travel])


def moved(pose: Float[Array, "3"], motion: Float[Array, "3"]) -> Float[Array, "3"]:
    """The pose (x, y, yaw) after a displacement in its own frame, at the mean heading."""
    yaw = pose[2] + motion[2] / 2
    c, s = jnp.cos(yaw), jnp.sin(yaw)
    return jnp.stack(
        [
            pose[0] + c * motion[0] - s * motion[1],
            pose[1] + s * motion[0] + c * motion[1],
            pose[2] + motion[2],
        ]
    )
