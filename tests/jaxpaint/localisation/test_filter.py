"""The filter knows how wrong it is, and nothing throws it."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jaxpaint.localisation import (
    Belief,
    DriftModel,
    Evidence,
    Trust,
    correct,
    match_scan,
    no_evidence,
    predict,
    surprise,
)

seeds = st.integers(0, 10_000)
ahead = jax.jit(predict)
after = jax.jit(correct)


def covariance(rng, rank=3, scale=(0.03, 0.03, 0.02)):
    """A random covariance of some rank, of about these standard deviations."""
    half = rng.normal(size=(3, rank)) * np.array(scale)[:, None]
    return half @ half.T


def evidence(information, error):
    """What says without noise that the pose is off by `error`."""
    information = jnp.asarray(information, float)
    one = jnp.asarray(1.0)
    return Evidence(information, information @ jnp.asarray(error, float), 0 * one, one)


def moved(pose, motion):
    """The pose after a displacement in its own frame at the mean heading."""
    yaw = pose[2] + motion[2] / 2
    c, s = np.cos(yaw), np.sin(yaw)
    return pose + np.array([c * motion[0] - s * motion[1], s * motion[0] + c * motion[1], motion[2]])


@given(seed=seeds, rank=st.integers(0, 3), seen=st.integers(0, 3), size=st.floats(-1, 1))
def test_a_correction_is_bayes_rule_whatever_is_singular(x64, seed, rank, seen, size):
    """Against a pseudo-inverse in the span of the covariance."""
    rng = np.random.default_rng(seed)
    P = covariance(rng, rank) * 10**size
    rows = rng.normal(size=(seen, 3)) * [300, 300, 900]
    error = P @ rng.normal(size=3)
    trust = Trust(surprise=1e9)
    got = after(Belief(jnp.zeros(3), jnp.asarray(P)), evidence(rows.T @ rows, error), trust)
    expected = P - P @ rows.T @ np.linalg.solve(np.eye(seen) + rows @ P @ rows.T, rows @ P)
    np.testing.assert_allclose(got.covariance, expected, atol=1e-9 * max(P.max(), 1e-12))
    np.testing.assert_allclose(got.pose, expected @ (rows.T @ rows @ error), atol=1e-9)
    np.testing.assert_array_equal(got.covariance, got.covariance.T)


@given(seed=seeds, rank=st.integers(1, 3), seen=st.integers(1, 3), size=st.floats(-3, 1))
def test_float32_is_enough_for_small_and_large(seed, rank, seen, size):
    """From 30 um to 0.3 m of uncertainty: not negative, symmetric, never larger than before."""
    rng = np.random.default_rng(seed)
    P = covariance(rng, rank) * 10 ** (2 * size)
    rows = rng.normal(size=(seen, 3)) * [300, 300, 900]
    got = after(Belief(jnp.zeros(3), jnp.asarray(P)), evidence(rows.T @ rows, np.zeros(3)))
    found = np.asarray(got.covariance, float)
    np.testing.assert_array_equal(found, found.T)
    expected = P - P @ rows.T @ np.linalg.solve(np.eye(seen) + rows @ P @ rows.T, rows @ P)
    assert np.linalg.eigvalsh(found).min() > -1e-6 * np.abs(found).max()
    np.testing.assert_allclose(
        found, expected, atol=2e-3 * np.abs(P).max() if size < 0 else 0.1 * np.abs(P).max()
    )


def test_the_jacobians_are_those_of_the_motion(x64):
    """Covariance after a motion without noise, against differences of the motion itself."""
    rng, h = np.random.default_rng(0), 1e-6
    still = jax.tree.map(jnp.zeros_like, DriftModel())
    for _ in range(10):
        pose, motion, P = rng.normal(size=3), rng.normal(size=3), covariance(rng)
        columns = [(moved(pose + h * e, motion) - moved(pose - h * e, motion)) / (2 * h) for e in np.eye(3)]
        F = np.stack(columns, axis=1)
        got = ahead(Belief(jnp.asarray(pose), jnp.asarray(P)), jnp.asarray(motion), jnp.asarray(0.3), still)
        np.testing.assert_allclose(got.pose, moved(pose, motion), atol=1e-12)
        np.testing.assert_allclose(got.covariance, F @ P @ F.T, atol=1e-9)


@given(seed=seeds, pieces=st.integers(2, 40))
def test_drift_does_not_depend_on_the_steps(x64, seed, pieces):
    """A straight way in one step or in many; along and across are of the way and not of the base."""
    rng = np.random.default_rng(seed)
    motion, drift = np.array([*rng.normal(size=2), 0.0]), DriftModel(yaw=0.0)
    start = Belief(jnp.asarray(rng.normal(size=3)), jnp.zeros((3, 3)))
    once = ahead(start, jnp.asarray(motion), jnp.asarray(0.0), drift)
    often = start
    for _ in range(pieces):
        often = ahead(often, jnp.asarray(motion / pieces), jnp.asarray(0.0), drift)
    np.testing.assert_allclose(often.covariance, once.covariance, atol=1e-14)
    way = np.linalg.norm(motion)
    values, vectors = np.linalg.eigh(np.asarray(once.covariance[:2, :2]))
    np.testing.assert_allclose(values, [1e-6 * way, 1e-5 * way], rtol=1e-6)
    direction = moved(np.asarray(start.pose), motion)[:2] - np.asarray(start.pose[:2])
    np.testing.assert_allclose(abs(vectors[:, 1] @ direction), way, rtol=1e-6)


def test_rotation_and_steering_have_their_own_share():
    still, drift = Belief(jnp.zeros(3), jnp.zeros((3, 3))), DriftModel()
    turned = ahead(still, jnp.asarray([0.0, 0.0, -2.0]), jnp.asarray(0.0), drift).covariance
    np.testing.assert_allclose(jnp.diagonal(turned), [2e-8, 2e-8, 2e-5], rtol=1e-5)
    steered = ahead(still, jnp.zeros(3), jnp.asarray(-3.0), drift).covariance
    np.testing.assert_allclose(jnp.diagonal(steered), [3e-7, 3e-7, 3e-7], rtol=1e-5)
    assert not np.any(ahead(still, jnp.zeros(3), jnp.asarray(0.0), drift).covariance)


def test_yaw_is_not_wrapped():
    belief = Belief(jnp.asarray([0.0, 0.0, 3.1]), jnp.eye(3))
    belief = ahead(belief, jnp.asarray([0.0, 0.0, 0.2]), jnp.asarray(0.0))
    np.testing.assert_allclose(belief.pose[2], 3.3, rtol=1e-6)
    seen = evidence(np.eye(3) * 1e6, [0, 0, 0.1])
    np.testing.assert_allclose(after(belief, seen).pose[2], 3.4, rtol=1e-4)


def test_it_knows_how_wrong_it_is():
    """200 runs of 20 steps with noise as modelled and looks of all ranks: errors squared average to 3."""
    drift = DriftModel(
        along=1e-4, across=2e-5, yaw=2e-4, turn_position=1e-5, turn_yaw=1e-3, steer_position=1e-5
    )
    values = {k: float(v) for k, v in vars(drift).items()}

    def run(key):
        def step(state, key):
            true, belief = state
            a, b, c, d = jax.random.split(key, 4)
            motion = jax.random.normal(a, (3,)) * jnp.asarray([0.1, 0.05, 0.1])
            way, turn = jnp.sqrt(motion[0] ** 2 + motion[1] ** 2), jnp.abs(motion[2])
            tangent = motion[:2] / way
            normal = jnp.stack([-tangent[1], tangent[0]])
            same = values["turn_position"] * turn + values["steer_position"] * 0.2
            noise = jax.random.normal(b, (3,)) * jnp.sqrt(
                jnp.stack(
                    [
                        values["along"] * way + same,
                        values["across"] * way + same,
                        values["yaw"] * way + values["turn_yaw"] * turn + values["steer_yaw"] * 0.2,
                    ]
                )
            )
            slipped = motion + jnp.concatenate([tangent * noise[0] + normal * noise[1], noise[2:]])
            none = Belief(true, jnp.zeros((3, 3)))
            true = predict(none, slipped, jnp.asarray(0.0), drift).pose
            belief = predict(belief, motion, jnp.asarray(0.2), drift)
            rows = jax.random.normal(c, (2, 3)) * jnp.asarray([1.0, 1.0, 2.0])
            seen = rows @ (true - belief.pose) + 0.004 * jax.random.normal(d, (2,))
            information = rows.T @ rows / 0.004**2
            one = jnp.asarray(1.0)
            look = Evidence(information, rows.T @ seen / 0.004**2, one, one)
            belief = correct(belief, look)
            return (true, belief), None

        first, rest = jax.random.split(key)
        spread = jnp.asarray([0.03, 0.03, 0.02])
        belief = Belief(jnp.asarray([1.0, -2.0, 0.5]), jnp.diag(spread**2))
        start = belief.pose + spread * jax.random.normal(first, (3,)), belief
        (true, belief), _ = jax.lax.scan(step, start, jax.random.split(rest, 20))
        return true - belief.pose, belief.covariance

    error, P = jax.jit(jax.vmap(run))(jax.random.split(jax.random.key(0), 200))
    error, P = np.asarray(error, float), np.asarray(P, float)
    normalised = np.einsum("ri,ri->r", error, np.linalg.solve(P, error[..., None])[..., 0])
    assert 2.4 < normalised.mean() < 3.6  # 3.5 standard deviations of the mean of 200
    np.testing.assert_array_equal(P, np.swapaxes(P, 1, 2))
    assert np.linalg.eigvalsh(P).min() > 0


def test_nothing_that_is_not_finite_comes_in():
    belief = Belief(jnp.asarray([1.0, 2.0, 3.0]), 1e-4 * jnp.eye(3))
    good = evidence(np.eye(3) * 1e6, [0.001, 0, 0])
    for field, bad in [
        ("information", np.nan),
        ("information", np.inf),
        ("vector", np.nan),
        ("vector", np.inf),
    ]:
        spoiled = Evidence(**{**vars(good), field: getattr(good, field).at[0].set(bad)})
        same(after(belief, spoiled), belief)
    same(after(belief, no_evidence(jnp.float32)), belief)
    huge = after(belief, evidence(np.eye(3) * 1e35, [1e-3, 0, 0]))
    assert all(np.isfinite(leaf).all() for leaf in jax.tree.leaves(huge))


def same(a, b):
    jax.tree.map(np.testing.assert_array_equal, a, b)


def test_a_wrong_match_does_not_throw_the_robot():
    """5 standard deviations are refused and widen the belief; who is really there is believed in the end."""
    belief = Belief(jnp.zeros(3), jnp.diag(jnp.asarray([1e-6, 1e-6, 1e-6])))
    error = jnp.asarray([0.005, 0.0, 0.0])
    look = evidence(np.eye(3) * 1e7, error)
    assert 16.3 < float(surprise(belief, look)) < 25
    once = after(belief, look)
    np.testing.assert_array_equal(once.pose, belief.pose)
    np.testing.assert_allclose(once.covariance, 2 * belief.covariance)
    np.testing.assert_allclose(after(once, look).pose, error, atol=1e-3)
    far = belief
    looks = 0
    while float(far.pose[0]) == 0 and looks < 20:
        far, looks = after(far, evidence(np.eye(3) * 1e7, [0.1, 0, 0])), looks + 1
    assert 8 <= looks <= 12  # 100 standard deviations: log2(10^4 / 16.3) looks in a row


def test_no_correction_is_longer_than_trust_allows():
    rng, trust = np.random.default_rng(0), Trust()
    for _ in range(30):
        P = covariance(rng)
        belief = Belief(jnp.zeros(3), jnp.asarray(P))
        rows = rng.normal(size=(2, 3)) * 300
        got = after(belief, evidence(rows.T @ rows, rng.normal(size=3) * 0.2), trust)
        move = np.asarray(got.pose, float)
        assert move @ np.linalg.solve(P, move) < 16.3 * 1.01


def test_gradients_are_finite_at_rest_and_certain():
    """No motion, no covariance: roots whose own gradients are infinite."""

    def loss(motion, P, information, vector):
        belief = predict(Belief(jnp.zeros(3), P), motion, motion[0])
        one = jnp.ones(())
        got = correct(belief, Evidence(information, vector, one, one))
        return got.pose.sum() + got.covariance.sum()

    gradient = jax.jit(
        jax.grad(loss, argnums=(0, 1, 2, 3)), compiler_options={"xla_disable_hlo_passes": "fusion"}
    )
    for P in (jnp.zeros((3, 3)), jnp.diag(jnp.asarray([1e-4, 0.0, 0.0]))):
        slopes = gradient(jnp.zeros(3), P, jnp.zeros((3, 3)), jnp.zeros(3))
        assert all(np.isfinite(slope).all() for slope in slopes)


@pytest.mark.parametrize("looks", [1, 4])
def test_round_a_column_good_travel_and_the_yaw_seen_give_the_place(places, bearings, looks):
    """A base goes 1.5 m round a column of 2 m radius; it drifts in yaw by 2 mrad a metre and slips by 0.3 %.

    The column shows the distance and the yaw less the angle along the arc. Dead reckoning ends 3 mrad and
    some mm off; with looks each 2 cm the yaw error is what the travel is off by, over the radius.
    """
    place, rng = places["column"], np.random.default_rng(0)
    outline = place.outline(rng)
    axis, radius, steps = np.array([4.0, 0.0]), 3.0, 75
    arc = 1.5 / radius / steps
    motion = jnp.asarray([0.0, -1.5 / steps, -arc])
    slipped = np.array([0.0, -1.5 / steps * 1.003, -arc + 0.002 * 1.5 / steps])
    drift = DriftModel(along=2e-5, across=1e-6, yaw=6e-6)
    look = jax.jit(lambda b, r: match_scan(outline, b.pose, jnp.zeros(3), r, jnp.isfinite(r), bearings))
    true = np.array([1.0, 0.0, 0.0])
    belief = dead = Belief(jnp.asarray(true), jnp.diag(jnp.asarray([1e-7, 1e-7, 1e-7])))
    for step in range(steps):
        true = moved(true, slipped)
        belief, dead = (ahead(b, motion, jnp.asarray(0.0), drift) for b in (belief, dead))
        if step % looks == 0:
            belief = after(belief, look(belief, jnp.asarray(place.ranges(true, noise=rng))))
    error, blind = np.asarray(belief.pose) - true, np.asarray(dead.pose) - true
    arm = true[:2] - axis
    outward = arm / np.linalg.norm(arm)
    along = np.array([-outward[1], outward[0]])
    assert abs(blind[2]) > 0.0025
    assert abs(error[:2] @ outward) < 0.0025
    assert abs(error[2]) < 0.002
    assert abs(error[:2] @ along) < 0.006  # 4.5 mm of slip, which nothing sees
    assert error @ np.linalg.solve(np.asarray(belief.covariance, float), error) < 12
