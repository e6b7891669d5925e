"""Arc length along the profiles of a bent wall, in place of lengths on the plane behind it."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from sims.scenes.charts import AbstractChart, HeightChart
from sims.scenes.heightmap import spline_weights

_NEWTON_STEPS = 3
_SETTLE = np.array([0.125, 0.75, 0.125])


class ArcScale(eqx.Module):
    """Arc length along one profile against the straight coordinate below it, there and back.

    base: coefficients of the quadratic B-spline that gives the straight coordinate at even arcs [m]; it is
    the definition, so that tangents go on across its knots. guess: arcs at even straight coordinates [m],
    from which the inverse starts. first_arc, arc_step, first_base, base_step: where these begin, and their
    pitch [m]. Beyond the ends the scale goes on straight.
    """

    base: Float[Array, "K"]
    guess: Float[Array, "M"]
    first_arc: Float[Array, ""]
    arc_step: Float[Array, ""]
    first_base: Float[Array, ""]
    base_step: Float[Array, ""]

    @staticmethod
    def along(slope: Float[np.ndarray, "N"], first: float, step: float) -> "ArcScale":
        """The scale of a profile with these slopes at even coordinates from `first`; both are 0 together."""
        rate = np.sqrt(1 + np.asarray(slope, float) ** 2)
        straight = first + step * np.arange(len(rate))
        arc = np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * step)])
        arc -= np.interp(0.0, straight, arc)
        even = np.linspace(arc[0], arc[-1], len(arc))
        return ArcScale(
            base=jnp.asarray(_coefficients(np.interp(even, arc, straight)), dtype=float),
            guess=jnp.asarray(arc, dtype=float),
            first_arc=jnp.asarray(even[0], dtype=float),
            arc_step=jnp.asarray(even[1] - even[0], dtype=float),
            first_base=jnp.asarray(first, dtype=float),
            base_step=jnp.asarray(step, dtype=float),
        )

    def to_base(self, arc: Float[Array, ""]) -> tuple[Float[Array, ""], Float[Array, ""]]:
        """The straight coordinate at an arc [m], and its slope, which is at most 1."""
        place = (arc - self.first_arc) / self.arc_step
        within = jnp.clip(place, 0.5, self.base.shape[0] - 1.5)
        index = jnp.clip(jnp.round(jax.lax.stop_gradient(within)), 1, self.base.shape[0] - 2).astype(int)
        weights, slopes = spline_weights(within - index.astype(within.dtype))
        three = jax.lax.dynamic_slice(self.base, (index - 1,), (3,))
        rate = jnp.sum(three * slopes)
        return jnp.sum(three * weights) + (place - within) * rate, rate / self.arc_step

    def to_arc(self, base: Float[Array, ""]) -> Float[Array, ""]:
        """The arc at a straight coordinate [m]: Newton's method, of which the last step carries gradients."""
        place = jax.lax.stop_gradient((base - self.first_base) / self.base_step)
        index = jnp.clip(jnp.floor(place), 0, self.guess.shape[0] - 2).astype(int)
        two = jax.lax.dynamic_slice(self.guess, (index,), (2,))
        arc = two[0] + (place - index.astype(place.dtype)) * (two[1] - two[0])
        for _ in range(_NEWTON_STEPS):
            arc = jax.lax.stop_gradient(arc)
            found, rate = self.to_base(arc)
            arc = arc + (base - found) / rate
        return arc


class ArcLengthChart(AbstractChart):
    """A height map's chart whose u and v are lengths along the wall's mean profiles across and up [m].

    Exact where every section across is the same, as on a column, and every section up; elsewhere the two
    means are what is left of the error of lengths on the base plane. u and v are 0 where those are.
    """

    flat: HeightChart
    across: ArcScale
    up: ArcScale
    lower: Float[Array, "2"]
    upper: Float[Array, "2"]

    @staticmethod
    def of(flat: HeightChart, across: ArcScale, up: ArcScale) -> "ArcLengthChart":
        """The chart of all of a height map."""
        lower, upper = (
            jnp.stack([across.to_arc(corner[0]), up.to_arc(corner[1])]) for corner in (flat.lower, flat.upper)
        )
        return ArcLengthChart(flat=flat, across=across, up=up, lower=lower, upper=upper)

    def to_uv(self, p_map: Float[Array, "3"]) -> tuple[Float[Array, "2"], Float[Array, ""]]:
        base, height = self.flat.to_uv(p_map)
        return jnp.stack([self.across.to_arc(base[0]), self.up.to_arc(base[1])]), height

    def point(self, uv: Float[Array, "2"]) -> Float[Array, "3"]:
        return self.flat.point(self._base(uv))

    def normal(self, uv: Float[Array, "2"]) -> Float[Array, "3"]:
        return self.flat.normal(self._base(uv))

    def on_surface(self, uv: Float[Array, "2"]) -> Bool[Array, ""]:
        return self.flat.on_surface(self._base(uv))

    def _base(self, uv: Float[Array, "2"]) -> Float[Array, "2"]:
        return jnp.stack([self.across.to_base(uv[0])[0], self.up.to_base(uv[1])[0]])


def _coefficients(values: Float[np.ndarray, "N"]) -> Float[np.ndarray, "N"]:
    """Of the quadratic B-spline through the values; at the ends it goes on straight.

    The deviation from a straight line is small and smooth, so a few rounds of correcting the spline's own
    smoothing settle it, and a straight line stays exactly what it is.
    """
    found = values.copy()
    for _ in range(60):
        wide = np.concatenate([[2 * found[0] - found[1]], found, [2 * found[-1] - found[-2]]])
        found = found + values - np.convolve(wide, _SETTLE, mode="valid")
    return found
