"""The random walk of `kinematic` odometry, fitted to what wheels on a floor do in `wheeled`, by gradient.

Of each move, from rest to rest, the error of odometry (x, y [m], yaw [rad]) is taken for normal, with
variances that grow with the way d [m] and with what the steering axes turn a [rad]:

    var x = var y = walk^2 d + scrub^2 a        var yaw = yaw_walk^2 d + yaw_scrub^2 a

as `sims.odometry.wandering` makes them. The four are those of greatest likelihood.
"""

import dataclasses
import math

import jax
import jax.numpy as jnp
import numpy as np
import optax
from jaxtyping import Array, Float

from experiments.fidelities.follow import Followed
from experiments.fidelities.motions import move_length
from sims.odometry import displacement

_STEPS, _RATE = 1500, 0.02
# Variances below these are rounding [m^2, rad^2].
_LEAST = np.array([1e-12, 1e-12, 1e-12])


@dataclasses.dataclass(frozen=True)
class Moves:
    """error: of odometry in each move (x, y [m], yaw [rad]). way: [m]. turned: of the steering axes [rad]."""

    error: Float[np.ndarray, "n 3"]
    way: Float[np.ndarray, " n"]
    turned: Float[np.ndarray, " n"]


@dataclasses.dataclass(frozen=True)
class Walk:
    """walk [m/sqrt(m)], yaw_walk [rad/sqrt(m)], scrub [m/sqrt(rad)], yaw_scrub [rad/sqrt(rad)]."""

    walk: float
    yaw_walk: float
    scrub: float
    yaw_scrub: float


def moves_of(found: Followed) -> Moves:
    """The moves of all worlds, one row each."""
    length = move_length()
    ends = np.arange(length - 1, found.base.shape[1], length)
    start = np.zeros_like(found.base[:, :1])
    base, odometry = (
        jnp.asarray(np.concatenate([start, x[:, ends]], axis=1)) for x in (found.base, found.odometry)
    )
    each = jax.vmap(jax.vmap(displacement))
    error = np.asarray(each(base[:, :-1], base[:, 1:]) - each(odometry[:, :-1], odometry[:, 1:]))
    steps = np.linalg.norm(np.diff(found.odometry[..., :2], axis=1, prepend=start[..., :2]), axis=-1)
    way = steps.reshape(len(steps), -1, length).sum(-1)
    turned = np.diff(found.steered[:, ends], axis=1, prepend=np.zeros((len(steps), 1)))
    return Moves(error.reshape(-1, 3).astype(float), way.ravel().astype(float), turned.ravel().astype(float))


def fit_walk(moves: Moves) -> Walk:
    """The parameters of greatest likelihood."""
    with jax.enable_x64(True):
        return _fit(moves)


def _fit(moves: Moves) -> Walk:
    error, way, turned = (jnp.asarray(x) for x in (moves.error, moves.way, moves.turned))

    def loss(logs: Float[Array, "4"]) -> Float[Array, ""]:
        walk, yaw_walk, scrub, yaw_scrub = jnp.exp(2 * logs)
        place = walk * way + scrub * turned
        turn = yaw_walk * way + yaw_scrub * turned
        variance = jnp.stack([place, place, turn], axis=1) + _LEAST
        return (error**2 / variance + jnp.log(variance)).sum(1).mean()

    descent = optax.adam(_RATE)

    def step(state, _):
        logs, memory = state
        change, memory = descent.update(jax.grad(loss)(logs), memory)
        return (optax.apply_updates(logs, change), memory), None

    start = jnp.full(4, math.log(2e-3))
    (logs, _), _ = jax.jit(lambda s: jax.lax.scan(step, s, None, length=_STEPS))((start, descent.init(start)))
    return Walk(*(float(x) for x in np.exp(np.asarray(logs))))
