"""Servos and masses of an MJX model: what engines have in common."""

from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

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


def masses_of(model: mjx.Model) -> Masses:
    """Of all bodies but the world."""
    return Masses(model.body_mass[1:], model.body_ipos[1:], model.body_inertia[1:])


def floats_as(tree, dtype):
    """The tree with its floating-point leaves in `dtype`."""

    def convert(x):
        floating = eqx.is_array(x) and jnp.issubdtype(x.dtype, jnp.floating)
        return jnp.asarray(x, dtype) if floating else x

    return jax.tree.map(convert, tree)
