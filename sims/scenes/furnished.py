"""A room to paint in, and a flat wall with things before it."""

from dataclasses import dataclass

import jax.numpy as jnp

from sims.scenes.building import numbers, plaster, plate, wooden_floor
from sims.scenes.charts import PlaneChart
from sims.scenes.primitives import Box, Post, Rectangle, Sphere
from sims.scenes.scene import Scene
from sims.scenes.textures import AbstractTexture, Checker, Plain, Wood


@dataclass(frozen=True)
class Room:
    """Four walls without a ceiling, about a robot that looks at the front wall, x = 0; sizes in m.

    width: along y, about 0. depth: along x, from the front wall back. height: of all walls. thickness: of
    the wall with the door. door_x: middle of the opening in the wall on the robot's left; the front wall has
    none, as it is the one that is painted. door_width, door_height: of the opening. corridor: from the door
    to the wall of the corridor behind it. column_x, column_y, column_radius: a round column up to the top.
    """

    width: float = 5.0
    depth: float = 4.0
    height: float = 2.6
    thickness: float = 0.12
    door_x: float = -2.9
    door_width: float = 0.95
    door_height: float = 2.05
    corridor: float = 1.4
    column_x: float = -2.9
    column_y: float = -1.6
    column_radius: float = 0.2


@dataclass(frozen=True)
class Objects:
    """A flat wall, x = 0, with things before it that hide a little of the default canvas; sizes in m.

    width, height: of the wall. crate, ball, post: y of the middle of each. crate_size: along x, y and up; the
    ball lies on top of it. post_height, post_radius, ball_radius. gap: between the wall and crate, ball and
    post. frame: y and z of the middle of a picture; frame_size: width and height; frame_gap, frame_depth:
    how far from the wall its back is, and how thick it is.
    """

    width: float = 6.0
    height: float = 3.0
    gap: float = 0.03
    crate: float = 0.85
    crate_size: tuple[float, float, float] = (0.2, 0.5, 0.66)
    ball: float = 0.85
    ball_radius: float = 0.09
    post: float = -0.9
    post_radius: float = 0.045
    post_height: float = 1.0
    frame: tuple[float, float] = (0.15, 1.49)
    frame_size: tuple[float, float] = (0.34, 0.26)
    frame_gap: float = 0.04
    frame_depth: float = 0.03


def room(config: Room = Room()) -> Scene:
    """Front wall with the chart, rear and right walls, a left wall with a door, a corridor, a column."""
    half, height = 0.5 * config.width, config.height
    chart = _flat_chart(config.width, height)
    rear = _upright((-config.depth, 0, 0), (1, 0), config.width, height, 0.84)
    right = _upright((-0.5 * config.depth, -half, 0), (0, 1), config.depth, height, 0.80)
    beyond = (config.door_x, half + config.thickness + config.corridor, 0)
    corridor = _upright(beyond, (0, -1), config.door_width + 4 * config.corridor, height, 0.7)
    column = Post(
        foot=numbers(config.column_x, config.column_y, 0),
        radius=numbers(config.column_radius)[0],
        height=numbers(height)[0],
        texture=plaster(0.78, 0.77, 0.74),
    )
    front = plate(chart, -half, half, height, plaster())
    return Scene(
        (front, rear, right, *_wall_with_door(config), corridor, column, wooden_floor()), chart, "room"
    )


def objects(config: Objects = Objects()) -> Scene:
    """A flat wall, and before it a crate with a ball on top, a round post, and a picture that stands off."""
    chart = _flat_chart(config.width, config.height)
    wall = plate(chart, -0.5 * config.width, 0.5 * config.width, config.height, plaster())
    depth, _, up = config.crate_size
    frame_x = -config.frame_gap - 0.5 * config.frame_depth
    return Scene(
        (
            wall,
            _box((-config.gap - 0.5 * depth, config.crate, 0.5 * up), config.crate_size, _crate_wood()),
            Sphere(
                center=numbers(-config.gap - config.ball_radius, config.ball, up + config.ball_radius),
                radius=numbers(config.ball_radius)[0],
                texture=Plain(numbers(0.75, 0.2, 0.15)),
            ),
            Post(
                foot=numbers(-config.gap - config.post_radius, config.post, 0),
                radius=numbers(config.post_radius)[0],
                height=numbers(config.post_height)[0],
                texture=Plain(numbers(0.45, 0.47, 0.5)),
            ),
            _box((frame_x, *config.frame), (config.frame_depth, *config.frame_size), _picture()),
            wooden_floor(),
        ),
        chart,
        "objects",
    )


def _flat_chart(width: float, height: float) -> PlaneChart:
    return PlaneChart(
        origin=numbers(0, 0, 0),
        yaw=numbers(0)[0],
        lower=numbers(-0.5 * width, 0),
        upper=numbers(0.5 * width, height),
    )


def _wall_with_door(config: Room) -> tuple[Box, Box, Box]:
    """The wall on the robot's left in three parts: before the door, behind it, and above it."""
    y = 0.5 * config.width + 0.5 * config.thickness
    before, behind = config.door_x + 0.5 * config.door_width, config.door_x - 0.5 * config.door_width
    above = config.height - config.door_height

    def part(first: float, last: float, low: float, high: float) -> Box:
        size = (last - first, config.thickness, high - low)
        return _box((0.5 * (first + last), y, 0.5 * (low + high)), size, plaster(0.82, 0.84, 0.84))

    return (
        part(before, 0.0, 0.0, config.height),
        part(-config.depth, behind, 0.0, config.height),
        part(behind, before, config.height - above, config.height),
    )


def _upright(
    foot: tuple[float, float, float], outward: tuple[float, float], width: float, height: float, shade: float
) -> Rectangle:
    """A plate that stands with the middle of its lower edge at foot, seen from where `outward` points."""
    normal, up = numbers(*outward, 0), numbers(0, 0, 1)
    return Rectangle(
        center=numbers(*foot) + 0.5 * height * up,
        R_map_plate=jnp.stack([jnp.cross(up, normal), up, normal], axis=1),
        half=numbers(0.5 * width, 0.5 * height),
        texture=plaster(shade, shade, shade - 0.03),
    )


def _box(middle: tuple[float, ...], size: tuple[float, ...], texture: AbstractTexture) -> Box:
    """A box along the axes of the map."""
    return Box(
        center=numbers(*middle), R_map_box=jnp.eye(3, dtype=float), half=0.5 * numbers(*size), texture=texture
    )


def _crate_wood() -> Wood:
    return Wood(base=numbers(0.66, 0.5, 0.3), contrast=numbers(0.15)[0], board=numbers(0.11)[0])


def _picture() -> Checker:
    return Checker(numbers(0.15, 0.25, 0.45), numbers(0.85, 0.75, 0.4), numbers(0.07)[0])
