"""The robot before its wall in MuJoCo (C): what truly touches, and what the motors truly give."""

from typing import NamedTuple

import equinox as eqx
import jax.numpy as jnp
import mujoco
import numpy as np
from jaxtyping import Float

from sims.robots import Robot
from sims.robots.load import REFERENCE
from sims.scenes import Box, Rectangle, Scene, scene_mjcf

NEAR = 0.05
"""Distances beyond this are not told [m]."""

BODY, BRUSH, ITSELF = range(3)
"""What a distance is of: the body or the brush to what is around, parts of the robot to each other."""

# Behind its face a plate is as thick as this [m]: no link is ever wholly behind it.
_SOLID = 1.0
_ROBOT, _AROUND, _FLOOR = 1, 2, 4
_NOTHING = -1


class Posture(NamedTuple):
    """distance: least of each kind [m], at most `NEAR`, negative inside. place, rotation: of all geoms."""

    distance: Float[np.ndarray, "3"]
    place: Float[np.ndarray, "geoms 3"]
    rotation: Float[np.ndarray, "geoms 9"]


class Truth:
    """A model of the reference robot and a wall. What the base carries may not touch the floor; wheels do.

    Of the robot's own parts those pairs count that a joint does not join and that are apart at home. dof: the
    chain's joints in the model.
    """

    def __init__(self, scene: Scene, robot: Robot):
        self.model = _with_scene(scene)
        self.name, self.data = scene.name, mujoco.MjData(self.model)
        self.dof = np.array([self.model.joint(name).dofadr[0] for name in robot.chain.names])
        self._kind = _kinds(self.model, robot.chain.names[robot.base_size])
        self._exclude(np.concatenate([[1e3, 0, 0], np.asarray(robot.home, float)]))

    @property
    def damping(self) -> Float[np.ndarray, " joints"]:
        """Of the chain's joints."""
        return self.model.dof_damping.reshape(self.model.nv, -1)[self.dof, 0]

    def posture(self, q: Float[np.ndarray, " joints"]) -> Posture:
        """What is near at joint positions, and where all geoms are."""
        model, data = self.model, self.data
        self._place(q)
        least = np.full(4, NEAR)  # the last is for pairs that do not count
        if data.ncon:
            pairs = data.contact.geom
            np.minimum.at(least, self._kind[pairs[:, 0], pairs[:, 1]], data.contact.dist)
        robot = model.geom_contype == _ROBOT
        return Posture(least[:3], data.geom_xpos[robot].copy(), data.geom_xmat[robot].copy())

    def moved(self, a: Posture, b: Posture) -> float:
        """How far a point of the robot moves at most from one posture to the next [m], as the crow flies."""
        radius = self.model.geom_rbound[self.model.geom_contype == _ROBOT]
        turn = np.linalg.norm(b.rotation - a.rotation, axis=1) / 2**0.5
        return float((np.linalg.norm(b.place - a.place, axis=1) + turn * radius).max())

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

    def _place(self, q: Float[np.ndarray, " joints"]) -> None:
        self.data.qpos[self.dof] = q
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_comPos(self.model, self.data)
        mujoco.mj_collision(self.model, self.data)

    def _exclude(self, home: Float[np.ndarray, " joints"]) -> None:
        """Leaves out the pairs of the robot's own geoms that touch at home."""
        self._place(home)
        for (one, other), distance in zip(self.data.contact.geom, self.data.contact.dist, strict=True):
            if distance <= 0 and self._kind[one, other] == ITSELF:
                self._kind[one, other] = self._kind[other, one] = _NOTHING


def _with_scene(scene: Scene) -> mujoco.MjModel:
    spec = mujoco.MjSpec.from_file(str(REFERENCE))
    solid = tuple(_solid(primitive) for primitive in scene.primitives)
    wall = mujoco.MjSpec.from_string(scene_mjcf(eqx.tree_at(lambda s: s.primitives, scene, solid)))
    spec.attach(wall, prefix="wall/", frame=spec.worldbody.add_frame())
    for geom in spec.geoms:  # before it is compiled: bodies have masks of their geoms'
        is_wall, is_floor = geom.name.startswith("wall/"), geom.type == mujoco.mjtGeom.mjGEOM_PLANE
        geom.contype = _FLOOR if is_floor else _AROUND if is_wall else _ROBOT
        geom.conaffinity = 0 if is_wall else _ROBOT | _AROUND | _FLOOR
        geom.margin = NEAR
    model = spec.compile()
    model.body_gravcomp[:] = 0
    return model


def _solid(primitive):
    """A plate as a thick box with the same face."""
    if not isinstance(primitive, Rectangle):
        return primitive
    R, half = primitive.R_map_plate, _SOLID / 2
    size = jnp.append(primitive.half, half)
    return Box(center=primitive.center - half * R[:, 2], R_map_box=R, half=size, texture=primitive.texture)


def _kinds(model: mujoco.MjModel, first_joint: str) -> np.ndarray:
    """BODY, BRUSH, ITSELF or nothing for each pair of geoms."""
    first, carried = int(model.joint(first_joint).bodyid[0]), np.zeros(model.nbody, bool)
    for body in range(1, model.nbody):
        carried[body] = body == first or carried[model.body_parentid[body]]
    carried = carried[model.geom_bodyid]
    brush = np.array([model.geom(k).name.startswith("brush") for k in range(model.ngeom)])
    robot, floor = model.geom_contype == _ROBOT, model.geom_contype == _FLOOR
    kind = np.full((model.ngeom, model.ngeom), _NOTHING)
    for one, row in enumerate(kind):
        if robot[one]:
            counts = ~robot & (carried[one] | ~floor)
            row[counts] = BRUSH if brush[one] else BODY
            row[robot & (carried | carried[one])] = ITSELF
    return np.where(kind == _NOTHING, kind.T, kind)
