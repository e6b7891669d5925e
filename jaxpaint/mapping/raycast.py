"""RayCast 3D Mapping, S1-(4): where the picture's points land on a cloud, and how the surface lies there."""

from functools import partial
from typing import Literal

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from jaxpaint.clouds.neighbours import Cells, bin_points
from jaxpaint.mapping.canvas import Canvas
from jaxpaint.mapping.fronts import SUPPORT, front
from jaxpaint.mapping.mapped import Cause, Mapped
from jaxpaint.mapping.medians import median_of
from jaxpaint.mapping.planes import along, squared
from jaxpaint.mapping.tangents import Patch, far_patch, near_patch, roughness, tangent

Metric = Literal["distance", "cosine"]

_PROBE = 4
"""Points taken of each of the 25 cells about a probe for the brush's clearance."""
_SAMPLE = 128
"""Rays from which the noise is estimated."""


class MappingSettings(eqx.Module):
    """Numbers of the mapping; all traced.

    search: S1-(4) looks at points within this many local spacings of the ray [-].
    cosine_tolerance: S1's cosine metric looks within this angle of the ray, from its origin [rad].
    nearest: depth from the canvas at which a ray starts to see [m]; below 0, so that a canvas may lie on the
        surface itself.
    normal_radius: of the patch that gives the normal [m]. position_radius: of that for the position [m], at
        least half of the other. Both grow where the cloud is too sparse for them.
    residual: distance from the plane at which a point counts no more [m]; less where the points lie flat,
        and at least 3 standard deviations of the cloud's noise, which is estimated.
    steepest: largest angle between normal and ray [rad].
    flatness: largest share of the variance about the hit across the plane, beyond noise [-]; 0.09 at the
        edge of a box.
    rim: largest distance of the points' middle from the hit, in position radii [-]; 0.29 at a rim.
    brush_radius: of the brush [m]; strip: kept free beside it [m].
    clearance_height: points higher above the plane than this, or than 4 standard deviations of the noise, are
        in the brush's way [m].
    """

    search: Float[Array, ""] = eqx.field(default=1.5, converter=jnp.asarray)
    cosine_tolerance: Float[Array, ""] = eqx.field(default=0.02, converter=jnp.asarray)
    nearest: Float[Array, ""] = eqx.field(default=-0.1, converter=jnp.asarray)
    normal_radius: Float[Array, ""] = eqx.field(default=0.060, converter=jnp.asarray)
    position_radius: Float[Array, ""] = eqx.field(default=0.030, converter=jnp.asarray)
    residual: Float[Array, ""] = eqx.field(default=0.008, converter=jnp.asarray)
    steepest: Float[Array, ""] = eqx.field(default=1.309, converter=jnp.asarray)
    flatness: Float[Array, ""] = eqx.field(default=0.06, converter=jnp.asarray)
    rim: Float[Array, ""] = eqx.field(default=0.32, converter=jnp.asarray)
    brush_radius: Float[Array, ""] = eqx.field(default=0.010, converter=jnp.asarray)
    strip: Float[Array, ""] = eqx.field(default=0.010, converter=jnp.asarray)
    clearance_height: Float[Array, ""] = eqx.field(default=0.015, converter=jnp.asarray)


def cast(
    uv: Float[Array, "P 2"],
    canvas: Canvas,
    cloud: Float[Array, "N 3"],
    valid: Bool[Array, "N"],
    settings: MappingSettings | None = None,
    *,
    metric: Metric = "distance",
) -> Mapped:
    """Map points of the canvas [m] onto a cloud in the map frame [m], along the canvas' normal.

    One ray for each point, T = RayO + t RayV, S1-(4), with RayO on the canvas and RayV its normal. Of the
    cloud's points near the ray (metric "distance": within some local spacings; "cosine": within an angle, as
    S1) the first surface from the origin wins, and t is where the ray meets the plane of the points about it.
    Points that are not valid or not finite are missing points. Nothing is bridged: every other ray says why
    it has no hit.
    """
    settings = settings or MappingSettings()
    across, depth = canvas.to_canvas(cloud)
    points = jnp.concatenate([across, depth[:, None]], axis=-1)
    valid = valid & jnp.isfinite(points).all(-1) & (depth >= settings.nearest)
    cells, spacing = _cells(points, valid, uv, settings)
    outer = jnp.maximum(settings.normal_radius, 3 * spacing)
    near = partial(_near, settings, metric)
    depth, seen, found = jax.vmap(lambda ray: front(ray, cells, near))(uv)
    guess = jnp.concatenate([uv, depth[:, None]], axis=-1)
    patches = jax.vmap(lambda guess: far_patch(guess, cells, outer))(guess)
    noise = _noise(patches, found)
    hit, normal, status = jax.vmap(_surface, in_axes=(0, 0, None, None, None))(
        guess, patches, cells, noise, settings
    )
    status = jnp.where(found, status, jnp.where(seen, Cause.FRONT, Cause.MISS)).astype(jnp.int32)
    nowhere = ((status == Cause.MISS) | (status == Cause.FRONT))[:, None]
    hit = jnp.where(nowhere, guess.at[:, 2].set(0), hit)
    normal = jnp.where(nowhere, jnp.zeros_like(normal).at[:, 2].set(-1), normal)
    axes = jnp.stack([canvas.u_axis, canvas.v_axis, canvas.ray])
    p_map = canvas.center + jnp.sum(hit[:, :, None] * axes, axis=1)
    return Mapped(p_map, jnp.sum(normal[:, :, None] * axes, axis=1), status)


