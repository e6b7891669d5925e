"""Which stretch of a brush path one place of the base serves: as long as it stays within the arm's reach."""

from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float


class ReachWindow(eqx.Module):
    """width: what one place serves lies in a box this wide, in x, in y, and in yaw times `yaw_lever` [m]; it
    has to stay below twice the release margin, or a base in the middle is let go within its own stretch.
    yaw_lever: metres that count like one radian [m/rad].
    """

    width: Float[Array, ""]
    yaw_lever: Float[Array, ""]


class _Box(NamedTuple):
    """Lowest and highest of the wanted base places of a stretch (x, y, yaw times lever) [m]."""

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

    Each moment wants the base where the brush is at `home`. A stretch goes on while these places fit the
    window, which for a given order of the strokes takes the fewest stretches there can be; its place is the
    middle of their box. A moment with the pen up belongs to the stretch that comes next.
    """
    wanted = _wanted(position, axis, home, window.yaw_lever)
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
    _, places = jax.lax.scan(spread, (last, jnp.asarray(True)), (boxes, first, down), reverse=True)
    places = jnp.where(jnp.isfinite(places), places, wanted)
    return places / jnp.stack([jnp.ones_like(window.width), jnp.ones_like(window.width), window.yaw_lever])


def _wanted(position, axis, home, lever) -> Float[Array, "t 3"]:
    """Where the base has the brush at `home`, at each moment; its yaw as a length."""
    yaw = jnp.unwrap(jnp.arctan2(axis[:, 1], axis[:, 0]))
    c, s = jnp.cos(yaw), jnp.sin(yaw)
    x = position[:, 0] - c * home[0] + s * home[1]
    y = position[:, 1] - s * home[0] - c * home[1]
    return jnp.stack([x, y, lever * yaw], axis=1)
