"""Limits of rims and steering axes: they make a twist shorter, and never another one."""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxpaint.steering.drive import AbstractDrive, Odometry, Stance, WheelMotion


class Limited(NamedTuple):
    """twist: within the limits, along the one that was asked for. scale: its share of that one, in [0, 1]."""

    twist: Float[Array, "3"]
    scale: Float[Array, ""]


class Driven(NamedTuple):
    """One step. angle, way: of the steering axes at its end (`Stance`) [rad]. motion: what the encoders read.
    odometry: the twist that this is, and its residual. scale: share of the twist asked for that the limits
    left.
    """

    angle: Float[Array, "w"]
    way: Float[Array, "w"]
    motion: WheelMotion
    odometry: Odometry
    scale: Float[Array, ""]


def limited(drive: AbstractDrive, twist: Float[Array, "3"], angle: Float[Array, "w"]) -> Limited:
    """The twist times the largest factor in [0, 1] with which wheels at these angles meet every limit.

    Speeds and, with an offset, steering rates are linear in the twist, so the factor is exact. Without an
    offset the steering rate is a matter of time, not of the twist: see `driven`.
    """
    scale = share(drive.load(twist, angle))
    return Limited(scale * twist, scale)


def share(load: Float[Array, ""]) -> Float[Array, ""]:
    """What is left of a twist that asks for `load` times a limit, in [0, 1]."""
    return 1 / jnp.maximum(1.0, load)


def driven(
    drive: AbstractDrive,
    twist: Float[Array, "3"],
    angle: Float[Array, "w"],
    dt: Float[Array, ""],
    way: Float[Array, "w"] | None = None,
) -> Driven:
    """One step of `dt` [s] of wheels that stood at `angle`, with no rim and no steering axis above its limit.

    With an offset: rims and rates of the scaled twist at the step's start, held; that twist is driven.
    Without: axes turn first, at most rate_limit dt, and each wheel then rolls what of its velocity lies along
    it, scaled with the others. Until all are there, they do not agree on a twist: what is driven is the one
    that fits them best, and its residual says how much they scrub. To stand until they are there, drive the
    twist times `readiness` and turn meanwhile (`AbstractDrive.step`), as the whole-body controller does.

    way: of the step before; without it the nearer branch is taken.
    """
    stance = Stance(angle, jnp.zeros_like(angle) if way is None else way)
    stance, motion, scale = drive.step(twist, twist, stance, dt)
    return Driven(*stance, motion, drive.odometry(motion), scale)
