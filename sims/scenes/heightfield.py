"""A captured surface as a body that rays meet."""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from sims.scenes.heightmap import HeightMap
from sims.scenes.hits import Hit
from sims.scenes.primitives import AbstractPrimitive
from sims.scenes.textures import AbstractTexture

_ROUNDS = 6


class HeightField(AbstractPrimitive):
    """A height map seen from the robot's side.

    A ray is marched in `steps` equal steps through the slab [near, far] that holds all of the surface, on
    the depths of single cells; where it has sunk below them it is bisected on the smooth surface, and a
    last Newton step carries the gradient. Where the surface was not captured the ray stops without a
    reading, as it does at the rim of an object: what is behind is not known either. Where nothing is at all,
    as in a hole of a mesh, the ray passes. Things thinner than a step may be stepped over.

    near, far: x of the slab [m]. empty: cells without a body, a mask like the map's `valid`.
    """

    surface: HeightMap
    near: Float[Array, ""]
    far: Float[Array, ""]
    texture: AbstractTexture
    empty: Bool[Array, "V U"]
    steps: int = eqx.field(static=True, default=64)

    def intersect(self, origin: Float[Array, "3"], direction: Float[Array, "3"]) -> Hit:
        enter, leave = self._span(origin, direction)
        crosses = enter < leave
        low, high, sinks = self._march(origin, direction, enter, leave)
        distance = self._refine(origin, direction, low, high)
        point = origin + distance * direction
        uv = jnp.stack([-point[1], point[2]])
        _, slopes = self.surface.evaluate(uv)
        length = jnp.sqrt(1 + slopes[0] ** 2 + slopes[1] ** 2)
        normal = jnp.stack([-jnp.ones_like(length), -slopes[0], slopes[1]]) / length
        met = crosses & sinks & (distance > 0) & ~self.surface.holds(self.empty, uv)
        valid = met & self.surface.captured(uv) & (jnp.sum(normal * direction) < 0)
        return Hit(
            distance=jnp.where(met, distance, jnp.inf),
            normal=jnp.where(valid, normal, 0.0),
            colour=jnp.where(valid, self.texture.colour(uv), 0.0),
            valid=valid,
        )

    def _span(
        self, origin: Float[Array, "3"], direction: Float[Array, "3"]
    ) -> tuple[Float[Array, ""], Float[Array, ""]]:
        """Distances at which the ray enters and leaves the box around the surface; enter >= leave: a miss."""
        lower, upper = self.surface.lower, self.surface.upper
        low = jnp.stack([self.near, -upper[0], lower[1]]) - origin
        high = jnp.stack([self.far, -lower[0], upper[1]]) - origin
        moving = jnp.abs(direction) > 1e-9
        safe = jnp.where(moving, direction, 1.0)
        held = (low <= 0) & (high >= 0)
        one = jnp.where(moving, low / safe, jnp.where(held, -1e6, 1e6))
        other = jnp.where(moving, high / safe, jnp.where(held, 1e6, -1e6))
        enter = jnp.maximum(jnp.max(jnp.minimum(one, other)), 0.0)
        return enter, jnp.min(jnp.maximum(one, other))

    def _march(
        self,
        origin: Float[Array, "3"],
        direction: Float[Array, "3"],
        enter: Float[Array, ""],
        leave: Float[Array, ""],
    ) -> tuple[Float[Array, ""], Float[Array, ""], Array]:
        """Bracket of the first crossing, two cells wider on each side, and whether there is one."""
        stride = (leave - enter) / self.steps
        distances = enter + stride * jnp.arange(self.steps + 1, dtype=stride.dtype)
        points = jax.lax.stop_gradient(origin[None, :] + distances[:, None] * direction[None, :])
        depths = jax.vmap(self.surface.nearest)(jnp.stack([-points[:, 1], points[:, 2]], axis=1))
        below = points[:, 0] >= depths
        sunk = enter + stride * jnp.argmax(below).astype(stride.dtype)
        # Single cells are steps where the surface is a slope: the crossing may lie two cells off.
        low = jnp.maximum(sunk - stride - 2 * self.surface.cell, enter)
        high = jnp.minimum(sunk + 2 * self.surface.cell, leave)
        # A ray that starts below the surface came from behind it.
        return low, high, jnp.any(below) & ~below[0]

    def _refine(
        self,
        origin: Float[Array, "3"],
        direction: Float[Array, "3"],
        low: Float[Array, ""],
        high: Float[Array, ""],
    ) -> Float[Array, ""]:
        """Newton's method on the smooth surface within the bracket; its last step alone carries gradients."""

        def gap(distance: Float[Array, ""]) -> tuple[Float[Array, ""], Float[Array, ""]]:
            point = origin + distance * direction
            depth, slopes = self.surface.evaluate(jnp.stack([-point[1], point[2]]))
            rate = -slopes[0] * direction[1] + slopes[1] * direction[2] - direction[0]
            return depth - point[0], rate

        def improve(_: int, found: tuple[Array, Array, Array]) -> tuple[Array, Array, Array]:
            low, high, distance = found
            value, rate = gap(distance)
            low, high = jnp.where(value > 0, distance, low), jnp.where(value > 0, high, distance)
            newton = distance - value / jnp.where(rate < -1e-3, rate, -1.0)
            within = (newton >= low) & (newton <= high)
            return low, high, jnp.where(within, newton, 0.5 * (low + high))

        start = (low, high, 0.5 * (low + high))
        distance = jax.lax.stop_gradient(jax.lax.fori_loop(0, _ROUNDS, improve, start)[2])
        value, rate = gap(distance)
        steep = jnp.abs(rate) > 1e-3
        return distance - jnp.where(steep, value / jax.lax.stop_gradient(jnp.where(steep, rate, 1.0)), 0.0)
