"""A round brush pressed against the wall."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from sims.paint.applicator import Applicator, smoothstep
from sims.paint.contact import Contact
from sims.parameters import scalar

# The ferrule holds the bristles: however hard they are pressed, the contact grows by no more than this share.
_LARGEST_SPREAD = 0.2


class Brush(Applicator):
    """A round bristle brush whose free tips would stand `compression` deep in the wall when held as planned.

    radius: of the contact at nominal compression [m].
    compression: how deep the path presses the bristles into the wall [m]: a choice of the plan, 10 mm of
        about 25 mm of bristle, and no property of the true brush. The planned path lies on the surface with
        the bristles bent by so much, and contact is lost where the tip is lifted by more: that is what a
        drifting robot may be off along the normal before it leaves bare wall. It costs force on wall and
        arm, wear, bristles that splay where they are pressed still further (`spread`), and paint that is
        squeezed out at starts and ends; of these only the splaying is modelled. With less, coverage falls
        where scan and base err by more than that.
    spread: growth of the contact's radius per metre of further compression [1]; bent bristles splay.
    softness: width of the rim beyond the radius over which the pressure falls to zero [m]. Splayed outer
        bristles lift off gradually. At 20 % of the film as the limit of
        "painted", the default wets 1.3 mm beyond the radius.
    touch: compression over which the bristles take up contact [m].
    film: thickness that one pass at the nominal speed leaves on the centre-line [m].
    nominal_speed: of that pass [m/s].
    shear: share of the flow that is drawn off by motion instead of fed per time [1].
    valve: 0, a dipped brush that paints wherever it touches, whatever the pen command says; 1, a fed brush
        that the pen command opens and shuts.
    """

    radius: Float[Array, ""] = eqx.field(converter=scalar, default=0.010)
    compression: Float[Array, ""] = eqx.field(converter=scalar, default=0.010)
    spread: Float[Array, ""] = eqx.field(converter=scalar, default=0.5)
    softness: Float[Array, ""] = eqx.field(converter=scalar, default=0.003)
    touch: Float[Array, ""] = eqx.field(converter=scalar, default=0.002)
    film: Float[Array, ""] = eqx.field(converter=scalar, default=60e-6)
    nominal_speed: Float[Array, ""] = eqx.field(converter=scalar, default=0.030)
    shear: Float[Array, ""] = eqx.field(converter=scalar, default=0.0)
    valve: Float[Array, ""] = eqx.field(converter=scalar, default=0.0)

    def contact_radius(self, height: Float[Array, ""]) -> Float[Array, ""]:
        """Radius of the wetted disc [m] with the tip at this height; the ferrule bounds it."""
        bound = _LARGEST_SPREAD * self.radius
        return self.radius + bound * jnp.tanh(-self.spread * height / bound)

    def rate(
        self, du: Float[Array, "*cells"], dv: Float[Array, "*cells"], contact: Contact
    ) -> Float[Array, "*cells"]:
        """Growth of the film [m/s]: flat inside the disc, falling over the soft rim, none where lifted.

        A leaning brush presses less on the side to which it leans, loses contact there first, and its disc is
        shortened along the lean.
        """
        sideways = du * contact.lean[0] + dv * contact.lean[1]
        distance = jnp.sqrt(du * du + dv * dv + sideways * sideways + 1e-12)
        edge = self.contact_radius(contact.height) + self.softness
        inside = smoothstep((edge - distance) / self.softness)
        pressed = smoothstep((self.compression - contact.height - sideways) / self.touch)
        return self._flow(contact) * inside * pressed

    def _flow(self, contact: Contact) -> Float[Array, ""]:
        """Growth of the film under the brush [m/s]."""
        # One pass takes a point on the centre-line through a chord of twice the radius and half of each rim.
        fed = self.film * self.nominal_speed / (2 * self.radius + self.softness)
        drawn = 1 - self.shear + self.shear * contact.speed / self.nominal_speed
        return fed * drawn * (1 - self.valve + self.valve * contact.pen)

    def area(self, contact: Contact) -> Float[Array, ""]:
        """Area of the disc with half of its rim [m^2]."""
        return jnp.pi * (self.contact_radius(contact.height) + 0.5 * self.softness) ** 2

    def reach(self) -> float:
        """Largest radius with its rim [m]; host only."""
        return (1 + _LARGEST_SPREAD) * float(self.radius) + float(self.softness)
