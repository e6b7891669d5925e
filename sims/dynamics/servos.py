"""Servos and masses of an MJX model: what engines have in common."""

from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from sims.dynamics.parameters import Links
from sims.dynamics.quiet import mjx
from sims.dynamics.tree import Masses


class Pulled(NamedTuple):
    """force: of the servos on their degrees of freedom [N, N m]. damping: how it falls with their speed where
    they are not at their limits, viscous friction included [N s/m, N m s/rad].
    """

    force: Float[Array, " joints"]
    damping: Float[Array, " joints"]


def servos(
    model: mjx.Model,
    q: Float[Array, " joints"],
    v: Float[Array, " joints"],
    told: Float[Array, " joints"],
) -> Pulled:
    """Servo i acts on the i-th of the last degrees of freedom with told - kp q - kv v, within its limits."""
    gains, limits = model.actuator_biasprm, model.actuator_forcerange
    servo = told + gains[:, 1] * q + gains[:, 2] * v
    force = jnp.clip(servo, limits[:, 0], limits[:, 1])
    # A servo at its limit damps nothing more.
    return Pulled(force, model.dof_damping[-len(gains) :] - gains[:, 2] * (servo == force))


class Load(NamedTuple):
    """Masses, and the gravity that pulls at them [m/s^2]."""

    masses: Masses
    gravity: Float[Array, "3"]


def load_of(links: Links) -> Load:
    """What the links of these parameters weigh."""
    return Load(Masses(links.mass, links.center, links.inertia), links.gravity)


def masses_of(model: mjx.Model) -> Masses:
    """Of all bodies but the world."""
    return Masses(model.body_mass[1:], model.body_ipos[1:], model.body_inertia[1:])


def with_links(
    model: mjx.Model,
    links: Links,
    position_gain: Float[Array, " joints"],
    timestep: Float[Array, ""],
) -> mjx.Model:
    """The model with these links and servos, in their dtype. Degrees of freedom before the joints' are free.

    position_gain: of every joint. timestep [s].
    """
    model, p = floats_as(model, timestep.dtype), links
    world, free = jnp.zeros((1,), timestep.dtype), jnp.zeros((model.nv - len(position_gain),), timestep.dtype)
    bias = jnp.stack([jnp.zeros_like(position_gain), -position_gain, -p.velocity_gain], axis=1)
    return model.tree_replace(
        {
            "body_mass": jnp.concatenate([world, p.mass]),
            "body_ipos": jnp.concatenate([model.body_ipos[:1], p.center]),
            "body_inertia": jnp.concatenate([model.body_inertia[:1], p.inertia]),
            "dof_armature": jnp.concatenate([free, p.armature]),
            "dof_damping": jnp.concatenate([free, p.damping]),
            "actuator_biasprm": jnp.concatenate([bias, model.actuator_biasprm[:, 3:]], axis=1),
            "actuator_forcerange": jnp.stack([-p.force_limit, p.force_limit], axis=1),
            "opt.gravity": p.gravity,
            "opt.timestep": timestep,
        }
    )  # type: ignore[return-value]


def floats_as(tree, dtype):
    """The tree with its floating-point leaves in `dtype`."""

    def convert(x):
        floating = eqx.is_array(x) and jnp.issubdtype(x.dtype, jnp.floating)
        return jnp.asarray(x, dtype) if floating else x

    return jax.tree.map(convert, tree)
