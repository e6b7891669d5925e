"""Rigid bodies on a tree of hinges and slides: what MJX computes before contacts, in fewer operations.

MJX goes through a model body by body, and each becomes dozens of small operations: half of a step's, and most
of the time that it takes to compile. Here all joints of one depth are done at once, and sums along the tree
are one addition a joint. Conventions are MuJoCo's: spatial vectors are (angular, linear), about the center of
mass of all.
"""

from typing import NamedTuple

import jax.numpy as jnp
import mujoco
import numpy as np
from jaxtyping import Array, Float

from jaxpaint.kinematics.rotations import cross

_HINGE, _FREE = int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_FREE)


class Masses(NamedTuple):
    """Of each body: mass [kg], center in its frame [m], principal moments about it [kg m^2]."""

    mass: Float[Array, " bodies"]
    center: Float[Array, "bodies 3"]
    inertia: Float[Array, "bodies 3"]


class Placed(NamedTuple):
    """Where all is, in the world. R, p: of the frames behind each joint, the root's first. screw: motion of
    each degree of freedom, MuJoCo's cdof. spatial: inertia of each body, as (moments and products xx, yy, zz,
    xy, xz, yz; mass times lever; mass), about `com`. com: of all bodies [m].
    """

    R: Float[Array, "links 3 3"]
    p: Float[Array, "links 3"]
    screw: Float[Array, "dofs 6"]
    spatial: Float[Array, "bodies 10"]
    com: Float[Array, "3"]


