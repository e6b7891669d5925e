"""Inverse dynamics of a chain: the forces and torques that a motion asks of its joints."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from jaxpaint.kinematics.chain import KinematicChain
from jaxpaint.kinematics.frame_loop import looped_frames
from jaxpaint.kinematics.rotations import cross


class Inertia(eqx.Module):
    """What each joint of a chain carries, in the frame behind the joint, and what resists at the joint.

    mass [kg]; center of mass [m]; tensor about it [kg m^2]; armature: of rotor and gears seen at the joint
    [kg m^2 or kg]; damping [N m s/rad or N s/m]; gravity in the map frame [m/s^2].
    """

    mass: Float[Array, " joints"]
    center: Float[Array, "joints 3"]
    tensor: Float[Array, "joints 3 3"]
    armature: Float[Array, " joints"]
    damping: Float[Array, " joints"]
    gravity: Float[Array, "3"]


def inverse_dynamics(
    chain: KinematicChain,
    inertia: Inertia,
    q: Float[Array, " joints"],
    v: Float[Array, " joints"],
    a: Float[Array, " joints"],
) -> Float[Array, " joints"]:
    """Torques and forces of the motors [N m, N] for position, speed and acceleration, by Newton and Euler.

    As mj_inverse, where no motor is helped (`gravcomp` is what a motor supplies). The recursions are sums
    along the chain, since all vectors are in the map frame.
    """
    links = looped_frames(chain, q)
    hinge = np.array([[kind == "hinge"] for kind in chain.kinds])
    axis = links.R[..., 2]
    turn, slide = jnp.where(hinge, axis, 0), jnp.where(hinge, 0, axis)
    v, a = v[:, None], a[:, None]
    spin = jnp.cumsum(turn * v, axis=0)
    below = spin - turn * v  # of the link before
    gain = jnp.cumsum(turn * a + cross(below, turn * v), axis=0)
    gain_below = gain - turn * a - cross(below, turn * v)
    arm = links.p - jnp.concatenate([links.p[:1], links.p[:-1]])
    steps = _carried(below, gain_below, arm) + slide * a + 2 * cross(below, slide * v)
    center = (links.R * inertia.center[:, None, :]).sum(-1)
    acceleration = jnp.cumsum(steps, axis=0) + _carried(spin, gain, center) - inertia.gravity[None]
    force = inertia.mass[:, None] * acceleration
    moment = _turned(links.R, inertia.tensor, gain) + cross(spin, _turned(links.R, inertia.tensor, spin))
    # moments about the last joint: near the robot, wherever in the map it stands
    place = links.p - links.p[-1:]
    moment = moment + cross(place + center, force)
    force, moment = _beyond(force), _beyond(moment)
    asked = turn * (moment - cross(place, force)) + slide * force
    return asked.sum(-1) + inertia.armature * a[:, 0] + inertia.damping * v[:, 0]


def _carried(spin, gain, arm):
    """Acceleration that a turning link gives to a point at the end of `arm`."""
    return cross(gain, arm) + cross(spin, cross(spin, arm))


def _turned(R, tensor, vector):
    """R I R' w for each link, without a matrix product."""
    inside = (R * vector[:, :, None]).sum(1)
    return (R * (tensor * inside[:, None, :]).sum(-1)[:, None, :]).sum(-1)


def _beyond(rows):
    """Sums from each joint to the tool."""
    return jnp.flip(jnp.cumsum(jnp.flip(rows, 0), axis=0), 0)
