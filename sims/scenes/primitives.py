"""Bodies that a ray can meet, one ray at a time.

Every surface has one face, seen from outside: the front of a rectangle, the convex side of a cylinder patch,
the outside of a box or sphere, the top of the floor. A ray that comes from behind passes through. Directions
are unit vectors; distances are metres along them.
"""

import abc

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from sims.scenes.hits import Hit, hit_where
from sims.scenes.textures import AbstractTexture


class AbstractPrimitive(eqx.Module):
    """One body of a scene."""

    texture: eqx.AbstractVar[AbstractTexture]

    @abc.abstractmethod
    def intersect(self, origin: Float[Array, "3"], direction: Float[Array, "3"]) -> Hit:
        """First hit of the ray that leaves `origin` [m] along the unit `direction`, both in the map frame."""


class Rectangle(AbstractPrimitive):
    """A flat plate seen from its front.

    center: middle [m]. R_map_plate: columns are its u axis, v axis and outward normal. half: half sizes [m].
    """

    center: Float[Array, "3"]
    R_map_plate: Float[Array, "3 3"]
    half: Float[Array, "2"]
    texture: AbstractTexture

    def intersect(self, origin: Float[Array, "3"], direction: Float[Array, "3"]) -> Hit:
        start, along = _turned(origin - self.center, self.R_map_plate), _turned(direction, self.R_map_plate)
        towards = along[2] < 0
        distance = -start[2] / jnp.where(towards, along[2], -1.0)
        uv = start[:2] + distance * along[:2]
        met = towards & (distance > 0) & jnp.all(jnp.abs(uv) <= self.half)
        return hit_where(met, distance, self.R_map_plate[:, 2], self.texture.colour(uv))


class Floor(AbstractPrimitive):
    """The level plane z = height, without end, seen from above."""

    height: Float[Array, ""]
    texture: AbstractTexture

    def intersect(self, origin: Float[Array, "3"], direction: Float[Array, "3"]) -> Hit:
        towards = direction[2] < 0
        distance = (self.height - origin[2]) / jnp.where(towards, direction[2], -1.0)
        met = towards & (distance > 0)
        normal = jnp.zeros_like(origin).at[2].set(1)
        return hit_where(met, distance, normal, self.texture.colour(origin[:2] + distance * direction[:2]))


class CylinderPatch(AbstractPrimitive):
    """Part of an upright cylinder, seen from its convex side.

    foot: the axis at the lower end [m]. yaw: heading that looks squarely at the middle generator [rad].
    half_angle: of the patch about the axis, at most pi [rad].
    """

    foot: Float[Array, "3"]
    yaw: Float[Array, ""]
    radius: Float[Array, ""]
    half_angle: Float[Array, ""]
    height: Float[Array, ""]
    texture: AbstractTexture

    def intersect(self, origin: Float[Array, "3"], direction: Float[Array, "3"]) -> Hit:
        start = origin - self.foot
        distance, cuts = _round_side(start, direction, self.radius)
        point = start + distance * direction
        ahead = jnp.cos(self.yaw) * point[0] + jnp.sin(self.yaw) * point[1]
        right = jnp.sin(self.yaw) * point[0] - jnp.cos(self.yaw) * point[1]
        angle = jnp.arctan2(jnp.where(cuts, right, 0.0), jnp.where(cuts, -ahead, 1.0))
        within = (jnp.abs(angle) <= self.half_angle) & (point[2] >= 0) & (point[2] <= self.height)
        normal = jnp.stack([point[0], point[1], jnp.zeros_like(point[2])]) / self.radius
        uv = jnp.stack([self.radius * angle, point[2]])
        return hit_where(cuts & (distance > 0) & within, distance, normal, self.texture.colour(uv))


