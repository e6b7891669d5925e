"""The three walls of S1 section V: flat, inside corner, column."""

import math
from dataclasses import dataclass

import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxpaint.errors import InputError
from sims.scenes.charts import CylinderChart, FoldChart, PlaneChart
from sims.scenes.primitives import CylinderPatch, Floor, Rectangle
from sims.scenes.scene import Scene
from sims.scenes.textures import Plaster, Wood


@dataclass(frozen=True)
class FlatWall:
    """An upright plane at x = 0, centred on y = 0, standing on the floor; sizes in m."""

    width: float = 6.0
    height: float = 3.0


@dataclass(frozen=True)
class Corner:
    """Two upright faces that meet in an inside corner, symmetric about the x axis.

    edge_x: where they meet [m]; with 0.85 the default canvas, 1.70 m wide, fits between them at x = 0.
    interior: angle between them on the robot's side [rad]. face_width, height [m].
    """

    edge_x: float = 0.85
    interior: float = math.pi / 2
    face_width: float = 3.0
    height: float = 3.0


@dataclass(frozen=True)
class Column:
    """A round column whose nearest generator stands at x = 0; radius and height in m."""

    radius: float = 2.0
    height: float = 3.0


def flat(config: FlatWall = FlatWall()) -> Scene:
    """The flat wall of S1 fig. 11."""
    half = 0.5 * config.width
    chart = PlaneChart(
        origin=_array(0, 0, 0), yaw=_array(0)[0], lower=_array(-half, 0), upper=_array(half, config.height)
    )
    plate = _plate(chart, -half, half, config.height, plaster())
    return Scene((plate, wooden_floor()), chart, "flat")


def corner(config: Corner = Corner()) -> Scene:
    """The corner of S1 fig. 11: the robot looks into the edge."""
    width = config.face_width
    chart = FoldChart(
        origin=_array(config.edge_x, 0, 0),
        yaw=_array(0)[0],
        interior=_array(config.interior)[0],
        lower=_array(-width, 0),
        upper=_array(width, config.height),
    )
    left = _plate(chart, -width, 0.0, config.height, plaster())
    right = _plate(chart, 0.0, width, config.height, plaster(0.80, 0.83, 0.86))
    return Scene((left, right, wooden_floor()), chart, "corner")


def cylinder(config: Column = Column()) -> Scene:
    """The cylinder of S1 fig. 11, the half of it that faces the robot."""
    half_angle = 0.5 * math.pi
    reach = config.radius * half_angle
    chart = CylinderChart(
        axis=_array(config.radius, 0, 0),
        yaw=_array(0)[0],
        radius=_array(config.radius)[0],
        lower=_array(-reach, 0),
        upper=_array(reach, config.height),
    )
    patch = CylinderPatch(
        foot=chart.axis,
        yaw=chart.yaw,
        radius=chart.radius,
        half_angle=_array(half_angle)[0],
        height=_array(config.height)[0],
        texture=plaster(),
    )
    return Scene((patch, wooden_floor()), chart, "cylinder")


WALLS = {"flat": flat, "corner": corner, "cylinder": cylinder}


def make_wall(kind: str) -> Scene:
    """The wall of that name, with its default sizes."""
    if kind not in WALLS:
        raise InputError(f"--wall: '{kind}' found, allowed: {', '.join(WALLS)}, or a cloud file")
    return WALLS[kind]()


def _plate(
    chart: PlaneChart | FoldChart, left: float, right: float, height: float, texture: Plaster
) -> Rectangle:
    """The flat part of a chart between two values of u, from the floor up."""
    middle = _array(0.5 * (left + right), 0.5 * height)
    normal = chart.normal(middle)
    up = _array(0, 0, 1)
    return Rectangle(
        center=chart.point(middle),
        R_map_plate=jnp.stack([jnp.cross(up, normal), up, normal], axis=1),
        half=_array(0.5 * (right - left), 0.5 * height),
        texture=texture,
    )


def plaster(red: float = 0.86, green: float = 0.85, blue: float = 0.80) -> Plaster:
    """Light plaster, the look of a wall that nobody photographed."""
    return Plaster(base=_array(red, green, blue), contrast=_array(0.06)[0], grain=_array(0.35)[0])


def wooden_floor() -> Floor:
    """Boards at z = 0."""
    wood = Wood(base=_array(0.62, 0.48, 0.34), contrast=_array(0.12)[0], board=_array(0.18)[0])
    return Floor(height=_array(0)[0], texture=wood)


def _array(*values: float) -> Float[Array, "n"]:
    return jnp.asarray(values, dtype=float)
