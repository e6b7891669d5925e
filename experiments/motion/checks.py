"""What a planned motion does to limits, time and walls: by finite differences, and by MuJoCo in C."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool, Float

from experiments.motion.clearance import distances
from experiments.motion.missions import Missions
from experiments.motion.topp import fastest_time
from experiments.motion.truth import Truth
from experiments.motion.wheel_turns import wheel_turns
from jaxpaint.trajectories import Trajectory, on_segment, sample

STEP = 0.001
# Every so many steps torques are asked for.
_TORQUE_EVERY = 4
_NODES, _MOMENTS = 101, 2001
_STILL = 1e-5  # a segment without more way than this has no bound [rad or m]


@dataclasses.dataclass(frozen=True, eq=False)
class Checked:
    """speed, acceleration, torque: largest share of a limit that was used. jump: largest change of
    acceleration from one millisecond to the next of the base's place [m/s^2], its yaw and the arm's joints
    [rad/s^2]. distance: least of body, brush and parts among themselves [m], a lower bound, at most `NEAR`.
    moving: time between the rests that the mission asks for, at its waypoints; `via_rest` of it at via
    points, where wheels turn. bound: least time for the same ways; `turning` of it is what the wheels need at
    via points [s].
    """

    speed: float
    acceleration: float
    torque: float
    jump: tuple[float, float, float]
    distance: tuple[float, float, float]
    moving: float
    via_rest: float
    bound: float
    turning: float

    @property
    def collides(self) -> bool:
        """Whether anything touches, or may: the distances are lower bounds."""
        return min(self.distance) <= 0


def check(missions: Missions) -> list[Checked]:
    """Every mission that is driven."""
    truth = Truth(missions.scene, missions.around.robot)
    return [
        _check_one(
            missions,
            jax.tree.map(lambda x, k=k: np.asarray(x)[k], missions.motion.trajectory),
            missions.touches[k],
            truth,
        )
        for k in np.flatnonzero(~missions.refused)
    ]


def _check_one(missions: Missions, trajectory: Trajectory, touches: np.ndarray, truth: Truth) -> Checked:
    robot = missions.around.robot
    p = positions(trajectory)
    v, a = (p[2:] - p[:-2]) / (2 * STEP), (p[2:] - 2 * p[1:-1] + p[:-2]) / STEP**2
    limit_v, limit_a = np.asarray(robot.speed_limit, float), np.asarray(robot.acceleration_limit, float)
    torque = truth.torques(p[1:-1:_TORQUE_EVERY], v[::_TORQUE_EVERY], a[::_TORQUE_EVERY])
    body, brush, itself = distances(truth, p, _brush_counts(trajectory, touches, len(p)))
    rest = np.asarray(trajectory.rest, float)
    corner = np.arange(len(rest)) % _parts(trajectory, touches) > 0
    rest = np.where(corner, rest, 0)
    base = np.asarray(trajectory.points, float)[:, :3]
    long = np.asarray(trajectory.segments, float)
    turning = wheel_turns(truth.model, base, long, corner)
    return Checked(
        speed=_share(v, limit_v),
        acceleration=_share(a, limit_a),
        torque=float((np.abs(torque) / np.asarray(robot.torque_limit, float)).max()),
        jump=_jump(a, robot.base_size),
        distance=(float(body), float(brush), float(itself)),
        moving=float(long.sum() + rest.sum()),
        via_rest=float(rest.sum()),
        bound=float(_bounds(robot, trajectory, truth).sum()) + turning,
        turning=turning,
    )


def _parts(trajectory: Trajectory, touches: Bool[np.ndarray, " w"]) -> int:
    """Segments to a waypoint."""
    return len(trajectory.start) // (len(touches) - 1)


def _brush_counts(
    trajectory: Trajectory, touches: Bool[np.ndarray, " w"], count: int
) -> Bool[np.ndarray, " t"]:
    """Everywhere but on the last segment to a touch, at it, and on the first segment from it.

    A chain's segments without way are not counted: a straight way to a touch is the touch's own.
    """
    parts, counts = _parts(trajectory, touches), np.ones(count, bool)
    start, long = np.asarray(trajectory.start, float), np.asarray(trajectory.segments, float)
    for waypoint in np.flatnonzero(touches):
        before, after = waypoint * parts - 1, waypoint * parts
        after += int(np.argmax(long[after : after + parts] > 0))
        first, last = start[before], start[after] + long[after]
        counts[int(np.floor(first / STEP)) + 1 : int(np.floor(last / STEP))] = False
    return counts


def positions(trajectory: Trajectory) -> Float[np.ndarray, "t joints"]:
    """Every millisecond, in double precision."""
    with jax.enable_x64(True):
        exact = jax.tree.map(lambda x: jnp.asarray(np.asarray(x, float)), trajectory)
        count = 5000 * int(np.ceil(float(trajectory.duration) / STEP / 5000))
        return np.asarray(_SAMPLE(exact, jnp.arange(count) * STEP))


_SAMPLE = jax.jit(jax.vmap(lambda trajectory, t: sample(trajectory, t).p, in_axes=(None, 0)))


def _share(rows, limit) -> float:
    """The base's position is limited by its length in the plane."""
    use = np.abs(rows) / limit
    line = np.linalg.norm(rows[:, :2], axis=1) / limit[:2].min()
    return float(max(use[:, 2:].max(), line.max()))


