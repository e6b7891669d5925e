"""A robot of a URDF file as a MuJoCo specification.

What a URDF cannot say is added: planar base joints, sites, velocity servos. Its fixed links stay bodies.
"""

import xml.etree.ElementTree as ET
from pathlib import Path

import mujoco
import numpy as np

from jaxpaint.errors import InputError
from sims.robots.meshes import resolve_meshes
from sims.robots.urdf_joints import check_joints

BASE_JOINTS = ("base_x", "base_y", "base_yaw")
_PLANAR = ("_TX", "_TY", "_RZ")  # what MuJoCo makes of a planar joint
# Of an added servo on the joint's own inertia: arm, base [s].
_TIME_CONSTANT, _BASE_TIME_CONSTANT = 0.01, 0.03
_BASE_SPEED = (0.5, 0.5, 1.0)  # [m/s, m/s, rad/s]
# A URDF does not tell the inertia of rotors and gears at the joint; without, light wrists chatter [kg m^2].
_ARMATURE = 0.1
# A dummy link between two joints has no mass; MuJoCo wants some [kg, kg m^2].
_LEAST_MASS, _LEAST_INERTIA = 1e-3, 1e-6


def urdf_spec(path: Path, brush: str) -> mujoco.MjSpec:
    """The specification of a URDF file whose brush is the link of that name. Raises InputError."""
    root = _parsed(path)
    _check_tree(root)
    check_joints(root, brush, BASE_JOINTS)
    resolve_meshes(root, path)
    for text in root.iter("mujoco"):
        text.clear()  # paths are absolute by now, and what else it says is for other programs
    try:
        spec = mujoco.MjSpec.from_string(ET.tostring(root, encoding="unicode"))
    except ValueError as error:
        raise InputError(f"not a URDF that MuJoCo reads: {one_line(error)}") from error
    spec.compiler.fusestatic = False
    spec.compiler.discardvisual = False  # it would take what collides with nothing for a picture
    spec.compiler.boundmass, spec.compiler.boundinertia = _LEAST_MASS, _LEAST_INERTIA
    _add_base(spec)
    for body in spec.bodies[1:]:
        body.gravcomp = 1.0  # as the arm's own controller does
    for geom in spec.geoms:
        geom.contype = geom.conaffinity = 0
    for joint in spec.joints:
        if joint.name not in BASE_JOINTS:
            joint.armature = _ARMATURE
    _add_servos(spec, dict(zip(BASE_JOINTS, _BASE_SPEED, strict=True)) | _speeds(root))
    return spec


def _parsed(path: Path) -> ET.Element:
    try:
        root = ET.parse(path).getroot()
    # LookupError and ValueError: encodings that nobody knows, or that the parser cannot do.
    except (ET.ParseError, LookupError, ValueError) as error:
        raise InputError(f"not XML: {one_line(error)}") from error
    if root.tag != "robot":
        raise InputError(f"the outermost element is <{root.tag}>; a URDF's is <robot>")
    if any("xacro" in element.tag for element in root.iter()):
        raise InputError("has xacro elements; expand them first: xacro FILE > FILE.urdf")
    return root


def _check_tree(root: ET.Element) -> None:
    """One root, known links, masses that are numbers above zero."""
    links = [link.get("name", "") for link in root.findall("link")]
    children = []
    for joint in root.findall("joint"):
        ends = [getattr(joint.find(end), "attrib", {}).get("link", "") for end in ("parent", "child")]
        unknown = [end for end in ends if end not in links]
        if unknown:
            raise InputError(f"joint '{joint.get('name')}' names link '{unknown[0]}', which there is not")
        children.append(ends[1])
    roots = [link for link in links if link not in children]
    if len(roots) != 1:
        raise InputError(f"{len(roots)} root links ({', '.join(roots) or 'a loop'}); allowed: one")
    for link in root.findall("link"):
        _check_inertia(link)


def _check_inertia(link: ET.Element) -> None:
    inertial = link.find("inertial")
    if inertial is None:
        return
    found = {
        **getattr(inertial.find("mass"), "attrib", {}),
        **getattr(inertial.find("inertia"), "attrib", {}),
    }
    for name in ("value", "ixx", "iyy", "izz"):
        try:
            good = 0 < float(found.get(name, "")) < np.inf
        except ValueError:
            good = False
        if not good:
            what = "mass" if name == "value" else name
            raise InputError(
                f"link '{link.get('name')}' has {what} '{found.get(name, '')}'; allowed: a number above 0, "
                "or no <inertial> at all"
            )


