"""MJX as a function from joints and servo commands to joints, with only the numbers that matter."""

import contextlib
import io

import equinox as eqx
import jax
import jax.numpy as jnp
import mujoco
import numpy as np
from jaxtyping import Array, Float

from sims.dynamics.parameters import Physics

with contextlib.redirect_stdout(io.StringIO()):  # it prints that Warp is not there
    from mujoco import mjx

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
    """A planar model in MJX, fixed when programs are compiled: its structure, and numbers that `Physics` has
    not (frames, axes). Two engines of equal models are equal, so a program is not compiled twice.
    """

    def __init__(self, planar: mujoco.MjModel):
        self.model = mjx.put_model(planar, impl="jax")
        self.data = mjx.make_data(planar, impl="jax")
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
    ) -> tuple[Float[Array, " joints"], Float[Array, " joints"]]:
        """Joints after one physics step; `model` by `with_physics`."""
        data = mjx.step(model, _floats_as(self.data, q.dtype).replace(qpos=q, qvel=v, ctrl=ctrl))
        return data.qpos, data.qvel

    def with_physics(self, physics: Physics, timestep: Float[Array, ""]) -> mjx.Model:
        """The model with these parameters, in their dtype. timestep [s]."""
        model = _floats_as(self.model, timestep.dtype)
        p, world = physics, jnp.zeros((1,), timestep.dtype)
        arm = jnp.concatenate([jnp.zeros_like(p.velocity_gain[:3]), p.position_gain])
        bias = jnp.stack([jnp.zeros_like(arm), -arm, -p.velocity_gain], axis=1)
        rest = model.actuator_biasprm[:, 3:]
        return model.tree_replace(
            {
                "body_mass": jnp.concatenate([world, p.mass]),
                "body_ipos": jnp.concatenate([model.body_ipos[:1], p.center]),
                "body_inertia": jnp.concatenate([model.body_inertia[:1], p.inertia]),
                "dof_armature": p.armature,
                "dof_damping": p.damping,
                "actuator_biasprm": jnp.concatenate([bias, rest], axis=1),
                "actuator_forcerange": jnp.stack([-p.force_limit, p.force_limit], axis=1),
                "opt.gravity": p.gravity * p.gravity_error,
                "opt.timestep": timestep,
            }
        )  # type: ignore[return-value]


def _floats_as(tree, dtype):
    """The tree with its floating-point leaves in `dtype`."""

    def convert(x):
        floating = eqx.is_array(x) and jnp.issubdtype(x.dtype, jnp.floating)
        return jnp.asarray(x, dtype) if floating else x

    return jax.tree.map(convert, tree)
