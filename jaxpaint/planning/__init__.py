"""Where the robot should stand and look for what the brush will do."""

from jaxpaint.planning.profile import Profile, wall_profile
from jaxpaint.planning.stations import StationSettings, plan_stations
from jaxpaint.planning.viewpoints import Viewpoints, ViewpointSettings, plan_viewpoints

__all__ = [
    "Profile",
    "StationSettings",
    "ViewpointSettings",
    "Viewpoints",
    "plan_stations",
    "plan_viewpoints",
    "wall_profile",
]
