"""Motion through waypoints with a stop at each: the trajectory controller's plan (S1 section IV-A)."""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from jaxpaint.trajectories.quintic import State, rest_duration, rest_progress


class Trajectory(eqx.Module):
    """Quintics from rest to rest between waypoints, on one clock.

    points: the waypoints; those that were masked out repeat the one before. start: when each segment begins
    [s], and when the last one ends. A segment without way takes no time.
    """

    points: Float[Array, "waypoints joints"]
    start: Float[Array, " waypoints"]

    @property
    def duration(self) -> Float[Array, ""]:
        """From the first waypoint to the last [s]."""
        return self.start[-1]

    @property
    def segments(self) -> Float[Array, " segments"]:
        """How long each segment takes [s]."""
        return self.start[1:] - self.start[:-1]


def plan(
    waypoints: Float[Array, "waypoints joints"],
    mask: Bool[Array, " waypoints"],
    v_max: Float[Array, " joints"],
    a_max: Float[Array, " joints"],
) -> Trajectory:
    """The shortest motion through the waypoints that `mask` keeps, straight in joint space, in step.

    Limits in rad/s or m/s, and per second. The first waypoint is kept whatever its mask says: it is where one
    starts.
    """
    points = _forward_fill(waypoints, mask)
    durations = jax.vmap(lambda way: rest_duration(way, v_max, a_max))(points[1:] - points[:-1])
    return _on_clock(points, durations)


def plan_base_and_arm(
    waypoints: Float[Array, "waypoints joints"],
    mask: Bool[Array, " waypoints"],
    v_max: Float[Array, " joints"],
    a_max: Float[Array, " joints"],
    *,
    base_size: int = 3,
) -> Trajectory:
    """Base and arm planned apart, then put on one clock: a segment takes as long as the slower of them needs.

    Slowing down keeps the limits, so both arrive together (S1's command adapter). The base's first two joints
    are a position in the plane: their limits hold for its length, whatever the direction.
    """
    points = _forward_fill(waypoints, mask)
    ways = points[1:] - points[:-1]
    base = jax.vmap(lambda way: _base_duration(way[:base_size], v_max, a_max))(ways)
    arm = jax.vmap(lambda way: rest_duration(way[base_size:], v_max[base_size:], a_max[base_size:]))(ways)
    return _on_clock(points, jnp.maximum(base, arm))


def sample(trajectory: Trajectory, t: Float[Array, ""]) -> State:
    """The state at time t [s]; at rest at either end before and after."""
    start, durations = trajectory.start, trajectory.segments
    # the last segment that has begun and takes time; a maximum, since searching does not vectorise
    index = jnp.arange(durations.shape[0])
    segment = jnp.where((start[:-1] <= t) & (durations > 0), index, 0).max()
    moving = durations[segment] > 0
    duration = jnp.where(moving, durations[segment], 1)
    x = jnp.clip((t - start[segment]) / duration, 0, 1)
    s, rate, bend = rest_progress(x)
    way = trajectory.points[segment + 1] - trajectory.points[segment]
    return State(trajectory.points[segment] + s * way, rate / duration * way, bend / duration**2 * way)


def _forward_fill(waypoints, mask):
    """Each waypoint, or the last kept one before it; what a masked one holds, NaN included, is ignored."""

    def keep(last, row):
        point, kept = row
        out = jnp.where(kept, point, last)
        return out, out

    _, filled = jax.lax.scan(keep, waypoints[0], (waypoints[1:], mask[1:]))
    return jnp.concatenate([waypoints[:1], filled])


def _base_duration(way, v_max, a_max):
    """Of a straight line of the base while it turns."""
    square = (way[:2] * way[:2]).sum()
    safe = jnp.where(square > 0, square, 1)
    length = jnp.where(square > 0, jnp.sqrt(safe), 0)
    line = jnp.concatenate([length[None], way[2:]])
    slowest = jnp.minimum(v_max[0], v_max[1])[None]
    gentlest = jnp.minimum(a_max[0], a_max[1])[None]
    size = way.shape[0]
    return rest_duration(
        line, jnp.concatenate([slowest, v_max[2:size]]), jnp.concatenate([gentlest, a_max[2:size]])
    )


def _on_clock(points, durations) -> Trajectory:
    zero = jnp.zeros_like(durations[:1])
    return Trajectory(points, jnp.concatenate([zero, jnp.cumsum(durations)]))
