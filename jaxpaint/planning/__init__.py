"""Where the robot should stand and look for what the brush will do."""

from jaxpaint.planning.stations import StationSettings, plan_stations
from jaxpaint.planning.viewpoints import Viewpoints, ViewpointSettings, plan_viewpoints

__all__ = ["StationSettings", "ViewpointSettings", "Viewpoints", "plan_stations", "plan_viewpoints"]
