"""Four-wheel-steering kinematics (4WSK): base twist to steered, driven wheels and back.

S1-(9) as printed satisfies no single set of no-slip constraints. Derived here for a wheel whose contact lies
under its steering axis at (a, b) in the base frame (link length l = 0): the contact moves with (v_x - w b,
v_y + w a); a wheel that does not slip points along that velocity and rolls at its magnitude.
"""

import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxpaint.steering.angles import wrap
from jaxpaint.steering.drive import AbstractDrive

# Below this rim speed a wheel keeps its direction: the angle of a vanishing velocity means nothing.
_STILL = 1e-4


class SteeredWheels(AbstractDrive):
    """position: (a_i, b_i) of the steering axes in the base frame [m]. rate_limit: of the steering angles
    [rad/s]. speed_limit: of the wheel's rim [m/s].
    """

    position: Float[Array, "w 2"]
    rate_limit: Float[Array, ""]
    speed_limit: Float[Array, ""]

    @property
    def size(self) -> int:
        """The number of wheels."""
        return self.position.shape[0]

    def steered(self, twist, angle, dt):
        """Towards the nearer of the two angles that fit, at the rate limit."""
        target, _ = wheel_commands(self, twist, angle)
        step = self.rate_limit * dt
        return angle + jnp.clip(target - angle, -step, step)

    def rolled(self, twist, angle):
        """The part of each contact velocity that lies along the wheel's present direction.

        A module that is not there yet does not push sideways.
        """
        velocity = contact_velocity(self, twist)
        return velocity[:, 0] * jnp.cos(angle) + velocity[:, 1] * jnp.sin(angle)

    def twist(self, angle, speed):
        """See `base_twist`."""
        return base_twist(self, angle, speed)

    def readiness(self, twist, angle):
        """1 when every wheel points along its demanded velocity (either way), 0 from 18 degrees off."""
        v = contact_velocity(self, twist)
        along = jnp.abs(v[:, 0] * jnp.cos(angle) + v[:, 1] * jnp.sin(angle))
        size = jnp.sqrt((v**2).sum(-1) + 1e-12)
        worst = jnp.where(size > 1e-3, along / size, 1.0).min()
        return jnp.clip((worst - 0.95) / 0.04, 0.0, 1.0)


def holonomic(
    half: Float[Array, ""], rate_limit: Float[Array, ""], speed_limit: Float[Array, ""]
) -> SteeredWheels:
    """A base whose wheels are not known: steered wheels in the corners of a square, `half` aside [m].

    With a rate limit that they never meet, every twist is theirs at once, and odometry measures it as one.
    """
    corners = jnp.asarray([[1, 1], [1, -1], [-1, 1], [-1, -1]], half.dtype)
    return SteeredWheels(corners * half, rate_limit, speed_limit)


def contact_velocity(wheels: SteeredWheels, twist: Float[Array, "3"]) -> Float[Array, "w 2"]:
    """Velocity of each wheel contact in the base frame [m/s] for a base twist (v_x, v_y, w), S1-(8)."""
    a, b = wheels.position[:, 0], wheels.position[:, 1]
    return jnp.stack([twist[0] - twist[2] * b, twist[1] + twist[2] * a], axis=-1)


def wheel_commands(
    wheels: SteeredWheels, twist: Float[Array, "3"], angle: Float[Array, "w"]
) -> tuple[Float[Array, "w"], Float[Array, "w"]]:
    """Steering angle [rad] and rim speed [m/s] of each wheel for a twist, on the branch that turns least.

    A wheel may roll backwards, so of the two angles that fit, the one nearer to the present `angle` is taken;
    it then lies within a quarter turn. At rest the present angle is kept.
    """
    velocity = contact_velocity(wheels, twist)
    square = (velocity**2).sum(-1)
    moving = square > _STILL**2
    x, y = jnp.where(moving, velocity[:, 0], 1.0), jnp.where(moving, velocity[:, 1], 0.0)
    turn = wrap(jnp.arctan2(y, x) - angle)
    back = jnp.abs(turn) > jnp.pi / 2
    turn = jnp.where(back, wrap(turn + jnp.pi), turn)
    speed = jnp.sqrt(jnp.where(moving, square, 1.0)) * jnp.where(back, -1.0, 1.0)
    return angle + jnp.where(moving, turn, 0.0), jnp.where(moving, speed, 0.0)


def base_twist(
    wheels: SteeredWheels, angle: Float[Array, "w"], speed: Float[Array, "w"]
) -> Float[Array, "3"]:
    """The twist that fits steering angles and rim speeds best, by least squares: odometry.

    For wheels about their own centroid (sum a = sum b = 0 after shifting), the normal equations are diagonal.
    """
    vx, vy = speed * jnp.cos(angle), speed * jnp.sin(angle)
    center = wheels.position.mean(0)
    a, b = wheels.position[:, 0] - center[0], wheels.position[:, 1] - center[1]
    omega = (a * vy - b * vx).sum() / (a**2 + b**2).sum()
    return jnp.stack([vx.mean() + omega * center[1], vy.mean() - omega * center[0], omega])
