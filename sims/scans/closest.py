"""The nearest point of the exact surface: the truth that a measured or refined cloud is held against.

A surface counts from both sides here, although a ray meets it from outside only. Nearest is meant among all
of the surface, also what other bodies hide. All rules are for one point, in the map frame, in metres.
"""

from functools import singledispatch

import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxpaint.kinematics.rotations import rotate, transpose
from sims.scenes.primitives import AbstractPrimitive, Box, CylinderPatch, Floor, Post, Rectangle, Sphere
from sims.scenes.scene import Scene


def closest_point(scene: Scene, p: Float[Array, "3"]) -> tuple[Float[Array, "3"], Float[Array, ""]]:
    """The point of all the scene's bodies nearest to `p`, and its distance [m]; the first body wins a tie.

    Gradients are finite everywhere, and 0 for the distance of a point that lies on the surface. Raises
    TypeError for a body without a rule.
    """
    points = jnp.stack([closest_on(primitive, p) for primitive in scene.primitives])
    squares = ((points - p[None]) ** 2).sum(1)
    first = jnp.argmin(squares)
    square = squares[first]
    apart = square > 0
    # Double where: the root's gradient is infinite on the surface.
    return points[first], jnp.where(apart, jnp.sqrt(jnp.where(apart, square, 1.0)), 0.0)


@singledispatch
def closest_on(primitive: AbstractPrimitive, p: Float[Array, "3"]) -> Float[Array, "3"]:
    """The point of one body's surface nearest to `p`; where many are (at a centre), one of them."""
    known = ", ".join(kind.__name__ for kind in closest_on.registry if kind is not object)
    raise TypeError(f"primitive: no rule for the nearest point of {type(primitive).__name__}; known: {known}")


@closest_on.register
def _(primitive: Rectangle, p: Float[Array, "3"]) -> Float[Array, "3"]:
    R = primitive.R_map_plate
    uv = rotate(transpose(R), p - primitive.center)[:2]
    uv = jnp.clip(uv, -primitive.half, primitive.half)
    return primitive.center + R[:, 0] * uv[0] + R[:, 1] * uv[1]


@closest_on.register
def _(primitive: Floor, p: Float[Array, "3"]) -> Float[Array, "3"]:
    return p.at[2].set(primitive.height)


@closest_on.register
def _(primitive: Sphere, p: Float[Array, "3"]) -> Float[Array, "3"]:
    return primitive.center + primitive.radius * _outward(p - primitive.center)


@closest_on.register
def _(primitive: CylinderPatch, p: Float[Array, "3"]) -> Float[Array, "3"]:
    offset = p - primitive.foot
    cos, sin = jnp.cos(primitive.yaw), jnp.sin(primitive.yaw)
    towards, right = -(cos * offset[0] + sin * offset[1]), sin * offset[0] - cos * offset[1]
    # On the axis all generators are equally near, and arctan2 has no gradient there.
    away = towards**2 + right**2 > 0
    angle = jnp.arctan2(jnp.where(away, right, 0.0), jnp.where(away, towards, 1.0))
    # The distance to a generator grows with the angle to it: beyond an edge that edge is nearest.
    angle = jnp.clip(angle, -primitive.half_angle, primitive.half_angle) + primitive.yaw
    level = -primitive.radius * jnp.stack([jnp.cos(angle), jnp.sin(angle)])
    return primitive.foot + jnp.append(level, jnp.clip(offset[2], 0.0, primitive.height))


@closest_on.register
def _(primitive: Post, p: Float[Array, "3"]) -> Float[Array, "3"]:
    offset = p - primitive.foot
    outward = _outward(offset[:2])
    reach = (offset[:2] * outward).sum()
    side = jnp.append(primitive.radius * outward, jnp.clip(offset[2], 0.0, primitive.height))
    end = jnp.where(offset[2] > 0.5 * primitive.height, primitive.height, 0.0)
    cap = jnp.append(outward * jnp.minimum(reach, primitive.radius), end)
    nearer = ((side - offset) ** 2).sum() <= ((cap - offset) ** 2).sum()
    return primitive.foot + jnp.where(nearer, side, cap)


@closest_on.register
def _(primitive: Box, p: Float[Array, "3"]) -> Float[Array, "3"]:
    R, half = primitive.R_map_box, primitive.half
    offset = rotate(transpose(R), p - primitive.center)
    depth = half - jnp.abs(offset)
    inside = jnp.all(depth > 0)
    # From inside, straight out through the nearest face.
    out = inside & (jnp.arange(3) == jnp.argmin(depth))
    face = jnp.where(offset < 0, -half, half)
    return primitive.center + rotate(R, jnp.where(out, face, jnp.clip(offset, -half, half)))


def _outward(offset: Float[Array, "n"]) -> Float[Array, "n"]:
    """The unit vector along `offset`; the last axis where there is none, by a double where."""
    square = (offset * offset).sum()
    away = square > 0
    last = jnp.zeros_like(offset).at[-1].set(1.0)
    return jnp.where(away, offset / jnp.sqrt(jnp.where(away, square, 1.0)), last)
