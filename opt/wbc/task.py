"""The brush task: what twist the brush should have, and the rows that ask for it."""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from opt.wbc.settings import ControllerSettings


class Reference(NamedTuple):
    """Where the brush should be now, in the map frame, and how it moves there.

    position [m], rotation (columns are the brush's axes), velocity [m/s], angular_velocity [rad/s], pen (1
    down).
    """

    position: Float[Array, "3"]
    rotation: Float[Array, "3 3"]
    velocity: Float[Array, "3"]
    angular_velocity: Float[Array, "3"]
    pen: Float[Array, ""]


class TaskRows(NamedTuple):
    """J, v and the slack's cost of the rows J q = v in S1-(11)."""

    jacobian: Float[Array, "6 n"]
    target: Float[Array, "6"]
    slack_cost: Float[Array, "6"]


def orientation_error(rotation: Float[Array, "3 3"], wanted: Float[Array, "3 3"]) -> Float[Array, "3"]:
    """Rotation vector, to first order, that turns `rotation` into `wanted` [rad, map frame]."""
    return jnp.cross(rotation, wanted, axisa=0, axisb=0).sum(0) / 2


def brush_rows(
    position: Float[Array, "3"],
    rotation: Float[Array, "3 3"],
    jacobian: Float[Array, "6 n"],
    reference: Reference,
    settings: ControllerSettings,
) -> TaskRows:
    """Rows for the brush's twist: the reference's own plus feedback on the error, in the brush frame.

    The brush frame keeps the spin about the brush apart: its slack is cheap.
    """
    linear = reference.velocity + settings.position_gain * (reference.position - position)
    angular = reference.angular_velocity + settings.orientation_gain * orientation_error(
        rotation, reference.rotation
    )

    def to_brush(rows):  # R' rows, for [3] and [3, n]
        return (rotation.reshape(3, 3, *[1] * (rows.ndim - 1)) * rows[:, None]).sum(0)

    rows = jnp.concatenate([to_brush(jacobian[:3]), to_brush(jacobian[3:])])
    return TaskRows(rows, jnp.concatenate([to_brush(linear), to_brush(angular)]), settings.slack_cost)
