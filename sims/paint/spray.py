"""A spray gun: an elliptical double Gaussian."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from sims.paint.applicator import Applicator, smoothstep
from sims.paint.contact import Contact
from sims.parameters import scalar

# The footprint ends smoothly between these Mahalanobis distances of the wider Gaussian.
_FADE, _END = 2.5, 3.0


class Spray(Applicator):
    """Two concentric elliptical Gaussians: a dense core and a wide mist.

    core, mist: standard deviations along u and v at the nominal stand-off [m]. share: of the paint in the
    core [1]. stand_off: nominal distance from nozzle to wall [m]; a contact's height adds to it.
    flow: volume of paint that arrives on the wall [m^3/s] with the pen down. film: nominal thickness [m],
    against which "painted" is judged.
    """

    core_u: Float[Array, ""] = eqx.field(converter=scalar, default=0.008)
    core_v: Float[Array, ""] = eqx.field(converter=scalar, default=0.012)
    mist_u: Float[Array, ""] = eqx.field(converter=scalar, default=0.016)
    mist_v: Float[Array, ""] = eqx.field(converter=scalar, default=0.024)
    share: Float[Array, ""] = eqx.field(converter=scalar, default=0.7)
    stand_off: Float[Array, ""] = eqx.field(converter=scalar, default=0.20)
    flow: Float[Array, ""] = eqx.field(converter=scalar, default=64e-9)
    film: Float[Array, ""] = eqx.field(converter=scalar, default=60e-6)

    def rate(
        self, du: Float[Array, "*cells"], dv: Float[Array, "*cells"], contact: Contact
    ) -> Float[Array, "*cells"]:
        """Growth of the film [m/s]; the spot widens with the distance and wanders along the lean."""
        throw, scale = self._throw(contact)
        u, v = (du - throw * contact.lean[0]) / scale, (dv - throw * contact.lean[1]) / scale
        wide = jnp.sqrt((u / self.mist_u) ** 2 + (v / self.mist_v) ** 2 + 1e-12)
        narrow = (u / self.core_u) ** 2 + (v / self.core_v) ** 2
        dense = self.share * jnp.exp(-0.5 * narrow) / (self.core_u * self.core_v)
        thin = (1 - self.share) * jnp.exp(-0.5 * wide * wide) / (self.mist_u * self.mist_v)
        fade = smoothstep((_END - wide) / (_END - _FADE))
        return self.flow * contact.pen * (dense + thin) * fade / (2 * jnp.pi * scale**2)

    def _throw(self, contact: Contact) -> tuple[Float[Array, ""], Float[Array, ""]]:
        """Distance from nozzle to wall [m], and its ratio to the nominal one; bounded, for `reach`."""
        throw = jnp.clip(self.stand_off + contact.height, 0.25 * self.stand_off, 1.5 * self.stand_off)
        return throw, throw / self.stand_off

    def area(self, contact: Contact) -> Float[Array, ""]:
        """Volume over the density in the middle [m^2]."""
        _, scale = self._throw(contact)
        density = self.share / (self.core_u * self.core_v) + (1 - self.share) / (self.mist_u * self.mist_v)
        return 2 * jnp.pi * scale**2 / density

    def reach(self) -> float:
        """Edge of the mist at the largest stand-off and 15 degrees of lean [m]; host only."""
        return 1.5 * (_END * max(float(self.mist_u), float(self.mist_v)) + 0.27 * float(self.stand_off))
