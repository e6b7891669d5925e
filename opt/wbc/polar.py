"""How a base that cannot go sideways reaches a pose: it aims at it, drives, and turns at the end."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxpaint.steering import wrap

# Driving begins when the base is aimed this well, and is at full speed from half of that [rad].
_AIMED = 0.2
# An axle nearer to its place than this is there, and turns [m].
_THERE = 0.008


def polar_twist(
    base: Float[Array, "3"],
    goal: Float[Array, "3"],
    row: Float[Array, "3"],
    lever: Float[Array, ""],
    gain: Float[Array, ""],
    speeds: tuple[Float[Array, ""], Float[Array, ""]],
) -> Float[Array, "3"]:
    """Twist (v_x, v_y [m/s], w [rad/s], base frame) with `row` . twist = 0, from the pose `base` to `goal`
    (x, y, yaw).

    With (r, e) the distance and the bearing of the goal, both of the point of the base that cannot go
    sideways (the axle's middle, row = (0, 1, a)):

        v_x = +- gain r max(0, min(1, 2 - 2 |e| / aimed)),   w = gain e,   v_y = -w a

    and at the goal w = gain (goal's yaw - yaw). The base drives backwards where it turns less for it. lever:
    metres that count like a radian. speeds: least and largest of v_x and lever w.
    """
    axle = row[2] / row[1]
    heading, final = _direction(base[2]), _direction(goal[2])
    off = goal[:2] + axle * final - base[:2] - axle * heading
    ahead = heading[0] * off[0] + heading[1] * off[1]
    aside = heading[0] * off[1] - heading[1] * off[0]
    distance = jnp.sqrt(ahead**2 + aside**2 + 1e-12)
    there = distance < _THERE
    way = jnp.where(ahead >= 0, 1.0, -1.0)
    bearing = jnp.arctan2(jnp.where(there, 0.0, way * aside), jnp.where(there, 1.0, way * ahead))
    turn = jnp.where(there, wrap(goal[2] - base[2]), bearing)
    aimed = jnp.clip(2 - 2 * jnp.abs(bearing) / _AIMED, 0.0, 1.0)
    forwards = way * jnp.clip(gain * distance, *speeds) * jnp.where(there, 0.0, aimed)
    spin = jnp.sign(turn) * jnp.clip(gain * jnp.abs(turn) * lever, 0.0, speeds[1]) / lever
    return jnp.stack([forwards, -spin * axle, spin])


def _direction(yaw: Float[Array, ""]) -> Float[Array, "2"]:
    return jnp.stack([jnp.cos(yaw), jnp.sin(yaw)])
