"""Where the robot should stand and look for what the brush will do."""

from jaxpaint.planning.area import OperatingArea, operating_area
from jaxpaint.planning.cameras import ViewSettings, camera_rotation
from jaxpaint.planning.profile import Profile, wall_profile
from jaxpaint.planning.reach import CameraArm
from jaxpaint.planning.set_cover import Cover, set_cover
from jaxpaint.planning.stations import StationSettings, plan_stations
from jaxpaint.planning.stretches import ReachWindow, serving_places
from jaxpaint.planning.surroundings import Surroundings, surroundings
from jaxpaint.planning.viewpoints import Viewpoints, plan_viewpoints

__all__ = [
    "CameraArm",
    "Cover",
    "OperatingArea",
    "Profile",
    "ReachWindow",
    "StationSettings",
    "Surroundings",
    "ViewSettings",
    "Viewpoints",
    "camera_rotation",
    "operating_area",
    "plan_stations",
    "plan_viewpoints",
    "serving_places",
    "set_cover",
    "surroundings",
    "wall_profile",
]
