"""The trajectory controller: base and arm follow their own plans on one clock (S1 section IV-A)."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from jaxpaint.kinematics.chain import KinematicChain, forward
from jaxpaint.steering import wrap
from opt.controller import Command, Controller, Decision, Measured
from opt.plan import Samples
from opt.wbc.base_motion import body_twist

# The wheels turn towards where the base will go this much later [s].
_LEAD = 0.6
# Base speeds below this are not corrected: odometry might not see the correction, which would never end
# [m/s].
_WORTH_MEASURING = 0.01


class TrajectoryMemory(eqx.Module):
    """Nothing: the plan and the present measurement say all."""


class TrajectoryController(Controller):
    """Feeds planned velocities forward, with feedback on odometry and encoders, each joint for itself.

    The arm does not make good what the base misses: that is what the whole-body controller is for. The base's
    plan may go any way in the plane: for a differential base it is refused (`sims.robots.checks`).

    plan: rows of positions (base x, y, yaw in the map frame, arm), as many velocities, and the pen. gain:
    feedback [1/s].
    """

    chain: KinematicChain
    plan: Samples
    gain: Float[Array, ""]
    duration: Float[Array | np.ndarray, ""]

    def initial(self, measured: Measured) -> TrajectoryMemory:
        """Nothing to remember."""
        return TrajectoryMemory()

    def surface(self, clock) -> None:
        """Nothing: joints alone are planned."""

    def decide(
        self, memory: TrajectoryMemory, measured: Measured, clock, dt
    ) -> tuple[Decision, TrajectoryMemory]:
        """One control step."""
        row = self.plan.at(clock)
        n = self.chain.size
        q, pen = row[:n], row[2 * n]
        # what is commanded now holds until the next step: the speed half-way there
        velocity = self.plan.at(clock + dt / 2)[n : 2 * n]
        off = jnp.concatenate(
            [q[:2] - measured.base[:2], wrap(q[2:3] - measured.base[2:]), q[3:] - measured.arm]
        )
        wanted = velocity + self.gain * off
        moving = (jnp.abs(velocity[:3]) > _WORTH_MEASURING).any()
        base = jnp.where(moving, wanted[:3], velocity[:3])
        steer = jnp.where(moving, base, self.plan.at(clock + _LEAD)[n : n + 3])
        yaw = measured.base[2]
        command = Command(body_twist(base, yaw), body_twist(steer, yaw), wanted[3:])
        zero = jnp.zeros_like(clock)
        decision = Decision(command, zero + 1, forward(self.chain, q).p, pen, zero, jnp.int32(0))
        return decision, memory
