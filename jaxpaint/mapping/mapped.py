"""What the mapping gives for each ray: a point and a normal, or the reason why there is none."""

import enum

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float, Int


class Cause(enum.IntEnum):
    """HIT, or why a ray's point is left out of the path."""

    HIT = 0
    MISS = 1
    """No points near the ray, or points on one side of it only: a hole or the surface's rim."""
    FRONT = 2
    """Points near the ray, but nowhere enough of them at one depth: no consistent surface."""
    STEEP = 3
    """The surface turns too far away from the ray."""
    SHARP = 4
    """The surface is not flat about the point: an edge."""
    CLEARANCE = 5
    """A brush held along the normal would touch another surface."""
    SHORT = 6
    """On the surface, but in a run too short to paint."""
    OVERFLOW = 7
    """On the surface, but in a run beyond the number that the path has room for."""


class Mapped(eqx.Module):
    """The picture's points on the surface, in the map frame.

    p_map: point on the surface [m]. normal: unit, towards the ray's origin. status: a `Cause`.
    Where status is MISS or FRONT, p_map is the ray's origin on the canvas; otherwise the hit, refused or not.
    """

    p_map: Float[Array, "P 3"]
    normal: Float[Array, "P 3"]
    status: Int[Array, "P"]


def count_by_cause(status: Int[Array, "P"]) -> Int[Array, "causes"]:
    """How many rays ended in each `Cause`, in its order."""
    return (status[:, None] == jnp.arange(len(Cause))).sum(0)
