"""What every tool that lays paint has in common."""

import abc
import math

import equinox as eqx
from jaxtyping import Array, Float

from sims.paint.contact import Contact


class Applicator(eqx.Module):
    """A brush, a spray gun: turns a contact into a rate of growth of the film around it."""

    film: eqx.AbstractVar[Float[Array, ""]]

    @abc.abstractmethod
    def rate(
        self, du: Float[Array, "*cells"], dv: Float[Array, "*cells"], contact: Contact
    ) -> Float[Array, "*cells"]:
        """Growth of the film [m/s] at offsets (du, dv) [m] from the foot of the tool, for one contact.

        Smooth, and zero at distances beyond `reach`.
        """

    @abc.abstractmethod
    def area(self, contact: Contact) -> Float[Array, ""]:
        """Rough area [m^2] of the footprint of one contact: volume over the rate in the middle."""

    @abc.abstractmethod
    def reach(self) -> float:
        """Largest distance [m] from the foot of the tool that gets paint; host only."""


def window_cells(applicator: Applicator, cell: float) -> int:
    """Cells across the window that holds a footprint, odd: the static size `deposit` wants; host only."""
    # The foot lies up to half a cell from the middle of the middle cell.
    return 2 * math.ceil(applicator.reach() / cell + 0.5 - 1e-5) + 1


def smoothstep(x: Float[Array, "*any"]) -> Float[Array, "*any"]:
    """0 below 0, 1 above 1, a cubic with flat ends between."""
    x = x.clip(0, 1)
    return x * x * (3 - 2 * x)
