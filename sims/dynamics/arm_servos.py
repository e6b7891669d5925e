"""Where an industrial arm's controller tells its servos to be."""

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from opt.wbc import RobotLimits

# A reference stays this near to its joint [rad]: a servo at its force limit winds nothing up.
LEASH = 0.1
# No joint is as fast, not even one that falls [rad/s]: it is driven by what has come unstable.
_ABSURD = 100.0


def arm_reference(
    robot: RobotLimits,
    arm: Float[Array, " a"],
    goal: Float[Array, " a"],
    pace: Float[Array, " a"],
    commanded: Float[Array, " a"],
    h: Float[Array, ""],
) -> tuple[Float[Array, " a"], Float[Array, " a"]]:
    """Goal [rad] and pace [rad/s] one physics step of `h` [s] later, within the joints' limits."""
    change = robot.arm_acceleration * h
    pace = pace + jnp.clip(commanded - pace, -change, change)
    pace = jnp.clip(pace, -robot.arm_speed, robot.arm_speed)
    goal = jnp.clip(goal + pace * h, robot.arm_lower, robot.arm_upper)
    return leashed(arm, goal), pace


def arm_holds(velocity: Float[Array, " a"]) -> Bool[Array, ""]:
    """Whether all joints have a speed that a joint can have: servos have not come unstable."""
    return (jnp.abs(velocity) < _ABSURD).all()


def leashed(joint: Float[Array, " n"], goal: Float[Array, " n"]) -> Float[Array, " n"]:
    """The goal, as near to the joint as it may be."""
    return joint + jnp.clip(goal - joint, -LEASH, LEASH)
