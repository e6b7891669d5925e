"""A robot's body as spheres that ride on its chain, for clearance."""

import equinox as eqx
from jaxtyping import Array, Float, Int

from jaxpaint.kinematics.chain import KinematicChain, frames


class Spheres(eqx.Module):
    """frame: the joint behind which each rides. center: in that frame [m]. radius [m], 0 for a corner."""

    frame: Int[Array, " spheres"]
    center: Float[Array, "spheres 3"]
    radius: Float[Array, " spheres"]


def sphere_centers(
    chain: KinematicChain, spheres: Spheres, q: Float[Array, " joints"]
) -> Float[Array, "spheres 3"]:
    """Where the centers are in the map [m]."""
    links = frames(chain, q)
    p, R = links.p[spheres.frame], links.R[spheres.frame]
    return p + (R * spheres.center[:, None, :]).sum(-1)
