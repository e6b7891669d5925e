"""Random walls: flat, bent, or two faces that meet in a corner.

All are made about one frame, W: its origin is a point of the wall that the camera looks at. Its z axis is the
wall's normal there, for a corner the bisector of its faces, out to the camera; y is along a corner's edge.
All draws are even over 0..1.
"""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from jaxpaint.kinematics.pose import Pose
from jaxpaint.kinematics.rotations import rotate
from sims.scans.settings import ScanSettings
from sims.scans.turns import any_turn, upright_frame
from sims.scenes.primitives import CylinderPatch, Rectangle
from sims.scenes.textures import AbstractTexture


class Fold(eqx.Module):
    """How a corner is folded. half: half the angle between its faces [rad]. side: 1 for an inside corner, -1
    for an outside one.
    """

    half: Float[Array, ""]
    side: Float[Array, ""]


def random_fold(settings: ScanSettings, draws: Float[Array, "2"]) -> Fold:
    """Angle and side of a corner."""
    low, high = settings.interior
    return Fold(0.5 * (low + draws[0] * (high - low)), jnp.where(draws[1] < settings.inside, 1.0, -1.0))


def random_frame(upright: Bool[Array, ""], draws: Float[Array, "6"]) -> Pose:
    """T_map_W of any attitude, or with y straight up, as an upright cylinder needs; within 1 m of the map's
    origin in each direction: a wall that always went through the origin would be found without looking.
    """
    R = jnp.where(upright, upright_frame(2 * jnp.pi * draws[0]), any_turn(draws[:3]))
    return Pose(2 * draws[3:] - 1, R)


def flat_face(
    T_map_W: Pose, distance: Float[Array, ""], texture: AbstractTexture, draws: Float[Array, "4"]
) -> Rectangle:
    """A plate through W's origin, 1 to 2.5 times the distance wide to each side of its middle."""
    half = distance * (1.0 + 1.5 * draws[:2])
    shift = 0.6 * (half - 0.7 * distance) * (2 * draws[2:] - 1)
    center = T_map_W.apply(jnp.append(shift, 0.0))
    return Rectangle(center=center, R_map_plate=T_map_W.R, half=half, texture=texture)


def corner_faces(
    T_map_W: Pose,
    fold: Fold,
    distance: Float[Array, ""],
    textures: tuple[AbstractTexture, AbstractTexture],
    draws: Float[Array, "4"],
) -> tuple[Rectangle, Rectangle]:
    """Both faces of a corner whose edge is W's y axis, each 1 to 2 times the distance wide."""
    tall, shift = distance * (1.0 + draws[0]), distance * (draws[1] - 0.5)

    def face(right: float, width: Float[Array, ""], texture: AbstractTexture) -> Rectangle:
        cos, sin, zero = jnp.cos(fold.half), jnp.sin(fold.half), jnp.zeros_like(shift)
        away = jnp.stack([right * sin, zero, fold.side * cos])
        normal = jnp.stack([-right * fold.side * cos, zero, sin])
        # Along the face and across the edge: with the edge and the normal it is a right-handed frame.
        across = jnp.stack([normal[2], zero, -normal[0]])
        R_W_plate = jnp.stack([across, jnp.stack([zero, zero + 1, zero]), normal], axis=1)
        center = T_map_W.apply(0.5 * width * away + jnp.stack([zero, shift, zero]))
        turned = jnp.stack([rotate(T_map_W.R, R_W_plate[:, k]) for k in range(3)], axis=1)
        half = jnp.stack([0.5 * width, tall])
        return Rectangle(center=center, R_map_plate=turned, half=half, texture=texture)

    return (
        face(1.0, distance * (1.0 + draws[2]), textures[0]),
        face(-1.0, distance * (1.0 + draws[3]), textures[1]),
    )


def bent_face(
    T_map_W: Pose,
    settings: ScanSettings,
    distance: Float[Array, ""],
    texture: AbstractTexture,
    draws: Float[Array, "4"],
) -> CylinderPatch:
    """An upright convex cylinder that touches the plane z = 0 of W, whose y axis points up."""
    low, high = settings.bend_radius
    radius = low + draws[0] * (high - low)
    height = 2 * distance * (1.0 + draws[1])
    normal = T_map_W.R[:, 2]
    foot = (T_map_W.p - radius * normal).at[2].add(-height * (0.3 + 0.4 * draws[2]))
    return CylinderPatch(
        foot=foot,
        yaw=jnp.arctan2(-normal[1], -normal[0]),
        radius=radius,
        half_angle=jnp.minimum((1.0 + draws[3]) * distance / radius, jnp.pi),
        height=height,
        texture=texture,
    )
