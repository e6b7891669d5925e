"""The MuJoCo model behind fidelity `dynamic`: a planar base and an arm, nothing else."""

from collections.abc import Sequence

import mujoco
import numpy as np

from sims.dynamics.links import add_links
from sims.robots.inertia import link_inertias, torque_limits
from sims.robots.model import find, joints_to, link_frames
from sims.robots.servos import damping_of, velocity_servo
from sims.robots.urdf import compiled

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
    ranges. Raises InputError.
    """
    joints = joints_to(model, int(model.site_bodyid[find(model, mujoco.mjtObj.mjOBJ_SITE, site)]))
    spec = bare_spec(model, "planar")
    frames, inertia = link_frames(model, joints), link_inertias(model, joints)
    add_links(spec.worldbody, np.eye(4), model, joints, frames, inertia)
    for j in joints:
        add_servo(spec, model.joint(j).name)
    planar = compiled(spec)
    fill_servos(planar, model, joints)
    return planar


def bare_spec(model: mujoco.MjModel, name: str) -> mujoco.MjSpec:
    """An empty model with the gravity of another, without constraints, integrated implicitly in speeds."""
    spec = mujoco.MjSpec()
    spec.modelname = name
    spec.compiler.degree = False
    option = spec.option
    option.gravity = model.opt.gravity
    option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    option.iterations, option.ls_iterations = 1, 1
    option.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    bits = mujoco.mjtDisableBit
    option.disableflags = int(bits.mjDSBL_CONSTRAINT) | int(bits.mjDSBL_CONTACT)
    return spec


def add_servo(spec: mujoco.MjSpec, joint: str) -> None:
    """An actuator whose force is its control and what its gains say."""
    servo = spec.add_actuator(name=joint, target=joint)
    servo.trntype = mujoco.mjtTrn.mjTRN_JOINT
    servo.gaintype, servo.biastype = mujoco.mjtGain.mjGAIN_FIXED, mujoco.mjtBias.mjBIAS_AFFINE
    servo.forcelimited, servo.forcerange = 1, [-_FORCE, _FORCE]


def fill_servos(made: mujoco.MjModel, model: mujoco.MjModel, joints: Sequence[int]) -> None:
    """Gains and limits of the servos of `made` as `model` has them: servo i is that of joints[i]."""
    data, full = mujoco.MjData(made), np.zeros((made.nv, made.nv))
    mujoco.mj_forward(made, data)
    mujoco.mj_fullM(made, data, full)
    for i, (j, limit) in enumerate(zip(joints, torque_limits(model, joints), strict=True)):
        servo, dof = velocity_servo(model, j), made.jnt_dofadr[made.actuator_trnid[i, 0]]
        gain = full[dof, dof] / _TIME_CONSTANT if servo is None else damping_of(model, servo)
        made.actuator_gainprm[i, 0] = 1
        made.actuator_biasprm[i, :3] = 0, 0, -gain
        if np.isfinite(limit):
            made.actuator_forcerange[i] = -limit, limit
