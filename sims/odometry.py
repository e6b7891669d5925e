"""What the base really does, and what its odometry makes of it.

The wheel driver reports speed, and zero below its dead band: slow creep is not measured, which is what makes
halting worth while. Each wheel rolls a little further or less than is believed, and its steering angle has
a zero of its own: drift in proportion to travel, mostly of the heading. Turning loaded modules scrubs.
"""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, PRNGKeyArray


class OdometryNoise(eqx.Module):
    """dead_band: rim speed below which zero is reported [m/s]. steering: standard deviation over wheels of
    the zero of the steering angle [rad]. radius: of the share by which a wheel rolls further than it is
    believed to, its radius and the slip of its tread [-]. walk [m/sqrt(m)], yaw_walk [rad/sqrt(m)]: random
    walk along the way. scrub [m/sqrt(rad)], yaw_scrub [rad/sqrt(rad)]: the same as loaded modules turn.
    """

    dead_band: Float[Array, ""]
    steering: Float[Array, ""]
    radius: Float[Array, ""]
    walk: Float[Array, ""]
    yaw_walk: Float[Array, ""]
    scrub: Float[Array, ""]
    yaw_scrub: Float[Array, ""]


class Slip(eqx.Module):
    """One world's own errors, which odometry does not know. steering: what the true angle of each module is
    more than the measured one [rad]. radius: share by which each wheel rolls further than measured [-].
    """

    steering: Float[Array, " w"]
    radius: Float[Array, " w"]


def no_slip(wheels: int, dtype=None) -> Slip:
    """Wheels that are what odometry takes them for."""
    return Slip(jnp.zeros(wheels, dtype), jnp.zeros(wheels, dtype))


def draw_slip(noise: OdometryNoise, wheels: int, *, key: PRNGKeyArray) -> Slip:
    """The errors of one world."""
    a, b = jax.random.normal(key, (2, wheels), noise.radius.dtype)
    return Slip(noise.steering * a, noise.radius * b)


def reported_speed(noise: OdometryNoise, speed: Float[Array, "w"]) -> Float[Array, "w"]:
    """Rim speeds as the wheel driver reports them."""
    return jnp.where(jnp.abs(speed) < noise.dead_band, 0.0, speed)


def wandering(
    noise: OdometryNoise,
    twist: Float[Array, "3"],
    turned: Float[Array, ""],
    shock: Float[Array, "3"],
    dt: Float[Array, ""],
) -> Float[Array, "3"]:
    """Random displacement in the base frame (x, y [m], yaw [rad]) in one step of a twist.

    turned: mean angle that the modules turned in the step [rad]. shock: standard normal numbers.
    """
    travel = jnp.sqrt(twist[0] ** 2 + twist[1] ** 2 + 1e-16) * dt
    walk = jnp.stack([noise.walk, noise.walk, noise.yaw_walk])
    scrub = jnp.stack([noise.scrub, noise.scrub, noise.yaw_scrub])
    return shock * jnp.sqrt(walk**2 * travel + scrub**2 * turned + 1e-20)


def displacement(before: Float[Array, "3"], after: Float[Array, "3"]) -> Float[Array, "3"]:
    """What `moved` takes from one pose to the other."""
    yaw = (before[2] + after[2]) / 2
    c, s = jnp.cos(yaw), jnp.sin(yaw)
    dx, dy = after[0] - before[0], after[1] - before[1]
    return jnp.stack([c * dx + s * dy, c * dy - s * dx, after[2] - before[2]])


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
