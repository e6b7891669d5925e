"""A planar model as a function from joints and servo commands to joints.

What MuJoCo computes, in few operations: `mjx.Model` carries the parameters, `Tree` does what MJX would do.
"""

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
from jaxtyping import Array, Float

from sims.dynamics.parameters import Physics
from sims.dynamics.quiet import mjx
from sims.dynamics.servos import Load, masses_of, servos, with_links
from sims.dynamics.tree import Tree

# What makes a chain, besides its `Physics`.
_FIXED = (
    "body_parentid",
    "body_pos",
    "body_quat",
    "body_iquat",
    "jnt_bodyid",
    "jnt_type",
    "jnt_pos",
    "jnt_axis",
)


class Engine:
    """A planar model, fixed when programs are compiled: its structure, and numbers that `Physics` has
    not (frames, axes). Two engines of equal models are equal, so a program is not compiled twice.
    """

    def __init__(self, planar: mujoco.MjModel):
        self.model = mjx.put_model(planar, impl="jax")
        self.tree = Tree(planar)
        self._content = tuple(np.asarray(getattr(planar, name)).tobytes() for name in _FIXED)

    def __eq__(self, other) -> bool:
        return isinstance(other, Engine) and self._content == other._content

    def __hash__(self) -> int:
        return hash(self._content)

    def advance(
        self,
        model: mjx.Model,
        q: Float[Array, " joints"],
        v: Float[Array, " joints"],
        ctrl: Float[Array, " joints"],
        balanced: Float[Array, ""],
        told: Load | None = None,
    ) -> tuple[Float[Array, " joints"], Float[Array, " joints"]]:
        """Joints after one physics step; `model` by `with_physics`.

        As MuJoCo's integrator `implicitfast`. balanced: share of the weight that motors are told to hold
        besides `ctrl`. told: what that weight is computed of for the arm, where it is not the truth. Their
        limits hold for all that motors are told, so one that is too weak lets its load sink.
        """
        tree, h, masses = self.tree, model.opt.timestep, masses_of(model)
        root = jnp.eye(3, dtype=q.dtype), jnp.zeros(3, q.dtype)
        placed = tree.place(masses, root, q)
        carried = tree.composite(placed.spatial)
        weight = tree.weight(placed, carried, model.opt.gravity)
        if told is not None:
            arm = tree.weight_of(told.masses, root, q, told.gravity)[3:]
            weight = jnp.concatenate([weight[:3], arm])  # wheels hold the base on whatever slope
        pulled = servos(model, q, v, ctrl + balanced * weight)
        # Implicit in the speeds: what damps acts like inertia for a step, and one factorisation serves all.
        inertia = tree.inertia(placed, carried, model.dof_armature + h * pulled.damping)
        force = pulled.force - model.dof_damping * v - tree.bias(placed, v, model.opt.gravity)
        v = v + h * jax.scipy.linalg.cho_solve(jax.scipy.linalg.cho_factor(inertia), force)
        return q + h * v, v

    def with_physics(self, physics: Physics, timestep: Float[Array, ""]) -> mjx.Model:
        """The model with these parameters, in their dtype. timestep [s]."""
        base = jnp.zeros_like(physics.velocity_gain[:3])
        return with_links(self.model, physics, jnp.concatenate([base, physics.position_gain]), timestep)
