"""Wheels with rollers, such as mecanum wheels: they do not steer, and every twist is theirs at once."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxpaint.kinematics.small_solve import gram, solve_spd
from jaxpaint.steering.drive import AbstractDrive, Odometry, Step, WheelMotion
from jaxpaint.steering.limits import share
from jaxpaint.steering.odometry import root_mean_square


class RollerWheels(AbstractDrive):
    """Wheels that do not steer and may slide along their rollers: every twist is theirs at once.

    rows: rim speed of each wheel for unit twists, S = rows (v_x, v_y, w); of rank 3.
    """

    rows: Float[Array, "w 3"]
    speed_limit: Float[Array, ""]

    @property
    def size(self) -> int:
        """The number of wheels."""
        return self.rows.shape[0]

    @property
    def nonholonomic_rows(self):
        """None."""
        return jnp.zeros((0, 3), self.rows.dtype)

    def steered(self, twist, angle, dt):
        """Nothing steers."""
        return angle

    def rolled(self, twist, angle):
        """rows (v_x, v_y, w)."""
        return self.rows[:, 0] * twist[0] + self.rows[:, 1] * twist[1] + self.rows[:, 2] * twist[2]

    def load(self, twist, angle):
        """Of the rims."""
        return jnp.abs(self.rolled(twist, angle)).max() / self.speed_limit

    def step(self, twist, steer_twist, stance, dt):
        """Rims at once at their speed."""
        speed = self.rolled(twist, stance.angle)
        scale = share(jnp.abs(speed).max() / self.speed_limit)
        return Step(stance, WheelMotion(stance.angle, scale * speed, jnp.zeros_like(speed)), scale)

    def odometry(self, motion):
        """One equation for each wheel: its rim; the rollers leave the rest open."""
        twist = self.twist(motion.angle, motion.speed)
        return Odometry(twist, root_mean_square(self.rolled(twist, motion.angle) - motion.speed))

    def twist(self, angle, speed):
        """The normal equations (rows' rows) twist = rows' S."""
        right = (self.rows * speed[:, None]).sum(0)
        return solve_spd(gram(self.rows.T), right[:, None])[0][:, 0]

    def readiness(self, twist, angle):
        """Always."""
        return jnp.ones_like(twist[0])


def mecanum(
    position: Float[Array, "w 2"], roller_angle: Float[Array, ""], speed_limit: Float[Array, ""]
) -> RollerWheels:
    """Mecanum wheels that roll along x, with their contacts at (a_i, b_i) in the base frame [m].

    The contact moves with (v_x - w b, v_y + w a). The roller on the floor turns freely about its own axis
    r = (sin(angle), s cos(angle)), at `roller_angle` [rad] to the wheel's axle (0, 1), and does not slip
    along it: r . (v_x - w b - S, v_y + w a) = 0. So the rim's speed is S = v_x - w b + s cot(angle)
    (v_y + w a), with s = -1 front left and rear right, +1 front right and rear left: seen from above, the
    rollers form an X, those on the floor an O.
    """
    a, b = position[:, 0], position[:, 1]
    slope = -jnp.sign(a * b) / jnp.tan(roller_angle)
    return RollerWheels(jnp.stack([jnp.ones_like(a), slope, slope * a - b], axis=1), speed_limit)
