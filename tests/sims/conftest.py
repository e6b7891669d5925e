"""Walls of a few lines each: a truth that owes nothing to `sims.scenes`."""

import equinox as eqx
import jax
import jax.numpy as jnp
import pytest


class Hit(eqx.Module):
    """As `sims.scenes` returns it."""

    distance: jax.Array
    normal: jax.Array
    colour: jax.Array
    valid: jax.Array


class PlaneChart(eqx.Module):
    """The wall x = 0, right is -y; a square hole around (0.5, 0) if asked for."""

    lower: jax.Array
    upper: jax.Array
    hole: float

    def to_uv(self, p):
        return jnp.stack([-p[1], p[2]]), -p[0]

    def point(self, uv):
        return jnp.stack([jnp.zeros_like(uv[0]), -uv[0], uv[1]])

    def normal(self, uv):
        return jnp.asarray([-1, 0, 0], uv.dtype)

    def on_surface(self, uv):
        inside = ((uv >= self.lower) & (uv <= self.upper)).all()
        return inside & (jnp.abs(uv - jnp.asarray([0.5, 0], uv.dtype)).max() >= self.hole)


class PlaneScene(eqx.Module):
    """A wall x = 0 of one grey, brighter than `dark` noise minds."""

    chart: PlaneChart
    grey: float

    def raycast(self, origin, direction):
        ahead = direction[0] > 1e-6
        distance = jnp.where(ahead, -origin[0] / jnp.where(ahead, direction[0], 1), -1)
        return Hit(distance, self.chart.normal(origin[:2]), jnp.full(3, self.grey), ahead & (distance > 0))


class StepScene(eqx.Module):
    """A wall x = 0 whose half y < 0 stands forward by `step`; rays from x < -step only."""

    step: float

    def raycast(self, origin, direction):
        front, back = (-self.step - origin[0]) / direction[0], -origin[0] / direction[0]
        distance = jnp.where(origin[1] + front * direction[1] < 0, front, back)
        return Hit(distance, jnp.asarray([-1.0, 0, 0]), jnp.full(3, 0.5), distance > 0)


class CylinderChart(eqx.Module):
    """A pillar about the vertical through (radius, 0): u is arc length to the right of its foremost line."""

    lower: jax.Array
    upper: jax.Array
    radius: float

    def to_uv(self, p):
        x, y = p[0] - self.radius, p[1]
        return jnp.stack([self.radius * jnp.arctan2(-y, -x), p[2]]), jnp.hypot(x, y) - self.radius

    def point(self, uv):
        angle = uv[0] / self.radius
        return jnp.stack([self.radius * (1 - jnp.cos(angle)), -self.radius * jnp.sin(angle), uv[1]])

    def normal(self, uv):
        angle = uv[0] / self.radius
        return jnp.stack([-jnp.cos(angle), -jnp.sin(angle), jnp.zeros_like(angle)])

    def on_surface(self, uv):
        return ((uv >= self.lower) & (uv <= self.upper)).all()


class CylinderScene(eqx.Module):
    """The pillar, for level rays along +x."""

    chart: CylinderChart

    def raycast(self, origin, direction):
        radius = self.chart.radius
        inside = radius**2 - origin[1] ** 2
        x = radius - jnp.sqrt(jnp.maximum(inside, 0))
        return Hit(x - origin[0], jnp.zeros(3), jnp.full(3, 0.5), inside > 0)


@pytest.fixture
def plane():
    """Builds a wall x = 0, u and v from -2 to 2."""

    def build(grey=0.5, hole=0.0):
        return PlaneScene(PlaneChart(jnp.full(2, -2.0), jnp.full(2, 2.0), hole), grey)

    return build


@pytest.fixture
def step_wall():
    """A wall with a step of 0.3 m at y = 0."""
    return StepScene(0.3)


@pytest.fixture
def pillar():
    """A pillar of 0.5 m radius that touches x = 0."""
    limit = jnp.asarray([0.5 * jnp.pi, 2.0])
    return CylinderScene(CylinderChart(-limit, limit, 0.5))


@pytest.fixture
def R_map_camera():
    """A level camera that looks along +x of the map."""
    return jnp.asarray([[0.0, 0, 1], [-1, 0, 0], [0, -1, 0]])
