"""Where the free camera stands that shows robot and canvas."""

import dataclasses

import numpy as np
from jaxtyping import Float

# The camera looks this far to the side of straight into the wall, and down [rad]: from straight behind, the
# robot would hide what it paints.
_ASIDE, _DOWN = np.radians(-24.0), np.radians(-24.0)
# Angle of view, upright [rad], and what is left at the rims.
FIELD, _RIM = np.radians(45.0), 1.05


@dataclasses.dataclass(frozen=True, eq=False)
class View:
    """MuJoCo's free camera. lookat, distance [m]; azimuth: heading in which it looks, elevation [rad]."""

    lookat: Float[np.ndarray, "3"]
    distance: float
    azimuth: float
    elevation: float

    @property
    def forward(self) -> Float[np.ndarray, "3"]:
        """Unit direction in which the camera looks."""
        flat = np.cos(self.elevation)
        return np.array([flat * np.cos(self.azimuth), flat * np.sin(self.azimuth), np.sin(self.elevation)])

    @property
    def position(self) -> Float[np.ndarray, "3"]:
        """Where the camera stands [m]."""
        return self.lookat - self.distance * self.forward


def view_of(points: Float[np.ndarray, "n 3"], yaw: float, aspect: float) -> View:
    """The nearest camera that sees all points, behind and above a robot whose wall has the heading `yaw`
    [rad]. aspect: width of the picture over its height.
    """
    towards = View(points.mean(axis=0), 0.0, float(yaw + _ASIDE), float(_DOWN))
    right = np.array([np.sin(towards.azimuth), -np.cos(towards.azimuth), 0.0])
    axes = np.stack([right, np.cross(right, towards.forward)])
    reach = np.tan(FIELD / 2) * np.array([aspect, 1.0]) / _RIM
    middle, distance = towards.lookat, 0.0
    for _ in range(20):  # what is nearer looks larger: the middle of the picture is none of the points
        aside, ahead = (points - middle) @ axes.T, (points - middle) @ towards.forward
        distance = float((np.abs(aside) / reach - ahead[:, None]).max())
        seen = aside / (distance + ahead)[:, None]
        middle = middle + 0.5 * distance * (seen.max(axis=0) + seen.min(axis=0)) / 2 @ axes
    return dataclasses.replace(towards, lookat=middle, distance=distance)
