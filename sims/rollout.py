"""Many control steps of one world, in blocks of one length, so that any plan runs on one compilation."""

import dataclasses
from collections.abc import Callable
from typing import NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int, PRNGKeyArray, PyTree

from opt.controller import Controller
from opt.wbc import ControlStatus, RobotLimits
from sims.backward import KEEP_ALL, Backward
from sims.odometry import OdometryNoise
from sims.worlds import Fidelity, World

# One row is recorded every so many control steps, and the robot looks every so many records: 2.5 times a
# second.
RECORD_EVERY, LOOKS = 4, 5

# The world with a belief that a look has corrected and what is remembered, of both, the plan's clock [s] and
# random numbers.
Look = Callable[[World, PyTree, Float[Array, ""], PRNGKeyArray], tuple[World, PyTree]]


class RolloutState(eqx.Module):
    """Between blocks. clock: of the plan [s]. steps: control steps while live. faults: steps whose program
    was not solved, or whose target was given up. gave_up: whether the controller gave its target up in the
    last live step. diverged_at: control step at which a number stopped being finite, or the world left what
    its fidelity is about (`Fidelity.holds`); -1 while it did not. residual_sum, residual_most: of odometry
    (`World.residual`) over those steps [m/s]. seen: what looks remember; () where nothing is looked at.
    """

    world: World
    memory: PyTree
    clock: Float[Array, ""]
    steps: Int[Array, ""]
    faults: Int[Array, ""]
    gave_up: Bool[Array, ""]
    diverged_at: Int[Array, ""]
    residual_sum: Float[Array, ""]
    residual_most: Float[Array, ""]
    seen: PyTree = ()


class Record(NamedTuple):
    """What is kept of every `RECORD_EVERY`-th step; stacked over time by the rollout."""

    base: Float[Array, "*t 3"]
    tilt: Float[Array, "*t 3"]
    arm: Float[Array, "*t a"]
    odometry: Float[Array, "*t 3"]
    believed: Float[Array, "*t 3"]
    planned: Float[Array, "*t 3"]
    pen: Float[Array, "*t"]
    halted: Float[Array, "*t"]
    clock: Float[Array, "*t"]
    live: Bool[Array, "*t"]


def start(controller: Controller, fidelity: Fidelity, world: World, seen: PyTree = ()) -> RolloutState:
    """Before the first step. seen: what looks remember at the start."""
    world = fidelity.begin(world)
    zero = jnp.zeros((), jnp.int32)
    clock = jnp.zeros((), world.base.dtype)
    memory = controller.initial(world.measured())
    none, never = jnp.zeros_like(clock), jnp.zeros((), bool)
    return RolloutState(world, memory, clock, zero, zero, never, zero - 1, none, none, seen)


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
    look: Look | None = None,
    backward: Backward = KEEP_ALL,
) -> tuple[RolloutState, Record]:
    """`records` times `RECORD_EVERY` control steps; a world whose plan is over stands still.

    key: this world's and this block's. look: what the robot does every `LOOKS` records, which `records` must
    be a multiple of then. backward: how gradients go back. Steps that are not finite are undone, the world is
    marked and stopped.
    """
    between = LOOKS if look is not None else records
    if records % between:
        raise ValueError(f"records: {records}, allowed: multiples of {LOOKS}, between looks")
    shape = (records // between, between, RECORD_EVERY, 3)
    shocks = jax.random.normal(key, shape, state.world.base.dtype)

    def inner(state: RolloutState, shock):
        return _one_step(controller, fidelity, robot, noise, dt, state, shock)

    def outer(state: RolloutState, row):
        number, shocks = row
        state, seen = jax.lax.scan(backward.step(inner), backward.cut(state, number), shocks)
        return state, jax.tree.map(lambda x: x[-1], seen)

    def looked(state: RolloutState, row):
        (number, shocks), seen = row, state.seen
        if look is not None:
            before = state.world, state.seen
            after = look(*before, state.clock, jax.random.fold_in(key, number))
            live = is_live(controller, state)
            world, seen = jax.tree.map(lambda a, b: jnp.where(live, a, b), after, before)
            state = dataclasses.replace(state, world=world, seen=seen)
        rows = number * between + jnp.arange(between), shocks
        state, record = jax.lax.scan(backward.record(outer), dataclasses.replace(state, seen=()), rows)
        return dataclasses.replace(state, seen=seen), record

    state, record = jax.lax.scan(looked, state, (jnp.arange(shape[0]), shocks))
    return state, jax.tree.map(lambda x: x.reshape(-1, *x.shape[2:]), record)


def _one_step(controller: Controller, fidelity: Fidelity, robot, noise, dt, state: RolloutState, shock):
    live = is_live(controller, state)
    decision, memory = controller.decide(state.memory, state.world.measured(), state.clock, dt)
    before = _record(state.world, decision, state.clock, live)
    world = fidelity.step(robot, noise, state.world, decision.command, shock, dt)
    finite = _all_finite((world, memory, decision.planned, decision.rate)) & fidelity.holds(robot, world)
    go = live & finite
    moved = RolloutState(
        world,
        memory,
        state.clock + decision.rate * dt,
        state.steps + 1,
        state.faults + (decision.fault != 0),
        decision.fault == ControlStatus.OUT_OF_REACH,
        state.diverged_at,
        state.residual_sum + world.residual,
        jnp.maximum(state.residual_most, world.residual),
        state.seen,
    )
    new = jax.tree.map(lambda a, b: jnp.where(go, a, b), moved, state)
    broke = live & ~finite
    new = eqx.tree_at(lambda s: s.diverged_at, new, jnp.where(broke, state.steps, state.diverged_at))
    return new, before


def _record(world: World, decision, clock, live) -> Record:
    return Record(
        world.base,
        world.tilt,
        world.arm,
        world.odometry,
        world.believed,
        decision.planned,
        decision.pen,
        decision.halted,
        clock,
        live,
    )


def _all_finite(tree) -> Bool[Array, ""]:
    sums = [jnp.sum(x) for x in jax.tree.leaves(tree) if jnp.issubdtype(jnp.result_type(x), jnp.floating)]
    return jnp.isfinite(jnp.stack(sums)).all()
