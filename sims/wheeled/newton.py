"""Accelerations of a robot on its wheels: the least of a convex cost, by Newton's method.

    1/2 a' M a - f' a + sum over contacts s(J a - r)

M is an arrow: wheels and arm meet only in the base, and contacts join no two wheels. So each step takes a 2
by 2 matrix for each wheel and a 6 by 6 one for the base; the arm's is the same for all steps.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax.scipy.linalg import cho_factor, cho_solve
from jaxtyping import Array, Float

from sims.wheeled.contacts import Contacts, cone_cost

# Newton's steps from the last accelerations, and those of each line search: what slides changes seldom.
_STEPS, _SEARCH = 5, 3
_BASE = 6


class Arrow(NamedTuple):
    """M by parts: base; base and wheels; wheels; and of the arm what is left of it once it is eliminated:
    M_arm, M_arm^-1 M_arm,base, and what that takes from the base.
    """

    base: Float[Array, "6 6"]
    beside: Float[Array, "w 6 2"]
    wheel: Float[Array, "w 2 2"]
    arm: Float[Array, "a a"]
    follows: Float[Array, "a 6"]
    eased: Float[Array, "6 6"]


def arrow(M: Float[Array, "dofs dofs"], wheels: int) -> Arrow:
    """M by parts. Degrees of freedom: base, then axis and axle of each wheel, then the arm."""
    first = _BASE + 2 * wheels
    own = [slice(_BASE + 2 * k, _BASE + 2 * k + 2) for k in range(wheels)]
    arm, to_arm = M[first:, first:], M[first:, :_BASE]
    follows = cho_solve(cho_factor(arm), to_arm)
    eased = (to_arm[:, :, None] * follows[:, None, :]).sum(0)
    beside, wheel = jnp.stack([M[:_BASE, o] for o in own]), jnp.stack([M[o, o] for o in own])
    return Arrow(M[:_BASE, :_BASE], beside, wheel, arm, follows, eased)


def accelerations(
    M: Float[Array, "dofs dofs"],
    force: Float[Array, " dofs"],
    contacts: Contacts,
    wheel: tuple[int, ...],
    start: Float[Array, " dofs"],
) -> Float[Array, " dofs"]:
    """The accelerations [m/s^2, rad/s^2] that forces and contacts give. wheel: of each contact. start: where
    the search begins.
    """
    wheels = max(wheel) + 1
    parts = arrow(M, wheels)
    columns = jnp.asarray([[*range(_BASE), _BASE + 2 * k, _BASE + 2 * k + 1] for k in wheel])

    def step(a, _):
        off = _rows(contacts, a[columns]) - contacts.reference
        cost = cone_cost(contacts, off)
        resists = _back(contacts, cost.slope, wheel, len(a))
        pulls = force - (M * a[None]).sum(1)
        way = _solve(parts, _by_wheel(contacts, cost.change, wheel), pulls - resists)
        along = _rows(contacts, way[columns])
        bend = (way * (M * way[None]).sum(1)).sum()
        far = _line_search(contacts, off, along, -(way * pulls).sum(), bend)
        return a + far * way, None

    return jax.lax.scan(step, start, None, length=_STEPS)[0]


def _line_search(contacts: Contacts, off, along, slope, bend):
    """How far to go along the way: where the cost's slope is 0, by Newton's method within a bracket."""

    def step(state, _):
        low, high, far = state
        cost = cone_cost(contacts, off + far * along)
        rise = slope + far * bend + (cost.slope * along).sum()
        curve = bend + (along[:, :, None] * cost.change * along[:, None, :]).sum()
        low, high = jnp.where(rise < 0, far, low), jnp.where(rise < 0, high, far)
        newton = far - rise / curve
        middle = jnp.where(jnp.isfinite(high), (low + high) / 2, 2 * far)
        return (low, high, jnp.where((newton >= low) & (newton <= high), newton, middle)), None

    zero = jnp.zeros_like(slope)
    start = zero, zero + jnp.inf, zero + 1
    return jax.lax.scan(step, start, None, length=_SEARCH)[0][2]


def _rows(contacts: Contacts, a: Float[Array, "c 8"]) -> Float[Array, "c 3"]:
    return (contacts.jacobian * a[:, None, :]).sum(-1)


def _back(contacts: Contacts, slope: Float[Array, "c 3"], wheel: tuple[int, ...], dofs: int):
    """J' s on all degrees of freedom."""
    rows = (contacts.jacobian * slope[:, :, None]).sum(1)
    wheels = max(wheel) + 1
    own = [sum(rows[c, _BASE:] for c in range(len(wheel)) if wheel[c] == k) for k in range(wheels)]
    rest = jnp.zeros(dofs - _BASE - 2 * wheels, slope.dtype)
    return jnp.concatenate([rows[:, :_BASE].sum(0), *own, rest])


def _by_wheel(contacts: Contacts, change: Float[Array, "c 3 3"], wheel: tuple[int, ...]):
    """J' S J of each wheel. [w, 8, 8]"""
    J = contacts.jacobian
    turned = (change[:, :, :, None] * J[:, None]).sum(2)
    each = (J[:, :, :, None] * turned[:, :, None, :]).sum(1)
    return jnp.stack(
        [sum(each[c] for c in range(len(wheel)) if wheel[c] == k) for k in range(max(wheel) + 1)]
    )


def _solve(parts: Arrow, added: Float[Array, "w 8 8"], force: Float[Array, " dofs"]):
    """(M + J' S J)^-1 force."""
    wheels = added.shape[0]
    first = _BASE + 2 * wheels
    beside = parts.beside + added[:, :_BASE, _BASE:]
    inverse = _inverse(parts.wheel + added[:, _BASE:, _BASE:])
    of_wheels, of_arm = force[_BASE:first].reshape(wheels, 2), force[first:]
    carried = (beside[:, :, :, None] * inverse[:, None]).sum(2)  # beside wheel^-1
    rest = force[:_BASE] - (carried * of_wheels[:, None, :]).sum((0, 2))
    rest = rest - (parts.follows * of_arm[:, None]).sum(0)
    eliminated = (carried[:, :, None, :] * beside[:, None, :, :]).sum((0, 3))
    base = parts.base + added[:, :_BASE, :_BASE].sum(0) - eliminated - parts.eased
    x = cho_solve(cho_factor(base), rest)
    own = of_wheels - (beside * x[None, :, None]).sum(1)
    turned = (inverse * own[:, None, :]).sum(-1)
    arm = cho_solve(cho_factor(parts.arm), of_arm) - (parts.follows * x[None]).sum(1)
    return jnp.concatenate([x, turned.reshape(-1), arm])


def _inverse(A: Float[Array, "w 2 2"]) -> Float[Array, "w 2 2"]:
    a, b, d = A[:, 0, 0], A[:, 0, 1], A[:, 1, 1]
    rows = jnp.stack([jnp.stack([d, -b], axis=1), jnp.stack([-b, a], axis=1)], axis=1)
    return rows / (a * d - b * b)[:, None, None]
