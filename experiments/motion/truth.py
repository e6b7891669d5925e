"""The robot before its wall in MuJoCo (C): what truly touches, and what the motors truly give."""

from collections.abc import Sequence

import mujoco
import numpy as np
from jaxtyping import Float

from sims.robots import Robot
from sims.robots.load import REFERENCE
from sims.scenes import Scene, scene_mjcf

NEAR = 0.05
"""Distances beyond this are not told [m]."""


class Truth:
    """A model of the reference robot and a wall, whose geoms see each other and nothing else.

    The brush may touch. dof: the chain's joints in the model.
    """

    def __init__(self, scene: Scene, robot: Robot):
        self.model = _with_scene(scene)
        self.data = mujoco.MjData(self.model)
        self.dof = np.array([self.model.joint(name).dofadr[0] for name in robot.chain.names])

    @property
    def damping(self) -> Float[np.ndarray, " joints"]:
        """Of the chain's joints."""
        return self.model.dof_damping.reshape(self.model.nv, -1)[self.dof, 0]

    def distances(self, q: Sequence | Float[np.ndarray, "n joints"]) -> Float[np.ndarray, " n"]:
        """Least distance of the robot to the wall [m] at each row, at most `NEAR`; negative inside."""
        model, data = self.model, self.data
        least = np.full(len(q), NEAR)
        for k, row in enumerate(q):
            data.qpos[self.dof] = row
            mujoco.mj_kinematics(model, data)
            mujoco.mj_comPos(model, data)
            mujoco.mj_collision(model, data)
            if data.ncon:
                least[k] = min(NEAR, float(data.contact.dist.min()))
        return least

    def torques(self, p, v, a) -> Float[np.ndarray, "n joints"]:
        """Inverse dynamics at each row [N m, N]."""
        model, data, out = self.model, self.data, np.zeros_like(p)
        flags = model.opt.disableflags
        model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
        for k in range(len(p)):
            data.qpos[self.dof], data.qvel[self.dof], data.qacc[self.dof] = p[k], v[k], a[k]
            mujoco.mj_inverse(model, data)
            out[k] = data.qfrc_inverse[self.dof]
        model.opt.disableflags = flags
        return out


def _with_scene(scene: Scene) -> mujoco.MjModel:
    spec = mujoco.MjSpec.from_file(str(REFERENCE))
    wall = mujoco.MjSpec.from_string(scene_mjcf(scene))
    spec.attach(wall, prefix="wall/", frame=spec.worldbody.add_frame())
    for geom in spec.geoms:  # before it is compiled: bodies have masks of their geoms'
        is_wall, is_floor = geom.name.startswith("wall/"), geom.type == mujoco.mjtGeom.mjGEOM_PLANE
        geom.contype = 0 if is_wall else int(not geom.name.startswith("brush"))
        geom.conaffinity = int(is_wall and not is_floor)
        geom.margin = NEAR
    model = spec.compile()
    model.body_gravcomp[:] = 0
    return model
