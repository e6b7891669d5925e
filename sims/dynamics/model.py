"""The MuJoCo model behind fidelity `dynamic`: a planar base and an arm, nothing else."""

from collections.abc import Sequence

import mujoco
import numpy as np

from jaxpaint.kinematics import Inertia
from sims.robots.inertia import inertia_from_model, torque_limits
from sims.robots.model import find, joints_to, link_frames
from sims.robots.servos import damping_of, velocity_servo

# Of a joint that no velocity servo of the file drives: the time constant of ours on the joint's own inertia
# with all joints at 0 [s], and its force limit where the file sets none [N or N m].
_TIME_CONSTANT = 0.005
_FORCE = 1e4


def planar_model(model: mujoco.MjModel, site: str = "brush") -> mujoco.MjModel:
    """The chain to `site` of a robot's model: a body a link, a servo a joint, no geoms and no contacts.

    What rides on a link is part of it; joints beside the chain (wheels) are rigid, at zero. Positions are
    those of the robot's chain. Servo i pulls with ctrl - kp q - kv v: kv is that of the file's velocity servo
    on the joint, seen behind its gear, else it follows from the inertia; kp is 0. MJX wants few solver
    iterations; there is nothing to solve here, since nothing touches and the controllers mind the joints'
    ranges.
    """
    joints = joints_to(model, int(model.site_bodyid[find(model, mujoco.mjtObj.mjOBJ_SITE, site)]))
    spec = _bare_spec(model)
    parent, T_world_parent = spec.worldbody, np.eye(4)
    frames, inertia = link_frames(model, joints), inertia_from_model(model, joints)
    for first, last in _groups(model, joints):
        parent = _add_link(parent, np.linalg.inv(T_world_parent) @ frames[last], inertia, last)
        for k in range(first, last + 1):
            _add_joint(parent, model, joints[k], np.linalg.inv(frames[last]) @ frames[k])
        T_world_parent = frames[last]
    for j in joints:
        _add_servo(spec, model.joint(j).name)
    planar = spec.compile()
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


def _groups(model: mujoco.MjModel, joints: Sequence[int]) -> list[tuple[int, int]]:
    """Places among `joints` of the first and the last of each link: joints with nothing between share one."""
    inertia = inertia_from_model(model, joints)
    groups, first = [], 0
    for k in range(len(joints)):
        if float(inertia.mass[k]) > 0 or k == len(joints) - 1:
            groups.append((first, k))
            first = k + 1
    return groups


def _add_link(parent, T_parent: np.ndarray, inertia: Inertia, k: int):
    quat = np.zeros(4)
    mujoco.mju_mat2Quat(quat, T_parent[:3, :3].reshape(-1))
    i = np.asarray(inertia.tensor[k], float)
    return parent.add_body(
        pos=T_parent[:3, 3],
        quat=quat,
        mass=float(inertia.mass[k]),
        ipos=np.asarray(inertia.center[k], float),
        fullinertia=[i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2]],
        explicitinertial=True,
    )


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
