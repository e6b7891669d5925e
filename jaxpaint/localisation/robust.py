"""How far each measurement counts, when some are of things that are not on the map."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxpaint.kinematics.small_solve import solve_spd

_ROUNDS = 3
_YAW = 0.1
"""Errors of the heading beyond which nothing is matched rightly anyway [rad]."""


def inlier_shares(
    rows: Float[Array, "m 3"],
    residual: Float[Array, "m"],
    precision: Float[Array, "m"],
    scale: Float[Array, ""],
    gate: Float[Array, ""],
) -> Float[Array, "m"]:
    """Geman-McClure shares 1 / (1 + (e / scale)^2)^2 at the pose that fits best; 0 beyond the gate.

    A wrong pose moves all residuals, which must not look like outliers. So the pose is fitted for a few
    rounds on the linearised residuals, while the kernel shrinks from the gate's width [m] to `scale` [m].
    What the measurements cannot see stays where it is believed.
    """
    within = (jnp.abs(residual) < gate) & (precision > 0)
    share = within * _kernel(residual, gate)
    for k in range(1, _ROUNDS + 1):
        left = residual + (rows * _fitted(rows, residual, precision * share, gate)[None]).sum(1)
        share = within * _kernel(left, gate * (scale / gate) ** (k / _ROUNDS))
    return share


def _kernel(residual, scale):
    return 1 / (1 + (residual / scale) ** 2) ** 2


def _fitted(rows, residual, weight, gate):
    """The error that fits best, by least squares; a priori it is about as large as the gate."""
    weighed = rows * weight[:, None]
    prior = jnp.stack([gate**-2, gate**-2, jnp.full_like(gate, _YAW**-2)])
    information = (weighed[:, :, None] * rows[:, None, :]).sum(0) + prior[:, None] * jnp.eye(
        3, dtype=rows.dtype
    )
    vector = -(weighed * residual[:, None]).sum(0)
    return solve_spd(information, vector[:, None])[0][:, 0]
