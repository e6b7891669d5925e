"""Training on noisy planes: it learns, and a run that stopped goes on as if it had not."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from nets import weights
from nets.agn import AGN, AGNSettings
from nets.training import Lesson, Trainer, TrainingSettings, gains

POINTS, STEPS = 128, 24
TINY = AGNSettings(
    features=4, width=4, heads=1, pooled=2, nearest=4, further=2, groups=2, coplanar=2, beside=2
)


def lessons(key, count):
    """Scans of the plane z = 0, unevenly noisy, seen from above."""

    def one(key):
        first, second = jax.random.split(key)
        flat = jnp.concatenate([jax.random.uniform(first, (POINTS, 2)), jnp.zeros((POINTS, 1))], axis=1)
        off = jax.random.normal(second, (POINTS,))
        points = flat.at[:, 2].set(0.03 * off * (1 + 3 * (flat[:, 0] > 0.5)))
        there = jnp.ones(POINTS, bool)
        down = jnp.tile(jnp.asarray([0.0, 0.0, -1.0]), (POINTS, 1))
        return Lesson(points, there, down, jnp.full((POINTS, 3), 0.5), (), flat, there)

    return jax.vmap(one)(jax.random.split(key, count))


def trainer(**changes):
    settings = TrainingSettings(**{"steps": STEPS, "batch": 4, "rate": 1e-2, **changes})
    return Trainer(lessons, lambda scene, p: p.at[2].set(0.0), settings)


@pytest.fixture(scope="module")
def network():
    """One that attends to the wrong things: as drawn it fits planes well already."""
    return jax.tree.map(lambda leaf: 4 * leaf, AGN.of(TINY, key=jax.random.key(0)))


@pytest.fixture(scope="module")
def trained(network):
    """The trainer, the state after each step, and the losses."""
    training = trainer()
    states, losses = [training.start(network)], []
    for _ in range(STEPS):
        state, step = training.advance(states[-1])
        states.append(state)
        losses.append(float(step.loss.mean()))
    return training, states, losses


def test_the_loss_falls(trained):
    _, states, losses = trained
    assert np.isfinite(losses).all() and int(states[-1].step) == STEPS
    assert np.mean(losses[-6:]) < 0.8 * np.mean(losses[:6])


def test_other_scans_gain_too(trained):
    training, states, _ = trained
    held_out = lessons(jax.random.key(99), 4)
    before, after = (gains(training.validate(state, held_out)) for state in (states[0], states[-1]))
    assert after["l1"].mean() > before["l1"].mean() + 0.1
    assert after["l2"].shape == (4,)


def test_a_run_that_stopped_goes_on_bit_for_bit(trained, tmp_path):
    training, states, losses = trained
    path = tmp_path / "state.npz"
    weights.save(path, states[3], {})
    state = weights.load(path, training.start(states[0].network))
    for number in (3, 4):
        state, step = training.advance(state)
        assert float(step.loss.mean()) == losses[number]
    for a, b in zip(jax.tree.leaves(state), jax.tree.leaves(states[5]), strict=True):
        np.testing.assert_array_equal(a, b)


def test_nothing_is_compiled_twice(trained):
    training, states, _ = trained
    before = training._slopes.traces
    training.advance(states[7])
    assert training._slopes.traces == before
