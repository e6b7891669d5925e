"""From a user's options to a painting job: files are read and bad input refused before any work."""

import dataclasses
import math
from typing import cast

import jax
import jax.numpy as jnp

from experiments.commands.paint_options import PaintOptions
from experiments.drawings import built_in_drawing
from experiments.paint_fidelity import fidelity_of
from experiments.placing import Placed, placed
from experiments.resolving import resolved
from jaxpaint.decisions.thresholds import default_thresholds
from jaxpaint.errors import InputError
from jaxpaint.mapping.raycast import MappingSettings
from jaxpaint.pictures import (
    Drawing,
    FillSettings,
    RasterSettings,
    Strokes,
    fit,
    plan_strokes,
    read_drawing,
    reading_notes,
)
from jaxpaint.pictures.fills import Style
from jaxpaint.pictures.ink_settings import Reading, Side, Threshold
from jaxpaint.planning import Viewpoints
from opt.wbc import default_settings
from sims.limits import robot_limits
from sims.noise import noise_preset
from sims.paint import Brush, PaintGrid, canvas_extent
from sims.painting.job import CONTROL_PERIOD, SURVEY, Job
from sims.painting.survey import sight_of, survey
from sims.robots import Robot, check_can_paint, load_robot
from sims.scoring import Wanted, wanted_area
from sims.sensors import Camera

# Distance of neighbouring points of a stroke [m].
SPACING = 0.005
# What is painted may end up this far outside of the canvas and is still seen by the scores [m].
_RIM = 0.06


@dataclasses.dataclass(frozen=True)
class PaintTask:
    """A job with what only the host needs: the picture, where paint goes and where it should go.

    views: of the scan. notes: guesses to tell the user. resolved: options left open, as they were chosen.
    """

    job: Job
    drawing: Drawing
    strokes: Strokes
    grid: PaintGrid
    wanted: Wanted
    views: Viewpoints
    notes: tuple[str, ...]
    resolved: dict


def paint_task(options: PaintOptions) -> PaintTask:
    """Reads the inputs and puts the job together. Raises InputError."""
    picture = read_drawing(options.image or built_in_drawing(), _raster(options))
    robot = _robot(options)
    place = placed(options)
    scene, canvas = place.scene, place.canvas
    size = (float(canvas.size[0]), float(canvas.size[1]))
    drawing = fit(picture, size)
    fill = _fill(options)
    strokes = plan_strokes(drawing, SPACING, radius=options.brush_radius, fill=fill)
    camera, limits, noise = Camera(), robot_limits(robot), noise_preset(options.noise)
    seed = jax.random.key(options.seed)
    views, echoes = survey(scene, canvas, robot, camera, key=jax.random.fold_in(seed, SURVEY))
    job = Job(
        robot=robot,
        limits=limits,
        scene=scene,
        canvas=canvas,
        camera=camera,
        noise=noise,
        brush=Brush(radius=options.brush_radius, nominal_speed=options.speed),
        thresholds=default_thresholds(**options.threshold_changes()),
        settings=default_settings(arm_joints=robot.home.shape[0]),
        mapping=MappingSettings(brush_radius=options.brush_radius),
        picture=jnp.asarray(strokes.points, float),
        stroke=jnp.asarray(strokes.stroke, jnp.int32),
        camera_place=jnp.asarray(views.camera, float),
        camera_rotation=jnp.asarray(views.rotation, float),
        camera_base=jnp.asarray(views.base, float),
        camera_joints=jnp.asarray(views.joints, float),
        echoes=jnp.asarray(echoes, float),
        sight=sight_of(canvas, robot, noise.odometry, echoes),
        speed=jnp.asarray(options.speed),
        dt=jnp.asarray(CONTROL_PERIOD),
        seed=jax.random.key_data(seed),
        fidelity=fidelity_of(options, robot, canvas),
        colour=jnp.asarray(strokes.colour, jnp.int32),
        colours=len(drawing.colours),
        tool_change=jnp.asarray(options.tool_change_time),
    )
    extent = canvas_extent(scene, canvas, margin=_RIM + 2 * options.brush_radius)
    grid = PaintGrid.covering(*extent, options.brush_radius / 5)
    outlines = options.fill == "outline"
    wanted = wanted_area(drawing, scene, canvas, extent, options.brush_radius, outlines=outlines)
    chosen = resolved(options, place.found)
    notes = _notes(place, drawing, strokes)
    return PaintTask(job, drawing, strokes, grid, wanted, views, notes, chosen)


def _notes(place: Placed, drawing: Drawing, strokes: Strokes) -> tuple[str, ...]:
    """What to tell the user of the inputs, one sentence each: every note that is known before painting."""
    return (*place.notes, *reading_notes(drawing, strokes))


def _fill(options: PaintOptions) -> FillSettings:
    """How areas are painted."""
    angle = math.radians(options.fill_angle_deg)
    return FillSettings(cast(Style, options.fill), options.fill_overlap, angle, options.bleed)


def _raster(options: PaintOptions) -> RasterSettings:
    """How ink is found in pixels."""
    style, threshold = cast(Reading, options.line_art), cast(Threshold, options.threshold)
    return RasterSettings(style, threshold, cast(Side, options.ink), options.colours)


def _robot(options: PaintOptions) -> Robot:
    robot = load_robot(options.robot, brush_site=options.brush_site, camera_site=options.camera_site)
    try:
        check_can_paint(robot)
    except InputError as error:
        raise InputError(f"robot {options.robot}: {error}") from error
    return robot
