"""The twist that fits what wheels measure best, by least squares."""

import jax.numpy as jnp
from jaxtyping import Array, Float


def point_velocity(twist: Float[Array, "3"], point: Float[Array, "w 2"]) -> Float[Array, "w 2"]:
    """Velocity of points that are fixed to the base, in the base frame [m/s]: (v_x - w b, v_y + w a) at
    (a, b) for a twist (v_x, v_y, w), S1-(8).
    """
    a, b = point[:, 0], point[:, 1]
    return jnp.stack([twist[0] - twist[2] * b, twist[1] + twist[2] * a], axis=-1)


def rigid_twist(point: Float[Array, "w 2"], velocity: Float[Array, "w 2"]) -> Float[Array, "3"]:
    """The twist that gives points (a_i, b_i) [m] of the base their velocities [m/s] best, all in its frame.

    Least squares over all 2 w equations, equally weighted. About the points' own centroid (sum a = sum b = 0)
    the normal equations are diagonal. Points on one spot do not show w: it is 0 then.
    """
    center = point.mean(0)
    a, b = point[:, 0] - center[0], point[:, 1] - center[1]
    vx, vy = velocity[:, 0], velocity[:, 1]
    spread = (a**2 + b**2).sum()
    omega = (a * vy - b * vx).sum() / jnp.maximum(spread, jnp.finfo(spread.dtype).tiny)
    return jnp.stack([vx.mean() + omega * center[1], vy.mean() - omega * center[0], omega])


def rigid_residual(
    twist: Float[Array, "3"], point: Float[Array, "w 2"], velocity: Float[Array, "w 2"]
) -> Float[Array, ""]:
    """What a twist leaves of the equations of `rigid_twist`: their root mean square [m/s]."""
    return root_mean_square(point_velocity(twist, point) - velocity)


def root_mean_square(values: Float[Array, "*s"]) -> Float[Array, ""]:
    """Of all entries. Its gradient at 0, where it has none, is 0."""
    mean = (values**2).mean()
    some = mean > 0
    return jnp.where(some, jnp.sqrt(jnp.where(some, mean, 1.0)), 0.0)
