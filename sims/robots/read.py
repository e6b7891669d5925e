"""A robot's file, MJCF or URDF, as one compiled MuJoCo model with the sites that jaxpaint looks for."""

import xml.etree.ElementTree as ET
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import mujoco
import numpy as np

from jaxpaint.errors import InputError
from sims.robots.urdf import compiled, one_line, urdf_spec

REFERENCE = Path(__file__).with_name("reference.xml")
BRUSH, CAMERA, LIDAR = "brush", "camera", "lidar"
_FINITE = (
    "body_pos",
    "body_quat",
    "body_ipos",
    "body_iquat",
    "body_mass",
    "body_inertia",
    "jnt_pos",
    "jnt_axis",
    "jnt_range",
    "jnt_actfrcrange",
    "dof_armature",
    "dof_damping",
    "geom_pos",
    "geom_quat",
    "geom_size",
    "site_pos",
    "site_quat",
    "actuator_ctrlrange",
    "actuator_forcerange",
    "actuator_gear",
    "actuator_gainprm",
    "actuator_biasprm",
    "key_qpos",
)


def robot_model(
    path: Path | str | None = None, *, brush_site: str = BRUSH, camera_site: str = CAMERA
) -> mujoco.MjModel:
    """The compiled model of an MJCF or URDF file, by default the reference robot's.

    brush_site, camera_site: names of a site, or of a body or link whose frame is meant; in the model they are
    the sites `brush` and `camera`. Raises InputError.
    """
    return _read(path, {BRUSH: brush_site, CAMERA: camera_site, LIDAR: LIDAR})[1]


def robot_spec(path: Path | str | None = None, *, brush_site: str = BRUSH) -> mujoco.MjSpec:
    """The same before it is compiled, to change something in it; of the sites only the brush is named."""
    return _read(path, {BRUSH: brush_site})[0]


def _read(path: Path | str | None, sites: dict[str, str]) -> tuple[mujoco.MjSpec, mujoco.MjModel]:
    path = REFERENCE if path is None else Path(path)
    try:
        with _no_log():
            spec = _spec(path, sites[BRUSH])
            for site, name in sites.items():
                _name_site(spec, site, name)
            return spec, _checked(spec)
    except InputError as error:
        raise InputError(f"robot {path}: {error}") from error


@contextmanager
def _no_log() -> Iterator[None]:
    """Keeps MuJoCo's MUJOCO_LOG.TXT out of the working folder: what is wrong is said in our errors."""
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(lambda message: None)
    try:
        yield
    finally:
        mujoco.set_mju_user_warning(before)


def _spec(path: Path, brush: str) -> mujoco.MjSpec:
    if not path.is_file():
        raise InputError("no such file; expected an MJCF (.xml) or a URDF (.urdf)")
    if path.suffix.lower() == ".urdf" or _is_urdf(path):
        return urdf_spec(path, brush)
    try:
        return mujoco.MjSpec.from_file(str(path))
    except ValueError as error:
        raise InputError(f"not an MJCF that MuJoCo reads: {one_line(error)}") from error


def _checked(spec: mujoco.MjSpec) -> mujoco.MjModel:
    """The compiled model, without what MuJoCo lets pass: keyframes of the wrong size, and NaN."""
    sizes = {key.name: len(key.qpos) for key in spec.keys}
    model = compiled(spec)
    for name, size in sizes.items():
        if size not in (0, model.nq):
            raise InputError(f"keyframe '{name}' has {size} numbers in qpos; allowed: {model.nq}")
    for field in _FINITE:
        if not np.isfinite(getattr(model, field)).all():
            raise InputError(f"a number of {field.replace('_', ' ')} is not finite (nan or inf)")
    return model


def _is_urdf(path: Path) -> bool:
    try:
        return next(ET.iterparse(path, events=("start",)))[1].tag == "robot"
    except (ET.ParseError, StopIteration, UnicodeDecodeError):
        return False
    # MuJoCo would take any encoding, and read a URDF without what is added to one here.
    except (LookupError, ValueError) as error:
        raise InputError(f"not XML: {one_line(error)}") from error


def _name_site(spec: mujoco.MjSpec, site: str, name: str) -> None:
    """Makes `site` of the site `name`, or else puts it into the frame of the body of that name."""
    given = next((s for s in spec.sites if s.name == name), None)
    if given is not None and name == site:
        return
    body = next((b for b in spec.bodies if b.name == name), None)
    if given is None and body is None:
        if name != site:
            sites = ", ".join(x.name for x in [*spec.sites, *spec.bodies[1:]] if x.name)
            raise InputError(f"no site or link named '{name}' for the {site}; there are {sites}")
        return
    for other in [s for s in spec.sites if s.name == site]:
        other.name = f"{site}_of_the_file"
    if given is not None:
        given.name = site
    elif body is not None:
        body.add_site(name=site)
