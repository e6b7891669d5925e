"""A timed path of the brush: the runs at brush speed with the pen down, and pen-up moves between them."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from jaxpaint.mapping.mapped import Cause, Mapped
from jaxpaint.mapping.moves import Move, MoveSettings, lift_time, move_pose, move_time, plan_move
from jaxpaint.mapping.planes import unit
from jaxpaint.mapping.runs import Runs, find_runs, linked, smooth_normals, steps
from jaxpaint.mapping.time_law import time_for, travelled

# Points of the picture that stand for the surface where moves look for obstacles; moves and times that are
# worked on at once, so that memory does not grow with the picture.
_LOOKED_AT, _MOVES_AT_ONCE, _TIMES_AT_ONCE = 1024, 32, 4096


class PathSettings(eqx.Module):
    """Numbers of the path; all traced.

    speed: of the brush with the pen down [m/s]. acceleration: along the run [m/s^2]. jump: a step longer than
    this many usual steps splits a run [-]. turn: and a turn of the normal beyond this [rad]. shortest: rests
    of cut strokes that are shorter are left out [m]; a whole stroke is painted however short, as a dab.
    smoothing: length over which normals are averaged [m].
    """

    speed: Float[Array, ""] = eqx.field(default=0.03, converter=jnp.asarray)
    acceleration: Float[Array, ""] = eqx.field(default=0.3, converter=jnp.asarray)
    jump: Float[Array, ""] = eqx.field(default=5.0, converter=jnp.asarray)
    turn: Float[Array, ""] = eqx.field(default=0.35, converter=jnp.asarray)
    shortest: Float[Array, ""] = eqx.field(default=0.005, converter=jnp.asarray)
    smoothing: Float[Array, ""] = eqx.field(default=0.03, converter=jnp.asarray)
    move: MoveSettings = eqx.field(default_factory=MoveSettings)


class BrushPath(eqx.Module):
    """A path T in SE(3) as a function of time: `sample` it, ask its `duration`.

    Move m leads to run m, and the last one off the surface; it starts at `begins[m]` [s] and the run at
    `draws[m]`. status: a `Cause` for each point, with SHORT and OVERFLOW added. place: way along the runs at
    each point [m]. u_axis: direction that the brush frame's x axis follows. down, travel: length with the pen
    down and up [m].
    """

    p_map: Float[Array, "P 3"]
    normal: Float[Array, "P 3"]
    status: Int[Array, "P"]
    place: Float[Array, "P"]
    runs: Runs
    moves: Move
    begins: Float[Array, "R+1"]
    draws: Float[Array, "R+1"]
    end: Float[Array, ""]
    down: Float[Array, ""]
    travel: Float[Array, ""]
    u_axis: Float[Array, "3"]
    settings: PathSettings


class TimedPath(eqx.Module):
    """The brush in the map frame at each control step.

    position [m]; rotation R_map_brush: z into the surface, x along the canvas' u, y = z x x; velocity [m/s];
    angular_velocity in map axes [rad/s]; pen: 1 down, 0 up; run: the run that is drawn or moved to; colour:
    the tool in hand; live: the path has not ended. After its end the brush stays.
    """

    position: Float[Array, "T 3"]
    rotation: Float[Array, "T 3 3"]
    velocity: Float[Array, "T 3"]
    angular_velocity: Float[Array, "T 3"]
    pen: Float[Array, "T"]
    run: Int[Array, "T"]
    colour: Int[Array, "T"]
    live: Bool[Array, "T"]


def plan_path(
    mapped: Mapped,
    stroke: Int[Array, "P"],
    u_axis: Float[Array, "3"],
    settings: PathSettings | None = None,
    *,
    obstacles: Float[Array, "M 3"] | None = None,
    colour: Int[Array, "strokes"] | None = None,
    max_runs: int = 96,
) -> BrushPath:
    """Put the mapped points of all strokes, in painting order, on one clock.

    Pen down on runs of neighbouring hits of one stroke; between them the pen lifts, travels clear of every
    mapped point, of which at most a thousand are looked at, and of the `obstacles` (further points of the
    surface in the map frame [m]; NaN is no point, and a single one lifts a move) and comes down again.
    colour: the tool of each stroke; where it changes the pen goes further away and waits for the change.
    The path starts over its first point and ends over its last. Runs beyond `max_runs` are left out and their
    points marked OVERFLOW. A path without runs lasts 0 s and stays over the first point.

    The cost grows with the points and with the runs, not with their product.
    """
    settings = settings or PathSettings()
    link = linked(mapped, stroke, settings.jump, settings.turn)
    mapped = smooth_normals(mapped, link, settings.smoothing)
    runs, status = find_runs(mapped, stroke, link, settings.shortest, max_runs, colour)
    place = jnp.cumsum(jnp.where(link, steps(mapped.p_map), 0))
    moves = _plan_moves(mapped, runs, obstacles, settings)
    number = jnp.sum(runs.live)
    slot = jnp.arange(max_runs + 1)
    length = jnp.append(jnp.where(runs.live, place[runs.last] - place[runs.first], 0), 0)
    drawing = time_for(length, settings.speed, settings.acceleration)
    moving = jax.vmap(lambda move: move_time(move, settings.move))(moves)
    moving = jnp.where((slot <= number) & (number > 0), moving, 0)
    ends = jnp.cumsum(moving + drawing)
    draws = ends - drawing
    travel = jnp.sum(jnp.where((slot > 0) & (slot < number), moves.length, 0))
    return BrushPath(
        mapped.p_map, mapped.normal, status, place, runs, moves,
        draws - moving, draws, ends[-1], jnp.sum(length), travel, u_axis, settings,
    )  # fmt: skip


def _plan_moves(
    mapped: Mapped, runs: Runs, obstacles: Float[Array, "M 3"] | None, settings: PathSettings
) -> Move:
    """All pen-up moves: onto the first run, from each run to the next, and off the last one."""
    number = jnp.sum(runs.live)
    slot = jnp.arange(runs.live.shape[0] + 1)
    rises, lowers = slot > 0, slot < number
    start = jnp.where(rises, jnp.roll(jnp.append(runs.last, 0), 1), runs.first[0])
    end = jnp.where(lowers, jnp.append(runs.first, 0), start)
    before = jnp.roll(jnp.append(runs.colour, 0), 1)
    changes = rises & lowers & (jnp.append(runs.colour, 0) != before)
    surface, seen = _to_look_at(mapped, obstacles)

    def plan(row):
        start, end, rises, lowers, changes = row
        ends = mapped.p_map[start], mapped.p_map[end]
        normals = mapped.normal[start], mapped.normal[end]
        on_surface = (rises, lowers)
        return plan_move(ends, normals, surface, seen, settings.move, on_surface=on_surface, changes=changes)

    return jax.lax.map(plan, (start, end, rises, lowers, changes), batch_size=_MOVES_AT_ONCE)


def _to_look_at(mapped: Mapped, obstacles: Float[Array, "M 3"] | None):
    """Points that stand for the surface, and which of them are real."""
    number = mapped.status.shape[0]
    some = np.unique(np.linspace(0, number - 1, min(number, _LOOKED_AT)).round().astype(int))
    status = mapped.status[some]
    surface, seen = mapped.p_map[some], (status != Cause.MISS) & (status != Cause.FRONT)
    if obstacles is None:
        return surface, seen
    real = jnp.isfinite(obstacles).all(-1)
    surface = jnp.concatenate([surface, jnp.where(real[:, None], obstacles, 0)])
    return surface, jnp.concatenate([seen, real])


def duration(path: BrushPath) -> Float[Array, ""]:
    """Time of the whole path [s]."""
    return path.end


def sample(path: BrushPath, dt: Float[Array, ""], steps: int) -> TimedPath:
    """The path at 0, dt, 2 dt, ...: a path that lasts longer than steps * dt is still live at the last step.

    Velocities are the derivatives of the poses, by forward mode.
    """
    time = jnp.arange(steps, dtype=path.p_map.dtype) * dt

    def at(time):
        one = jnp.ones_like(time)
        (position, rotation), (velocity, spin), (pen, run) = jax.jvp(
            lambda t: _pose(path, t), (time,), (one,), has_aux=True
        )
        # half the sum of axis x its derivative, over the three axes, is the angular velocity
        angular = jnp.sum(jnp.cross(rotation, spin, axis=0), axis=1) / 2
        return position, rotation, velocity, angular, pen, run

    position, rotation, velocity, angular, pen, run = jax.lax.map(at, time, batch_size=_TIMES_AT_ONCE)
    return TimedPath(
        position, rotation, velocity, angular, pen, run, colour_at(path, time), (time < path.end)
    )


def colour_at(path: BrushPath, time: Float[Array, "*t"]) -> Int[Array, "*t"]:
    """The tool in hand at times of the path [s]: it changes at the top of the move to the first run that it
    draws, when the brush has left the surface.
    """
    number = jnp.sum(path.runs.live)
    lifts = jax.vmap(lambda move: lift_time(move, path.settings.move))(path.moves)
    taken = path.begins + jnp.where(jnp.arange(lifts.shape[0]) <= number, lifts, 0)
    run = jnp.searchsorted(taken, time, side="right") - 1
    return path.runs.colour[jnp.clip(run, 0, jnp.maximum(number - 1, 0))]


def _pose(path: BrushPath, time: Float[Array, ""]):
    """Position and rotation at a time [s]; whether the pen is down, and the run."""
    time = jnp.minimum(time, path.end)
    number = jnp.sum(path.runs.live)
    slot = jnp.clip(jnp.searchsorted(path.begins, time, side="right") - 1, 0, number)
    down = (time >= path.draws[slot]) & (slot < number)
    move = jax.tree.map(lambda leaf: leaf[slot], path.moves)
    p_move, n_move = move_pose(move, time - path.begins[slot], path.settings.move)
    run = jnp.clip(slot, 0, jnp.maximum(number - 1, 0))
    p_draw, n_draw = _drawn(path, run, time - path.draws[slot])
    position, normal = jnp.where(down, p_draw, p_move), jnp.where(down, n_draw, n_move)
    return (position, _frame(normal, path.u_axis)), (down.astype(path.p_map.dtype), run)


def _drawn(path: BrushPath, run: Int[Array, ""], time: Float[Array, ""]):
    """Point [m] and unit normal on a run at a time since its start [s]: cubics through the mapped points.

    The speed is constant over the chords between the points; over the cubic it sinks where the run turns
    sharply.
    """
    first, last = path.runs.first[run], path.runs.last[run]
    length = path.place[last] - path.place[first]
    way = path.place[first] + travelled(time, length, path.settings.speed, path.settings.acceleration)
    index = jnp.clip(jnp.searchsorted(path.place, way, side="right") - 1, first, jnp.maximum(last - 1, first))
    knots = jnp.clip(index + jnp.arange(-1, 3), first, last)
    place = path.place[knots]
    point, normal = (_cubic(values[knots], place, way) for values in (path.p_map, path.normal))
    return point, unit(normal, otherwise=path.normal[first])


def _cubic(values: Float[Array, "4 3"], place: Float[Array, "4"], way: Float[Array, ""]) -> Float[Array, "3"]:
    """Catmull-Rom: the cubic between the middle two of four knots, with slopes of the chords across each."""
    step = place[2] - place[1]
    step = jnp.where(step > 0, step, 1)
    x = (way - place[1]) / step
    first, last = (
        (values[k + 1] - values[k - 1])
        * step
        / jnp.where(place[k + 1] > place[k - 1], place[k + 1] - place[k - 1], 1)
        for k in (1, 2)
    )
    straight = values[2] - values[1]
    return values[1] + x * (first + x * (3 * straight - 2 * first - last + x * (first + last - 2 * straight)))


def _frame(normal: Float[Array, "3"], u_axis: Float[Array, "3"]) -> Float[Array, "3 3"]:
    """R_map_brush: z against the normal, x along the canvas' u."""
    z = -normal
    x = unit(u_axis - jnp.sum(u_axis * z) * z, otherwise=u_axis)
    return jnp.stack([x, jnp.cross(z, x), z], axis=1)
