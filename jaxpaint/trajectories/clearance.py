"""How near a moving robot's body comes to what is around it."""

from collections.abc import Callable

import jax
from jaxtyping import Array, Float

from jaxpaint.kinematics.chain import KinematicChain
from jaxpaint.kinematics.spheres import Spheres, sphere_centers


def clearance(
    chain: KinematicChain,
    spheres: Spheres,
    q: Float[Array, "times joints"],
    distance: Callable[[Float[Array, "3"]], Float[Array, ""]],
) -> Float[Array, " times"]:
    """The least gap [m] between the robot's spheres and a surface, at each joint position; negative inside.

    distance: the signed distance [m] of a point in the map from the surface, positive on the robot's side.
    """

    def at(q_t):
        centers = sphere_centers(chain, spheres, q_t)
        return (jax.vmap(distance)(centers) - spheres.radius).min()

    return jax.vmap(at)(q)
