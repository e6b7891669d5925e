"""Random things before a wall: two boxes, a sphere and a post. All draws are even over 0..1."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxpaint.kinematics.pose import Pose
from jaxpaint.kinematics.rotations import compose, rotate, transpose
from sims.scans.settings import ScanSettings
from sims.scans.turns import any_turn, turn_about_z
from sims.scenes.primitives import Box, Post, Sphere
from sims.scenes.textures import AbstractTexture

COUNT = 4
# The farthest that objects stand out of the wall, as a share of the camera's distance from it; so the camera
# is never inside one.
_GAP_SHARE = 0.3
# Where in its quarter of the picture an object's middle is: 0 at the picture's middle, 1 at its edge.
_PLACES = 0.12, 0.7


def random_sizes(
    settings: ScanSettings, height: Float[Array, ""], draws: Float[Array, "4 4"]
) -> tuple[Float[Array, "4 3"], Float[Array, "4"]]:
    """Extents of all objects along three axes [m], and the gaps between them and the wall [m].

    height: of the camera over the wall's plane [m].
    """
    low, high = settings.object_size
    sizes = height * (low + draws[:, :3] * (high - low))
    # Squared, so that things close to the wall are frequent: there they are hard to tell from it.
    gaps = draws[:, 3] ** 2 * jnp.minimum(settings.gap, _GAP_SHARE * height)
    return sizes, gaps


def places_in_picture(incidence: Float[Array, ""], draws: Float[Array, "4 3"]) -> Float[Array, "4 2"]:
    """Where objects' middles appear, as `ray_at` takes it: one in each quarter of the picture.

    On a slanted wall they keep closer to the middle, as places at the far side are many times further.
    """
    # All quarters are equally likely for each object, and no two have the same.
    quarter = (jnp.arange(COUNT) + jnp.floor(COUNT * draws[0, 2])) % COUNT
    signs = jnp.stack([1 - 2 * (quarter % 2), 1 - 2 * (quarter // 2)], axis=1)
    inner, outer = _PLACES
    return signs * jnp.cos(incidence) * (inner + draws[:, :2] * (outer - inner))


def random_objects(
    T_map_W: Pose,
    sizes: Float[Array, "4 3"],
    gaps: Float[Array, "4"],
    p_map_camera: Float[Array, "3"],
    rays: Float[Array, "4 3"],
    textures: tuple[AbstractTexture, ...],
    draws: Float[Array, "2 4"],
) -> tuple[Box, Box, Sphere, Post]:
    """Objects that stand off the wall's plane (z = 0 of W) by their gaps, their middles on these rays of the
    camera (map frame). None goes into the wall; now and then one goes into another.
    """
    turns = [_box_turn(T_map_W, draws[number]) for number in range(2)]
    normal = T_map_W.R[:, 2]
    post = _post_size(sizes[3], normal)
    reaches = jnp.stack(
        [
            *((jnp.abs(rotate(transpose(turns[k]), normal)) * sizes[k]).sum() for k in range(2)),
            sizes[2, 0],
            jnp.abs(normal[2]) * post[1] + jnp.sqrt(jnp.maximum(1 - normal[2] ** 2, 0.0)) * post[0],
        ]
    )
    heights = gaps + 0.5 * reaches
    above = (normal * (p_map_camera - T_map_W.p)).sum()
    # The floor of the slant only keeps numbers finite where no objects are wanted.
    along = (above - heights) / jnp.maximum(-(rays * normal).sum(1), 0.05)
    middles = p_map_camera + along[:, None] * rays
    foot = middles[3].at[2].add(-0.5 * post[1])
    return (
        Box(center=middles[0], R_map_box=turns[0], half=0.5 * sizes[0], texture=textures[0]),
        Box(center=middles[1], R_map_box=turns[1], half=0.5 * sizes[1], texture=textures[1]),
        Sphere(center=middles[2], radius=0.5 * sizes[2, 0], texture=textures[2]),
        Post(foot=foot, radius=0.5 * post[0], height=post[1], texture=textures[3]),
    )


def _box_turn(T_map_W: Pose, draws: Float[Array, "4"]) -> Float[Array, "3 3"]:
    """R_map_box: half of the boxes are turned about the wall's normal only, as what hangs on it is."""
    hung = compose(T_map_W.R, turn_about_z(2 * jnp.pi * draws[1]))
    return jnp.where(draws[0] < 0.5, hung, any_turn(draws[1:]))


def _post_size(size: Float[Array, "3"], normal: Float[Array, "3"]) -> Float[Array, "2"]:
    """Diameter and height [m]: several times as long as thick, but not far out of the wall."""
    return jnp.stack(
        [0.5 * size[0], jnp.minimum(4 * size[1], size[2] / jnp.maximum(jnp.abs(normal[2]), 0.1))]
    )
