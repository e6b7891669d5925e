"""RayCast 3D Mapping, S1-(4): where the picture's points land on a cloud, and how the surface lies there."""

from typing import Literal

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from jaxpaint.clouds.neighbours import Cells, bin_points
from jaxpaint.mapping.canvas import Canvas
from jaxpaint.mapping.mapped import Cause, Mapped
from jaxpaint.mapping.planes import along, bisquare, squared, weighted_mean, weighted_plane

Metric = Literal["distance", "cosine"]

_CROSS, _FRONT_MOST = 12, 40
"""Points taken of each of the 9 cells about a ray, and how many of all these are looked at, by depth."""
_PATCH = 5
"""Points taken of each of the 49 cells that hold the patch of the tangent plane."""
_PROBE = 4
"""Points taken of each of the 25 cells about a probe for the brush's clearance."""
_GRAZING = 0.05
"""Cosine to the ray below which a plane is not met by the ray: far beyond the steepest surface."""
_SUPPORT = 3
"""Points at one depth that make a surface; fewer are flying points."""


class MappingSettings(eqx.Module):
    """Numbers of the mapping; all traced.

    search: S1-(4) looks at points within this many local spacings of the ray [-].
    cosine_tolerance: S1's cosine metric looks within this angle of the ray, from its origin [rad].
    nearest: depth from the canvas at which a ray starts to see [m].
    normal_radius, position_radius: of the patches that give the normal and the position [m].
    residual: distance from the plane at which a point counts no more [m].
    steepest: largest angle between normal and ray [rad].
    flatness: largest share of the patch's variance across the plane [-]: 0.09 at the edge of a box.
    rim: largest distance of the patch's centre from the hit, in radii of the patch [-]: 0.29 at a straight rim.
    brush_radius: of the brush [m]; strip: kept free beside it [m].
    clearance_height: points higher above the plane than this are in the brush's way [m].
    """

    search: Float[Array, ""] = eqx.field(default=1.5, converter=jnp.asarray)
    cosine_tolerance: Float[Array, ""] = eqx.field(default=0.02, converter=jnp.asarray)
    nearest: Float[Array, ""] = eqx.field(default=0.0, converter=jnp.asarray)
    normal_radius: Float[Array, ""] = eqx.field(default=0.060, converter=jnp.asarray)
    position_radius: Float[Array, ""] = eqx.field(default=0.020, converter=jnp.asarray)
    residual: Float[Array, ""] = eqx.field(default=0.008, converter=jnp.asarray)
    steepest: Float[Array, ""] = eqx.field(default=1.309, converter=jnp.asarray)
    flatness: Float[Array, ""] = eqx.field(default=0.06, converter=jnp.asarray)
    rim: Float[Array, ""] = eqx.field(default=0.35, converter=jnp.asarray)
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

    One ray for each point, T = RayO + t RayV, S1-(4), with RayO on the canvas and RayV its normal. Of the cloud's
    points near the ray (metric "distance": within some local spacings; "cosine": within an angle, as S1) the first
    surface from the origin wins, and t is where the ray meets the plane of the points about it. Points that are
    not valid or not finite are missing points. Nothing is bridged: every other ray says why it has no hit.
    """
    settings = settings or MappingSettings()
    across, depth = canvas.to_canvas(cloud)
    points = jnp.concatenate([across, depth[:, None]], axis=-1)
    valid = valid & jnp.isfinite(points).all(-1) & (depth >= settings.nearest)
    cells, spacing = _cells(points, valid, uv, settings)
    hit, normal, status = jax.vmap(lambda ray: _cast_one(ray, cells, spacing, settings, metric))(uv)
    axes = jnp.stack([canvas.u_axis, canvas.v_axis, canvas.ray])
    p_map = canvas.center + jnp.sum(hit[:, :, None] * axes, axis=1)
    return Mapped(p_map, jnp.sum(normal[:, :, None] * axes, axis=1), status)


def _cells(points, valid, uv, settings: MappingSettings) -> tuple[Cells, Float[Array, ""]]:
    """The cloud in cells about the rays, and its typical spacing across them [m].

    A cell is a third of the normal's patch, so that 7 x 7 cells hold the patch, and wide enough for the search.
    """
    lower, upper = jnp.nanmin(uv, axis=0), jnp.nanmax(uv, axis=0)
    patch = settings.normal_radius
    spacing = _spacing(points, valid, uv, lower - 4 * patch, 1.5 * patch)
    widest = jnp.max(upper - lower) / 1000
    reach = jnp.maximum(settings.search * spacing, (settings.brush_radius + settings.strip) / 2)
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
    usual = jnp.nanmedian(jnp.where(number > 0, number, jnp.nan))
    return size / jnp.sqrt(jnp.where(usual > 0, usual, 1))


def _cast_one(ray, cells: Cells, spacing, settings: MappingSettings, metric: Metric):
    """One ray in the canvas frame (u, v, depth): hit [m], unit normal towards the canvas, cause."""
    depth, seen, found = _front(ray, cells, settings, metric)
    guess = jnp.append(ray, depth)
    inner = jnp.maximum(settings.position_radius, 2 * spacing)
    near = _patch(guess, cells, 1, _CROSS, inner)
    outer = jnp.maximum(settings.normal_radius, 3 * spacing)
    far = _patch(guess, cells, 3, _PATCH, outer)
    normal, rise, off_centre, supported, rough = _plane(near, far, inner, outer, settings)
    blocked = _blocked(jnp.append(ray, depth + rise), normal, cells, settings)
    status = jnp.where(blocked, Cause.CLEARANCE, Cause.HIT)
    status = jnp.where(rough > settings.flatness, jnp.where(blocked, status, Cause.SHARP), status)
    status = jnp.where(-normal[2] < jnp.cos(settings.steepest), Cause.STEEP, status)
    status = jnp.where(off_centre > settings.rim, Cause.MISS, status)
    status = jnp.where(found & supported, status, Cause.FRONT)
    status = jnp.where(seen, status, Cause.MISS)
    nowhere = (status == Cause.MISS) | (status == Cause.FRONT)
    facing = jnp.zeros_like(normal).at[2].set(-1)
    hit = jnp.append(ray, jnp.where(nowhere, 0, depth + rise))
    return hit, jnp.where(nowhere, facing, normal), status.astype(jnp.int32)


def _front(ray, cells: Cells, settings: MappingSettings, metric: Metric):
    """Depth of the first surface along the ray [m]; whether anything is near the ray; whether that is a surface.

    A point belongs to a surface when it is one of three within a cell's width in depth, and it is near when it lies
    within `search` spacings of the ray, the spacing being that of the first surface about the ray.
    """
    first, count = cells.between(ray, 1, -jnp.inf, jnp.inf)
    points, real = cells.take(first, count, _CROSS)
    across = jnp.square(points[0] - ray[0]) + jnp.square(points[1] - ray[1])
    real = real & (across <= jnp.square(cells.size))
    depth, order = jax.lax.top_k(jnp.where(real, -points[2], -jnp.inf), _FRONT_MOST)
    depth, across = -depth, across[order]
    surface = _supported(depth, cells.size)
    start = depth[jnp.argmax(surface)]
    number = jnp.sum(surface & (depth <= start + cells.size))
    spacing = cells.size * jnp.sqrt(jnp.pi / jnp.maximum(number, 1))
    if metric == "cosine":
        near = across <= jnp.square(jnp.tan(settings.cosine_tolerance) * depth)
    else:
        near = across <= jnp.square(settings.search * spacing)
    near = near & jnp.isfinite(depth)
    start = depth[jnp.argmax(near & surface)]
    group = near & surface & (depth <= start + cells.size)
    closest = jnp.argmin(jnp.where(group, across, jnp.inf))
    return jnp.where(group.any(), depth[closest], 0), near.any(), group.any()


def _supported(depth: Float[Array, "K"], gap: Float[Array, ""]) -> Bool[Array, "K"]:
    """Which of the ascending depths are among `_SUPPORT` within the gap [m]."""
    more = _SUPPORT - 1
    whole = jnp.isfinite(depth[more:]) & (depth[more:] - jnp.where(jnp.isfinite(depth[:-more]), depth[:-more], 0) <= gap)
    whole = jnp.pad(whole, (more, more))
    return jnp.stack([whole[more - k : whole.shape[0] - k] for k in range(_SUPPORT)]).any(0)


def _patch(middle, cells: Cells, reach: int, most: int, radius):
    """Points of the cloud relative to the middle of a patch [m], and which are real."""
    first, count = cells.between(middle[:2], reach, middle[2] - radius, middle[2] + radius)
    points, real = cells.take(first, count, most)
    return points - middle[:, None], real


def _plane(near, far, inner, outer, settings: MappingSettings):
    """The plane about the ray's first guess of a hit, from a dense near and a wide far patch relative to the guess.

    First from the near patch alone, then wider and re-weighted by the distance from the plane, so that the other
    face of an inside corner loses its say; the near patch then gives the position. Gives the normal, the hit's depth
    from the guess [m], the variance's share across the plane, the distance of the inner patch's centre from the hit
    in its radii, and whether enough points carry it.
    """
    ahead = jnp.stack([jnp.zeros_like(inner), jnp.zeros_like(inner), jnp.ones_like(inner)])

    def fit(patch, radius, cut, normal, rise):
        local = patch[0] - (rise * ahead)[:, None]
        window = patch[1] * bisquare(squared(local) / jnp.square(radius))
        weight = window * bisquare(jnp.square(along(local, normal) / cut))
        centre, normal = weighted_plane(local / radius, weight, normal)
        return normal, rise + jnp.sum(centre * normal) * radius / jnp.minimum(normal[2], -_GRAZING)

    plane = fit(near, inner, jnp.full_like(inner, jnp.inf), -ahead, jnp.zeros_like(inner))
    plane = fit(near, inner, settings.residual, *plane)
    normal, rise = jax.lax.fori_loop(0, 3, lambda _, plane: fit(far, outer, settings.residual, *plane), plane)
    local = far[0] - (rise * ahead)[:, None]
    window = far[1] * bisquare(squared(local) / jnp.square(2 * inner))
    across, whole = jnp.sum(window * jnp.square(along(local, normal))), jnp.sum(window * squared(local))
    rough = across / jnp.maximum(whole, jnp.finfo(whole.dtype).tiny)
    return normal, *_position(near, normal, rise, inner, settings), rough


def _position(near, normal, rise, inner, settings: MappingSettings):
    """The hit's depth from the guess [m], the patch's centre from the hit in its radii, and whether points carry it."""
    local = near[0] - jnp.zeros_like(normal).at[2].set(rise)[:, None]
    window = near[1] * bisquare(squared(local) / jnp.square(inner))
    weight = window * bisquare(jnp.square(along(local, normal) / settings.residual))
    centre = weighted_mean(local, weight / jnp.maximum(jnp.sum(weight), jnp.finfo(weight.dtype).tiny))
    rise = rise + jnp.sum(centre * normal) / jnp.minimum(normal[2], -_GRAZING)
    return rise, jnp.sqrt(jnp.sum(centre * centre)) / inner, jnp.sum(weight > 0) >= 2 * _SUPPORT


def _blocked(hit, normal, cells: Cells, settings: MappingSettings) -> Bool[Array, ""]:
    """Whether a surface stands in the way of a brush held along the normal at the hit."""
    reach = jnp.square(settings.brush_radius + settings.strip)
    step = 2 * cells.size

    def probe(height):
        middle = hit + height * normal
        first, count = cells.between(middle[:2], 2, middle[2] - step, middle[2] + step)
        points, real = cells.take(first, count, _PROBE)
        local = points - hit[:, None]
        above = along(local, normal)
        aside = squared(local) - above * above
        slice_ = (above > jnp.maximum(height - step / 2, settings.clearance_height)) & (above <= height + step / 2)
        return jnp.sum(real & slice_ & (aside < reach))

    heights = settings.clearance_height + step * (jnp.arange(3) + 0.5)
    return jnp.sum(jax.vmap(probe)(heights)) >= _SUPPORT
