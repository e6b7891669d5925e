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
        balanced: Float[Array, ""],
    ) -> tuple[Float[Array, " joints"], Float[Array, " joints"]]:
        """Joints after one physics step; `model` by `with_physics`.

        balanced: share of the weight that motors are told to hold besides `ctrl`. Their limits hold for all
        that they are told, so a motor that is too weak lets its load sink.
        """
        data = _floats_as(self.data, q.dtype).replace(qpos=q, qvel=v)
        data = mjx.fwd_velocity(model, mjx.fwd_position(model, data))
        data = data.replace(ctrl=ctrl + balanced * _weight(model, data))
        data = mjx.fwd_acceleration(model, mjx.fwd_actuation(model, data))
        # A servo at its limit damps nothing more: MuJoCo's integrator knows that, MJX's must be told.
        low, high = model.actuator_forcerange[:, 0], model.actuator_forcerange[:, 1]
        follows = (data.actuator_force > low) & (data.actuator_force < high)
        gains = model.actuator_biasprm * follows[:, None]
        data = mjx.implicit(model.replace(actuator_biasprm=gains), data)
        return data.qpos, data.qvel

    def with_physics(self, physics: Physics, timestep: Float[Array, ""]) -> mjx.Model:
        """The model with these parameters, in their dtype. timestep [s]."""
        model = _floats_as(self.model, timestep.dtype)
        p, world = physics, jnp.zeros((1,), timestep.dtype)
        mass = jnp.concatenate([world, p.mass])
        arm = jnp.concatenate([jnp.zeros_like(p.velocity_gain[:3]), p.position_gain])
        bias = jnp.stack([jnp.zeros_like(arm), -arm, -p.velocity_gain], axis=1)
        rest = model.actuator_biasprm[:, 3:]
        return model.tree_replace(
            {
                "body_mass": mass,
                "body_subtreemass": jnp.flip(jnp.cumsum(jnp.flip(mass))),
                "body_ipos": jnp.concatenate([model.body_ipos[:1], p.center]),
                "body_inertia": jnp.concatenate([model.body_inertia[:1], p.inertia]),
                "dof_armature": p.armature,
                "dof_damping": p.damping,
                "actuator_biasprm": jnp.concatenate([bias, rest], axis=1),
                "actuator_forcerange": jnp.stack([-p.force_limit, p.force_limit], axis=1),
                "opt.gravity": p.gravity,
                "opt.timestep": timestep,
            }
        )  # type: ignore[return-value]


def _weight(model: mjx.Model, data: mjx.Data) -> Float[Array, " joints"]:
    """Forces and torques that hold a chain up where it is [N, N m]; no body carries two."""
    body = model.dof_bodyid
    up = -model.opt.gravity * model.body_subtreemass[body, None]
    lever = data.subtree_com[body] - data.xanchor
    hinge = (model.jnt_type == int(mujoco.mjtJoint.mjJNT_HINGE))[:, None]
    return (data.xaxis * jnp.where(hinge, jnp.cross(lever, up), up)).sum(-1)


def _floats_as(tree, dtype):
    """The tree with its floating-point leaves in `dtype`."""

    def convert(x):
        floating = eqx.is_array(x) and jnp.issubdtype(x.dtype, jnp.floating)
        return jnp.asarray(x, dtype) if floating else x

    return jax.tree.map(convert, tree)
