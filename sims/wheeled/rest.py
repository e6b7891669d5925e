"""A robot at rest on its wheels: how it stands, and how far a turn of them takes it."""

from typing import NamedTuple

import mujoco
import numpy as np
from jaxtyping import Float

from sims.wheeled.in_c import with_contacts
from sims.wheeled.parameters import FRICTION

# Until all has come to rest [s], in steps of this [s].
_SETTLING, _STEP = 2.0, 0.005


class Rest(NamedTuple):
    """tilt: height of the base [m], roll, pitch [rad]: `sims.worlds.World`. rolling_radius: way of a wheel
    for a turn of one radian [m]: a loaded tyre is flatter than its radius.
    """

    tilt: Float[np.ndarray, "3"]
    rolling_radius: float


def at_rest(rolling: mujoco.MjModel, arm: Float[np.ndarray, " arm"]) -> Rest:
    """Where the robot of a `wheeled_model` comes to rest with its arm held like this, by MuJoCo in C."""
    model = with_contacts(rolling, friction=FRICTION)
    model.opt.timestep = _STEP
    data = mujoco.MjData(model)
    data.qpos[7 + model.nv - 6 - len(arm) :] = arm
    held = data.qpos[7:].copy()
    for _ in range(int(_SETTLING / _STEP)):
        mujoco.mj_step(model, data)
        data.qpos[7:], data.qvel[6:] = held, 0.0
    mujoco.mj_forward(model, data)
    w, x, y, z = data.qpos[3:7]
    roll, pitch = np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)), np.arcsin(2 * (w * y - z * x))
    treads = {int(t) for t in model.pair_geom2}
    deepest = [
        min((float(c.dist) for c in data.contact if t in (c.geom1, c.geom2)), default=0.0) for t in treads
    ]
    radius = np.mean([model.geom_size[t, 0] for t in treads])
    # A contact lies at half of its depth.
    return Rest(np.array([data.qpos[2], roll, pitch]), float(radius + np.mean(deepest) / 2))


def tread_depths(rolling: mujoco.MjModel, tilt: Float[np.ndarray, "*t 3"]) -> Float[np.ndarray, "*t wheels"]:
    """How deep each wheel of a `wheeled_model` is in a flat floor [m], with the base tilted like this.

    tilt: height [m], roll, pitch [rad]. Below 0 a wheel is off the floor. To the first order in the angles.
    """
    data = mujoco.MjData(rolling)
    mujoco.mj_kinematics(rolling, data)
    treads = np.unique(rolling.pair_geom2)
    place, radius = data.geom_xpos[treads] - data.xpos[1], rolling.geom_size[treads, 0]
    floor = data.geom_xpos[rolling.pair_geom1[0], 2] - data.xpos[1, 2]
    rise = tilt[..., :1] + tilt[..., 1:2] * place[:, 1] - tilt[..., 2:] * place[:, 0]
    return floor + radius - place[:, 2] - rise
