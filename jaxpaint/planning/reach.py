"""Which camera poses an arm reaches from which base poses, clear of everything and of the robot itself."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from jaxpaint.compiling import batched
from jaxpaint.kinematics.chain import KinematicChain, arm_chain
from jaxpaint.kinematics.ik import solve, spread_starts
from jaxpaint.kinematics.pose import Pose
from jaxpaint.kinematics.spheres import Spheres, sphere_centers
from jaxpaint.planning.postures import solve_apart
from jaxpaint.planning.surroundings import Surroundings
from jaxpaint.trajectories.own_clearance import own_gap_at

# Pairs solved at once: one size, compiled once.
_BLOCK = 512
# Starts of the inverse kinematics: fewer than for one pose, as a view has several stops to be reached from.
_STARTS = 4
# Gap that a posture keeps from everything: twice the lidar's noise [m].
_GAP = 0.02
# The base may stand this far further off than it was meant to, and the camera is reached still [m].
_OFF = 0.09


class CameraArm(eqx.Module):
    """A robot as far as its camera is concerned.

    chain: from the map to the camera, base joints (x, y, yaw) first. home, lower, upper: of the arm's joints
    [rad]. brush: place of the brush at home in the base frame (x, y) [m]. spheres: the body and the
    brush. footprint: the
    base's corners in its frame [m]. lidar: height of its beams [m].
    """

    chain: KinematicChain
    home: Float[Array, " arm"]
    lower: Float[Array, " arm"]
    upper: Float[Array, " arm"]
    brush: Float[Array, "2"]
    spheres: Spheres
    footprint: Float[Array, "corners 2"]
    lidar: Float[Array, ""]

    @property
    def shoulder(self) -> Float[np.ndarray, "3"]:
        """Where the arm's first joint is in the base frame [m]."""
        return np.asarray(self.chain.p_offset[self.base_size], float)

    @property
    def length(self) -> float:
        """No point of the camera is further from the shoulder [m]."""
        links = np.linalg.norm(np.asarray(self.chain.p_offset[self.base_size + 1 :], float), axis=1)
        return float(links.sum() + np.linalg.norm(np.asarray(self.chain.p_tool, float)))

    @property
    def base_size(self) -> int:
        """How many joints are the base's."""
        return self.chain.size - self.home.shape[0]


def near_pairs(
    arm: CameraArm, place: Float[np.ndarray, "cameras 3"], bases: Float[np.ndarray, "bases 3"], most: int
) -> tuple[Int[np.ndarray, " pairs"], Int[np.ndarray, " pairs"]]:
    """Cameras and bases worth an attempt: within the arm's length, up to `most` bases a camera.

    Those come first from which the camera is where the brush is at home, as far as the shoulder is concerned.
    """
    c, s = np.cos(bases[:, 2]), np.sin(bases[:, 2])
    x, y, z = arm.shoulder
    shoulder = np.stack(
        [bases[:, 0] + c * x - s * y, bases[:, 1] + s * x + c * y, np.full(len(bases), z)], axis=1
    )
    away = np.linalg.norm(place[:, None] - shoulder, axis=-1)
    usual = np.linalg.norm(np.asarray(arm.brush, float) - arm.shoulder[:2])
    rank = np.where(away < arm.length, np.abs(away - usual), np.inf)
    order = np.argsort(rank, axis=1, kind="stable")[:, :most]
    kept = np.isfinite(np.take_along_axis(rank, order, axis=1))
    camera = np.broadcast_to(np.arange(len(place))[:, None], order.shape)
    return camera[kept], order[kept]


def reach(
    arm: CameraArm,
    place: Float[np.ndarray, "pairs 3"],
    rotation: Float[np.ndarray, "pairs 3 3"],
    base: Float[np.ndarray, "pairs 3"],
    around: Surroundings,
) -> tuple[Float[np.ndarray, "pairs arm"], Bool[np.ndarray, " pairs"]]:
    """The arm's joints that put the camera there [rad], and whether they do without touching anything."""
    joints, good = [np.zeros((0, arm.home.shape[0]))], [np.zeros(0, bool)]
    for first in range(0, len(place), _BLOCK):
        part = [_filled(x[first : first + _BLOCK]) for x in (place, rotation, base)]
        q, converged, body = (np.asarray(x) for x in _REACH(arm, *part))
        number = min(_BLOCK, len(place) - first)
        ok = converged[:number].copy()
        gap = around.gap(body[:number][ok].astype(float)) - np.asarray(arm.spheres.radius, float)
        ok[ok] = gap.min(axis=1, initial=np.inf) >= _GAP
        joints.append(q[:number])
        good.append(ok)
    return np.concatenate(joints), np.concatenate(good)


def _one(arm: CameraArm, place, rotation, base):
    starts = spread_starts(arm.home, arm.lower, arm.upper, count=_STARTS)
    target = Pose(place, rotation)

    def own(q):
        rows = [jnp.concatenate([base, joints]) for joints in (arm.home, q)]
        return own_gap_at(arm.chain, arm.spheres, *rows)

    found, apart = solve_apart(arm_chain(arm.chain, base), starts, target, arm.lower, arm.upper, own)
    away = base[:2] - place[:2]
    off = base.at[:2].add(_OFF * away / jnp.sqrt((away * away).sum() + 1e-6))
    further = solve(arm_chain(arm.chain, off), found.q[None], target, arm.lower, arm.upper)
    body = sphere_centers(arm.chain, arm.spheres, jnp.concatenate([base, found.q]))
    return found.q, found.converged & further.converged & apart, body


_REACH = batched(_one, in_axes=(None, 0, 0, 0))


def _filled(rows: np.ndarray) -> np.ndarray:
    """A whole block, with copies of the last row; in the robot's precision."""
    missing = _BLOCK - len(rows)
    return np.concatenate([rows, rows[-1:].repeat(missing, axis=0)]).astype(jnp.zeros(0).dtype)
