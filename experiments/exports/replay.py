"""A planned trajectory replayed in MuJoCo: does a robot with position servos paint where the plan says?

python -m experiments.exports.replay runs/paint-1/trajectory.csv [ROBOT] [--brush-site NAME]
"""

import argparse
import dataclasses
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

import mujoco
import numpy as np
from jaxtyping import Bool, Float

from experiments.exports.table import read_table
from jaxpaint.errors import InputError
from sims.robots.read import BRUSH, REFERENCE, robot_spec

if TYPE_CHECKING:
    from sims.painting.joint_plan import JointTrajectory

# Simulation step [s], and how stiff the servos are: natural frequency [rad/s], critically damped. They carry
# the links' weight: softer ones sag by millimetres, as they have no integral part.
STEP = 0.002
STIFFNESS = 200.0


@dataclasses.dataclass(frozen=True, eq=False)
class Replay:
    """The brush at every simulation step, map frame [m]: where the plan has it and where it was."""

    time: Float[np.ndarray, " t"]
    planned: Float[np.ndarray, "t 3"]
    reached: Float[np.ndarray, "t 3"]
    pen: Bool[np.ndarray, " t"]

    @property
    def error(self) -> Float[np.ndarray, " down"]:
        """Distances from the plan while the pen is down [m]."""
        return np.linalg.norm(self.reached - self.planned, axis=1)[self.pen]


def replay(plan: "JointTrajectory", robot: Path | None = None, brush_site: str = BRUSH) -> Replay:
    """Simulates the robot of an MJCF or URDF with a position servo on every planned joint, gravity on.

    Nothing but the servos holds the weight, whatever the model's `gravcomp` says. They are told position and
    velocity, as a joint trajectory controller tells them, and are bound to the forces of the actuators that
    they replace. Raises InputError for a robot without the plan's joints or without the brush.
    """
    model = servo_model(plan.names, robot, brush_site)
    data, ghost = mujoco.MjData(model), mujoco.MjData(model)
    place = np.array([model.joint(name).qposadr[0] for name in plan.names])
    dof = np.array([model.joint(name).dofadr[0] for name in plan.names])
    brush = model.site(BRUSH).id
    data.qpos[place] = plan.position[0]
    lead = model.actuator_gainprm[:, 0], -model.actuator_biasprm[:, 2]
    time = np.arange(plan.time[0], plan.time[-1], STEP)
    position, velocity = _between(plan, time)
    planned, reached = np.zeros((2, len(time), 3))
    data.qvel[dof] = velocity[0]
    for k in range(len(time)):
        mujoco.mj_kinematics(model, data)
        ghost.qpos[:] = data.qpos
        ghost.qpos[place] = position[k]
        mujoco.mj_kinematics(model, ghost)
        planned[k], reached[k] = ghost.site_xpos[brush], data.site_xpos[brush]
        # A servo pulls with kp (control - q) - kv q': this control makes it kp (p - q) + kv (v - q').
        data.ctrl[:] = position[k] + lead[1] / lead[0] * velocity[k]
        mujoco.mj_step(model, data)
    pen = plan.pen[np.searchsorted(plan.time, time, side="right") - 1]
    return Replay(time, planned, reached, pen)


def servo_model(names: Sequence[str], robot: Path | None = None, brush_site: str = BRUSH) -> mujoco.MjModel:
    """The robot's model with a position servo on each of the joints `names` in place of its own actuators,
    and with nothing else that holds its weight.
    """
    spec = robot_spec(robot, brush_site=brush_site)
    own = spec.compile()
    shown = robot or REFERENCE.name
    missing = [name for name in names if mujoco.mj_name2id(own, mujoco.mjtObj.mjOBJ_JOINT, name) < 0]
    if missing:
        raise InputError(f"robot {shown}: found no joint {missing[0]!r}, allowed: the plan's robot")
    if mujoco.mj_name2id(own, mujoco.mjtObj.mjOBJ_SITE, BRUSH) < 0:
        raise InputError(f"robot {shown}: found no site {BRUSH!r}, allowed: the name by --brush-site")
    inertia, forces = _inertia(own), _force_ranges(own)
    for actuator in list(spec.actuators):
        spec.delete(actuator)
    for body in spec.bodies:
        body.gravcomp = 0
    for name in names:
        mass = inertia[own.joint(name).dofadr[0]]
        servo = spec.add_actuator(name=name, target=name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
        servo.set_to_position(kp=mass * STIFFNESS**2, kv=2 * mass * STIFFNESS)
        if name in forces:
            servo.forcerange, servo.forcelimited = forces[name], True
    spec.option.timestep = STEP
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    return spec.compile()


def _inertia(model: mujoco.MjModel) -> np.ndarray:
    """What each joint feels when it alone moves, at home."""
    data = mujoco.MjData(model)
    if model.nkey:
        mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    full = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, full)
    return np.diag(full)


def _force_ranges(model: mujoco.MjModel) -> dict[str, np.ndarray]:
    """The force limits of the joints that have an actuator with some."""
    return {
        model.joint(model.actuator_trnid[a, 0]).name: model.actuator_forcerange[a]
        for a in range(model.nu)
        if model.actuator_trntype[a] == int(mujoco.mjtTrn.mjTRN_JOINT) and model.actuator_forcelimited[a]
    }


def _between(plan: "JointTrajectory", time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Positions and velocities at any time, as a joint trajectory controller fills them in: by quintics."""
    from scipy.interpolate import BPoly

    derivatives = np.stack([plan.position, plan.velocity, plan.acceleration], axis=1)
    curve = BPoly.from_derivatives(plan.time, derivatives)
    return curve(time), curve.derivative()(time)


class _Parser(argparse.ArgumentParser):
    """Bad usage is an InputError."""

    def error(self, message: str) -> NoReturn:
        raise InputError(f"{message}; usage: {self.format_usage().removeprefix('usage: ')}")


def main(words: Sequence[str]) -> int:
    """Replays a file and prints the error; bad input is one line and exit status 2."""
    parser = _Parser(
        prog="python -m experiments.exports.replay",
        description="Replays a planned trajectory in MuJoCo and prints how far the brush is off the plan.",
        allow_abbrev=False,
    )
    parser.add_argument("trajectory", type=Path, help="a trajectory.csv of 'jaxpaint paint --export csv'")
    parser.add_argument("robot", type=Path, nargs="?", help="its MJCF or URDF (the reference robot)")
    parser.add_argument("--brush-site", default=BRUSH, metavar="NAME", help="as in the run (brush)")
    try:
        given = parser.parse_args(words)
        error = replay(read_table(given.trajectory), given.robot, given.brush_site).error * 1e3
        if not len(error):
            raise InputError(f"{given.trajectory}: found no sample with the pen down, allowed: one or more")
    except InputError as wrong:
        print(f"replay: {' '.join(str(wrong).split())}", file=sys.stderr)
        return 2
    print(f"brush off the plan, pen down: mean {error.mean():.3f} mm, largest {error.max():.3f} mm")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
