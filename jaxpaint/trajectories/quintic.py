"""Quintic polynomials in time: joint motion with continuous position, speed and acceleration."""

from math import comb

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

# Rest to rest, s = 10 x^3 - 15 x^4 + 6 x^5 for x from 0 to 1: the largest of |s'| and of |s''|.
_PEAK_SPEED = 15 / 8
_PEAK_ACCELERATION = 10 / np.sqrt(3)

_TRIALS = 96  # durations tried for general ends, geometrically spaced
_SPAN = 64.0  # the longest of them over the shortest
_PIECES = 8  # into which a polynomial is cut where its peak is bounded


class State(eqx.Module):
    """Position, speed and acceleration of each joint: s(t) of S1 section IV-A [rad or m, and per second]."""

    p: Float[Array, " joints"]
    v: Float[Array, " joints"]
    a: Float[Array, " joints"]


class Quintic(eqx.Module):
    """p(t) = sum_k coefficients[k] (t / duration)^k, t from 0 to duration [s]; a duration of 0 is a rest."""

    coefficients: Float[Array, "6 joints"]
    duration: Float[Array, ""]


def rest_duration(
    distance: Float[Array, " joints"], v_max: Float[Array, " joints"], a_max: Float[Array, " joints"]
) -> Float[Array, ""]:
    """The shortest time [s] of a quintic from rest to rest within both limits, all joints together."""
    away = jnp.abs(distance)
    by_speed = _PEAK_SPEED * away / v_max
    share = _PEAK_ACCELERATION * away / a_max
    safe = jnp.where(share > 0, share, 1)  # the root's gradient is infinite at 0
    return jnp.maximum(by_speed, jnp.where(share > 0, jnp.sqrt(safe), 0)).max()


def rest_progress(x: Float[Array, ""]) -> tuple[Float[Array, ""], Float[Array, ""], Float[Array, ""]]:
    """s, ds/dx and d2s/dx2 of the quintic from rest to rest at x, the share of its duration, from 0 to 1."""
    s = x * x * x * (10 + x * (6 * x - 15))
    return s, 30 * x * x * (1 - x) * (1 - x), 60 * x * (1 - x) * (1 - 2 * x)


def quintic(start: State, end: State, duration: Float[Array, ""]) -> Quintic:
    """The quintic between two states in a given time [s]."""
    v0, v1 = start.v * duration, end.v * duration
    a0, a1 = start.a * duration**2, end.a * duration**2
    way = end.p - start.p
    rows = [
        start.p,
        v0,
        a0 / 2,
        10 * way - 6 * v0 - 4 * v1 - 1.5 * a0 + 0.5 * a1,
        -15 * way + 8 * v0 + 7 * v1 + 1.5 * a0 - a1,
        6 * way - 3 * (v0 + v1) - 0.5 * (a0 - a1),
    ]
    return Quintic(jnp.stack(rows), duration)


def evaluate(curve: Quintic, t: Float[Array, ""]) -> State:
    """The state at time t [s], the ends' positions before and after."""
    moving = curve.duration > 0
    duration = jnp.where(moving, curve.duration, 1)
    x = jnp.clip(t / duration, 0, 1)
    c = curve.coefficients
    p = c[0] + x * (c[1] + x * (c[2] + x * (c[3] + x * (c[4] + x * c[5]))))
    v = c[1] + x * (2 * c[2] + x * (3 * c[3] + x * (4 * c[4] + x * 5 * c[5])))
    a = 2 * c[2] + x * (6 * c[3] + x * (12 * c[4] + x * 20 * c[5]))
    rate = jnp.where(moving, 1 / duration, 0)
    return State(p, v * rate, a * rate * rate)


def fastest_quintic(
    start: State, end: State, v_max: Float[Array, " joints"], a_max: Float[Array, " joints"]
) -> tuple[Quintic, Bool[Array, ""]]:
    """A quintic between two states within the limits, near the shortest, and whether there is one.

    Durations from 1 ms on are tried, 4.5 % apart; longer is not always gentler when the ends move, so the
    first that holds is taken. Where none holds, the longest is returned.
    """
    way = end.p - start.p
    change = jnp.abs(end.v - start.v) / a_max
    least = jnp.maximum(
        jnp.maximum((jnp.abs(way) / v_max).max(), change.max()), rest_duration(way, v_max, a_max) / 4
    )
    least = jnp.maximum(least, 1e-3)
    durations = least * jnp.asarray(_SPAN ** (np.arange(_TRIALS) / (_TRIALS - 1)), way.dtype)
    holds = jax.vmap(lambda duration: _within(quintic(start, end, duration), v_max, a_max))(durations)
    first = jnp.where(holds.any(), jnp.argmax(holds), _TRIALS - 1)
    return quintic(start, end, durations[first]), holds.any()


def _within(curve: Quintic, v_max, a_max) -> Bool[Array, ""]:
    """Whether both limits are kept at every time: a polynomial lies between its Bernstein coefficients."""
    order = np.arange(6)[:, None]
    speed = (order * curve.coefficients)[1:] / curve.duration
    acceleration = (order * (order - 1) * curve.coefficients)[2:] / curve.duration**2
    slack = 1 + 1e-5  # a state at the limit is within it
    within_speed = jnp.abs(jnp.asarray(_bernstein(4), speed.dtype) @ speed) <= v_max * slack
    return (
        within_speed.all(0)
        & (jnp.abs(jnp.asarray(_bernstein(3), speed.dtype) @ acceleration) <= a_max * slack).all(0)
    ).all()


def _bernstein(degree: int) -> np.ndarray:
    """From a polynomial's coefficients on [0, 1] to its Bernstein coefficients on each of the pieces."""
    rows = []
    for piece in range(_PIECES):
        u, h = piece / _PIECES, 1 / _PIECES
        # x = u + h y on the piece: first the coefficients in y, then Bernstein's
        shifted = [
            [comb(k, i) * u ** (k - i) * h**i if i <= k else 0.0 for k in range(degree + 1)]
            for i in range(degree + 1)
        ]
        raised = [
            [comb(j, i) / comb(degree, i) if i <= j else 0.0 for i in range(degree + 1)]
            for j in range(degree + 1)
        ]
        rows.append(np.array(raised) @ np.array(shifted))
    return np.concatenate(rows)
