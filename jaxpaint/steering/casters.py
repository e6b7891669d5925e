"""Driven casters: steered wheels whose contacts lie an offset l from their steering axes.

The contact lies at l u from the axis (a, b), u = (cos phi, sin phi) the rolling direction, n = (-sin phi,
cos phi). The axis moves with V = (v_x - w b, v_y + w a), S1-(8), and the contact with V + (w + phi') l n. It
rolls along u and does not slip along n:

    rolling    u . V = speed of the rim
    no slip    n . V + l (w + phi') = 0,  so  phi' = -(n . V) / l - w

At every angle any twist can be made at once: a twist asks for a steering rate and not for an angle. S1-(9) as
printed is neither these rows nor these with other signs (docs/steering.md).
"""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from jaxpaint.steering.drive import AbstractDrive, Odometry, Stance, Step, WheelMotion
from jaxpaint.steering.limits import limited, share
from jaxpaint.steering.odometry import point_velocity, rigid_residual, rigid_twist


class CasterWheels(AbstractDrive):
    """position: (a_i, b_i) of the steering axes in the base frame [m]. offset: l, from the axis to the
    contact along the rolling direction [m], not 0; below 0 the contact trails at angle 0, as those of most
    casters do: the same wheel half a turn round. rate_limit: of the steering angles [rad/s]. speed_limit: of
    the rims [m/s].

    With l > 0 and psi the direction of V, phi' = -(|V| / l) sin(psi - phi) - w. At w = 0 two angles stay:
    pushed (phi = psi, the contact ahead of its axis), where a deviation grows as exp(|V| t / l), and pulled
    (half a turn off: the contact trails, the rim turns backwards), where it dies out as fast. The law follows
    the twist and flees neither: a wheel that is pushed comes round by itself. Where |V| < l |w| no angle
    stays: the wheel turns on and on.
    """

    position: Float[Array, "w 2"]
    offset: Float[Array, ""]
    rate_limit: Float[Array, ""]
    speed_limit: Float[Array, ""]

    def __check_init__(self):
        """Raises a ValueError for an offset that is 0 or no number; where it is traced, nobody can tell."""
        try:
            offset = np.asarray(self.offset)
        except jax.errors.TracerArrayConversionError:
            return
        if not (np.isfinite(offset) & (offset != 0)).all():
            raise ValueError(f"offset: {offset} m; allowed: any number but 0 (for 0 take SteeredWheels)")

    @property
    def size(self) -> int:
        """The number of wheels."""
        return self.position.shape[0]

    @property
    def nonholonomic_rows(self):
        """None: every twist is theirs at once."""
        return jnp.zeros((0, 3), self.position.dtype)

    def steered(self, twist, angle, dt):
        """With the rates at the step's start, held. The twist is scaled whole to be within the limits."""
        return angle + self.rates(limited(self, twist, angle).twist, angle) * dt

    def rolled(self, twist, angle):
        """u . V."""
        velocity = point_velocity(twist, self.position)
        return velocity[:, 0] * jnp.cos(angle) + velocity[:, 1] * jnp.sin(angle)

    def rates(self, twist: Float[Array, "3"], angle: Float[Array, "w"]) -> Float[Array, "w"]:
        """Steering rates that the twist asks of wheels at these angles [rad/s]: -(n . V) / l - w.

        Linear in the twist, and 0 where it is.
        """
        velocity = point_velocity(twist, self.position)
        across = velocity[:, 1] * jnp.cos(angle) - velocity[:, 0] * jnp.sin(angle)
        return -across / self.offset - twist[2]

    def load(self, twist, angle):
        """Of the rims and of the steering axes."""
        return self._load(self.rolled(twist, angle), self.rates(twist, angle))

    def step(self, twist, steer_twist, stance, dt):
        """Rims and rates at the step's start, held. At rest nothing turns."""
        speed, rate = self.rolled(twist, stance.angle), self.rates(twist, stance.angle)
        scale = share(self._load(speed, rate))
        motion = WheelMotion(stance.angle, scale * speed, scale * rate)
        return Step(Stance(stance.angle + motion.rate * dt, stance.way), motion, scale)

    def odometry(self, motion):
        """Rolling and no slip of every wheel.

        They say that the point of the base above the contact, at (a, b) + l u, moves with speed u - l phi' n.
        """
        along = jnp.stack([jnp.cos(motion.angle), jnp.sin(motion.angle)], axis=-1)
        across = jnp.stack([-along[:, 1], along[:, 0]], axis=-1)
        contact = self.position + self.offset * along
        velocity = motion.speed[:, None] * along - self.offset * motion.rate[:, None] * across
        twist = rigid_twist(contact, velocity)
        return Odometry(twist, rigid_residual(twist, contact, velocity))

    def twist(self, angle, speed):
        """Raises a ValueError: without the steering rates it would be wrong."""
        raise ValueError(
            "twist: of casters with an offset by angles and speeds alone; allowed: odometry(WheelMotion), "
            "which has their steering rates too"
        )

    def readiness(self, twist, angle):
        """Always."""
        return jnp.ones_like(twist[0])

    def _load(self, speed, rate):
        """See `load`."""
        return jnp.maximum(jnp.abs(speed).max() / self.speed_limit, jnp.abs(rate).max() / self.rate_limit)
