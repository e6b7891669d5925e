"""What a look says about the error of a believed pose, in the form in which looks add up."""

from typing import Self

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float


class Evidence(eqx.Module):
    """One Gauss-Newton step in information form, about the pose that was believed during the look.

    The unknown is the error d = true - believed: (dx, dy) in the map frame [m] and dyaw [rad]. A look sees
    e + J d = 0 up to noise. information: sum of J^T J / variance; singular along what the look cannot see.
    vector: sum of -J^T e / variance, so that information d = vector at the most likely d. residual: root mean
    square of e at the believed pose [m]. used: how many measurements that is, each counted with its weight.

    Evidence about the same believed pose adds up: `a + b`. Never add looks across a correction.
    """

    information: Float[Array, "3 3"]
    vector: Float[Array, "3"]
    residual: Float[Array, ""]
    used: Float[Array, ""]

    def __add__(self, other: Self) -> "Evidence":
        squares = self.used * self.residual**2 + other.used * other.residual**2
        used = self.used + other.used
        return Evidence(
            self.information + other.information,
            self.vector + other.vector,
            _root_mean(squares, used),
            used,
        )


def no_evidence(dtype) -> Evidence:
    """A look that saw nothing."""
    zero = jnp.zeros((), dtype)
    return Evidence(jnp.zeros((3, 3), dtype), jnp.zeros(3, dtype), zero, zero)


def evidence_of(
    rows: Float[Array, "m 3"],
    residual: Float[Array, "m"],
    precision: Float[Array, "m"],
    share: Float[Array, "m"],
) -> Evidence:
    """The evidence of m measurements.

    rows: J. residual: e [m]. precision: 1 / variance [1/m^2]. share: how far each one counts, from 0 to 1.
    """
    weighed = rows * (precision * share)[:, None]
    used = share.sum()
    return Evidence(
        (weighed[:, :, None] * rows[:, None, :]).sum(0),
        -(weighed * residual[:, None]).sum(0),
        _root_mean((share * residual * residual).sum(), used),
        used,
    )


def lever(
    normal: Float[Array, "m 2"], points: Float[Array, "m 2"], base: Float[Array, "2"]
) -> Float[Array, "m 3"]:
    """J: how distances of points along `normal` change with the base's error; a turn is about the base."""
    arm = points - base[None]
    return jnp.stack(
        [normal[:, 0], normal[:, 1], normal[:, 1] * arm[:, 0] - normal[:, 0] * arm[:, 1]], axis=-1
    )


def _root_mean(squares, used):
    some = (used > 0) & (squares > 0)  # the root's gradient is infinite at 0
    return jnp.where(some, jnp.sqrt(jnp.where(some, squares, 1) / jnp.where(some, used, 1)), 0)