class Tree:
    """The structure of a MuJoCo model whose joints are hinges and slides, on the world or on one free body.

    A link is what moves behind one joint, so that a body with two joints is two links. Link 0 is the world,
    or the free body.
    """

    def __init__(self, model: mujoco.MjModel):
        self.free = bool(model.njnt) and int(model.jnt_type[0]) == _FREE
        first = int(self.free)
        joints = np.arange(first, model.njnt)
        self.size = len(joints)
        self.hinge = model.jnt_type[joints] == _HINGE
        self._axis = np.array(model.jnt_axis[joints])
        self._place = np.array(model.jnt_pos[joints])
        last = {1 if self.free else 0: 0}  # of each body: its last link
        self.parent, self._fixed_p, self._fixed_R = [], [], []
        for link, j in enumerate(joints, start=1):
            body = int(model.jnt_bodyid[j])
            begins = body not in last
            self.parent.append(last[int(model.body_parentid[body])] if begins else last[body])
            self._fixed_p.append(model.body_pos[body] if begins else np.zeros(3))
            self._fixed_R.append(_matrix(model.body_quat[body]) if begins else np.eye(3))
            last[body] = link
        self.link = np.array([last[b] for b in range(1, model.nbody)])
        self._body_of = {link: b for b, link in enumerate(self.link)}
        self._principal = np.stack([_matrix(q) for q in model.body_iquat[1:]])
        self._depth = [0]
        for parent in self.parent:
            self._depth.append(self._depth[parent] + 1)

    def place(self, masses: Masses, root: tuple[Array, Array], q: Float[Array, " joints"]) -> Placed:
        """root: R and p of link 0."""
        R, p, anchor, axis = self._links(root, q)
        R_body, p_body = R[self.link], p[self.link]
        lever = p_body + (R_body * masses.center[:, None, :]).sum(-1)
        com = (masses.mass[:, None] * lever).sum(0) / masses.mass.sum()
        spatial = _spatial(masses, R_body, lever - com[None], self._principal)
        return Placed(R, p, self._screws(R[0], p[0], anchor, axis, com), spatial, com)

    def composite(self, spatial: Float[Array, "bodies 10"]) -> Float[Array, "links 10"]:
        """What each link carries: sums over all bodies beyond it."""
        zero = jnp.zeros_like(spatial[0])
        rows = [spatial[self._body_of[k]] if k in self._body_of else zero for k in range(self.size + 1)]
        for k in range(self.size, 0, -1):
            rows[self.parent[k - 1]] = rows[self.parent[k - 1]] + rows[k]
        return jnp.stack(rows)

    def inertia(
        self, placed: Placed, composite: Float[Array, "links 10"], armature: Float[Array, " dofs"]
    ) -> Float[Array, "dofs dofs"]:
        """The joint-space inertia, as mj_fullM. armature: added to its diagonal."""
        force = moved(composite[self._link_of_dof], placed.screw)
        lower = jnp.where(self._above, (placed.screw[None] * force[:, None]).sum(-1), 0)
        diagonal = jnp.eye(len(armature), dtype=armature.dtype)
        return lower + lower.T * (1 - diagonal) + diagonal * armature[:, None]

    def bias(
        self, placed: Placed, v: Float[Array, " dofs"], gravity: Float[Array, "3"]
    ) -> Float[Array, " dofs"]:
        """Forces that centrifugal and Coriolis effects and the weight ask for, as qfrc_bias."""
        steps = placed.screw * v[:, None]
        before, behind = self._along(steps)
        turning = _motion_cross(before, placed.screw) * v[:, None]
        acceleration = self._along(turning)[1] - jnp.concatenate([jnp.zeros_like(gravity), gravity])[None]
        spatial, speed = placed.spatial, behind[self.link]
        force = moved(spatial, acceleration[self.link]) + _force_cross(speed, moved(spatial, speed))
        return (placed.screw * self.composite(force)[self._link_of_dof]).sum(-1)

    def weight(
        self, placed: Placed, composite: Float[Array, "links 10"], gravity: Float[Array, "3"]
    ) -> Float[Array, " dofs"]:
        """Forces and torques that hold up what each degree of freedom carries where it is [N, N m]."""
        up = jnp.concatenate([jnp.zeros_like(gravity), -gravity])
        return (placed.screw * moved(composite, up[None])[self._link_of_dof]).sum(-1)

    def weight_of(
        self,
        masses: Masses,
        root: tuple[Float[Array, "3 3"], Float[Array, "3"]],
        q: Float[Array, " joints"],
        gravity: Float[Array, "3"],
    ) -> Float[Array, " dofs"]:
        """The same of other masses."""
        placed = self.place(masses, root, q)
        return self.weight(placed, self.composite(placed.spatial), gravity)

    def bodies(self, placed: Placed) -> tuple[Float[Array, "bodies 3 3"], Float[Array, "bodies 3"]]:
        """Rotations and positions of the bodies' frames."""
        return placed.R[self.link], placed.p[self.link]

    @property
    def dofs(self) -> int:
        """Degrees of freedom: six of a free body, then the joints'."""
        return self.size + 6 * self.free

    @property
    def _link_of_dof(self) -> np.ndarray:
        return np.concatenate([np.zeros(6 * self.free, int), np.arange(1, self.size + 1)])

    @property
    def _above(self) -> np.ndarray:
        """Whether dof j (column) carries dof i (row), or is it."""
        ancestors = np.eye(self.size + 1, dtype=bool)
        for k, parent in enumerate(self.parent, start=1):
            ancestors[k] |= ancestors[parent]
        links = self._link_of_dof
        mine = ancestors[np.ix_(links, links)]
        if self.free:
            mine[:6, :6] = np.tri(6, dtype=bool)
        return mine

    def _links(self, root: tuple[Array, Array], q):
        """R, p of all links; anchors and axes of joints; depth by depth."""
        dtype = q.dtype
        fixed_R, fixed_p, place, axis = (
            np.asarray(x, dtype) for x in (self._fixed_R, self._fixed_p, self._place, self._axis)
        )
        turn = _turns(axis, jnp.where(self.hinge, q, 0))
        slide = axis * jnp.where(self.hinge, 0, q)[:, None]
        R: list = [root[0]] + [None] * self.size
        p: list = [root[1]] + [None] * self.size
        anchors: list = [None] * self.size
        axes: list = [None] * self.size
        for depth in range(1, max(self._depth) + 1):
            here = np.array([k for k in range(1, self.size + 1) if self._depth[k] == depth])
            j = here - 1
            R_parent = jnp.stack([R[self.parent[k]] for k in j])
            p_parent = jnp.stack([p[self.parent[k]] for k in j])
            R_fixed = _products(R_parent, fixed_R[j])
            at = p_parent + _applied(R_parent, fixed_p[j]) + _applied(R_fixed, place[j] + slide[j])
            R_link = _products(R_fixed, turn[j])
            behind, along = at - _applied(R_link, place[j]), _applied(R_fixed, axis[j])
            for row, k in enumerate(j):
                R[k + 1], p[k + 1], anchors[k], axes[k] = R_link[row], behind[row], at[row], along[row]
        return jnp.stack(R), jnp.stack(p), jnp.stack(anchors), jnp.stack(axes)

    def _screws(self, R_root, p_root, anchor, axis, com):
        hinge, none = self.hinge[:, None], jnp.zeros_like(axis)
        lever = cross(axis, com[None] - anchor)
        joints = jnp.concatenate([jnp.where(hinge, axis, none), jnp.where(hinge, lever, axis)], axis=1)
        if not self.free:
            return joints
        zero, one = jnp.zeros_like(R_root), jnp.eye(3, dtype=com.dtype)
        axes = R_root.T
        turns = jnp.concatenate([axes, cross(axes, (com - p_root)[None] + zero)], axis=1)
        return jnp.concatenate([jnp.concatenate([zero, one], axis=1), turns, joints])

    def _along(self, steps: Float[Array, "dofs 6"]):
        """Sums from the root to each degree of freedom, without it, and to each link, with it.

        Of a free body's turns MuJoCo counts the three as one joint: before each of them come its slides.
        """
        first = 6 * self.free
        slides, turns = steps[:3].sum(0), steps[3:first].sum(0)
        root = slides + turns if self.free else jnp.zeros_like(steps[0])
        behind, before = [root], []
        for k, parent in enumerate(self.parent):
            before.append(behind[parent])
            behind.append(behind[parent] + steps[first + k])
        free = [jnp.zeros_like(slides)] * 3 + [slides] * 3 if self.free else []
        return jnp.stack([*free, *before]), jnp.stack(behind)


