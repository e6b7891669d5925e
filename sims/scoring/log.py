"""What a run records for its scores: the truth beside what was planned and believed."""

import equinox as eqx
from jaxtyping import Array, Bool, Float


class Log(eqx.Module):
    """One world's control steps, in order; any stretch of a run, so a long run can be scored in parts.

    planned: brush position of the plan at this time, map frame [m]. brush: true brush position [m]. axis:
    true brush axis, unit, from the handle into the wall. pen: commanded state, down above one half. live:
    steps that belong to the run (padding is not live). odometry, base: believed and true base pose (x, y
    [m], yaw [rad]) in the map frame. halted: whether the controller held the base.
    """

    planned: Float[Array, "time 3"]
    brush: Float[Array, "time 3"]
    axis: Float[Array, "time 3"]
    pen: Float[Array, "time"]
    live: Bool[Array, "time"]
    odometry: Float[Array, "time 3"]
    base: Float[Array, "time 3"]
    halted: Bool[Array, "time"]
