"""The paintable wall's own coordinates: u to the robot's right and v up, in metres along the surface.

Charts are read at every simulated step, so they are plain elementwise code for one point. height is the
signed distance to the surface along its normal, above zero on the robot's side.
"""

import abc

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from sims.scenes.heightmap import HeightMap

_FOOT_STEPS = 2


class AbstractChart(eqx.Module):
    """Maps between points of the map frame and coordinates on the wall."""

    lower: eqx.AbstractVar[Float[Array, "2"]]
    upper: eqx.AbstractVar[Float[Array, "2"]]

    @abc.abstractmethod
    def to_uv(self, p_map: Float[Array, "3"]) -> tuple[Float[Array, "2"], Float[Array, ""]]:
        """Coordinates [m] of the foot of a point on the surface, and its height above it [m]."""

    @abc.abstractmethod
    def point(self, uv: Float[Array, "2"]) -> Float[Array, "3"]:
        """The point of the surface at uv, in the map frame [m]."""

    @abc.abstractmethod
    def normal(self, uv: Float[Array, "2"]) -> Float[Array, "3"]:
        """Unit normal at uv, out of the wall to the robot, in the map frame."""

    def on_surface(self, uv: Float[Array, "2"]) -> Bool[Array, ""]:
        """Whether there is wall at uv: within its extent, and captured."""
        return jnp.all((uv >= self.lower) & (uv <= self.upper))


class PlaneChart(AbstractChart):
    """A flat upright wall. origin: where u = v = 0 [m]. yaw: heading that looks squarely into it [rad]."""

    origin: Float[Array, "3"]
    yaw: Float[Array, ""]
    lower: Float[Array, "2"]
    upper: Float[Array, "2"]

    def to_uv(self, p_map: Float[Array, "3"]) -> tuple[Float[Array, "2"], Float[Array, ""]]:
        ahead, right, up = _turned(p_map - self.origin, self.yaw)
        return jnp.stack([right, up]), -ahead

    def point(self, uv: Float[Array, "2"]) -> Float[Array, "3"]:
        return self.origin + _turned_back(jnp.zeros_like(uv[0]), uv[0], uv[1], self.yaw)

    def normal(self, uv: Float[Array, "2"]) -> Float[Array, "3"]:
        zero = jnp.zeros_like(uv[0])
        return _turned_back(zero - 1, zero, zero, self.yaw)


class FoldChart(AbstractChart):
    """Two upright faces that meet in an inside corner, u = 0 along the edge, u < 0 on the left face.

    origin: the edge at v = 0 [m]. yaw: heading that looks into the edge, along the bisector [rad].
    interior: angle between the faces on the robot's side, in (0, pi) [rad].

    In front of the wall the closest face is exactly the one on the point's side of the bisector. Straight
    behind the edge, where a point has no foot on either face, u stays 0 and height is that to the face's
    plane.
    """

    origin: Float[Array, "3"]
    yaw: Float[Array, ""]
    interior: Float[Array, ""]
    lower: Float[Array, "2"]
    upper: Float[Array, "2"]

    def to_uv(self, p_map: Float[Array, "3"]) -> tuple[Float[Array, "2"], Float[Array, ""]]:
        ahead, right, up = _turned(p_map - self.origin, self.yaw)
        cos, sin = jnp.cos(0.5 * self.interior), jnp.sin(0.5 * self.interior)
        side = jnp.where(right >= 0, 1.0, -1.0).astype(right.dtype)
        along = jnp.maximum(sin * side * right - cos * ahead, 0.0)
        return jnp.stack([side * along, up]), -sin * ahead - cos * side * right

    def point(self, uv: Float[Array, "2"]) -> Float[Array, "3"]:
        cos, sin = jnp.cos(0.5 * self.interior), jnp.sin(0.5 * self.interior)
        return self.origin + _turned_back(-cos * jnp.abs(uv[0]), sin * uv[0], uv[1], self.yaw)

    def normal(self, uv: Float[Array, "2"]) -> Float[Array, "3"]:
        cos, sin = jnp.cos(0.5 * self.interior), jnp.sin(0.5 * self.interior)
        side = jnp.where(uv[0] >= 0, 1.0, -1.0).astype(uv.dtype)
        return _turned_back(-sin, -cos * side, jnp.zeros_like(uv[1]), self.yaw)