def _add_base(spec: mujoco.MjSpec) -> None:
    """Planar joints for the root link, unless the file has them; its lowest point is put on the floor."""
    names = [joint.name for joint in spec.joints]
    if any(name in names for name in BASE_JOINTS):
        return
    tops = list(spec.worldbody.bodies)
    if len(tops) != 1:
        found = ", ".join(body.name for body in tops) or "none"
        raise InputError(f"links on the fixed world: {found}; allowed: one, the mobile base")
    base = tops[0]
    planar = [joint for joint in base.joints if joint.name.endswith(_PLANAR)]
    for joint in base.joints:
        if joint.type == mujoco.mjtJoint.mjJNT_FREE:
            raise InputError(
                f"link '{base.name}' hangs on a floating joint; allowed: none (planar base joints are "
                "added), or a planar one"
            )
    if len(planar) == len(BASE_JOINTS):
        for joint, name in zip(planar, BASE_JOINTS, strict=True):
            joint.name = name
        return
    if base.joints:
        raise InputError(
            f"joint '{base.joints[0].name}' is between the world and link '{base.name}'; allowed: a fixed "
            f"joint, a planar one, or {', '.join(BASE_JOINTS)}"
        )
    slide, hinge = mujoco.mjtJoint.mjJNT_SLIDE, mujoco.mjtJoint.mjJNT_HINGE
    for name, kind, axis in zip(BASE_JOINTS, (slide, slide, hinge), np.eye(3), strict=True):
        base.add_joint(name=name, type=kind, axis=axis)
    base.pos = base.pos + np.array([0.0, 0.0, _depth_below_floor(spec)])


def _depth_below_floor(spec: mujoco.MjSpec) -> float:
    """How far the robot's lowest geom reaches below z = 0 at rest [m], 0 where none does."""
    model = compiled(spec.copy())
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    lowest = 0.0
    for g in range(model.ngeom):
        middle = data.geom_xpos[g] + data.geom_xmat[g].reshape(3, 3) @ model.geom_aabb[g, :3]
        lowest = min(lowest, middle[2] - np.abs(data.geom_xmat[g].reshape(3, 3)[2]) @ model.geom_aabb[g, 3:])
    return -float(lowest)


def _speeds(root: ET.Element) -> dict[str, float]:
    """<limit velocity> of each joint that has one [rad/s or m/s]."""
    found = {}
    for joint in root.findall("joint"):
        limit = joint.find("limit")
        if limit is not None and limit.get("velocity") is not None:
            try:
                found[joint.get("name", "")] = float(limit.get("velocity", ""))
            except ValueError as error:
                raise InputError(
                    f"joint '{joint.get('name')}' has velocity '{limit.get('velocity')}'"
                ) from error
    return found


def _add_servos(spec: mujoco.MjSpec, speeds: dict[str, float]) -> None:
    """A velocity servo on every joint that has a speed limit, as strong as its effort limit."""
    model = compiled(spec.copy())
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    mass = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    for joint in spec.joints:
        if joint.name not in speeds:
            continue
        if not 0 < speeds[joint.name] < np.inf:
            raise InputError(f"joint '{joint.name}' has velocity {speeds[joint.name]:g}; allowed: above 0")
        dof = model.joint(joint.name).dofadr[0]
        servo = spec.add_actuator(name=joint.name, target=joint.name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
        constant = _BASE_TIME_CONSTANT if joint.name in BASE_JOINTS else _TIME_CONSTANT
        servo.set_to_velocity(kv=float(mass[dof, dof]) / constant)
        servo.ctrlrange = [-speeds[joint.name], speeds[joint.name]]
        servo.ctrllimited = mujoco.mjtLimited.mjLIMITED_TRUE
        if joint.actfrcrange[0] < joint.actfrcrange[1]:
            servo.forcerange, servo.forcelimited = joint.actfrcrange, mujoco.mjtLimited.mjLIMITED_TRUE


def compiled(spec: mujoco.MjSpec) -> mujoco.MjModel:
    """The model of a specification. Raises InputError with what MuJoCo says."""
    try:
        return spec.compile()
    except ValueError as error:
        raise InputError(f"MuJoCo does not compile it: {one_line(error)}") from error


def one_line(error: Exception) -> str:
    """What MuJoCo says, without its line breaks: the first line alone would not name the element."""
    return " ".join(str(error).split()).removeprefix("Error: ")
