"""The base's planar laser scanner."""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, PRNGKeyArray

from jaxpaint.kinematics import Pose
from sims.parameters import scalar
from sims.scenes.scene import Scene


class Lidar(eqx.Module):
    """A planar scanner with equal steps between beams.

    first, last: bearings of the first and last beam in the scanner's frame [rad]. near, far: range [m].
    sigma: standard deviation of a range [m]. dropout: share of beams without an echo [1]. beams: how many.
    The defaults are those of a small 270 degree safety scanner.
    """

    first: Float[Array, ""] = eqx.field(converter=scalar, default=-2.356)
    last: Float[Array, ""] = eqx.field(converter=scalar, default=2.356)
    near: Float[Array, ""] = eqx.field(converter=scalar, default=0.05)
    far: Float[Array, ""] = eqx.field(converter=scalar, default=20.0)
    sigma: Float[Array, ""] = eqx.field(converter=scalar, default=0.01)
    dropout: Float[Array, ""] = eqx.field(converter=scalar, default=0.005)
    beams: int = eqx.field(static=True, default=541)

    @property
    def bearings(self) -> Float[Array, "beams"]:
        """Directions of the beams in the scanner's frame [rad], counter-clockwise."""
        return self.first + (self.last - self.first) * jnp.arange(self.beams) / max(self.beams - 1, 1)


def scan(
    scene: Scene, lidar: Lidar, T_map_lidar: Pose, *, key: PRNGKeyArray
) -> tuple[Float[Array, "beams"], Bool[Array, "beams"]]:
    """Noisy ranges [m] (0 where invalid) and their validity. Beams lie in the frame's x-y plane."""
    ahead, left = T_map_lidar.R[None, :, 0], T_map_lidar.R[None, :, 1]
    bearing = lidar.bearings[:, None]
    directions = jnp.cos(bearing) * ahead + jnp.sin(bearing) * left
    hits = jax.vmap(scene.raycast, in_axes=(None, 0))(T_map_lidar.p, directions)
    range_key, drop_key = jax.random.split(key)
    noise = lidar.sigma * jax.random.normal(range_key, hits.distance.shape, hits.distance.dtype)
    echoed = jax.random.uniform(drop_key, hits.distance.shape) >= lidar.dropout
    valid = hits.valid & echoed & (hits.distance >= lidar.near) & (hits.distance <= lidar.far)
    return jnp.where(valid, hits.distance + noise, 0), valid
