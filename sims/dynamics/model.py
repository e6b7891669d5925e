"""The MuJoCo model behind fidelity `dynamic`: a planar base and an arm, nothing else."""

from collections.abc import Sequence

import mujoco
import numpy as np

from sims.robots.inertia import link_inertias, torque_limits
from sims.robots.model import find, joints_to, link_frames
from sims.robots.servos import damping_of, velocity_servo
from sims.robots.urdf import compiled

# Of a joint that no velocity servo of the file drives: the time constant of ours on the joint's own inertia
# with all joints at 0 [s], and its force limit where the file sets none [N or N m].
_TIME_CONSTANT = 0.005
_FORCE = 1e4
# Share of a moment of inertia that is rounding.
_ROUNDING = 1e-9


def planar_model(model: mujoco.MjModel, site: str = "brush") -> mujoco.MjModel:
    """The chain to `site` of a robot's model: a body a link, a servo a joint, no geoms and no contacts.

    What rides on a link is part of it; joints beside the chain (wheels) are rigid, at zero. Positions are
    those of the robot's chain. Servo i pulls with ctrl - kp q - kv v: kv is that of the file's velocity servo
    on the joint, seen behind its gear, else it follows from the inertia; kp is 0. MJX wants few solver
    iterations; there is nothing to solve here, since nothing touches and the controllers mind the joints'
    ranges. Raises InputError.
    """
    joints = joints_to(model, int(model.site_bodyid[find(model, mujoco.mjtObj.mjOBJ_SITE, site)]))
    spec = _bare_spec(model)
    parent, T_world_parent = spec.worldbody, np.eye(4)
    frames, inertia = link_frames(model, joints), link_inertias(model, joints)
    for first, last in _groups(inertia):
        parent = _add_link(parent, np.linalg.inv(T_world_parent) @ frames[last], *inertia[last])
        for k in range(first, last + 1):
            _add_joint(parent, model, joints[k], np.linalg.inv(frames[last]) @ frames[k])
        T_world_parent = frames[last]
    for j in joints:
        _add_servo(spec, model.joint(j).name)
    planar = compiled(spec)
    _fill_servos(planar, model, joints)
    return planar


def _bare_spec(model: mujoco.MjModel) -> mujoco.MjSpec:
    spec = mujoco.MjSpec()
    spec.modelname = "planar"
    spec.compiler.degree = False
    option = spec.option
    option.gravity = model.opt.gravity
    option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    option.iterations, option.ls_iterations = 1, 1
    option.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    bits = mujoco.mjtDisableBit
    option.disableflags = int(bits.mjDSBL_CONSTRAINT) | int(bits.mjDSBL_CONTACT)
    return spec


def _groups(inertia: list[tuple[float, np.ndarray, np.ndarray]]) -> list[tuple[int, int]]:
    """First and last joint of each link, by their places: joints with nothing between share one."""
    groups, first = [], 0
    for k, (mass, _, _) in enumerate(inertia):
        if mass > 0 or k == len(inertia) - 1:
            groups.append((first, k))
            first = k + 1
    return groups


def _add_link(parent, T_parent: np.ndarray, mass: float, center: np.ndarray, tensor: np.ndarray):
    moments, axes = _principal(tensor)
    return parent.add_body(
        pos=T_parent[:3, 3],
        quat=_quaternion(T_parent[:3, :3]),
        mass=mass,
        ipos=center,
        iquat=_quaternion(axes),
        inertia=moments,
        explicitinertial=True,
    )


def _principal(tensor: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Principal moments, falling, and their axes as columns of a rotation.

    Of a flat body the largest is the sum of the others; rounding may lift it above, which MuJoCo refuses.
    """
    moments, axes = np.linalg.eigh(tensor)
    moments, axes = moments[::-1].copy(), axes[:, ::-1]
    excess = moments[0] - moments[1] - moments[2]
    if 0 < excess <= _ROUNDING * moments[0]:
        moments[0] = moments[1] + moments[2]
    return moments, axes * np.sign(np.linalg.det(axes))


def _quaternion(R: np.ndarray) -> np.ndarray:
    quat = np.zeros(4)
    mujoco.mju_mat2Quat(quat, R.reshape(-1))
    return quat


def _add_joint(body, model: mujoco.MjModel, joint: int, T_body_joint: np.ndarray) -> None:
    dof = int(model.jnt_dofadr[joint])
    body.add_joint(
        name=model.joint(joint).name,
        type=mujoco.mjtJoint(int(model.jnt_type[joint])),
        pos=T_body_joint[:3, 3],
        axis=T_body_joint[:3, 2],
        armature=model.dof_armature[dof],
        damping=model.dof_damping[dof],
    )


def _add_servo(spec: mujoco.MjSpec, joint: str) -> None:
    servo = spec.add_actuator(name=joint, target=joint)
    servo.trntype = mujoco.mjtTrn.mjTRN_JOINT
    servo.gaintype, servo.biastype = mujoco.mjtGain.mjGAIN_FIXED, mujoco.mjtBias.mjBIAS_AFFINE
    servo.forcelimited, servo.forcerange = 1, [-_FORCE, _FORCE]


def _fill_servos(planar: mujoco.MjModel, model: mujoco.MjModel, joints: Sequence[int]) -> None:
    data, full = mujoco.MjData(planar), np.zeros((planar.nv, planar.nv))
    mujoco.mj_forward(planar, data)
    mujoco.mj_fullM(planar, data, full)
    for i, (j, limit) in enumerate(zip(joints, torque_limits(model, joints), strict=True)):
        servo = velocity_servo(model, j)
        gain = full[i, i] / _TIME_CONSTANT if servo is None else damping_of(model, servo)
        planar.actuator_gainprm[i, 0] = 1
        planar.actuator_biasprm[i, :3] = 0, 0, -gain
        if np.isfinite(limit):
            planar.actuator_forcerange[i] = -limit, limit
