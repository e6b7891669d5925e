"""Several depth images become one cloud in the map frame."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from jaxpaint.mapping.canvas import Canvas
from sims.sensors.camera import Camera, back_project, rotate


def merge_views(
    camera: Camera,
    depth: Float[Array, "views height width"],
    valid: Bool[Array, "views height width"],
    p_map_camera: Float[Array, "views 3"],
    R_map_camera: Float[Array, "views 3 3"],
) -> tuple[Float[Array, "points 3"], Bool[Array, "points"]]:
    """The cloud of all views in the map frame, points = views x height x width.

    The poses are what the robot believes (odometry and arm encoders), so their errors become the cloud's.
    """

    def place(image, position, rotation):
        return position + rotate(rotation, back_project(camera, image))

    cloud = jax.vmap(place)(depth, p_map_camera, R_map_camera)
    return cloud.reshape(-1, 3), valid.reshape(-1)


def crop_to_canvas(
    cloud: Float[Array, "points 3"],
    valid: Bool[Array, "points"],
    canvas: Canvas,
    *,
    margin: Float[Array, ""] | float = 0.1,
    depth: tuple[float, float] = (-1.0, 2.0),
) -> Bool[Array, "points"]:
    """Which points lie in the box in front of and behind the canvas.

    margin: kept around the rectangle [m]. depth: nearest and farthest kept, along the rays [m].
    """
    uv, along = canvas.to_canvas(cloud)
    inside = (jnp.abs(uv) <= 0.5 * canvas.size + margin).all(-1)
    return valid & inside & (along >= depth[0]) & (along <= depth[1])


def thin(
    cloud: Float[Array, "points 3"], valid: Bool[Array, "points"], max_points: int
) -> tuple[Float[Array, "kept 3"], Bool[Array, "kept"]]:
    """At most `max_points` valid points, at even steps through the cloud, so of every view alike.

    A static budget: the result always has `max_points` rows; those past the number of valid points are
    invalid and zero. Deterministic.
    """
    rank = jnp.cumsum(valid.astype(jnp.int32))
    count = rank[-1]
    slots = jnp.arange(max_points, dtype=jnp.int32)
    kept = jnp.minimum(count, max_points)
    # Ordinals floor(slot * count / kept) without the product, which overflows int32 for large clouds.
    whole, rest = count // jnp.maximum(kept, 1), count % jnp.maximum(kept, 1)
    ordinal = slots * whole + _floor_share(slots, rest, kept)
    index = jnp.searchsorted(rank, ordinal + 1, method="scan_unrolled")
    filled = slots < kept
    index = jnp.where(filled, index, 0)
    return jnp.where(filled[:, None], cloud[index], 0), filled


def _floor_share(slots, rest, kept):
    """floor(slots * rest / kept) in floating point; one off at worst, which only moves a step."""
    return jnp.minimum((slots * (rest / jnp.maximum(kept, 1))).astype(jnp.int32), rest)
