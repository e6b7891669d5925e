"""The brush task: what twist the brush should have, and the rows that ask for it."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxpaint.kinematics import Pose
from opt.wbc.pieces import Equalities
from opt.wbc.reference import Reference, orientation_error
from opt.wbc.settings import ControllerSettings


def brush_twist(
    pose: Pose, jacobian: Float[Array, "6 n"], reference: Reference, settings: ControllerSettings
) -> Equalities:
    """J q + s = v, S1-(11) with the slack of S1's reference [26].

        v = (v_ref + k_p (p_ref - p),  w_ref + k_o e(R, R_ref))

    pose: of the brush in the map frame, jacobian: there [m, rad]. The rows stand in the brush frame, which
    keeps the spin about the brush apart: its slack is cheap. A row whose slack costs 0 is left out.
    """
    linear = reference.velocity + settings.position_gain * (reference.position - pose.p)
    off = orientation_error(pose.R, reference.rotation)
    angular = reference.angular_velocity + settings.orientation_gain * off

    def to_brush(rows):  # R' rows, for [3] and [3, n]
        return (pose.R.reshape(3, 3, *[1] * (rows.ndim - 1)) * rows[:, None]).sum(0)

    rows = jnp.concatenate([to_brush(jacobian[:3]), to_brush(jacobian[3:])])
    target = jnp.concatenate([to_brush(linear), to_brush(angular)])
    wanted = settings.slack_cost > 0
    compliance = 1 / jnp.where(wanted, settings.slack_cost, 1.0)
    return Equalities(jnp.where(wanted[:, None], rows, 0.0), jnp.where(wanted, target, 0.0), compliance)
