"""What random scans are drawn from."""

from dataclasses import replace
from typing import Self

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from sims.parameters import scalar
from sims.sensors.camera import Camera
from sims.sensors.depth_noise import DepthNoise

KINDS = ("flat", "corner", "objects")
"""The three scene types, by their number: a flat wall, a corner, objects in front of a wall."""


class ScanSettings(eqx.Module):
    """Ranges (lowest, highest) and shares; all draws are uniform where nothing else is said. All is traced.

    shares: how often each of `KINDS` comes. distance: to the wall, along the optical axis [m]. incidence: the
    largest angle between the picture's middle ray and a flat wall's normal [rad]. bend: share of the flat
    walls that are bent outwards, as columns are; bend_radius: of those [m]. interior: angle between the faces
    of a corner, on the side of the air for inside corners and of the wall for outside ones [rad]; inside:
    share of inside corners. object_size: of things before a wall, as a share of the distance to it; gap:
    between them and the wall, at most [m]; present: share of the two boxes, sphere and post that are there
    (one always is). camera: of which the scans are windows. noise: of its depth.
    """

    shares: Float[Array, "3"] = eqx.field(converter=jnp.asarray, default=(1 / 3, 1 / 3, 1 / 3))
    distance: Float[Array, "2"] = eqx.field(converter=jnp.asarray, default=(0.4, 2.5))
    incidence: Float[Array, ""] = eqx.field(converter=scalar, default=0.96)
    bend: Float[Array, ""] = eqx.field(converter=scalar, default=0.25)
    bend_radius: Float[Array, "2"] = eqx.field(converter=jnp.asarray, default=(0.6, 4.0))
    interior: Float[Array, "2"] = eqx.field(converter=jnp.asarray, default=(1.047, 2.618))
    inside: Float[Array, ""] = eqx.field(converter=scalar, default=0.7)
    object_size: Float[Array, "2"] = eqx.field(converter=jnp.asarray, default=(0.06, 0.3))
    gap: Float[Array, ""] = eqx.field(converter=scalar, default=0.25)
    present: Float[Array, ""] = eqx.field(converter=scalar, default=0.7)
    camera: Camera = eqx.field(default_factory=Camera)
    noise: DepthNoise = eqx.field(default_factory=DepthNoise)

    def scored(self) -> Self:
        """The same for sets that scores are taken on: the plain three scene types, no wall is bent."""
        return replace(self, bend=scalar(0.0))
