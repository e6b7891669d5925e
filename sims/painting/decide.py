"""Which controller moves the robot: the adaptive control policy's decision (S1 section IV), or the user's."""

from typing import Literal

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from jaxpaint.compiling import one_by_one
from jaxpaint.decisions.modes import decide
from jaxpaint.kinematics.rotations import frame_from_axis
from jaxpaint.mapping.mapped import Cause
from jaxpaint.mapping.timeline import BrushPath
from sims.painting.job import Job

Chooser = Literal["acp", "whole-body", "trajectory"]


def waypoint_mode(job: Job) -> Float[Array, ""]:
    """1 if the viewpoints look like a path, 0 if they are independent waypoints; the same in all worlds."""
    every = jnp.ones(job.camera_place.shape[:1], bool)
    return decide(job.camera_place, job.camera_rotation, every, job.thresholds).whole_body


def path_mode(job: Job, path: BrushPath) -> Float[Array, ""]:
    """1 if the mapped strokes look like a path."""
    rotation = jax.vmap(frame_from_axis, in_axes=(0, None))(-path.normal, path.u_axis)
    return decide(path.p_map, rotation, path.status == Cause.HIT, job.thresholds).whole_body


_PATH = one_by_one(path_mode, in_axes=(None, 0))


def choose_for_scan(controller: Chooser, job: Job, worlds: int) -> Bool[np.ndarray, " worlds"]:
    """Whether the whole-body controller goes through the viewpoints."""
    if controller != "acp":
        return np.full(worlds, controller == "whole-body")
    return np.full(worlds, bool(jax.jit(waypoint_mode)(job) > 0.5))


def choose_for_strokes(controller: Chooser, job: Job, path: BrushPath) -> Bool[np.ndarray, " worlds"]:
    """Whether the whole-body controller follows the strokes, world by world."""
    if controller != "acp":
        return np.full(path.end.shape[0], controller == "whole-body")
    return np.asarray(_PATH(job, path)) > 0.5
