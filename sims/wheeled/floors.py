"""What the wheels of fidelity `wheeled` roll on: a plane, and what lies on it."""

import abc
import dataclasses
import math

import mujoco
import numpy as np

from jaxpaint.errors import InputError

# Steeper and the robot falls over, or its wheels spin [rad].
_STEEPEST = math.radians(20)


@dataclasses.dataclass(frozen=True)
class Floor(abc.ABC):
    """A floor in the map frame. Its geoms have these names; wheels are geoms of the kind `tread`."""

    @property
    def tread(self) -> mujoco.mjtGeom:
        """MJX has no contact of cylinders with anything but planes."""
        return mujoco.mjtGeom.mjGEOM_SPHERE

    @abc.abstractmethod
    def add(self, spec: mujoco.MjSpec, height: float) -> list[str]:
        """Puts the floor, with its plane at `height` [m], into a model; names of its geoms."""


@dataclasses.dataclass(frozen=True)
class Flat(Floor):
    """A level plane."""

    @property
    def tread(self) -> mujoco.mjtGeom:
        """Cylinders, which touch along a line and resist being turned on the spot."""
        return mujoco.mjtGeom.mjGEOM_CYLINDER

    def add(self, spec: mujoco.MjSpec, height: float) -> list[str]:
        """One plane."""
        return [_plane(spec, "floor", [0.0, 0.0, height], np.eye(3))]


@dataclasses.dataclass(frozen=True)
class Ramp(Floor):
    """A plane that rises beyond a line.

    start: a point of the line (x, y) [m]. yaw: the way up [rad]. slope [rad].
    """

    start: tuple[float, float] = (0.0, 1.0)
    yaw: float = math.pi / 2
    slope: float = math.radians(4)

    def __post_init__(self) -> None:
        if not 0 < self.slope <= _STEEPEST:
            raise InputError(
                f"ramp: a slope of {math.degrees(self.slope):g} degrees; "
                f"allowed: above 0, up to {math.degrees(_STEEPEST):g}"
            )

    def add(self, spec: mujoco.MjSpec, height: float) -> list[str]:
        """Two planes: what lies below either of them is ground."""
        R = _turn(self.yaw) @ _pitch(-self.slope)
        level = _plane(spec, "floor", [0.0, 0.0, height], np.eye(3))
        return [level, _plane(spec, "ramp", [*self.start, height], R)]


@dataclasses.dataclass(frozen=True)
class Bump(Floor):
    """A speed bump, a triangular prism; S2's at site 2' is 1 m by 0.35 m by 0.05 m.

    center: middle of its base (x, y) [m]. yaw: of its ridge [rad]. length: along the ridge, width: across,
    height [m].
    """

    center: tuple[float, float] = (0.0, 0.5)
    yaw: float = 0.0
    length: float = 1.0
    width: float = 0.35
    height: float = 0.05

    def __post_init__(self) -> None:
        sizes = (self.length, self.width, self.height)
        if not all(0 < size < math.inf for size in sizes) or self.height / (self.width / 2) > math.tan(
            _STEEPEST
        ):
            raise InputError(
                f"bump: length, width and height of {sizes} m; allowed: above 0, and sides up to "
                f"{math.degrees(_STEEPEST):g} degrees steep"
            )

    def add(self, spec: mujoco.MjSpec, height: float) -> list[str]:
        """A plane, and a mesh on it."""
        x, y = self.length / 2, self.width / 2
        corners = [[s * x, t * y, 0.0] for s in (-1, 1) for t in (-1, 1)]
        ridge = [[s * x, 0.0, self.height] for s in (-1, 1)]
        mesh = spec.add_mesh(name="bump", uservert=np.ravel(corners + ridge))
        mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX
        geom = spec.worldbody.add_geom(name="bump", type=mujoco.mjtGeom.mjGEOM_MESH, meshname="bump")
        geom.pos, geom.alt.euler = [*self.center, height], [0.0, 0.0, self.yaw]
        geom.contype = geom.conaffinity = 0
        return [_plane(spec, "floor", [0.0, 0.0, height], np.eye(3)), "bump"]


def _plane(spec: mujoco.MjSpec, name: str, place: list[float], R: np.ndarray) -> str:
    quat = np.zeros(4)
    mujoco.mju_mat2Quat(quat, R.reshape(-1))
    size, kind = [0.0, 0.0, 1.0], mujoco.mjtGeom.mjGEOM_PLANE
    spec.worldbody.add_geom(name=name, type=kind, size=size, pos=place, quat=quat, contype=0, conaffinity=0)
    return name


def _turn(yaw: float) -> np.ndarray:
    c, s = math.cos(yaw), math.sin(yaw)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def _pitch(angle: float) -> np.ndarray:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
