"""The three walls of S1 section V: flat, inside corner, column; and all walls by name."""

import math
from dataclasses import dataclass

from jaxpaint.errors import InputError
from sims.scenes.building import numbers, plaster, plate, wooden_floor
from sims.scenes.charts import CylinderChart, FoldChart, PlaneChart
from sims.scenes.furnished import objects, room
from sims.scenes.primitives import CylinderPatch
from sims.scenes.scene import Scene


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
        origin=numbers(0, 0, 0),
        yaw=numbers(0)[0],
        lower=numbers(-half, 0),
        upper=numbers(half, config.height),
    )
    face = plate(chart, -half, half, config.height, plaster())
    return Scene((face, wooden_floor()), chart, "flat")


def corner(config: Corner = Corner()) -> Scene:
    """The corner of S1 fig. 11: the robot looks into the edge."""
    width = config.face_width
    chart = FoldChart(
        origin=numbers(config.edge_x, 0, 0),
        yaw=numbers(0)[0],
        interior=numbers(config.interior)[0],
        lower=numbers(-width, 0),
        upper=numbers(width, config.height),
    )
    left = plate(chart, -width, 0.0, config.height, plaster())
    right = plate(chart, 0.0, width, config.height, plaster(0.80, 0.83, 0.86))
    return Scene((left, right, wooden_floor()), chart, "corner")


def cylinder(config: Column = Column()) -> Scene:
    """The cylinder of S1 fig. 11, the half of it that faces the robot."""
    half_angle = 0.5 * math.pi
    reach = config.radius * half_angle
    chart = CylinderChart(
        axis=numbers(config.radius, 0, 0),
        yaw=numbers(0)[0],
        radius=numbers(config.radius)[0],
        lower=numbers(-reach, 0),
        upper=numbers(reach, config.height),
    )
    patch = CylinderPatch(
        foot=chart.axis,
        yaw=chart.yaw,
        radius=chart.radius,
        half_angle=numbers(half_angle)[0],
        height=numbers(config.height)[0],
        texture=plaster(),
    )
    return Scene((patch, wooden_floor()), chart, "cylinder")


WALLS = {"flat": flat, "corner": corner, "cylinder": cylinder, "objects": objects, "room": room}


def make_wall(kind: str) -> Scene:
    """The wall of that name, with its default sizes."""
    if kind not in WALLS:
        raise InputError(
            f"--wall: '{kind}' found, allowed: {', '.join(WALLS)}, or the file of a cloud or mesh"
        )
    return WALLS[kind]()