def _jump(a, size: int) -> tuple[float, float, float]:
    change = np.abs(np.diff(a, axis=0)).max(0)
    return float(change[:2].max()), float(change[2:size].max()), float(change[size:].max())


def _bounds(robot, trajectory: Trajectory, truth: Truth) -> np.ndarray:
    """Least time of each segment's way under the robot's full limits, acceleration free to jump.

    Where ways meet the path has a corner, at which every motion along it must stand still.
    """
    rows = _along(trajectory)
    ways = [_way(q) for q in rows if np.abs(q[-1] - q[0]).max() > _STILL]
    limit_v, limit_a = np.asarray(robot.speed_limit, float), np.asarray(robot.acceleration_limit, float)
    limit_t = np.asarray(robot.torque_limit, float)
    rows = [_rows(truth, *way, limit_v, limit_a, limit_t) for way in ways]
    return fastest_time(*(np.stack(x) for x in zip(*rows, strict=True)))


def _along(trajectory: Trajectory) -> Float[np.ndarray, "segments times joints"]:
    """Every segment at equal steps of time."""
    with jax.enable_x64(True):
        exact = jax.tree.map(lambda x: jnp.asarray(np.asarray(x, float)), trajectory)
        segments = jnp.arange(exact.start.shape[0])
        return np.asarray(_ON(exact, segments, jnp.linspace(0, 1, _MOMENTS)))


_ON = jax.jit(
    jax.vmap(
        jax.vmap(lambda t, k, share: on_segment(t, k, share * t.segments[k]).p, in_axes=(None, None, 0)),
        in_axes=(None, 0, None),
    )
)


def _way(q: Float[np.ndarray, "times joints"]):
    """q, dq/ds, d2q/ds2 at equal steps of s, the mean of the shares that base and arm have done."""
    ends = q[-1] - q[0]
    moves = np.abs(ends) > _STILL / 10
    parts = [part for part in (np.arange(3), np.arange(3, q.shape[1])) if moves[part].any()]
    share = np.mean(
        [((q - q[0])[:, p] / np.where(moves, ends, np.inf)[p]).sum(1) / moves[p].sum() for p in parts], 0
    )
    s = np.linspace(0, 1, _NODES)
    at = np.stack([np.interp(s, share, q[:, j]) for j in range(q.shape[1])], 1)
    first = np.gradient(at, s, axis=0)
    return at, first, np.gradient(first, s, axis=0)


def _rows(truth: Truth, q, first, second, limit_v, limit_a, limit_t):
    """Rows of `fastest_time`: the base's line, the other joints, the torques."""

    def lined(x):
        along = first[:, :2] / np.maximum(np.linalg.norm(first[:, :2], axis=1, keepdims=True), 1e-12)
        return np.concatenate([(x[:, :2] * along).sum(1, keepdims=True), x[:, 2:]], axis=1)

    def least(limit):
        return np.concatenate([limit[:2].min(keepdims=True), limit[2:]])

    zero = np.zeros_like(q)
    weight = truth.torques(q, zero, zero)
    inertia = truth.torques(q, zero, first) - weight
    damping = truth.damping * first
    coriolis = truth.torques(q, first, second) - weight - damping
    A, B = np.concatenate([lined(first), inertia], 1), np.concatenate([lined(second), coriolis], 1)
    C, offset = (np.concatenate([0 * lined(zero), x], 1) for x in (damping, weight))
    limit = np.broadcast_to(np.concatenate([least(limit_a), limit_t]), A.shape)
    V = (least(limit_v) / np.maximum(np.abs(lined(first)), 1e-9)).min(1) ** 2
    return A, B, offset, limit, V, C
