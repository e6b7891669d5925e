"""Four-wheel-steering kinematics (4WSK): base twist to steered, driven wheels and back.

S1-(9) as printed satisfies no single set of no-slip constraints. Derived here for a wheel whose contact lies
under its steering axis at (a, b) in the base frame (link length l = 0): the contact moves with (v_x - w b,
v_y + w a); a wheel that does not slip points along that velocity and rolls at its magnitude.
"""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float


class SteeringGeometry(eqx.Module):
    """position: (a_i, b_i) of the steering axes in the base frame [m]. radius: of the wheels [m]. rate_limit:
    of the steering angles [rad/s]. speed_limit: of the wheel's rim [m/s].
    """

    position: Float[Array, "w 2"]
    radius: Float[Array, ""]
    rate_limit: Float[Array, ""]
    speed_limit: Float[Array, ""]


# Below this rim speed a wheel keeps its direction: the angle of a vanishing velocity means nothing.
_STILL = 1e-4


def contact_velocity(geometry: SteeringGeometry, twist: Float[Array, "3"]) -> Float[Array, "w 2"]:
    """Velocity of each wheel contact in the base frame [m/s] for a base twist (v_x, v_y, w), S1-(8)."""
    a, b = geometry.position[:, 0], geometry.position[:, 1]
    return jnp.stack([twist[0] - twist[2] * b, twist[1] + twist[2] * a], axis=-1)


def wrap(angle: Float[Array, "*s"]) -> Float[Array, "*s"]:
    """The same angle in [-pi, pi)."""
    return angle - 2 * jnp.pi * jnp.floor((angle + jnp.pi) / (2 * jnp.pi))


def wheel_commands(
    geometry: SteeringGeometry, twist: Float[Array, "3"], angle: Float[Array, "w"]
) -> tuple[Float[Array, "w"], Float[Array, "w"]]:
    """Steering angle [rad] and rim speed [m/s] of each wheel for a twist, on the branch that turns least.

    A wheel may roll backwards, so of the two angles that fit, the one nearer to the present `angle` is taken;
    it then lies within a quarter turn. At rest the present angle is kept.
    """
    velocity = contact_velocity(geometry, twist)
    square = (velocity**2).sum(-1)
    moving = square > _STILL**2
    x, y = jnp.where(moving, velocity[:, 0], 1.0), jnp.where(moving, velocity[:, 1], 0.0)
    turn = wrap(jnp.arctan2(y, x) - angle)
    back = jnp.abs(turn) > jnp.pi / 2
    turn = jnp.where(back, wrap(turn + jnp.pi), turn)
    speed = jnp.sqrt(jnp.where(moving, square, 1.0)) * jnp.where(back, -1.0, 1.0)
    return angle + jnp.where(moving, turn, 0.0), jnp.where(moving, speed, 0.0)


def base_twist(
    geometry: SteeringGeometry, angle: Float[Array, "w"], speed: Float[Array, "w"]
) -> Float[Array, "3"]:
    """The twist that fits steering angles and rim speeds best, by least squares: odometry.

    For wheels about their own centroid (sum a = sum b = 0 after shifting), the normal equations are diagonal.
    """
    vx, vy = speed * jnp.cos(angle), speed * jnp.sin(angle)
    center = geometry.position.mean(0)
    a, b = geometry.position[:, 0] - center[0], geometry.position[:, 1] - center[1]
    omega = (a * vy - b * vx).sum() / (a**2 + b**2).sum()
    return jnp.stack([vx.mean() + omega * center[1], vy.mean() - omega * center[0], omega])
