"""The tangent plane of a noisy surface that may have another surface beside it."""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from jaxpaint.clouds.neighbours import Cells
from jaxpaint.mapping.planes import along, bisquare, squared, weighted_mean, weighted_plane

_GRAZING = 0.05
"""Cosine to the ray below which a plane is not met by the ray: far beyond the steepest surface."""
_NEAR, _FAR = 12, 5
"""Points taken of each of the 9 cells of the near and of the 49 cells of the far patch."""
_ROUNDS = 4
"""Re-weighted fits to the far patch."""
_ENOUGH = 6
"""Points that carry a plane."""


class Patch(eqx.Module):
    """Points of the cloud about a guess of a hit, relative to it in the canvas frame [m], and which are real.

    radius: points count up to here [m].
    """

    points: Float[Array, "3 K"]
    real: Bool[Array, "K"]
    radius: Float[Array, ""]

    def window(self, rise: Float[Array, ""], radius: Float[Array, ""]) -> tuple[Array, Array]:
        """The points from a hit that lies `rise` behind the guess [m], and their weights by distance."""
        local = self.points.at[2].add(-rise)
        return local, self.real * bisquare(squared(local) / jnp.square(radius))


class Tangent(eqx.Module):
    """The tangent plane at a hit.

    normal: unit, towards the canvas. rise: the hit's depth behind the guess [m]. off_centre: distance of the
    points' middle from the hit, in position radii. enough: whether enough points carry it. rough: the share
    of the variance across the plane that is more than noise.
    """

    normal: Float[Array, "3"]
    rise: Float[Array, ""]
    off_centre: Float[Array, ""]
    enough: Bool[Array, ""]
    rough: Float[Array, ""]


def near_patch(guess: Float[Array, "3"], cells: Cells) -> Patch:
    """A dense patch as wide as a cell."""
    return _patch(guess, cells, 1, _NEAR, cells.size)


def far_patch(guess: Float[Array, "3"], cells: Cells, radius: Float[Array, ""]) -> Patch:
    """A wide patch, at most three cells in radius [m], for the normal."""
    return _patch(guess, cells, 3, _FAR, radius)


def _patch(guess: Float[Array, "3"], cells: Cells, reach: int, most: int, radius: Float[Array, ""]) -> Patch:
    first, count = cells.between(guess[:2], reach, guess[2] - radius, guess[2] + radius)
    points, real = cells.take(first, count, most)
    return Patch(points - guess[:, None], real, radius)


def roughness(patch: Patch) -> Float[Array, ""]:
    """Standard deviation of a patch across its plain plane [m]; NaN for too few points."""
    local, window = patch.window(jnp.zeros_like(patch.radius), patch.radius)
    centre, normal = weighted_plane(local / patch.radius, window, _facing(local))
    height = along(local, normal) - jnp.sum(centre * normal) * patch.radius
    mean_square = jnp.sum(window * jnp.square(height)) / jnp.maximum(jnp.sum(window), _tiny(window))
    return jnp.where(jnp.sum(window > 0) >= _ENOUGH, jnp.sqrt(mean_square), jnp.nan)


def tangent(
    near: Patch,
    far: Patch,
    position_radius: Float[Array, ""],
    residual: Float[Array, ""],
    noise: Float[Array, ""],
) -> Tangent:
    """The plane about a guess of a hit, from a dense near and a wide far patch.

    First from the near patch alone, then wider and re-weighted by the distance from the plane (Tukey's
    weights, zero from `residual` [m] or earlier where the points lie flat), so that the other face of an
    inside corner loses its say. The position comes from the points within its own radius. noise: standard
    deviation of the cloud [m].
    """

    def fit(patch: Patch, plane):
        normal, rise, cut = plane
        local, window = patch.window(rise, patch.radius)
        height = along(local, normal)
        weight = window * bisquare(jnp.square(height / cut))
        spread = jnp.sum(weight * jnp.square(height)) / jnp.maximum(jnp.sum(weight), _tiny(weight))
        centre, normal = weighted_plane(local / patch.radius, weight, normal)
        rise = rise + jnp.sum(centre * normal) * patch.radius / jnp.minimum(normal[2], -_GRAZING)
        return normal, rise, jnp.clip(5 * jnp.sqrt(spread), residual / 4, residual)

    start = _facing(near.points), jnp.zeros_like(noise), jnp.full_like(noise, jnp.inf)
    normal, rise, _ = jax.lax.fori_loop(0, 2, lambda _, plane: fit(near, plane), start)
    start = normal, rise, residual
    normal, rise, cut = jax.lax.fori_loop(0, _ROUNDS, lambda _, plane: fit(far, plane), start)
    local, window = far.window(rise, 2 * near.radius)
    across = jnp.sum(window * (jnp.square(along(local, normal)) - jnp.square(noise)))
    rough = across / jnp.maximum(jnp.sum(window * squared(local)), _tiny(window))
    return Tangent(normal, *_position(far, normal, rise, position_radius, cut), rough)


def _position(patch: Patch, normal, rise, radius, cut):
    """The hit's depth from the guess [m], the points' middle from the hit in radii, whether they suffice."""
    local, window = patch.window(rise, radius)
    weight = window * bisquare(jnp.square(along(local, normal) / cut))
    centre = weighted_mean(local, weight / jnp.maximum(jnp.sum(weight), _tiny(weight)))
    rise = rise + jnp.sum(centre * normal) / jnp.minimum(normal[2], -_GRAZING)
    return rise, jnp.sqrt(jnp.sum(centre * centre)) / radius, jnp.sum(weight > 0) >= _ENOUGH


def _facing(points: Float[Array, "3 K"]) -> Float[Array, "3"]:
    """The normal towards the canvas."""
    return jnp.zeros_like(points[:, 0]).at[2].set(-1)


def _tiny(like: Array) -> float:
    """Smallest divisor that keeps 0 / 0 out."""
    return float(jnp.finfo(like.dtype).tiny)
