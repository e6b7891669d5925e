"""What a planar scanner saw from one place, as pieces of walls: the map that scans are matched with."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from jaxpaint.localisation.pieces import pieces_of
from jaxpaint.localisation.splitting import runs_of


class Outline(eqx.Module):
    """Up to k pieces of walls in the map frame [m].

    start, end: their ends, in the order of the beams. normal: at the middle, unit, towards where they were
    seen from. sigma: standard deviation of the piece's place along it [m]. live: 1, or 0 where there is no
    piece. curvature: 0 for straight ones, above 0 for a column and below 0 for a niche [1/m].
    """

    start: Float[Array, "k 2"]
    end: Float[Array, "k 2"]
    normal: Float[Array, "k 2"]
    sigma: Float[Array, "k"]
    live: Float[Array, "k"]
    curvature: Float[Array, "k"]


def outline_of(
    echoes: Float[np.ndarray, "beams 2"],
    seen_from: Float[np.ndarray, "2"],
    *,
    count: int = 32,
    range_sigma: float = 0.01,
) -> Outline:
    """The outline of a scan whose scanner stood still.

    echoes: (x, y) in the map frame [m], in the order of the beams, NaN for none. seen_from: where the scanner
    stood [m]. count: how many pieces are kept, the longest. range_sigma: standard deviation of a range [m].
    A straight wall becomes one piece, a column a few of the same circle, any other curve some of both. What
    is shorter than 80 mm or seen by fewer than 6 beams is left out. Nothing seen is an outline without live
    pieces.
    """
    if echoes.ndim != 2 or echoes.shape[1] != 2:
        raise ValueError(f"echoes: shape {echoes.shape}, allowed is (beams, 2)")
    if count < 1:
        raise ValueError(f"count: {count}, allowed: above 0")
    if not range_sigma > 0:
        raise ValueError(f"range_sigma: {range_sigma}, allowed: above 0")
    here = np.asarray(seen_from, float)
    runs = runs_of(np.asarray(echoes, float) - here, range_sigma)
    pieces = [piece for run in runs for piece in pieces_of(run, range_sigma)]
    longest = sorted(range(len(pieces)), key=lambda k: -pieces[k].length)[:count]
    rows = np.zeros((count, 9))
    rows[:, 4], rows[:, 6] = 1, 1  # a piece that is none still has a unit normal and a variance
    for row, k in zip(rows, sorted(longest), strict=False):
        p = pieces[k]
        row[:] = [*(here + p.start), *(here + p.end), *p.normal, p.sigma, 1, p.curvature]
    start, end, normal, rest = np.split(rows, [2, 4, 6], axis=1)
    return Outline(*(jnp.asarray(x, float) for x in (start, end, normal, *rest.T)))
