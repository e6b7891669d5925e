"""The MuJoCo model behind fidelity `wheeled`: a free base on steered, driven wheels, and an arm."""

from collections.abc import Sequence
from typing import NamedTuple

import mujoco
import numpy as np

from jaxpaint.errors import InputError
from sims.dynamics.links import Carried, add_link, add_links
from sims.dynamics.model import add_servo, bare_spec, fill_servos
from sims.robots.inertia import link_inertias
from sims.robots.model import body_frames, find, floor_frame, joints_to, link_frames, matrix, names_of
from sims.robots.urdf import compiled
from sims.robots.wheels import STEER, WHEEL
from sims.wheeled.floors import Flat, Floor

# Newton's method needs few iterations from the last step's forces; each one's line search likewise.
_ITERATIONS, _LINE_SEARCH = 4, 4
# Sliding friction counts so much stiffer than the normal forces [-].
STIFFER = 10.0
# Share of a load that a tyre gives way to at once, and the rest with the time constant of `WheeledPhysics`:
# hard, and wheels that are turned on the spot hop, as the solver lifts what slides.
GIVING = 0.5
# The base's yaw axis passes the base's origin as near as this [m].
_BESIDE = 1e-3


class WheelJoints(NamedTuple):
    """Joints of the wheels: as many of each."""

    steer: tuple[int, ...]
    drive: tuple[int, ...]


def wheeled_model(
    model: mujoco.MjModel, floor: Floor | None = None, *, height: float = 0.0, site: str = "brush"
) -> mujoco.MjModel:
    """The robot's model with a free base on its wheels; nothing touches but treads and floor.

    Degrees of freedom: six of the base, then steering axis and axle of one wheel after the other, then the
    arm. Each of these has a servo that pulls with ctrl - kp q - kv v, of gains as in `planar_model`. height:
    of the floor's plane over where the treads' lowest points are [m]. Raises InputError for a robot whose
    wheels are not steered.
    """
    arm = joints_to(model, int(model.site_bodyid[find(model, mujoco.mjtObj.mjOBJ_SITE, site)]))
    wheels, floor = wheel_joints(model), floor or Flat()
    arm, yaw = arm[3:], arm[2]
    driven = [j for pair in zip(*wheels, strict=True) for j in pair]
    joints = [yaw, *driven, *arm]
    frames, carried = link_frames(model, joints), link_inertias(model, joints)
    T_base = _base_frame(model, yaw, frames[0])
    spec = bare_spec(model, "wheeled")
    _solver(spec)
    base = _add_base(spec, T_base, frames[0], carried[0])
    for k in range(len(wheels.steer)):
        part = slice(1 + 2 * k, 3 + 2 * k)
        wheel = add_links(base, T_base, model, joints[part], frames[part], carried[part])
        _add_tread(wheel, model, wheels.drive[k], floor.tread)
    part = slice(1 + len(driven), None)
    add_links(base, T_base, model, arm, frames[part], carried[part])
    lowest = min(frames[2 + 2 * k][2, 3] - tread_size(model, j)[0] for k, j in enumerate(wheels.drive))
    _touch(spec, floor.add(spec, lowest + height), [tread_name(model, j) for j in wheels.drive])
    for j in [*driven, *arm]:
        add_servo(spec, model.joint(j).name)
    rolling = compiled(spec)
    fill_servos(rolling, model, [*driven, *arm])
    return rolling


def wheel_joints(model: mujoco.MjModel) -> WheelJoints:
    """The joints `steer_NAME` and `wheel_NAME` of all wheels. Raises InputError where there are none."""
    names = names_of(model, mujoco.mjtObj.mjOBJ_JOINT)
    wheels = [name.removeprefix(WHEEL) for name in names if name.startswith(WHEEL)]
    if len(wheels) < 3 or any(STEER + name not in names for name in wheels):
        raise InputError(
            f"wheels {', '.join(wheels) or 'none'}; allowed with fidelity wheeled: three or more, each with "
            f"the joints {STEER}NAME and {WHEEL}NAME"
        )
    found = (
        [find(model, mujoco.mjtObj.mjOBJ_JOINT, kind + name) for name in wheels] for kind in (STEER, WHEEL)
    )
    return WheelJoints(*(tuple(joints) for joints in found))


def tread_name(model: mujoco.MjModel, drive: int) -> str:
    """Of the geom that touches the floor."""
    return f"tread_{model.joint(drive).name.removeprefix(WHEEL)}"


def tread_size(model: mujoco.MjModel, drive: int) -> tuple[float, float]:
    """Radius and half width of a wheel [m]: of the geom on its body that is largest across the axle."""
    T_world_axle = link_frames(model, [drive])[0]
    bodies = body_frames(model)
    body, sizes = int(model.jnt_bodyid[drive]), []
    for g in range(model.body_geomadr[body], model.body_geomadr[body] + model.body_geomnum[body]):
        R = T_world_axle[:3, :3].T @ (bodies[body] @ matrix(model.geom_pos[g], model.geom_quat[g]))[:3, :3]
        half = np.abs(R) @ model.geom_aabb[g, 3:]
        sizes.append((float(min(half[0], half[1])), float(half[2])))
    if not sizes:
        raise InputError(
            f"joint '{model.joint(drive).name}' has no geom on its body; allowed with fidelity wheeled: one "
            "that says how large the wheel is"
        )
    return max(sizes)


def _base_frame(model: mujoco.MjModel, yaw: int, T_world_yaw: np.ndarray) -> np.ndarray:
    T = floor_frame(model, yaw)
    if np.abs(T_world_yaw[:2, 3]).max() > _BESIDE:
        raise InputError(
            f"joint '{model.joint(yaw).name}' turns about {T_world_yaw[:2, 3].round(3).tolist()} m; allowed "
            "with fidelity wheeled: about the map's origin where all joints are 0"
        )
    T[:3, :3], T[:2, 3] = np.eye(3), 0.0
    return T


def _add_base(spec: mujoco.MjSpec, T_base: np.ndarray, T_yaw: np.ndarray, carried: Carried):
    mass, center, tensor = carried
    T = np.linalg.inv(T_base) @ T_yaw
    R = T[:3, :3]
    body = add_link(spec.worldbody, T_base, mass, R @ center + T[:3, 3], R @ tensor @ R.T)
    body.name = "base"
    body.add_freejoint(name="base")
    return body


def _add_tread(body, model: mujoco.MjModel, drive: int, kind: mujoco.mjtGeom) -> None:
    radius, half = tread_size(model, drive)
    name, size = tread_name(model, drive), [radius, half, 0.0]
    body.add_geom(name=name, type=kind, size=size, mass=0, contype=0, conaffinity=0)


def _touch(spec: mujoco.MjSpec, floor: Sequence[str], treads: Sequence[str]) -> None:
    """Friction, stiffness and damping are filled in by `WheeledPhysics`."""
    for tread in treads:
        for ground in floor:
            pair = spec.add_pair(name=f"{tread} {ground}", geomname1=ground, geomname2=tread)
            pair.condim = 3
            pair.solimp = [GIVING, GIVING, 0.001, 0.5, 2]


def _solver(spec: mujoco.MjSpec) -> None:
    option, bits = spec.option, mujoco.mjtDisableBit
    option.disableflags = int(bits.mjDSBL_EULERDAMP)
    option.integrator = mujoco.mjtIntegrator.mjINT_EULER
    option.solver, option.cone = mujoco.mjtSolver.mjSOL_NEWTON, mujoco.mjtCone.mjCONE_ELLIPTIC
    option.iterations, option.ls_iterations = _ITERATIONS, _LINE_SEARCH
    option.impratio = STIFFER
