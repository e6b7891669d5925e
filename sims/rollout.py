"""Many control steps of one world, in blocks of one length, so that any plan runs on one compilation."""

from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int, PRNGKeyArray, PyTree

from opt.controller import Controller
from opt.wbc import RobotLimits
from sims.odometry import OdometryNoise
from sims.worlds import Fidelity, World

# One row is recorded every so many control steps.
RECORD_EVERY = 4


class RolloutState(eqx.Module):
    """Between blocks. clock: of the plan [s]. steps: control steps while live. faults: steps whose program
    was not solved. diverged_at: control step at which a number stopped being finite, -1 while none did.
    """

    world: World
    memory: PyTree
    clock: Float[Array, ""]
    steps: Int[Array, ""]
    faults: Int[Array, ""]
    diverged_at: Int[Array, ""]


class Record(NamedTuple):
    """What is kept of every `RECORD_EVERY`-th step; stacked over time by the rollout."""

    base: Float[Array, "*t 3"]
    arm: Float[Array, "*t a"]
    odometry: Float[Array, "*t 3"]
    planned: Float[Array, "*t 3"]
    pen: Float[Array, "*t"]
    halted: Float[Array, "*t"]
    clock: Float[Array, "*t"]
    live: Bool[Array, "*t"]


def start(controller: Controller, fidelity: Fidelity, world: World) -> RolloutState:
    """Before the first step."""
    world = fidelity.begin(world)
    zero = jnp.zeros((), jnp.int32)
    clock = jnp.zeros((), world.base.dtype)
    return RolloutState(world, controller.initial(world.measured()), clock, zero, zero, zero - 1)


def is_live(controller: Controller, state: RolloutState) -> Bool[Array, ""]:
    """Whether the plan goes on."""
    return (state.clock < controller.duration) & (state.diverged_at < 0)


def run_block(
    controller: Controller,
    fidelity: Fidelity,
    robot: RobotLimits,
    noise: OdometryNoise,
    dt: Float[Array, ""],
    state: RolloutState,
    key: PRNGKeyArray,
    *,
    records: int,
) -> tuple[RolloutState, Record]:
    """`records` times `RECORD_EVERY` control steps; a world whose plan is over stands still.

    key: this world's and this block's. Steps that are not finite are undone, the world is marked and stopped.
    """
    shocks = jax.random.normal(key, (records, RECORD_EVERY, 3), state.world.base.dtype)

    def inner(state: RolloutState, shock):
        return _one_step(controller, fidelity, robot, noise, dt, state, shock)

    def outer(state: RolloutState, shocks):
        state, seen = jax.lax.scan(inner, state, shocks)
        return state, jax.tree.map(lambda x: x[-1], seen)

    return jax.lax.scan(outer, state, shocks)


def _one_step(controller: Controller, fidelity: Fidelity, robot, noise, dt, state: RolloutState, shock):
    live = is_live(controller, state)
    decision, memory = controller.decide(state.memory, state.world.measured(), state.clock, dt)
    before = _record(state.world, decision, state.clock, live)
    world = fidelity.step(robot, noise, state.world, decision.command, shock, dt)
    finite = _all_finite((world, memory, decision.planned, decision.rate))
    go = live & finite
    moved = RolloutState(
        world,
        memory,
        state.clock + decision.rate * dt,
        state.steps + 1,
        state.faults + (decision.fault != 0),
        state.diverged_at,
    )
    new = jax.tree.map(lambda a, b: jnp.where(go, a, b), moved, state)
    broke = live & ~finite
    new = eqx.tree_at(lambda s: s.diverged_at, new, jnp.where(broke, state.steps, state.diverged_at))
    return new, before


def _record(world: World, decision, clock, live) -> Record:
    return Record(
        world.base, world.arm, world.odometry, decision.planned, decision.pen, decision.halted, clock, live
    )


def _all_finite(tree) -> Bool[Array, ""]:
    sums = [jnp.sum(x) for x in jax.tree.leaves(tree) if jnp.issubdtype(jnp.result_type(x), jnp.floating)]
    return jnp.isfinite(jnp.stack(sums)).all()
