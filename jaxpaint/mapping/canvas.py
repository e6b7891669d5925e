"""The rectangle that carries the picture, posed near the wall."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float


class Canvas(eqx.Module):
    """A vertical rectangle from which every ray of S1-(4) leaves.

    center: middle of the rectangle in the map frame [m]. yaw: heading of the rays about map z [rad],
    0 looks along +x. size: width and height [m].
    """

    center: Float[Array, "3"]
    yaw: Float[Array, ""]
    size: Float[Array, "2"]

    @property
    def ray(self) -> Float[Array, "3"]:
        """Unit direction of the rays, into the wall: RayV of S1-(4)."""
        return jnp.stack([jnp.cos(self.yaw), jnp.sin(self.yaw), jnp.zeros_like(self.yaw)])

    @property
    def u_axis(self) -> Float[Array, "3"]:
        """Unit vector to the right of somebody who looks along the rays."""
        return jnp.stack([jnp.sin(self.yaw), -jnp.cos(self.yaw), jnp.zeros_like(self.yaw)])

    @property
    def v_axis(self) -> Float[Array, "3"]:
        """Unit vector upwards."""
        zero = jnp.zeros_like(self.yaw)
        return jnp.stack([zero, zero, zero + 1])

    def to_map(self, uv: Float[Array, "*points 2"]) -> Float[Array, "*points 3"]:
        """Points of the canvas [m, from its middle] in the map frame."""
        return self.center + uv[..., :1] * self.u_axis + uv[..., 1:] * self.v_axis

    def to_canvas(
        self, p_map: Float[Array, "*points 3"]
    ) -> tuple[Float[Array, "*points 2"], Float[Array, "*points"]]:
        """Canvas coordinates [m] of points, and their depth along the rays behind the canvas [m]."""
        offset = p_map - self.center
        u, v, depth = ((offset * axis).sum(-1) for axis in (self.u_axis, self.v_axis, self.ray))
        return jnp.stack([u, v], axis=-1), depth
