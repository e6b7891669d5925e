"""Driven wheels on one axle, which do not steer: a differential base, such as that of S2's robot."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxpaint.steering.drive import AbstractDrive, Odometry, Step, WheelMotion
from jaxpaint.steering.limits import share
from jaxpaint.steering.odometry import rigid_residual, rigid_twist


class DifferentialWheels(AbstractDrive):
    """Wheels that roll along the base's x axis, at (axle, lateral_i) in the base frame [m].

    speed_limit: of the rims [m/s]. Rolling: S_i = v_x - w b_i. No slip sideways: v_y + w a = 0, which is a
    constraint on the base's velocity that no angle can lift (it is not holonomic). Of a twist that breaks it,
    the wheels make v_x and w, and v_y is what the axle leaves: -w a.
    """

    axle: Float[Array, ""]
    lateral: Float[Array, "w"]
    speed_limit: Float[Array, ""]

    @property
    def size(self) -> int:
        """The number of wheels."""
        return self.lateral.shape[0]

    @property
    def nonholonomic_rows(self):
        """(0, 1, a): no slip along the axle."""
        one = jnp.ones_like(self.axle)
        return jnp.stack([0 * one, one, self.axle])[None]

    def steered(self, twist, angle, dt):
        """Nothing steers."""
        return angle

    def rolled(self, twist, angle):
        """v_x - w b."""
        return twist[0] - twist[2] * self.lateral

    def load(self, twist, angle):
        """Of the rims."""
        return jnp.abs(self.rolled(twist, angle)).max() / self.speed_limit

    def step(self, twist, steer_twist, stance, dt):
        """Rims at once at their speed."""
        speed = self.rolled(twist, stance.angle)
        scale = share(jnp.abs(speed).max() / self.speed_limit)
        return Step(stance, WheelMotion(stance.angle, scale * speed, jnp.zeros_like(speed)), scale)

    def odometry(self, motion):
        """Rolling and no slip of every wheel; two wheels always agree."""
        contact, velocity = self._measured(motion.speed)
        twist = rigid_twist(contact, velocity)
        return Odometry(twist, rigid_residual(twist, contact, velocity))

    def twist(self, angle, speed):
        """See `rigid_twist`."""
        return rigid_twist(*self._measured(speed))

    def readiness(self, twist, angle):
        """Always: nothing has to turn first. What it can never make, `nonholonomic_rows` say."""
        return jnp.ones_like(twist[0])

    def _measured(self, speed):
        """Contacts in the base frame and their velocities over ground, as the rims tell them."""
        contact = jnp.stack([jnp.broadcast_to(self.axle, self.lateral.shape), self.lateral], axis=-1)
        return contact, jnp.stack([speed, jnp.zeros_like(speed)], axis=-1)


def differential(
    track: Float[Array, ""], axle: Float[Array, ""], speed_limit: Float[Array, ""]
) -> DifferentialWheels:
    """Two wheels `track` apart [m], left first, on an axle at x = `axle` in the base frame [m]."""
    return DifferentialWheels(axle, jnp.stack([track / 2, -track / 2]), speed_limit)
