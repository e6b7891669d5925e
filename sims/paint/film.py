"""The film at points of the wall, without a grid: for programs of many worlds, and their gradients."""

import jax
from jaxtyping import Array, Float

from sims.paint.applicator import Applicator
from sims.paint.contact import Contact
from sims.paint.deposit import drop_broken


def film_at(
    applicator: Applicator, contacts: Contact, points: Float[Array, "points 2"]
) -> Float[Array, " points"]:
    """Thickness [m] at points (u, v) [m] that the contacts (leading axis: time) lay there.

    What `deposit` gives at the middle of a grid's cell. Scatters into a grid are slow in programs of many
    worlds; where a few hundred points tell enough, this is not.
    """

    def laid(contact: Contact) -> Float[Array, " points"]:
        away = points - contact.uv[None]
        return applicator.rate(away[:, 0], away[:, 1], contact) * contact.duration

    return jax.vmap(laid)(drop_broken(contacts)).sum(0)
