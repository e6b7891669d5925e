"""What a base is told, step by step: straight on, an arc, crabwise, a spin, stop and go."""

import dataclasses
from collections.abc import Callable

import numpy as np
from jaxtyping import Float

from sims.painting.job import CONTROL_PERIOD

# Wheels turn before the base goes [s]; it comes to rest after [s].
_BEFORE, _AFTER = 1.0, 0.5
# How fast a base gathers speed and loses it [m/s^2], and turns [rad/s^2].
_ACCELERATION = np.array([0.5, 0.5, 1.0])


@dataclasses.dataclass(frozen=True)
class Motion:
    """twist: (v_x, v_y [m/s], w [rad/s]) wanted at each time [s] after the start. seconds: how long."""

    name: str
    twist: Callable[[float], tuple[float, float, float]]
    seconds: float

    def rows(self) -> tuple[Float[np.ndarray, "t 3"], Float[np.ndarray, "t 3"]]:
        """Told twists of the base, within its accelerations, and of the steering, a row a control step."""
        before, going = (round(x / CONTROL_PERIOD) for x in (_BEFORE, self.seconds))
        wanted = np.array([self.twist(k * CONTROL_PERIOD) for k in range(going)])
        after = np.zeros((round(_AFTER / CONTROL_PERIOD), 3))
        wanted = np.concatenate([np.zeros((before, 3)), wanted, after])
        ways = wanted[before]
        steer = np.where(np.abs(wanted).sum(axis=1, keepdims=True) > 0, wanted, ways)
        return _limited(wanted), steer


def _limited(wanted: Float[np.ndarray, "t 3"]) -> Float[np.ndarray, "t 3"]:
    rows, now, change = [], np.zeros(3), _ACCELERATION * CONTROL_PERIOD
    for row in wanted:
        step = row - now
        now = now + step * min(1.0, *(change / np.maximum(np.abs(step), 1e-12)))  # all parts keep their ratio
        rows.append(now)
    return np.array(rows)


MOTIONS = (
    Motion("straight", lambda t: (0.2, 0.0, 0.0), 10.0),
    Motion("creep", lambda t: (0.03, 0.0, 0.0), 10.0),
    Motion("arc", lambda t: (0.2, 0.0, 0.2), 10.0),
    Motion("crab", lambda t: (0.1, 0.15, 0.0), 10.0),
    Motion("spin", lambda t: (0.0, 0.0, 0.4), 10.0),
    Motion("stop and go", lambda t: (0.2 if t % 2.0 < 1.2 else 0.0, 0.0, 0.0), 10.0),
)
"""All of them, which end at rest."""
