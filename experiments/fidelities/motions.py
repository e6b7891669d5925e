"""What a base is told, step by step: straight on, an arc, crabwise, a spin, stop and go; or at random."""

import dataclasses
from collections.abc import Callable

import numpy as np
from jaxtyping import Float

from sims.painting.job import CONTROL_PERIOD

# Wheels turn before the base goes [s]; it comes to rest after [s].
_BEFORE, _AFTER = 1.0, 1.0
# How fast a base gathers speed and loses it [m/s^2], and turns [rad/s^2].
_ACCELERATION = np.array([0.5, 0.5, 1.0])
# A random move: how long [s], and its fastest [m/s, rad/s].
_MOVE, _FASTEST = 2.0, np.array([0.15, 0.15, 0.2])

# Told twists of base and steering, a row a control step, in the base's frame.
Rows = tuple[Float[np.ndarray, "t 3"], Float[np.ndarray, "t 3"]]


@dataclasses.dataclass(frozen=True)
class Motion:
    """twist: (v_x, v_y [m/s], w [rad/s]) wanted at each time [s] after the start. seconds: how long."""

    name: str
    twist: Callable[[float], tuple[float, float, float]]
    seconds: float

    def rows(self) -> Rows:
        """Wheels turn, the base goes within its accelerations, and comes to rest."""
        going = round(self.seconds / CONTROL_PERIOD)
        return _move(np.array([self.twist(k * CONTROL_PERIOD) for k in range(going)]))


MOTIONS = (
    Motion("straight", lambda t: (0.2, 0.0, 0.0), 10.0),
    Motion("creep", lambda t: (0.03, 0.0, 0.0), 10.0),
    Motion("arc", lambda t: (0.2, 0.0, 0.2), 10.0),
    Motion("crab", lambda t: (0.1, 0.15, 0.0), 10.0),
    Motion("spin", lambda t: (0.0, 0.0, 0.4), 10.0),
    Motion("stop and go", lambda t: (0.2 if t % 2.0 < 1.2 else 0.0, 0.0, 0.0), 10.0),
)
"""All of them last as long."""


def random_moves(count: int, *, seed: int) -> Rows:
    """One move after another at random twists, each as long, from rest to rest."""
    rng = np.random.default_rng(seed)
    going = round(_MOVE / CONTROL_PERIOD)
    moves = [_move(np.tile(rng.uniform(-1, 1, 3) * _FASTEST, (going, 1))) for _ in range(count)]
    told, steer = zip(*moves, strict=True)
    return np.concatenate(told), np.concatenate(steer)


def move_length() -> int:
    """Control steps of a random move."""
    return round(_BEFORE / CONTROL_PERIOD) + round(_MOVE / CONTROL_PERIOD) + round(_AFTER / CONTROL_PERIOD)


def _move(wanted: Float[np.ndarray, "t 3"]) -> Rows:
    before, after = (np.zeros((round(x / CONTROL_PERIOD), 3)) for x in (_BEFORE, _AFTER))
    still = np.abs(wanted).sum(axis=1) == 0
    steer = np.where(still[:, None], wanted[0], wanted)
    told = _limited(np.concatenate([before, wanted, after]))
    return told, np.concatenate([before + wanted[0], steer, after + steer[-1]])


def _limited(wanted: Float[np.ndarray, "t 3"]) -> Float[np.ndarray, "t 3"]:
    """Within the accelerations; all parts of a change keep their ratio."""
    rows, now, change = [], np.zeros(3), _ACCELERATION * CONTROL_PERIOD
    for row in wanted:
        step = row - now
        now = now + step * min(1.0, *(change / np.maximum(np.abs(step), 1e-12)))
        rows.append(now)
    return np.array(rows)


def way_of(told: Float[np.ndarray, "t 3"]) -> Float[np.ndarray, "t 3"]:
    """Where a base would be that does what it is told, at the mean heading of each step (x, y, yaw)."""
    turn = told[:, 2] * CONTROL_PERIOD
    yaw = np.cumsum(turn)
    c, s = np.cos(yaw - turn / 2), np.sin(yaw - turn / 2)
    step = np.stack([c * told[:, 0] - s * told[:, 1], s * told[:, 0] + c * told[:, 1]], axis=1)
    return np.concatenate([np.cumsum(step * CONTROL_PERIOD, axis=0), yaw[:, None]], axis=1)
