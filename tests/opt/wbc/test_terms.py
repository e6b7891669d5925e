"""Every term can be left out by a number, is felt, and compiles nothing again; gradients."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.compiling import batched
from jaxpaint.decisions import default_thresholds
from jaxpaint.decisions.halting import HaltState
from jaxpaint.kinematics import forward
from opt.controller import Measured
from opt.plan import Samples
from opt.wbc import WholeBodyController, default_settings
from tests.opt.wbc.conftest import DT, straight

INF = np.inf
# How each term is left out: a name of the settings, or of the thresholds, and its value.
SWITCHES = {
    "brush twist": ("slack_cost", [0.0] * 6),
    "spin": ("slack_cost", [1e4, 1e4, 1e4, 1e3, 1e3, 0.0]),
    "effort of the arm": ("arm_effort", [0.0] * 6),
    "effort of the base": ("base_effort", [0.0] * 3),
    "manipulability": ("manipulability", 0.0),
    "base follow": ("base_follow", 0.0),
    "speed of the arm": ("arm_speed", INF),
    "speed of the base": ("base_speed", INF),
    "acceleration of the arm": ("arm_acceleration", INF),
    "acceleration of the base": ("base_acceleration", INF),
    "dampers": ("damper_start", 0.0),
    "clear of itself": ("own_approach", INF),
    "clear of the wall": ("wall_approach", INF),
    "low-speed rule": ("low_speed_scale", 0.0),
    "low-speed rule, signed": ("one_sided", 1.0),
    "halt": ("halt_travel", INF),
}


def decide(limits, settings, thresholds, rows, arm, base_velocity, arm_velocity, travel):
    """Velocities that one control step commands; the base at the origin, let go, its wheels sideways."""
    one = jnp.ones((), rows.dtype)
    controller = WholeBodyController(
        limits,
        settings,
        thresholds,
        Samples(rows, DT * one, 0 * one),
        Samples(jnp.asarray([[0.02, 0.5, 0.1]] * 2, rows.dtype), one, 0 * one),
        0.05 * one,
        one,
        10 * one,
    )
    measured = Measured(jnp.zeros(3, rows.dtype), arm, jnp.full(4, jnp.pi / 2, rows.dtype))
    memory = controller.initial(measured)
    moving = HaltState(halted=0 * one, travel=travel, rest=0 * one, halts=0 * one)
    memory = eqx.tree_at(
        lambda m: (m.halt, m.base_velocity, m.arm_velocity), memory, (moving, base_velocity, arm_velocity)
    )
    decision, memory = controller.decide(memory, measured, 0.2 * one, DT * one)
    return jnp.concatenate([memory.base_velocity, memory.arm_velocity]), decision.fault


@pytest.fixture(scope="module")
def states(robot, brush):
    """Postures and motions in which each term matters somewhere."""
    home = np.asarray(robot.home)
    folded = np.array([-0.24, -0.2, 2.5, 2.14, -1.34, 0], "f")
    bent = home + np.array([0, 0, 3.08 - home[2], 0, 0, 0], "f")
    at_limit = home + np.array([0, 0, 0, 0, 0, 6.1], "f")
    lists = []
    for arm, way, base, joints, travel in (
        (home, [0.0, 0.05, 0.02], [0, 0.1, 0], np.full(6, 0.05), 0.1),
        (home, [0.0, 0.05, 0.02], [0, 0.1, 0], np.full(6, 0.05), 0.5),
        (home, [0.0, 0.9, 0.0], [0, 0.48, 0], np.full(6, 0.9), 0.1),
        (home, [0.0, 2.5, 0.5], [0, 0.5, 0], [1.5, 1.5, 1.5, 1.5, 1.5, 1.5], 0.1),
        (home, [0.0, 0.05, 0.02], [0.3, -0.3, 0.3], np.zeros(6), 0.1),
        (folded, [-0.2, 0.0, 0.0], [0, 0.0, 0], [0, 0.3, 0.3, 0, 0, 0], 0.1),
        (folded - [0, 0, 0.2, 0, 0, 0], [-0.3, 0.0, 0.0], [0, 0.0, 0], np.zeros(6), 0.1),
        (bent, [-0.3, 0.0, 0.0], [0, 0.0, 0], np.zeros(6), 0.1),
        (at_limit, [0.0, 0.0, 0.0], [0, 0.1, 0], [0, 0, 0, 0, 0, 0.9], 0.1),
    ):
        pose = forward(robot.chain, jnp.concatenate([jnp.zeros(3), jnp.asarray(arm)]))
        turn = np.asarray(pose.R)
        if way[0] < -0.25:  # the plane stands nearer than the brush: parts are close to it
            turn = turn @ np.asarray([[0, 0, 1], [0, 1, 0], [-1, 0, 0.0]])
        rows = straight(pose.p, way, 30, turn)
        rows[:, :3] = np.asarray(pose.p) + 0.002  # near: the plan's clock goes on
        lists.append((rows, arm, base, joints, travel))
    return [
        jnp.asarray(np.stack([np.asarray(x, np.float32) for x in column]))
        for column in zip(*lists, strict=True)
    ]


def test_each_term_can_be_left_out_and_is_felt_and_nothing_compiles_again(limits, states):
    program = batched(decide, in_axes=(None, None, None, 0, 0, 0, 0, 0), chunk=4)
    settings, thresholds = default_settings(), default_thresholds()
    whole, _ = program(limits, settings, thresholds, *states)
    assert np.isfinite(whole).all()
    for term, (name, value) in SWITCHES.items():
        group = "settings" if hasattr(settings, name) else "thresholds"
        new = {"settings": settings, "thresholds": thresholds}
        new[group] = eqx.tree_at(lambda s, n=name: getattr(s, n), new[group], jnp.asarray(value, jnp.float32))
        without, _ = program(limits, new["settings"], new["thresholds"], *states)
        assert np.isfinite(without).all(), term
        assert np.abs(np.asarray(without) - np.asarray(whole)).max() > 1e-4, term
    off = {name: value for name, value in SWITCHES.values() if hasattr(settings, name) and value == INF}
    bare = eqx.tree_at(
        lambda s: [getattr(s, name) for name in off], settings, [jnp.float32(v) for v in off.values()]
    )
    assert np.isfinite(program(limits, bare, thresholds, *states)[0]).all()
    assert program.traces == 1


def doubles(tree):
    return jax.tree.map(
        lambda x: jnp.asarray(x, jnp.float64) if jnp.issubdtype(x.dtype, jnp.floating) else x, tree
    )


def test_gradients_of_one_step_agree_with_central_differences(x64, limits, states):
    soft = default_thresholds(halt_temperature=0.05, release_temperature=0.05, halt_travel=0.3)
    settings = eqx.tree_at(lambda s: s.qp_smoothing, default_settings(), jnp.float32(1e-4))
    flat, tree = jax.tree.flatten(doubles((settings, soft)))
    sizes = np.cumsum([x.size for x in flat])[:-1]
    shapes = [x.shape for x in flat]
    point = jnp.concatenate([x.reshape(-1) for x in flat])
    weight = jnp.asarray(np.random.default_rng(0).normal(size=9))

    def value(limits, point, *state):
        parts = [x.reshape(s) for x, s in zip(jnp.split(point, sizes), shapes, strict=True)]
        return (weight * decide(limits, *jax.tree.unflatten(tree, parts), *state)[0]).sum()

    limits, state = doubles(limits), [x[:1] for x in doubles(states)]
    slope = batched(
        lambda limits, *rest: jax.grad(lambda p: value(limits, p, *rest[1:]))(rest[0]),
        in_axes=(None, *[0] * 6),
        chunk=2,
    )
    one = batched(value, in_axes=(None, *[0] * 6), chunk=16)
    found = np.asarray(slope(limits, point[None], *state))[0]
    # A number that is exactly at a switch has no derivative there.
    names = [i for i, x in enumerate(point) if x != 0]
    h = 1e-6 * np.maximum(np.abs(np.asarray(point)), 1e-2)[names]
    steps = np.zeros((len(names), len(point)))
    steps[np.arange(len(names)), names] = h
    both = np.concatenate([point + steps, point - steps])
    values = np.asarray(one(limits, jnp.asarray(both), *[np.repeat(x, len(both), 0) for x in state]))
    difference = (values[: len(names)] - values[len(names) :]) / (2 * h)
    assert np.isfinite(found).all() and np.linalg.norm(found) > 0.1
    assert (np.abs(difference) > 1e-9).sum() >= 15
    np.testing.assert_allclose(found[names], difference, atol=2e-5 * np.abs(difference).max(), rtol=1e-3)
