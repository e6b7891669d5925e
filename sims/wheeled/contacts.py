"""What contacts of treads with the floor ask of a robot's accelerations: MuJoCo's soft elliptic cones.

A contact resists with a force whose pull on the acceleration a is the slope of a convex cost s(J a - r).
J: the contact's Jacobian (normal, two tangents), r: the acceleration that would end penetration and slip.
"""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

# No tread is so slippery, nor slips so slowly, that a division by it would overflow.
_LEAST = 1e-6


class Contacts(NamedTuple):
    """jacobian: of each contact on the motions of the base and of its own wheel's axis and axle. reference: r
    [m/s^2]. weight: of each row [kg], 0 where nothing touches. friction: of the tangents and, scaled as the
    rows' weights are, of the cone.
    """

    jacobian: Float[Array, "c 3 8"]
    reference: Float[Array, "c 3"]
    weight: Float[Array, "c 3"]
    friction: Float[Array, ""]
    cone: Float[Array, ""]


class Cost(NamedTuple):
    """Of each contact: slope of its cost with J a - r, and how that changes."""

    slope: Float[Array, "c 3"]
    change: Float[Array, "c 3 3"]


def cone_cost(contacts: Contacts, off: Float[Array, "c 3"]) -> Cost:
    """off: J a - r. A contact lets go, sticks, or slides on its cone.

    As MuJoCo's `mj_constraintUpdate` for elliptic cones.
    """
    mu, friction, D = contacts.cone, contacts.friction, contacts.weight
    N, U = mu * off[:, 0], friction * off[:, 1:]
    size = jnp.sqrt((U**2).sum(-1) + _LEAST**2)
    sticks = mu * N + size <= 0
    slides = ~sticks & (mu * size > N)
    along = U / size[:, None]
    zero = jnp.zeros_like(N)
    stuck = jnp.where(sticks[:, None], D, 0)
    pressed = jnp.where(slides, D[:, 0] / (mu**2 * (1 + mu**2)), 0)
    over = pressed * (N - mu * size)
    way = jnp.stack([mu + zero, -mu * friction * along[:, 0], -mu * friction * along[:, 1]], axis=1)
    slope = stuck * off + over[:, None] * way
    turning = -over * mu * friction**2 / size
    across = jnp.stack([zero, -along[:, 1], along[:, 0]], axis=1)
    change = _outer(pressed, way) + _outer(turning, across)
    return Cost(slope, change + stuck[:, :, None] * jnp.eye(3, dtype=off.dtype))


def _outer(scale: Float[Array, " c"], v: Float[Array, "c 3"]) -> Float[Array, "c 3 3"]:
    return (scale[:, None] * v)[:, :, None] * v[:, None, :]


def touching(
    distance: Float[Array, " c"],
    jacobian: Float[Array, "c 3 8"],
    speed: Float[Array, "c 3"],
    *,
    mobility: Float[Array, " c"],
    friction: Float[Array, ""],
    tyre: Float[Array, ""],
    grip: Float[Array, ""],
    giving: float,
    stiffer: float,
) -> Contacts:
    """As MuJoCo makes constraints: solref (tyre, 1), solreffriction (0, -grip), solimp (giving, giving, ...),
    impratio `stiffer`. distance: below 0 where geoms penetrate [m]. speed: of the contact, J v [m/s].
    mobility: body_invweight0 of the wheel [1/kg].
    """
    touches = distance < 0
    stiff = giving / ((1 - giving) * mobility)
    ratio = jnp.asarray([1.0, stiffer, stiffer], speed.dtype)
    weight = jnp.where(touches[:, None], stiff[:, None] * ratio, 0)
    damping, spring = 2 / (giving * tyre), 1 / (giving * tyre) ** 2
    normal = -damping * speed[:, :1] - spring * giving * distance[:, None]
    reference = jnp.concatenate([normal, -grip / giving * speed[:, 1:]], axis=1)
    slippery = jnp.maximum(friction, _LEAST)
    return Contacts(jacobian, reference, weight, slippery, slippery / stiffer**0.5)