class Post(AbstractPrimitive):
    """A whole upright cylinder with its top and bottom, seen from outside.

    foot: middle of the bottom [m]. The texture runs over arc length and height on the side, and over x and y
    on the ends [m].
    """

    foot: Float[Array, "3"]
    radius: Float[Array, ""]
    height: Float[Array, ""]
    texture: AbstractTexture

    def intersect(self, origin: Float[Array, "3"], direction: Float[Array, "3"]) -> Hit:
        start = origin - self.foot
        side, cuts = _round_side(start, direction, self.radius)
        rising = direction[2] > 0
        level = direction[2] == 0
        end = jnp.where(rising, 0.0, self.height)
        # Of the two ends only the one that faces the ray's start can be met from outside.
        cap = (end - start[2]) / jnp.where(level, 1.0, direction[2])
        at_side, at_cap = start + side * direction, start + cap * direction
        on_side = cuts & (side > 0) & (at_side[2] >= 0) & (at_side[2] <= self.height)
        on_cap = ~level & (cap > 0) & (at_cap[0] ** 2 + at_cap[1] ** 2 <= self.radius**2)
        # The side is entered before a cap wherever the ray meets both.
        point = jnp.where(on_side, at_side, at_cap)
        distance = jnp.where(on_side, side, jnp.where(on_cap, cap, 1.0))
        outward = jnp.stack([point[0], point[1], jnp.zeros_like(point[2])]) / self.radius
        up = jnp.zeros_like(outward).at[2].set(jnp.where(rising, -1.0, 1.0))
        angle = jnp.arctan2(jnp.where(on_side, point[1], 0.0), jnp.where(on_side, point[0], 1.0))
        uv = jnp.where(on_side, jnp.stack([self.radius * angle, point[2]]), point[:2])
        return hit_where(on_side | on_cap, distance, jnp.where(on_side, outward, up), self.texture.colour(uv))


class Sphere(AbstractPrimitive):
    """A ball seen from outside; its texture runs over longitude and height [m]."""

    center: Float[Array, "3"]
    radius: Float[Array, ""]
    texture: AbstractTexture

    def intersect(self, origin: Float[Array, "3"], direction: Float[Array, "3"]) -> Hit:
        start = origin - self.center
        closest = -jnp.sum(start * direction)
        chord = self.radius**2 - jnp.sum((start + closest * direction) ** 2)
        cuts = chord > 0
        distance = closest - jnp.sqrt(jnp.where(cuts, chord, 1.0))
        point = start + distance * direction
        polar = point[0] ** 2 + point[1] ** 2 > 0
        angle = jnp.arctan2(jnp.where(polar, point[1], 0.0), jnp.where(polar, point[0], 1.0))
        colour = self.texture.colour(jnp.stack([self.radius * angle, point[2]]))
        return hit_where(cuts & (distance > 0), distance, point / self.radius, colour)


class Box(AbstractPrimitive):
    """A box seen from outside. R_map_box: columns are its axes. half: half sizes along them [m]."""

    center: Float[Array, "3"]
    R_map_box: Float[Array, "3 3"]
    half: Float[Array, "3"]
    texture: AbstractTexture

    def intersect(self, origin: Float[Array, "3"], direction: Float[Array, "3"]) -> Hit:
        start, along = _turned(origin - self.center, self.R_map_box), _turned(direction, self.R_map_box)
        moving = along != 0
        sign = jnp.where(along < 0, -1.0, 1.0).astype(along.dtype)
        safe = jnp.where(moving, along, 1.0)
        # A ray along a slab is within it for ever or never.
        held = jnp.abs(start) <= self.half
        enter = jnp.where(moving, (-sign * self.half - start) / safe, jnp.where(held, -jnp.inf, jnp.inf))
        leave = jnp.where(moving, (sign * self.half - start) / safe, jnp.where(held, jnp.inf, -jnp.inf))
        first = jnp.max(enter)
        met = (first > 0) & (first <= jnp.min(leave)) & jnp.isfinite(first)
        distance = jnp.where(met, first, 1.0)
        face = (enter == first) & (jnp.cumsum(enter == first) == 1)
        normal = jnp.sum(self.R_map_box * jnp.where(face, -sign, 0.0)[None, :], axis=1)
        point = start + distance * along
        uv = jnp.stack([jnp.where(face[0], point[1], point[0]), jnp.where(face[2], point[1], point[2])])
        return hit_where(met, distance, normal, self.texture.colour(uv))


def _turned(vector: Float[Array, "3"], R_map_body: Float[Array, "3 3"]) -> Float[Array, "3"]:
    """A map vector in the axes of a body."""
    return jnp.sum(R_map_body * vector[:, None], axis=0)


def _round_side(
    start: Float[Array, "3"], direction: Float[Array, "3"], radius: Float[Array, ""]
) -> tuple[Float[Array, ""], Bool[Array, ""]]:
    """Distance at which a ray enters an endless cylinder about the z axis, and whether it cuts it at all."""
    flat = direction[0] ** 2 + direction[1] ** 2
    slanted = flat > 0
    safe = jnp.where(slanted, flat, 1.0)
    # From the point closest to the axis: b^2 - ac of the usual root cancels badly in float32.
    closest = -(start[0] * direction[0] + start[1] * direction[1]) / safe
    gap = (start[0] + closest * direction[0]) ** 2 + (start[1] + closest * direction[1]) ** 2
    chord = radius**2 - gap
    cuts = slanted & (chord > 0)
    return closest - jnp.sqrt(jnp.where(cuts, chord, 1.0) / safe), cuts
