"""Depth camera and lidar: what the robot sees of a scene."""

from sims.sensors.camera import Camera, back_project, pixel_rays
from sims.sensors.depth_noise import DepthNoise, observe
from sims.sensors.lidar import Lidar, scan
from sims.sensors.merge import crop_to_canvas, merge_views, thin
from sims.sensors.rgbd import RGBD, render

__all__ = [
    "RGBD",
    "Camera",
    "DepthNoise",
    "Lidar",
    "back_project",
    "crop_to_canvas",
    "merge_views",
    "observe",
    "pixel_rays",
    "render",
    "scan",
    "thin",
]
