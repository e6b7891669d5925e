"""Bases that cannot go everywhere: their constraint as hard rows."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxpaint.kinematics.small_solve import gram, solve_spd
from jaxpaint.steering import AbstractDrive
from opt.wbc.pieces import Bounds, Equalities


def nonholonomic_rows(drive: AbstractDrive, yaw: Float[Array, ""]) -> Float[Array, "k 3"]:
    """G R(yaw)' of the base's velocity in the map frame, with G = `drive.nonholonomic_rows` in its own; k = 0
    where the base can make every twist.
    """
    G, c, s = drive.nonholonomic_rows, jnp.cos(yaw), jnp.sin(yaw)
    return jnp.stack([c * G[:, 0] - s * G[:, 1], s * G[:, 0] + c * G[:, 1], G[:, 2]], axis=1)


def nonholonomic(rows: Float[Array, "k 3"], wanted: Float[Array, ""], arm_joints: int) -> Equalities:
    """G R(yaw)' q_base = 0, hard. wanted: 0 leaves the rows out."""
    k = rows.shape[0]
    whole = jnp.concatenate([rows, jnp.zeros_like(rows, shape=(k, arm_joints))], axis=1)
    on = jnp.broadcast_to(wanted > 0, (k,))
    return Equalities(jnp.where(on[:, None], whole, 0.0), jnp.zeros_like(whole[:, 0]), 1.0 - on)


def possible_part(rows: Float[Array, "k 3"], velocity: Float[Array, "3"]) -> Float[Array, "3"]:
    """The nearest velocity with rows v = 0: what the base can make of one that is not possible."""
    if rows.shape[0] == 0:
        return velocity
    share = solve_spd(gram(rows), (rows * velocity).sum(1)[:, None])[0][:, 0]
    return velocity - (rows * share[:, None]).sum(0)


def with_braking(
    bounds: Bounds, rows: Float[Array, "k 3"], velocity: Float[Array, "3"], step: Float[Array, "3"]
) -> Bounds:
    """The bounds, widened so far that they hold a velocity with rows v = 0: braking along the base's way.

    Bounds act on x, y and yaw apart. A base that brakes in each as hard as it can would leave its way, which
    the rows forbid: bounds and rows would contradict each other. Without rows nothing is widened.
    """
    if rows.shape[0] == 0:
        return bounds
    least = jnp.maximum(jnp.abs(velocity), jnp.finfo(velocity.dtype).tiny)
    slower = velocity * jnp.maximum(1 - (step / least).min(), 0.0)
    return Bounds(jnp.minimum(bounds.lower, slower), jnp.maximum(bounds.upper, slower))
