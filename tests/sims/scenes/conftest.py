"""A wall captured by a sensor of our own making, whose truth is known."""

from dataclasses import dataclass

import numpy as np
import pytest

from jaxpaint.clouds import Cloud
from sims.scenes import captured

SPACING = 0.008
NOISE = 0.002


@dataclass(frozen=True)
class Capture:
    """The cloud, and noise-free points and normals of the same wall in the capture's axes."""

    cloud: Cloud
    points: np.ndarray
    normals: np.ndarray


def _bend(u, v):
    """Depth of a gently bent wall, and its slopes: 12 mm up and down over 1.5 m."""
    k = 2 * np.pi / 1.5
    return 0.012 * np.cos(k * u) * np.sin(k * v), np.stack(
        [-0.012 * k * np.sin(k * u) * np.sin(k * v), 0.012 * k * np.cos(k * u) * np.cos(k * v)], axis=-1
    )


def _to_camera(points):
    """From (depth, right, up) to a camera 2 m in front, turned by 15 degrees: x right, y down, z forward."""
    cos, sin = np.cos(np.deg2rad(15)), np.sin(np.deg2rad(15))
    depth, right, up = points[:, 0], points[:, 1], points[:, 2]
    return np.stack([cos * right + sin * depth, -up, cos * depth - sin * right], axis=1)


@pytest.fixture(scope="session")
def capture():
    """A wall 1.8 x 1.6 m with a round hole, and a box 0.3 m wide that stands 0.35 m in front of it."""
    generator = np.random.default_rng(11)
    right, up = (
        axis.ravel() for axis in np.meshgrid(np.arange(-0.9, 0.9, SPACING), np.arange(0, 1.6, SPACING))
    )
    depth, slopes = _bend(right, up)
    hole = np.hypot(right - 0.5, up - 1.2) < 0.12
    hidden = (np.abs(right + 0.6) < 0.17) & (np.abs(up - 0.4) < 0.17)
    shown = ~hole & ~hidden
    wall = np.stack([depth, right, up], axis=1)[shown]
    normals = np.stack([-np.ones_like(depth), slopes[:, 0], slopes[:, 1]], axis=1)[shown]
    on_box = (np.abs(right + 0.6) < 0.15) & (np.abs(up - 0.4) < 0.15)
    box = np.stack([np.full(on_box.sum(), -0.35), right[on_box], up[on_box]], axis=1)
    seen = np.concatenate([wall, box])
    seen = seen + np.array([NOISE, 0, 0]) * generator.normal(size=(len(seen), 1))
    offset = np.array([2.0, 0, 0])
    cloud = Cloud(_to_camera(seen + offset), None, 0, None, "capture", np.zeros(3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return Capture(cloud, _to_camera(wall + offset), _to_camera(normals))


@pytest.fixture(scope="session")
def captured_wall(capture):
    """The capture as a wall, with the canvas that the program chooses."""
    return captured(capture.cloud, up="-y", canvas_size=(0.6, 0.5))
