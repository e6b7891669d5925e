"""What a planned motion does to limits, time and walls: by finite differences, and by MuJoCo in C."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from experiments.motion.missions import Missions
from experiments.motion.topp import fastest_time
from experiments.motion.truth import Truth
from jaxpaint.trajectories import Trajectory, on_segment, sample

STEP = 0.001
# Every so many steps torques and distances are asked for.
_TORQUE_EVERY, _DISTANCE_EVERY = 4, 20
_NODES, _MOMENTS = 101, 2001
_STILL = 1e-5  # a segment without more way than this has no bound [rad or m]


@dataclasses.dataclass(frozen=True, eq=False)
class Checked:
    """speed, acceleration, torque: largest share of a limit that was used. jump: largest change of
    acceleration from one sample to the next [m/s^2 or rad/s^2] of base and arm, and over a control period.
    distance: least of the robot to the wall [m], at most `NEAR`. moving: time in motion, bound: least
    time for the same ways [s].
    """

    speed: float
    acceleration: float
    torque: float
    jump: tuple[float, float]
    jump_20ms: tuple[float, float]
    distance: float
    moving: float
    bound: float


def check(missions: Missions) -> list[Checked]:
    """Every mission."""
    truth = Truth(missions.scene, missions.around.robot)
    return [
        _check_one(missions, jax.tree.map(lambda x, k=k: np.asarray(x)[k], missions.trajectory), truth)
        for k in range(len(missions.waypoints))
    ]


def _check_one(missions: Missions, trajectory: Trajectory, truth: Truth) -> Checked:
    robot = missions.around.robot
    p = positions(trajectory)
    v, a = (p[2:] - p[:-2]) / (2 * STEP), (p[2:] - 2 * p[1:-1] + p[:-2]) / STEP**2
    limit_v, limit_a = np.asarray(robot.speed_limit, float), np.asarray(robot.acceleration_limit, float)
    size = robot.base_size
    torque = truth.torques(p[1:-1:_TORQUE_EVERY], v[::_TORQUE_EVERY], a[::_TORQUE_EVERY])
    return Checked(
        speed=_share(v, limit_v),
        acceleration=_share(a, limit_a),
        torque=float((np.abs(torque) / np.asarray(robot.torque_limit, float)).max()),
        jump=_jump(a, size),
        jump_20ms=_jump(a[::20], size),
        distance=float(truth.distances(p[::_DISTANCE_EVERY]).min()),
        moving=float(np.asarray(trajectory.segments, float).sum()),
        bound=float(_bounds(robot, trajectory, truth).sum()),
    )


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


def _jump(a, size: int) -> tuple[float, float]:
    change = np.abs(np.diff(a, axis=0))
    return float(change[:, :size].max()), float(change[:, size:].max())


def _bounds(robot, trajectory: Trajectory, truth: Truth) -> np.ndarray:
    """Least time of each segment's way under the robot's full limits, acceleration free to jump."""
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
    offset = np.concatenate([0 * lined(zero), weight], 1)
    limit = np.broadcast_to(np.concatenate([least(limit_a), limit_t]), A.shape)
    V = (least(limit_v) / np.maximum(np.abs(lined(first)), 1e-9)).min(1) ** 2
    return A, B, offset, limit, V
