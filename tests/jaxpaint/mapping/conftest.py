"""Walls as clouds with known truth, and the mapping compiled once."""

from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.mapping import Canvas, MappingSettings, cast

ROOM, RAYS = 8192, 128
SPACING = 0.010


class Wall:
    """A cloud [n, 3] and its true surface: signed height and unit normal of points of the map frame."""

    def __init__(self, cloud, height: Callable, normal: Callable):
        self.cloud, self.height, self.normal = np.asarray(cloud), height, normal


def grid(width: float, height: float, spacing: float) -> tuple[np.ndarray, np.ndarray]:
    u, v = np.arange(-width / 2, width / 2, spacing), np.arange(-height / 2, height / 2, spacing)
    a, b = np.meshgrid(u, v)
    return a.ravel(), b.ravel()


def flat(spacing: float = SPACING, turn: float = 0.0) -> Wall:
    """An upright plane through the origin, turned about z [rad]; it is 0.6 m high."""
    along, out = np.array([np.sin(turn), -np.cos(turn), 0]), np.array([-np.cos(turn), -np.sin(turn), 0])
    u, v = grid(1.0, 0.6, spacing)
    cloud = u[:, None] * along + v[:, None] * np.array([0, 0, 1])
    return Wall(cloud, lambda p: p @ out, lambda p: np.broadcast_to(out, p.shape))


def corner(spacing: float = SPACING, sign: float = 1.0) -> Wall:
    """Two faces at right angles that meet at y = 0: an inside corner, or with sign -1 a box's edge."""
    u, v = grid(1.2, 0.6, spacing)
    u = u + spacing / 2
    edge = 0.5 + 0.2 * (-sign)
    q = np.sqrt(0.5)
    cloud = np.stack([edge - sign * np.abs(u) * q, -u * q, v], -1)

    def normal(p):
        side = np.where(p[:, 1:2] < 0, 1.0, -1.0)
        return q * np.concatenate([-np.ones_like(side), sign * side, 0 * side], -1)

    return Wall(cloud, lambda p: np.sum((p - [edge, 0, 0]) * normal(p), -1), normal)


def column(spacing: float = SPACING, radius: float = 0.6) -> Wall:
    """The near half of an upright column whose nearest line is x = y = 0."""
    u, v = grid(np.pi * radius, 0.4, spacing)
    cloud = np.stack([radius * (1 - np.cos(u / radius)), -radius * np.sin(u / radius), v], -1)

    def normal(p):
        out = (p - [radius, 0, 0]) * [1, 1, 0]
        return out / np.linalg.norm(out, axis=-1, keepdims=True)

    return Wall(cloud, lambda p: np.linalg.norm((p - [radius, 0, 0])[:, :2], axis=-1) - radius, normal)


WALLS = {"flat": flat, "corner": corner, "column": column}


def canvas_at(x: float, yaw: float = 0.0) -> Canvas:
    return Canvas(center=jnp.array([x, 0.0, 0.0]), yaw=jnp.asarray(yaw), size=jnp.array([0.9, 0.4]))


def wave(width: float = 0.8, height: float = 0.3) -> np.ndarray:
    x = np.linspace(-0.5, 0.5, RAYS)
    return np.stack([width * x, height / 2 * np.sin(9 * x)], -1)


def padded(cloud: np.ndarray) -> tuple[jax.Array, jax.Array]:
    """A cloud in the room that the compiled mapping has; what is spare is NaN."""
    room = np.full((ROOM, 3), np.nan)
    room[: len(cloud)] = cloud
    return jnp.asarray(room), jnp.arange(ROOM) < len(cloud)


@pytest.fixture(scope="session")
def mapping():
    """`mapping(cloud, canvas, uv, settings)` with numpy arrays, by one compiled program."""
    program = jax.jit(cast, static_argnames="metric")

    def run(cloud, canvas=None, uv=None, settings=None, metric="distance", valid=None):
        points, real = padded(cloud)
        real = real if valid is None else jnp.asarray(valid)
        uv = jnp.asarray(wave() if uv is None else uv)
        settings = settings or MappingSettings()
        out = program(uv, canvas or canvas_at(-0.3), points, real, settings, metric=metric)
        return jax.tree.map(np.asarray, out)

    return run


@pytest.fixture(scope="session")
def walls():
    """The builders of the walls: `walls.flat()`, `walls.corner()`, `walls.column()`."""
    return type("Walls", (), {name: staticmethod(build) for name, build in WALLS.items()})


@pytest.fixture(scope="session")
def at():
    """A canvas at some x [m], with a heading."""
    return canvas_at
