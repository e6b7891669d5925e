"""Wheels whose contacts lie under their steering axes (l = 0): they must point the way they go.

A wheel's axis at (a, b) in the base frame moves with V = (v_x - w b, v_y + w a), S1-(8). A wheel at the angle
phi rolls along u = (cos phi, sin phi) and does not slip along n = (-sin phi, cos phi):

    rolling    u . V = speed of the rim
    no slip    n . V = 0

so it points along V, either way round, and rolls at |V|. S1-(9) as printed is no wheel at all
(docs/steering.md).
"""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxpaint.steering.angles import wrap
from jaxpaint.steering.drive import AbstractDrive, Odometry, Stance, Step, WheelMotion
from jaxpaint.steering.limits import share
from jaxpaint.steering.odometry import point_velocity, rigid_residual, rigid_twist


class SteeredWheels(AbstractDrive):
    """position: (a_i, b_i) of the steering axes in the base frame [m]. rate_limit: of the steering angles
    [rad/s]. speed_limit: of the wheel's rim [m/s]. margin: how much less the other way round must turn before
    a wheel changes its way [rad]; see `wheel_commands`. still: below this speed [m/s] a wheel keeps its
    angle: the angle of a vanishing velocity means nothing.
    """

    position: Float[Array, "w 2"]
    rate_limit: Float[Array, ""]
    speed_limit: Float[Array, ""]
    margin: Float[Array, ""]
    still: Float[Array, ""]

    def __init__(
        self,
        position: Float[Array, "w 2"],
        rate_limit: Float[Array, ""],
        speed_limit: Float[Array, ""],
        margin: float | Float[Array, ""] = 0.2,
        still: float | Float[Array, ""] = 1e-4,
    ):
        self.position, self.rate_limit, self.speed_limit = position, rate_limit, speed_limit
        self.margin, self.still = (jnp.asarray(x, position.dtype) for x in (margin, still))

    @property
    def size(self) -> int:
        """The number of wheels."""
        return self.position.shape[0]

    @property
    def nonholonomic_rows(self):
        """None: any twist is theirs once the wheels have turned."""
        return jnp.zeros((0, 3), self.position.dtype)

    def steered(self, twist, angle, dt):
        """Towards the nearer of the two angles that fit, at the rate limit."""
        return angle + self._turned(_turns(self, twist, angle, 0.0).turn, dt)

    def rolled(self, twist, angle):
        """The part of each contact velocity that lies along the wheel's present direction.

        A module that is not there yet does not push sideways.
        """
        velocity = point_velocity(twist, self.position)
        return velocity[:, 0] * jnp.cos(angle) + velocity[:, 1] * jnp.sin(angle)

    def load(self, twist, angle):
        """Of the rims alone: the angle that a twist asks for is the same however slow it is."""
        return jnp.abs(self.rolled(twist, angle)).max() / self.speed_limit

    def step(self, twist, steer_twist, stance, dt):
        """Wheels turn first, as far as they come, and roll as they then stand."""
        turn, way = _turns(self, steer_twist, *stance)
        turned = self._turned(turn, dt)
        angle = stance.angle + turned
        speed = self.rolled(twist, angle)
        scale = share(jnp.abs(speed).max() / self.speed_limit)
        return Step(Stance(angle, way), WheelMotion(angle, scale * speed, turned / dt), scale)

    def odometry(self, motion):
        """Rolling and no slip of every wheel: a turning axis moves no contact that lies under it."""
        velocity = _along(motion.angle, motion.speed)
        twist = rigid_twist(self.position, velocity)
        return Odometry(twist, rigid_residual(twist, self.position, velocity))

    def twist(self, angle, speed):
        """See `rigid_twist`."""
        return rigid_twist(self.position, _along(angle, speed))

    def readiness(self, twist, angle):
        """1 when every wheel points along its demanded velocity (either way), 0 from 18 degrees off."""
        v = point_velocity(twist, self.position)
        along = jnp.abs(v[:, 0] * jnp.cos(angle) + v[:, 1] * jnp.sin(angle))
        size = jnp.sqrt((v**2).sum(-1) + 1e-12)
        worst = jnp.where(size > 1e-3, along / size, 1.0).min()
        return jnp.clip((worst - 0.95) / 0.04, 0.0, 1.0)

    def _turned(self, turn, dt):
        """What of turns is done after `dt` [s]."""
        most = self.rate_limit * dt
        return jnp.clip(turn, -most, most)


def holonomic(
    half: Float[Array, ""], rate_limit: Float[Array, ""], speed_limit: Float[Array, ""]
) -> SteeredWheels:
    """A base whose wheels are not known: steered wheels in the corners of a square, `half` aside [m].

    With a rate limit that they never meet, every twist is theirs at once, and odometry measures it as one.
    """
    corners = jnp.asarray([[1, 1], [1, -1], [-1, 1], [-1, -1]], half.dtype)
    return SteeredWheels(corners * half, rate_limit, speed_limit)


class WheelCommands(NamedTuple):
    """angle: where each axis should be [rad]. speed: of the rims there [m/s]. way: 1 for a wheel that rolls
    forwards, -1 for one that rolls backwards, and 0 for one that has not rolled yet.
    """

    angle: Float[Array, "w"]
    speed: Float[Array, "w"]
    way: Float[Array, "w"]


def wheel_commands(
    wheels: SteeredWheels,
    twist: Float[Array, "3"],
    angle: Float[Array, "w"],
    way: float | Float[Array, "w"] = 0.0,
) -> WheelCommands:
    """Steering angle [rad] and rim speed [m/s] of each wheel for a twist, on the branch that turns least.

    A wheel may roll backwards, so two angles fit, half a turn apart, and one is within a quarter turn of the
    present `angle`. Where both are a quarter turn away, noise would change the branch in every step, and the
    wheel would tremble on the spot. The angle alone cannot tell which branch it is on, so the branch is
    state: `way` of the last call. That one is kept unless the other turns less by more than `wheels.margin`,
    so an angle lies within pi/2 + margin/2. With way 0 (the default) the nearer is taken.

    Below `wheels.still` a wheel keeps angle and way, and rolls what of the velocity lies along it; at zero
    speed that is 0.
    """
    turn, now = _turns(wheels, twist, angle, way)
    target = angle + turn
    return WheelCommands(target, wheels.rolled(twist, target), now)


class _Turns(NamedTuple):
    """turn: to where each axis should be [rad]. way: see `WheelCommands`."""

    turn: Float[Array, "w"]
    way: Float[Array, "w"]


def _turns(
    wheels: SteeredWheels, twist: Float[Array, "3"], angle: Float[Array, "w"], way: float | Float[Array, "w"]
) -> _Turns:
    """See `wheel_commands`."""
    velocity = point_velocity(twist, wheels.position)
    moving = (velocity**2).sum(-1) > wheels.still**2
    x, y = jnp.where(moving, velocity[:, 0], 1.0), jnp.where(moving, velocity[:, 1], 0.0)
    turn = wrap(jnp.arctan2(y, x) - angle)
    back = jnp.abs(turn) > jnp.pi / 2 + way * (wheels.margin / 2)
    turn = jnp.where(back, turn - jnp.sign(turn) * jnp.pi, turn)
    now = 1 - 2 * back.astype(turn.dtype)
    return _Turns(jnp.where(moving, turn, 0.0), jnp.where(moving, now, way))


def _along(angle: Float[Array, "w"], speed: Float[Array, "w"]) -> Float[Array, "w 2"]:
    return jnp.stack([speed * jnp.cos(angle), speed * jnp.sin(angle)], axis=-1)
