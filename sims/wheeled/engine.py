"""MJX with contacts: a robot on its wheels as a function from its state to the next."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
from jaxtyping import Array, Float

from jaxpaint.kinematics.rotations import cross, rotation_from_quaternion
from sims.dynamics.quiet import mjx
from sims.dynamics.servos import Load, floats_as, masses_of, servos, with_links
from sims.dynamics.tree import Placed, Tree
from sims.robots.model import matrix
from sims.wheeled.attitude import integrated
from sims.wheeled.contacts import Contacts, touching
from sims.wheeled.model import GIVING, STIFFER
from sims.wheeled.newton import accelerations
from sims.wheeled.parameters import WheeledPhysics

# What makes a model, besides its `WheeledPhysics`.
_FIXED = (
    "body_parentid",
    "body_pos",
    "body_quat",
    "body_iquat",
    "body_invweight0",
    "jnt_bodyid",
    "jnt_type",
    "jnt_pos",
    "jnt_axis",
    "geom_type",
    "geom_size",
    "geom_pos",
    "geom_quat",
    "geom_bodyid",
    "pair_geom1",
    "pair_geom2",
    "mesh_vert",
)


class Motion(NamedTuple):
    """Position and speed of the free joint and of all others as MuJoCo has them, and the last acceleration,
    from which the next step's contact forces are sought.
    """

    q: Float[Array, " nq"]
    v: Float[Array, " nv"]
    a: Float[Array, " nv"]


class WheeledEngine:
    """A `wheeled_model` in MJX, fixed when programs are compiled: its structure, and numbers that
    `WheeledPhysics` has not. Two engines of equal models are equal, so a program is not compiled twice.
    """

    def __init__(self, rolling: mujoco.MjModel):
        self.rolling = rolling
        self.model = mjx.put_model(rolling, impl="jax")
        self.data = mjx.make_data(rolling, impl="jax")
        self.tree = Tree(rolling)
        self._moving = np.flatnonzero(rolling.geom_bodyid > 0)
        self._carrier = np.array(rolling.geom_bodyid[self._moving]) - 1
        self.wheel, self._sign, self._mobility = self._pairs(rolling)
        self._R_geom = np.stack([matrix(np.zeros(3), quat)[:3, :3] for quat in rolling.geom_quat])
        self._content = tuple(np.asarray(getattr(rolling, name)).tobytes() for name in _FIXED)

    def __eq__(self, other) -> bool:
        return isinstance(other, WheeledEngine) and self._content == other._content

    def __hash__(self) -> int:
        return hash(self._content)

    def _pairs(self, rolling: mujoco.MjModel) -> tuple[tuple[int, ...], np.ndarray, np.ndarray]:
        """Of each of MJX's contacts: its wheel, whether its normal points to the wheel (1) or away (-1), and
        the wheel's body_invweight0 [1/kg].
        """
        found = jax.jit(lambda data: mjx.collision(self.model, data)._impl.contact.geom)
        pairs = np.asarray(found(self.data))
        carrier = np.asarray(rolling.geom_bodyid)[pairs]
        sign = np.where(carrier[:, 1] > 0, 1.0, -1.0)
        body = carrier.max(axis=1)
        order = {int(b): k for k, b in enumerate(np.unique(body))}
        return tuple(order[int(b)] for b in body), sign, rolling.body_invweight0[body, 0]

    def advance(
        self,
        model: mjx.Model,
        now: Motion,
        ctrl: Float[Array, " joints"],
        balanced: Float[Array, " joints"],
        told: Load | None = None,
    ) -> Motion:
        """The robot after one physics step; `model` by `with_physics`. Servos as in `sims.dynamics.Engine`;
        what weight they balance is computed as if the base stood level, since nothing tells the arm.

        Damping acts like inertia for a step, which is `implicitfast`, but the contacts' solver knows it too:
        MuJoCo's own integrator adds it after the contacts, and then stiff drives slip where nothing pulls.
        """
        tree, h, gravity = self.tree, model.opt.timestep, model.opt.gravity
        root = rotation_from_quaternion(now.q[3:7]), now.q[:3]
        placed = tree.place(masses_of(model), root, now.q[7:])
        carried = tree.composite(placed.spatial)
        if told is None:
            weight = tree.weight(placed, carried, gravity[2] * root[0][:, 2])
        else:
            weight = tree.weight_of(told.masses, root, now.q[7:], told.gravity[2] * root[0][:, 2])
        pulled = servos(model, now.q[7:], now.v[6:], ctrl + balanced * weight[6:])
        free = jnp.zeros(6, now.q.dtype)
        implicit = model.dof_armature + h * jnp.concatenate([free, pulled.damping])
        inertia = tree.inertia(placed, carried, implicit)
        force = jnp.concatenate([free, pulled.force]) - model.dof_damping * now.v
        force = force - tree.bias(placed, now.v, gravity)
        touches = self._contacts(model, now, placed)
        a = accelerations(inertia, force, touches, self.wheel, now.a)
        v = now.v + h * a
        q = jnp.concatenate([integrated(now.q[:7], v[:6], h), now.q[7:] + h * v[6:]])
        return Motion(q, v, a)

    def _contacts(self, model: mjx.Model, now: Motion, placed: Placed) -> Contacts:
        found = self._collided(model, now, placed)._impl.contact
        columns = np.array([[0, 1, 2, 3, 4, 5, 6 + 2 * k, 7 + 2 * k] for k in self.wheel])
        screw = placed.screw[columns]
        lever = (found.pos - placed.com[None])[:, None, :] + jnp.zeros_like(screw[..., 3:])
        moves = screw[..., 3:] + cross(screw[..., :3], lever)  # of the contact's point on the wheel
        rows = (found.frame[:, :, None, :] * moves[:, None, :, :]).sum(-1)
        jacobian = self._sign[:, None, None].astype(rows.dtype) * rows
        speed = (jacobian * now.v[columns][:, None, :]).sum(-1)
        return touching(
            found.dist,
            jacobian,
            speed,
            mobility=jnp.asarray(self._mobility, rows.dtype),
            friction=model.pair_friction[0, 0],
            tyre=jnp.maximum(model.pair_solref[0, 0], 2 * model.opt.timestep),
            grip=-model.pair_solreffriction[0, 1],
            giving=GIVING,
            stiffer=STIFFER,
        )

    def _collided(self, model: mjx.Model, now: Motion, placed: Placed) -> mjx.Data:
        """MJX's data with the contacts of its own collision functions."""
        R, p = self.tree.bodies(placed)
        R_geom, p_geom = R[self._carrier], p[self._carrier]
        moving = p_geom + (R_geom * model.geom_pos[self._moving][:, None, :]).sum(-1)
        turned = (R_geom[:, :, :, None] * self._R_geom[self._moving].astype(R.dtype)[:, None]).sum(2)
        data = floats_as(self.data, now.q.dtype).replace(
            qpos=now.q,
            qvel=now.v,
            geom_xpos=model.geom_pos.at[self._moving].set(moving),
            geom_xmat=jnp.asarray(self._R_geom, R.dtype).at[self._moving].set(turned),
        )
        return mjx.collision(model, data)

    def with_physics(self, physics: WheeledPhysics, timestep: Float[Array, ""]) -> mjx.Model:
        """The model with these parameters, in their dtype. timestep [s]."""
        p = physics
        model = with_links(self.model, p, p.position_gain, timestep)
        zero, one = jnp.zeros_like(p.tyre), jnp.ones_like(p.tyre)
        pairs = jnp.ones((model.npair, 1), timestep.dtype)
        sliding = jnp.stack([p.friction, p.friction, zero, zero, zero])
        return model.tree_replace(
            {
                "pair_friction": pairs * sliding,
                "pair_solref": pairs * jnp.stack([p.tyre, one]),
                "pair_solreffriction": pairs * jnp.stack([zero, -p.grip]),
            }
        )  # type: ignore[return-value]