class CylinderChart(AbstractChart):
    """The convex side of an upright column, u = 0 along the generator nearest to the robot.

    axis: a point of the column's axis, at v = 0 [m]. yaw: heading that looks squarely at that generator
    [rad]. radius [m]. Points on the axis itself have no foot; they get u = 0.
    """

    axis: Float[Array, "3"]
    yaw: Float[Array, ""]
    radius: Float[Array, ""]
    lower: Float[Array, "2"]
    upper: Float[Array, "2"]

    def to_uv(self, p_map: Float[Array, "3"]) -> tuple[Float[Array, "2"], Float[Array, ""]]:
        ahead, right, up = _turned(p_map - self.axis, self.yaw)
        squared = ahead**2 + right**2
        # Double where: the gradients of sqrt and arctan2 at the axis would be NaN, and NaN times 0 is NaN.
        away = squared > 0
        distance = jnp.where(away, jnp.sqrt(jnp.where(away, squared, 1.0)), 0.0)
        angle = jnp.arctan2(jnp.where(away, right, 0.0), jnp.where(away, -ahead, 1.0))
        return jnp.stack([self.radius * angle, up]), distance - self.radius

    def point(self, uv: Float[Array, "2"]) -> Float[Array, "3"]:
        angle = uv[0] / self.radius
        return self.axis + _turned_back(
            -self.radius * jnp.cos(angle), self.radius * jnp.sin(angle), uv[1], self.yaw
        )

    def normal(self, uv: Float[Array, "2"]) -> Float[Array, "3"]:
        angle = uv[0] / self.radius
        return _turned_back(-jnp.cos(angle), jnp.sin(angle), jnp.zeros_like(uv[1]), self.yaw)


class HeightChart(AbstractChart):
    """A captured wall. u = -y and v = z are measured on the base plane x = 0, in place of arc length.

    A captured wall is nearly plane where it can be painted: at 8 degrees of slope the two differ by 1 %.
    to_uv finds the foot by two steps along the normal: exact on the surface, and off it to the third order in
    height times curvature.
    """

    surface: HeightMap
    lower: Float[Array, "2"]
    upper: Float[Array, "2"]

    @staticmethod
    def of(surface: HeightMap) -> "HeightChart":
        """The chart of all of a height map."""
        return HeightChart(surface=surface, lower=surface.lower, upper=surface.upper)

    def to_uv(self, p_map: Float[Array, "3"]) -> tuple[Float[Array, "2"], Float[Array, ""]]:
        base = jnp.stack([-p_map[1], p_map[2]])
        uv, height = base, jnp.zeros_like(p_map[0])
        for _ in range(_FOOT_STEPS):
            depth, slopes = self.surface.evaluate(uv)
            length = jnp.sqrt(1 + slopes[0] ** 2 + slopes[1] ** 2)
            # Distance to the tangent plane at uv, and where that plane's normal through the point meets it.
            gap = depth - p_map[0] + jnp.sum(slopes * (base - uv))
            height = gap / length
            uv = base - slopes * gap / length**2
        return uv, height

    def point(self, uv: Float[Array, "2"]) -> Float[Array, "3"]:
        depth, _ = self.surface.evaluate(uv)
        return jnp.stack([depth, -uv[0], uv[1]])

    def normal(self, uv: Float[Array, "2"]) -> Float[Array, "3"]:
        _, slopes = self.surface.evaluate(uv)
        length = jnp.sqrt(1 + slopes[0] ** 2 + slopes[1] ** 2)
        return jnp.stack([-jnp.ones_like(length), -slopes[0], slopes[1]]) / length

    def on_surface(self, uv: Float[Array, "2"]) -> Bool[Array, ""]:
        return self.surface.captured(uv)


def _turned(
    offset: Float[Array, "3"], yaw: Float[Array, ""]
) -> tuple[Float[Array, ""], Float[Array, ""], Float[Array, ""]]:
    """An offset of the map frame as (ahead, right, up) of somebody who looks along yaw."""
    cos, sin = jnp.cos(yaw), jnp.sin(yaw)
    return cos * offset[0] + sin * offset[1], sin * offset[0] - cos * offset[1], offset[2]


def _turned_back(
    ahead: Float[Array, ""], right: Float[Array, ""], up: Float[Array, ""], yaw: Float[Array, ""]
) -> Float[Array, "3"]:
    """(ahead, right, up) as an offset of the map frame: the inverse of `_turned`."""
    cos, sin = jnp.cos(yaw), jnp.sin(yaw)
    return jnp.stack([cos * ahead + sin * right, sin * ahead - cos * right, up])
