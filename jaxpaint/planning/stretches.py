"""Which stretch of a brush path one place of the base serves: as long as it stays within the arm's reach."""

from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float


class ReachWindow(eqx.Module):
    """width: what one place serves lies in a box this wide, in the brush's x and y, and in its heading times
    `yaw_lever` [m]; it has to stay below twice the release margin, or a base in the middle is let go within
    its own stretch. yaw_lever: metres that count like one radian [m/rad].
    """

    width: Float[Array, ""]
    yaw_lever: Float[Array, ""]


class _Box(NamedTuple):
    """Lowest and highest of what a stretch asks for: brush (x, y), and heading times lever [m]."""

    lower: Float[Array, "3"]
    upper: Float[Array, "3"]


def serving_places(
    position: Float[Array, "t 3"],
    axis: Float[Array, "t 3"],
    weight: Float[Array, "t"],
    home: Float[Array, "2"],
    window: ReachWindow,
) -> Float[Array, "t 3"]:
    """The base pose (x, y, yaw) that serves each moment of a path, before anything is in the way.

    position [m], axis (unit, into the wall): of the brush in the map frame. weight: 1 where the pen is down.
    home: brush in the base frame where the arm works best [m].

    A stretch goes on while brush and heading fit the window, which for a given order of the strokes takes the
    fewest stretches there can be; its place has the middle of their box at `home`. A moment with the pen up
    belongs to the stretch that comes next.
    """
    heading = jnp.unwrap(jnp.arctan2(axis[:, 1], axis[:, 0]))
    wanted = jnp.concatenate([position[:, :2], window.yaw_lever * heading[:, None]], axis=1)
    down = weight > 0.5
    nothing = _Box(jnp.full_like(wanted[0], jnp.inf), jnp.full_like(wanted[0], -jnp.inf))

    def grow(box: _Box, row):
        place, counts = row
        grown = _Box(jnp.minimum(box.lower, place), jnp.maximum(box.upper, place))
        fits = (grown.upper - grown.lower <= window.width).all()
        new = jax.tree.map(lambda a, b: jnp.where(fits, a, b), grown, _Box(place, place))
        box = jax.tree.map(lambda a, b: jnp.where(counts, a, b), new, box)
        return box, (box, counts & ~fits)

    _, (boxes, first) = jax.lax.scan(grow, nothing, (wanted, down))

    def spread(later, row):
        """From the end: a stretch's last box is its whole box, and the pen-up time before it is its own."""
        whole, ended = later
        box, begins, counts = row
        whole = jax.tree.map(lambda a, b: jnp.where(ended & counts, a, b), box, whole)
        return (whole, jnp.where(counts, begins, ended)), (whole.lower + whole.upper) / 2

    last = jax.tree.map(lambda x: x[-1], boxes)
    _, middle = jax.lax.scan(spread, (last, jnp.asarray(True)), (boxes, first, down), reverse=True)
    return _base_before(jnp.where(jnp.isfinite(middle), middle, wanted), home, window.yaw_lever)


def _base_before(middle: Float[Array, "t 3"], home, lever) -> Float[Array, "t 3"]:
    """The base pose (x, y, yaw) that has a brush (x, y, heading times lever) at `home`."""
    yaw = middle[:, 2] / lever
    c, s = jnp.cos(yaw), jnp.sin(yaw)
    x = middle[:, 0] - c * home[0] + s * home[1]
    y = middle[:, 1] - s * home[0] - c * home[1]
    return jnp.stack([x, y, yaw], axis=1)
