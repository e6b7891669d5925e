"""Speed limits."""

from jaxtyping import Array, Float

from opt.wbc.pieces import Bounds


def speed_bounds(limit: Float[Array, "n"]) -> Bounds:
    """|q_i| <= limit_i [m/s, rad/s]; infinity leaves it out."""
    return Bounds(-limit, limit)
