"""Options of `jaxpaint paint`."""

import dataclasses
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, ClassVar

from experiments import values as allowed
from experiments.commands.command import RunOptions
from experiments.options import defaults_of, option_names, refuse

PIXELS = (".png", ".jpg", ".jpeg")
PICTURES = (".svg", *PIXELS)
CAPTURES = (".ply", ".pcd", ".xyz", ".npz", ".stl", ".obj")
WALLS = ("flat", "corner", "cylinder", "objects", "room")
AXES = ("x", "y", "z", "+x", "+y", "+z", "-x", "-y", "-z")
NOISES = ("s1-simulation", "s1-real", "none")


@dataclasses.dataclass(frozen=True, kw_only=True)
class PaintOptions(RunOptions):
    """Paint a picture on a wall in many randomised worlds: scan, map, decide, move, lay paint, score."""

    image: Annotated[Path | None, allowed.file(*PICTURES, unset="the built-in drawing")] = None
    """Picture to paint."""
    wall: Annotated[str | Path, allowed.name_or_file(WALLS, CAPTURES)] = "flat"
    """Kind of wall, or a captured cloud or a mesh as the wall."""
    worlds: Annotated[int, allowed.whole("N", at_least=1)] = 64
    """Randomised worlds, in groups that fit into memory, on CPUs of up to 32 for each core: docs/scale.md."""
    memory_gb: Annotated[float | None, allowed.number("G", above=0, unset="most of what is free")] = None
    """Memory that all of it may take [GB = 1e9 bytes]; on other devices than CPUs the device's besides."""
    processes: Annotated[int, allowed.whole("N", at_least=1)] = 1
    """Processes that share the worlds; without --coordinator they are started here: docs/scale.md."""
    coordinator: Annotated[str | None, allowed.address(unset="chosen for local processes")] = None
    """Where processes meet that something else starts, one by one: an address of process 0 that all reach."""
    process: Annotated[int | None, allowed.whole("I", at_least=0, unset="none")] = None
    """Number of this process, from 0, beside --coordinator; number 0 writes and shows the result."""
    fidelity: Annotated[str, allowed.choice("kinematic", "dynamic", "wheeled")] = "kinematic"
    """How the robot moves: commanded velocities within limits (kinematic), by servos (dynamic), or on wheels
    that roll and slip (wheeled)."""
    floor: Annotated[str, allowed.choice("flat", "ramp", "bump")] = "flat"
    """What wheels roll on; a ramp or a speed bump lies across the way along the wall, half a metre to the
    left of where the base begins: short ways do not reach it."""
    friction: Annotated[float, allowed.number("MU", above=0, at_most=5)] = 0.8
    """Of the wheels on the floor [-]."""
    randomise: Annotated[float, allowed.number("F", at_least=0, at_most=4)] = 0.0
    """How much worlds differ in masses, friction, servos, calibration, latency, noise and slope of the floor:
    1 as in a workshop, 0 not at all: docs/worlds.md."""
    refine: Annotated[str, allowed.choice("none", later=("agn",))] = "none"
    """What improves the scanned cloud before it is used."""
    controller: Annotated[str, allowed.choice("acp", "whole-body", "trajectory")] = "acp"
    """Who moves the robot: acp decides between the other two for each task."""
    noise: Annotated[str, allowed.choice(*NOISES)] = "s1-simulation"
    """Preset of sensor and odometry noise."""
    canvas_size: Annotated[
        tuple[float, float] | None, allowed.number("W H", above=0, count=2, unset="fits the wall")
    ] = None
    """Width and height of the canvas [m]; the picture keeps its proportions."""
    canvas_pose: Annotated[
        tuple[float, float, float, float] | None,
        allowed.number("X Y Z YAW", count=4, unset="found on the wall"),
    ] = None
    """Middle of the canvas x, y, z [m] and heading of its rays about z [rad], in the map frame."""
    up: Annotated[str | None, allowed.choice(*AXES, unset="guessed, and said")] = None
    """Axis of the captured wall that points up."""
    wall_scale: Annotated[float, allowed.number("F", above=0)] = 1.0
    """Factor from the captured wall's unit to metres (0.001 for millimetres)."""
    wall_height: Annotated[float | None, allowed.number("M", at_least=0, unset="fits the robot")] = None
    """Height of the captured wall's lowest point above the floor [m]."""
    brush_radius: Annotated[float, allowed.number("M", above=0)] = 0.010
    """Radius of the brush's contact [m]."""
    speed: Annotated[float, allowed.number("M/S", above=0)] = 0.03
    """Speed of the brush along a stroke [m/s]."""
    fill: Annotated[str, allowed.choice("hatch", "contour", "outline")] = "hatch"
    """How areas of ink are painted: rim and rows, rims further and further inside, or the rims alone."""
    fill_overlap: Annotated[float, allowed.number("SHARE", at_least=0, at_most=0.8)] = 0.35
    """Share of the brush's width that neighbouring rows of a fill share."""
    fill_angle_deg: Annotated[float, allowed.number("DEG")] = 90.0
    """Angle of a fill's rows against the horizontal [degrees]."""
    bleed: Annotated[float, allowed.number("M", at_least=0)] = 0.00125
    """How far outside the ink of an area the brush's edge goes, so that drift leaves no bare rims [m];
    at most 0.4 of the brush's radius."""
    line_art: Annotated[str, allowed.choice("auto", "skeleton", "area")] = "auto"
    """How the ink of a PNG or JPEG is read: as centre-lines, as areas, or as it asks for."""
    threshold: Annotated[str, allowed.choice("auto", "global", "local")] = "auto"
    """Where a PNG's or JPEG's ink begins: one threshold, one by neighbourhood, or as the light asks for."""
    ink: Annotated[str, allowed.choice("auto", "dark", "light")] = "auto"
    """Side of the threshold that is ink; auto: what most of the picture's border is not."""
    colours: Annotated[int, allowed.whole("N", at_least=0, at_most=8)] = 0
    """Most colours that a PNG or JPEG is painted in, each a pass; 0: as many as it shows. More than one
    are told apart by colour, not by a --threshold."""
    tool_change_time: Annotated[float, allowed.number("S", at_least=0)] = 10.0
    """Time that a change of colour takes, the brush away from the wall [s]."""
    robot: Annotated[Path | None, allowed.file(".xml", ".urdf", unset="the reference robot")] = None
    """MJCF or URDF of another robot, with named base joints, arm joints and brush site: docs/robots.md."""
    brush_site: Annotated[str, allowed.text("NAME")] = "brush"
    """Site or link at the brush's tip, z out of the tool."""
    camera_site: Annotated[str, allowed.text("NAME")] = "camera"
    """Site or link of the wrist camera, z ahead and y down."""
    export: Annotated[tuple[str, ...], allowed.several("csv", "ros2-json", "ros2-yaml")] = ()
    """Files of the planned joint trajectory: a table, or a ROS 2 JointTrajectory message: docs/exports.md."""
    export_world: Annotated[int, allowed.whole("N", at_least=0)] = 0
    """World whose trajectory is exported."""
    record: Annotated[tuple[int, ...], allowed.indices("W")] = ()
    """Worlds whose trajectories go into trajectories.npz, in this order; none: the median and the worst of
    the first group, and its first ones."""
    theta: Annotated[float | None, allowed.number("M", above=0, unset="by preset")] = None
    """Base travel after which the base halts [m]: Theta of S1-(13)."""
    dwell: Annotated[float | None, allowed.number("S", at_least=0, unset="by preset")] = None
    """Least time that a halted base stays halted [s]."""
    release_margin: Annotated[float | None, allowed.number("M", at_least=0, unset="by preset")] = None
    """Distance of the brush from its best place before the arm at which a halted base moves again [m]."""
    low_speed_scale: Annotated[float | None, allowed.number("F", above=0, unset="by preset")] = None
    """The base moves at this multiple of the brush's speed or not at all: S of S1-(12)."""
    variance_bounds: Annotated[
        tuple[float, float] | None, allowed.number("LOW HIGH", at_least=0, count=2, unset="0.3 0.8")
    ] = None
    """Band of S1-(7) inside which poses count as waypoints, not as a path."""
    halting: bool = True
    """Let the base halt by S1-(13)."""
    low_speed: bool = True
    """Keep the base from creeping by S1-(12)."""

    CHOSEN_FROM: ClassVar[Mapping[str, tuple[str, ...]]] = {
        "canvas_size": ("wall", "up", "wall_scale", "wall_height"),
        "canvas_pose": ("wall", "up", "wall_scale", "wall_height", "canvas_size"),
        "up": ("wall", "wall_scale"),
        "wall_height": ("wall", "up", "wall_scale", "canvas_size"),
        "bleed": ("brush_radius",),
        "theta": ("halting",),
        "dwell": ("halting",),
        "release_margin": ("halting",),
        "low_speed_scale": ("low_speed",),
        "variance_bounds": (),
    }

    def check(self) -> None:
        """Raise InputError for the first option that is not allowed, alone or beside another."""
        super().check()
        if self.variance_bounds is not None and self.variance_bounds[0] >= self.variance_bounds[1]:
            refuse("--variance-bounds", self.variance_bounds, "LOW below HIGH")
        names = option_names(type(self))
        for name, when in self.without_effect().items():
            refuse(names[name], getattr(self, name), f"only {when}", "no effect")
        if self.export and self.export_world >= self.worlds:
            refuse("--export-world", self.export_world, f"below --worlds ({self.worlds})")
        missing = [world for world in self.record if world >= self.worlds]
        if missing:
            refuse("--record", missing[0], f"below --worlds ({self.worlds})")
        self._check_split()

    def _check_split(self) -> None:
        """Raise InputError where the worlds cannot be split over the processes as asked."""
        count, least = self.processes, -(-self.worlds // self.processes)
        if count > self.worlds:
            refuse("--processes", count, f"at most --worlds ({self.worlds})")
        if self.process is not None and self.coordinator is None:
            refuse("--process", self.process, "only beside --coordinator", "no effect")
        if self.coordinator is not None and self.process is None:
            refuse("--coordinator", self.coordinator, "only beside --process")
        if self.process is not None and self.process >= count:
            refuse("--process", self.process, f"0 to {count - 1}, below --processes")
        if self.export and self.export_world >= least:
            refuse("--export-world", self.export_world, f"below {least}, the worlds of process 0 of {count}")
        beyond = [world for world in self.record if world >= least]
        if beyond:
            refuse("--record", beyond[0], f"below {least}, the worlds of process 0 of {count}")

    def split_over(self) -> tuple[str | None, int, int]:
        """As the options say."""
        return self.coordinator, self.processes, self.process or 0

    def without_effect(self) -> dict[str, str]:
        """Options that do nothing beside the others though they are set, and when they would do something."""
        pixels = isinstance(self.image, Path) and self.image.suffix.lower() in PIXELS
        groups = (
            (self.captured() is not None, "beside a file as --wall", ("up", "wall_scale", "wall_height")),
            (pixels, "beside a PNG or JPEG as --image", ("line_art", "threshold", "ink", "colours")),
            (bool(self.export), "beside --export", ("export_world",)),
            (self.halting, "without --no-halting", ("theta", "dwell", "release_margin")),
            (self.low_speed, "without --no-low-speed", ("low_speed_scale",)),
            (self.fidelity == "wheeled", "beside --fidelity wheeled", ("floor", "friction")),
        )
        defaults = defaults_of(type(self))
        return {
            name: when
            for works, when, names in groups
            for name in names
            if not works and getattr(self, name) != defaults[name]
        }

    def captured(self) -> Path | None:
        """The file that is the wall, None for a kind of wall."""
        return self.wall if isinstance(self.wall, Path) else None

    def threshold_changes(self) -> dict[str, float]:
        """What differs from the default thresholds, by the names of `jaxpaint.decisions.Thresholds`."""
        given = {
            "halt_travel": self.theta if self.halting else math.inf,
            "dwell": self.dwell,
            "release_margin": self.release_margin,
            "low_speed_scale": self.low_speed_scale if self.low_speed else 0.0,
            "variance_lower": self.variance_bounds and self.variance_bounds[0],
            "variance_upper": self.variance_bounds and self.variance_bounds[1],
        }
        return {name: value for name, value in given.items() if value is not None}