def _cells(points, valid, uv, settings: MappingSettings) -> tuple[Cells, Float[Array, ""]]:
    """The cloud in cells about the rays, and its typical spacing across them [m].

    A cell is a third of the normal's patch, so that 7 x 7 cells hold the patch, and wide enough for the
    search.
    """
    lower, upper = jnp.nanmin(uv, axis=0), jnp.nanmax(uv, axis=0)
    patch = settings.normal_radius
    spacing = _spacing(points, valid, uv, lower - 4 * patch, 1.5 * patch)
    widest = jnp.max(upper - lower) / 1000
    reach = jnp.maximum(
        jnp.maximum(settings.search, 2) * spacing, (settings.brush_radius + settings.strip) / 2
    )
    size = jnp.maximum(jnp.maximum(patch / 3, reach), widest)
    return bin_points(points, valid, lower - 8 * size, size), spacing


def _spacing(points, valid, uv, lower, size) -> Float[Array, ""]:
    """Typical distance of neighbours across the rays [m]: from the median number of points in a wide cell."""
    rows = 128
    place = jnp.floor((points[:, :2] - lower) / size)
    here = valid & ((place >= 0) & (place < rows)).all(-1)
    flat = jnp.where(here, place[:, 0] * rows + place[:, 1], rows * rows).astype(jnp.int32)
    count = jnp.zeros(rows * rows + 1, points.dtype).at[flat].add(1)
    seen = jnp.clip(jnp.floor((uv - lower) / size), 0, rows - 1).astype(jnp.int32)
    number = count[seen[:, 0] * rows + seen[:, 1]]
    usual = median_of(number, number > 0)
    return size / jnp.sqrt(jnp.where(usual > 0, usual, 1))


def _near(settings: MappingSettings, metric: Metric, across, depth, spacing) -> Bool[Array, "K"]:
    """Which points S1-(4) looks at: squared distance from the ray [m^2], depth and local spacing [m]."""
    if metric == "cosine":
        return across <= jnp.square(jnp.tan(settings.cosine_tolerance) * depth)
    return across <= jnp.square(settings.search * spacing)


def _noise(patches: Patch, found: Bool[Array, "P"]) -> Float[Array, ""]:
    """Standard deviation of the cloud across its surface [m]: the median of some rays' patches."""
    some = slice(None, None, max(1, found.shape[0] // _SAMPLE))
    rough = jax.vmap(roughness)(jax.tree.map(lambda leaf: leaf[some], patches))
    usual = median_of(rough, found[some])
    return jnp.where(jnp.isfinite(usual), usual, 0)


def _surface(guess, far: Patch, cells: Cells, noise, settings: MappingSettings):
    """From a guess to the hit [m], unit normal towards the canvas and cause, in the canvas frame."""
    residual = jnp.maximum(settings.residual, 3 * noise)
    position_radius = jnp.maximum(settings.position_radius, 1.5 * cells.size)
    plane = tangent(near_patch(guess, cells), far, position_radius, residual, noise)
    hit = guess.at[2].add(plane.rise)
    highest = jnp.maximum(settings.clearance_height, 4 * noise)
    status = jnp.where(plane.rough > settings.flatness, Cause.SHARP, Cause.HIT)
    status = jnp.where(_blocked(hit, plane.normal, cells, highest, settings), Cause.CLEARANCE, status)
    status = jnp.where(-plane.normal[2] < jnp.cos(settings.steepest), Cause.STEEP, status)
    return hit, plane.normal, jnp.where(plane.enough & (plane.off_centre <= settings.rim), status, Cause.MISS)


def _blocked(hit, normal, cells: Cells, highest, settings: MappingSettings) -> Bool[Array, ""]:
    """Whether a surface above `highest` [m] is in the way of a brush held along the normal at the hit."""
    reach = jnp.square(settings.brush_radius + settings.strip)
    step = 2 * cells.size

    def probe(height):
        middle = hit + height * normal
        first, count = cells.between(middle[:2], 2, middle[2] - step, middle[2] + step)
        points, real = cells.take(first, count, _PROBE)
        local = points - hit[:, None]
        above = along(local, normal)
        aside = squared(local) - above * above
        here = (above > height - step / 2) & (above <= height + step / 2)
        return jnp.sum(real & here & (aside < reach))

    heights = highest + step * (jnp.arange(3) + 0.5)
    return jnp.sum(jax.vmap(probe)(heights)) >= SUPPORT