def moved(spatial: Float[Array, "n 10"], motion: Float[Array, "n 6"]) -> Float[Array, "n 6"]:
    """Spatial inertia times motion: angular and linear momentum, or moment and force."""
    turn, slide = motion[:, :3], motion[:, 3:]
    x, y, z = turn[:, :1], turn[:, 1:2], turn[:, 2:]
    xx, yy, zz, xy, xz, yz = (spatial[:, k : k + 1] for k in range(6))
    lever, mass = spatial[:, 6:9], spatial[:, 9:]
    own = jnp.concatenate(
        [xx * x + xy * y + xz * z, xy * x + yy * y + yz * z, xz * x + yz * y + zz * z], axis=1
    )
    return jnp.concatenate(
        [
            own + cross(lever, slide),
            mass * slide - cross(lever, turn),
        ],
        axis=1,
    )


def _spatial(masses: Masses, R_body, lever, principal: np.ndarray) -> Float[Array, "bodies 10"]:
    R = _products(R_body, np.asarray(principal, lever.dtype))
    own = R * masses.inertia[:, None, :]
    rows = [(own[:, a] * R[:, b]).sum(-1) for a, b in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
    x, y, z = lever[:, 0], lever[:, 1], lever[:, 2]
    shift = [y * y + z * z, x * x + z * z, x * x + y * y, -x * y, -x * z, -y * z]
    m = masses.mass
    return jnp.stack([r + m * s for r, s in zip(rows, shift, strict=True)] + [m * x, m * y, m * z, m], axis=1)


def _motion_cross(u, v):
    turn, slide = u[:, :3], u[:, 3:]
    first = cross(turn, v[:, :3])
    return jnp.concatenate([first, cross(turn, v[:, 3:]) + cross(slide, v[:, :3])], axis=1)


def _force_cross(v, f):
    turn, slide = v[:, :3], v[:, 3:]
    return jnp.concatenate([cross(turn, f[:, :3]) + cross(slide, f[:, 3:]), cross(turn, f[:, 3:])], axis=1)


def _turns(axis: np.ndarray, angle: Float[Array, " n"]):
    """Rotations about fixed axes (Rodrigues)."""
    skew = np.zeros((len(axis), 3, 3), axis.dtype)
    for (i, j, k), sign in (((0, 1, 2), -1), ((0, 2, 1), 1), ((1, 2, 0), -1)):
        skew[:, i, j], skew[:, j, i] = sign * axis[:, k], -sign * axis[:, k]
    s, c = jnp.sin(angle)[:, None, None], jnp.cos(angle)[:, None, None]
    return np.eye(3, dtype=axis.dtype)[None] + s * skew + (1 - c) * (skew @ skew)


def _products(A, B):
    """A B of stacked matrices, written out."""
    return A[:, :, :1] * B[:, :1] + A[:, :, 1:2] * B[:, 1:2] + A[:, :, 2:] * B[:, 2:]


def _applied(R, v):
    """R v of stacked matrices and vectors."""
    return R[:, :, 0] * v[:, :1] + R[:, :, 1] * v[:, 1:2] + R[:, :, 2] * v[:, 2:]


def _matrix(quat: np.ndarray) -> np.ndarray:
    R = np.zeros(9)
    mujoco.mju_quat2Mat(R, quat)
    return R.reshape(3, 3)
