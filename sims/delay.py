"""Commands that take their time to the drives."""

import dataclasses
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, PyTree

from opt.controller import Command
from opt.wbc import RobotLimits
from sims.worlds import Fidelity, World

# Commands that are remembered: a latency of as many control steps, less one, at most.
_SLOTS = 8


class Waiting(NamedTuple):
    """The latest command first, stacked, and what the fidelity behind knows."""

    commands: Command
    servos: PyTree


class Delayed(Fidelity):
    """Another fidelity whose drives get each command `latency` [s] late; between two, they are blended.

    What is longer than seven control steps counts as seven.
    """

    fidelity: Fidelity
    latency: Float[Array, ""]

    def begin(self, world: World) -> World:
        """Nothing was told yet."""
        if isinstance(world.servos, Waiting):
            return world
        inner = self.fidelity.begin(world)
        still = jnp.zeros((_SLOTS, 3), world.base.dtype)
        arm = jnp.zeros((_SLOTS, len(world.arm)), world.base.dtype)
        return dataclasses.replace(inner, servos=Waiting(Command(still, still, arm), inner.servos))

    def step(self, robot, noise, world, command, shock, dt) -> World:
        """One control step with the command that has arrived."""
        waiting: Waiting = world.servos
        rows = jax.tree.map(_pushed, command, waiting.commands)
        late = jnp.clip(self.latency / dt, 0, _SLOTS - 1)
        share = jnp.clip(1 - jnp.abs(jnp.arange(_SLOTS) - late), 0, 1).astype(dt.dtype)
        arrived = jax.tree.map(lambda x: (share[:, None] * x).sum(0), rows)
        inner = dataclasses.replace(world, servos=waiting.servos)
        after = self.fidelity.step(robot, noise, inner, arrived, shock, dt)
        return dataclasses.replace(after, servos=Waiting(rows, after.servos))

    def holds(self, robot: RobotLimits, world: World) -> Bool[Array, ""]:
        """As the fidelity behind says."""
        return self.fidelity.holds(robot, dataclasses.replace(world, servos=world.servos.servos))


def _pushed(new: Float[Array, " n"], rows: Float[Array, "slots n"]) -> Float[Array, "slots n"]:
    return jnp.concatenate([new[None], rows[:-1]])


def inner_fidelity(fidelity: Fidelity) -> Fidelity:
    """The one behind all delays."""
    return inner_fidelity(fidelity.fidelity) if isinstance(fidelity, Delayed) else fidelity
