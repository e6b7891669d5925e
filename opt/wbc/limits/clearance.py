"""Clearance: the robot keeps away from itself and from the wall, by one row of the program each."""

import itertools
from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxpaint.kinematics import Gap
from opt.wbc.pieces import Bounds, Inequalities

# Share of what bounds leave open between the best and the worst that a row still leaves open.
_ROOM = 0.05
# What a row of open bounds comes to at most.
_FAR = 1e3
# Share of its speed that the arm keeps where a gap is closed.
_CAUTIOUS = 0.2


class Clearance(NamedTuple):
    """The row, and the share of its speed that the arm may use: sliding fast along what is near asks for more
    acceleration than it has.
    """

    row: Inequalities
    speed_share: Float[Array, ""]


def clearance(
    gap: Gap, speed: Float[Array, ""], start: Float[Array, ""], stop: Float[Array, ""]
) -> Clearance:
    """The velocity damper of Faverjon and Tournassoud:

        -d gap/dt = -slope' q <= speed u,    u = max(-1, (gap - stop) / (start - stop))

    At `start` [m] a gap shrinks at most with `speed` [m/s], at `stop` it shrinks no more, and below it has to
    grow. An infinite speed leaves the row out.
    """
    on = jnp.isfinite(speed)
    u = (gap.value - stop) / (start - stop)
    limit = jnp.where(on, speed, 1.0) * jnp.where(on, jnp.maximum(u, -1.0), 1.0)
    row = Inequalities(jnp.where(on, -gap.slope, 0.0)[None], limit[None])
    return Clearance(row, jnp.where(on, jnp.clip(u, _CAUTIOUS, 1.0), 1.0))


def as_bounds_allow(rows: Inequalities, bounds: Bounds) -> Inequalities:
    """The rows as far as bounds and each other let them be met, so that no program is infeasible by them.

    A row is met by some q within the bounds where limit >= a, with a and b the least and largest rows q
    there; it asks for no more than limit' = max(limit, a + 0.05 (b - a)). Two rows can be met together where
    the same holds for every mixture of them (Farkas). The worst is one in which a variable cancels: these
    are looked at, and both rows are given the largest shortfall.
    """
    alone = rows._replace(limit=rows.limit + _shortfall(rows, bounds))
    for pair in itertools.combinations(range(rows.rows.shape[0]), 2):
        (first, second), limit = (alone.rows[k] for k in pair), alone.limit
        cancels = first * second < 0
        share = jnp.where(cancels, second / jnp.where(cancels, second - first, 1.0), 0.5)[:, None]
        mixture = share * first + (1 - share) * second
        mixed = (share * limit[pair[0]] + (1 - share) * limit[pair[1]])[:, 0]
        short = _shortfall(Inequalities(mixture, mixed), bounds).max()
        alone = alone._replace(limit=limit.at[jnp.asarray(pair)].add(short))
    return alone


def _shortfall(rows: Inequalities, bounds: Bounds) -> Float[Array, "r"]:
    """By how much each row asks for more than the bounds allow, with some room."""
    first, second = rows.rows * bounds.lower, rows.rows * bounds.upper
    low, high = (jnp.where(rows.rows == 0, 0.0, f(first, second)) for f in (jnp.minimum, jnp.maximum))
    least, most = jnp.maximum(low.sum(1), -_FAR), jnp.minimum(high.sum(1), _FAR)
    return jnp.maximum(least + _ROOM * (most - least) - rows.limit, 0.0)
