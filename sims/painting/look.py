"""A look as the robot moves: scans, depth and strokes as they truly are correct what the robot believes."""

import dataclasses

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, PRNGKeyArray

from jaxpaint.kinematics.chain import KinematicChain, forward
from jaxpaint.kinematics.pose import Pose
from jaxpaint.localisation import (
    Belief,
    Evidence,
    ScanSettings,
    StrokeSettings,
    correct,
    match_plane,
    match_scan,
    match_stroke,
    no_evidence,
    predict,
)
from opt.controller import Surface
from sims.odometry import displacement
from sims.painting.job import Job
from sims.painting.marks import Marks, in_view, with_mark
from sims.sensors import scan
from sims.sensors.patch import see_pixels
from sims.truth import true_brush, true_camera, true_lidar
from sims.worlds import World

# Pixels of the depth picture that are looked at, as x / z and y / z: from its middle down towards the brush,
# which itself is below the picture.
_COLUMNS, _ROWS = (-0.45, -0.15, 0.15, 0.45), (0.05, 0.2, 0.35, 0.5)
# Noise of a stroke's edge in the picture [m]: less than a pixel where the wall is an arm's width away.
_EDGE = 3e-4


def look(
    job: Job,
    world: World,
    marks: Marks,
    surface: Surface | None,
    clock: Float[Array, ""],
    *,
    key: PRNGKeyArray,
) -> tuple[World, Marks]:
    """The world with a corrected belief, and the marks with one more.

    surface: what the plan knows of the wall before the brush; without it only the lidar looks. clock: of the
    plan [s].
    """
    keys = jax.random.split(key, 3)
    motion = displacement(world.anchor, world.odometry)
    belief = predict(world.belief, motion, world.steered, job.sight.drift)
    sight = job.sight
    evidence = _weighed(_scanned(job, world, belief, keys[0]), sight.lidar)
    if surface is not None:
        wall = _wall_before_the_brush(job, world, belief, surface, keys[1])
        evidence = evidence + _weighed(wall, sight.depth * surface.known)
        evidence = evidence + _weighed(_strokes(job, world, belief, marks, clock, keys[2]), sight.strokes)
    belief = correct(belief, evidence)
    looked = dataclasses.replace(
        world, belief=belief, anchor=world.odometry, steered=jnp.zeros_like(world.steered)
    )
    return looked, marks if surface is None else _marked(job, looked, marks, surface, clock)


def _scanned(job: Job, world: World, belief: Belief, key: PRNGKeyArray) -> Evidence:
    """What a scan from where the base truly is says."""
    mount, lidar = job.robot.T_base_lidar, job.sight.scanner
    heading = jnp.arctan2(mount.R[1, 0], mount.R[0, 0])
    ranges, valid = scan(job.scene, lidar, true_lidar(job.robot, world.base, world.tilt), key=key)
    at = jnp.stack([mount.p[0], mount.p[1], heading])
    return match_scan(job.sight.outline, belief.pose, at, ranges, valid, lidar.bearings, _scans())


def _scans() -> ScanSettings:
    """Looks from one place share what the map is wrong by: as many as a stop between two strokes has."""
    return ScanSettings(looks=10.0)


def _wall_before_the_brush(job: Job, world: World, belief: Belief, surface: Surface, key) -> Evidence:
    """What the depth camera says of the wall beside the brush."""
    chain = job.robot.camera_chain
    true = true_camera(job.robot, job.calibration, world.base, world.tilt, world.arm)
    depth, valid = see_pixels(job.scene, job.sight.camera, job.noise.depth, true, _rays(), key=key)
    points = _in_map(_placed(chain, belief.pose, world.arm), depth[:, None] * _rays())
    return match_plane(points, valid, belief.pose[:2], surface.point, surface.normal)


def _strokes(job: Job, world: World, belief: Belief, marks: Marks, clock, key) -> Evidence:
    """What the strokes in view say."""
    chain = job.robot.camera_chain
    true = true_camera(job.robot, job.calibration, world.base, world.tilt, world.arm)
    local, valid = in_view(marks, true, clock)
    local = local + _EDGE * jax.random.normal(key, local.shape, local.dtype)
    seen = _in_map(_placed(chain, belief.pose, world.arm), local)
    number = jnp.maximum(valid.sum(), 1)
    variance = jnp.where(valid, marks.variance, 0.0).sum() / number
    known = StrokeSettings()
    settings = eqx.tree_at(lambda s: s.laid_sigma, known, jnp.sqrt(known.laid_sigma**2 + variance))
    return match_stroke(seen, marks.laid, marks.along, marks.normal, valid, belief.pose[:2], settings)


def _marked(job: Job, world: World, marks: Marks, surface: Surface, clock) -> Marks:
    """The marks with the brush's present one."""
    true = true_brush(job.robot.chain, job.calibration, world.base, world.tilt, world.arm).p
    believed = _placed(job.robot.chain, world.belief.pose, world.arm).p
    variance = (world.belief.covariance[0, 0] + world.belief.covariance[1, 1]) / 2
    return with_mark(marks, true, believed, surface, variance, clock)


def _placed(chain: KinematicChain, base: Float[Array, "3"], arm: Float[Array, " arm"]) -> Pose:
    return forward(chain, jnp.concatenate([base, arm]))


def _in_map(T_map_camera: Pose, points: Float[Array, "n 3"]) -> Float[Array, "n 3"]:
    return T_map_camera.p + (T_map_camera.R[None] * points[:, None, :]).sum(-1)


def _rays() -> Float[Array, "n 3"]:
    """Directions of the pixels in the camera frame, z = 1."""
    x, y = np.meshgrid(_COLUMNS, _ROWS)
    return jnp.asarray(np.stack([x.ravel(), y.ravel(), np.ones(x.size)], axis=1), float)


def _weighed(evidence: Evidence, weight: Float[Array, ""]) -> Evidence:
    """All of the evidence, or none."""
    nothing = no_evidence(evidence.residual.dtype)
    return jax.tree.map(lambda a, b: jnp.where(weight > 0, a, b), evidence, nothing)
