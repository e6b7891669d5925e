import hypothesis
import hypothesis.strategies as st
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.decisions.modes import CLUSTER, ModeSettings, decide, k_means, pose_vectors
from jaxpaint.decisions.thresholds import default_thresholds

ROOM = 64
DECIDE = jax.jit(decide, static_argnames="statistic")
VECTORS = jax.jit(pose_vectors)
LABELS = jax.jit(lambda poses, mask: k_means(poses, mask)[0])


def facing(number: int) -> np.ndarray:
    """Rotations that all look into the wall x = 0."""
    return np.tile(np.array([[0, 0, 1], [-1, 0, 0], [0, -1, 0]], float), (number, 1, 1))


def decision(position, rotation=None, statistic="deviation", thresholds=None, settings=None, room=ROOM):
    number = len(position)
    rotation = facing(number) if rotation is None else rotation
    p, R = np.full((room, 3), np.nan), np.full((room, 3, 3), np.nan)
    p[:number], R[:number] = position, rotation
    mask = jnp.arange(room) < number
    thresholds, settings = thresholds or default_thresholds(), settings or ModeSettings()
    return DECIDE(jnp.asarray(p), jnp.asarray(R), mask, thresholds, settings, statistic=statistic)


def row(number: int, spacing: float) -> np.ndarray:
    return np.stack([np.zeros(number), -spacing * np.arange(number), np.ones(number)], -1)


def grid(rows: int, columns: int, spacing: float) -> np.ndarray:
    u, v = np.meshgrid(np.arange(columns), np.arange(rows))
    return spacing * np.stack([0 * u.ravel(), -u.ravel(), v.ravel()], -1)


def circle(number: int, radius: float) -> np.ndarray:
    angle = 2 * np.pi * np.arange(number) / number
    return radius * np.stack([0 * angle, np.cos(angle), np.sin(angle)], -1)


@pytest.mark.parametrize(
    "position",
    [row(3, 1.0), row(3, 0.3), row(12, 0.5), grid(3, 4, 0.4), grid(2, 2, 1.0), row(1, 1.0)],
    ids=["three views", "three close views", "a long row", "a grid", "four views", "one pose"],
)
def test_waypoints_go_to_the_trajectory_controller(position):
    result = decision(position)
    assert float(result.whole_body) == 0
    assert 0.3 <= float(result.statistic) <= 0.8


@pytest.mark.parametrize(
    "position",
    [row(60, 0.005), row(60, 0.02), circle(60, 0.1), grid(8, 8, 0.01)],
    ids=["a line", "a coarse line", "a circle", "a hatch"],
)
def test_paths_go_to_the_whole_body_controller(position):
    result = decision(position)
    assert float(result.whole_body) == 1
    assert float(result.statistic) < 0.3


@hypothesis.given(st.integers(0, 10_000))
def test_the_literal_statistic_cannot_reach_the_upper_bound(seed):
    """Ratios that sum to one deviate by sqrt(5) / 6 = 0.373 at most, and do so for a straight line."""
    rng = np.random.default_rng(seed)
    literal = decision(rng.standard_normal((40, 3)) * rng.uniform(0, 1, 3), statistic="literal")
    assert float(literal.clusters.max()) <= 5**0.5 / 6 + 1e-6
    line = decision(row(40, 0.01), statistic="literal")
    np.testing.assert_allclose(line.clusters[line.counted], 5**0.5 / 6, rtol=1e-3)
    assert float(line.statistic) < 0.8


@hypothesis.given(st.integers(0, 10_000))
def test_statistics_are_those_of_the_variance_ratios(seed):
    """Against numpy's eigenvalues, without what we add."""
    rng = np.random.default_rng(seed)
    position = rng.standard_normal((30, 3)) * rng.uniform(0.1, 1, 3)
    bare = ModeSettings(tolerance=0.0, gap=0.0)
    results = {
        name: decision(position, statistic=name, settings=bare) for name in ("deviation", "range", "literal")
    }
    room, there = np.zeros((ROOM, 3)), jnp.arange(ROOM) < 30
    room[:30] = position
    poses = VECTORS(jnp.asarray(room), jnp.asarray(facing(ROOM)), there, 0.2)
    label = np.asarray(LABELS(poses, there))[:30]
    poses = np.asarray(poses)[:30]
    for k in np.flatnonzero(np.asarray(results["range"].counted)):
        local = poses[label == k]
        values = np.linalg.eigvalsh(np.cov(local.T, bias=True))
        ratios = values / values.sum()
        assert float(results["literal"].clusters[k]) == pytest.approx(ratios.std(), abs=2e-3)
        assert float(results["deviation"].clusters[k]) == pytest.approx(ratios.std() / 0.37268, abs=5e-3)
        assert float(results["range"].clusters[k]) == pytest.approx(ratios[-1] - ratios[0], abs=2e-3)
    assert float(results["range"].statistic) == pytest.approx(
        np.mean(np.asarray(results["range"].clusters)[np.asarray(results["range"].counted)]), rel=1e-5
    )


def test_the_mean_leaves_lone_poses_out():
    position = np.concatenate([row(8, 0.01), [[5.0, 5.0, 5.0]]])
    result = decision(position)
    assert 1 in np.asarray(result.number)[~np.asarray(result.counted)]
    assert float(result.number.sum()) == 9


def test_clusters_never_get_worse_than_the_start():
    """Lloyd's iterations lower the sum of squares of S1-(5) from the stretches they start with."""
    poses = np.random.default_rng(2).standard_normal((ROOM, 6))

    def spread(label):
        return sum(((poses[label == k] - poses[label == k].mean(0)) ** 2).sum() for k in np.unique(label))

    label = np.asarray(LABELS(jnp.asarray(poses), jnp.ones(ROOM, bool)))
    assert len(np.unique(label)) <= ROOM // CLUSTER
    assert spread(label) < 0.7 * spread(np.arange(ROOM) // CLUSTER)


def test_place_and_heading_do_not_matter():
    rng = np.random.default_rng(0)
    position = grid(3, 4, 0.4) + 0.02 * rng.standard_normal((12, 3))
    yaw = 2.5
    turn = np.array([[np.cos(yaw), -np.sin(yaw), 0], [np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]])
    moved = decision(position @ turn.T + [3.0, -2.0, 0.5], turn @ facing(12))
    assert float(moved.statistic) == pytest.approx(float(decision(position).statistic), abs=1e-4)


def test_turns_count_by_their_weight():
    """Poses on one spot that turn differ by rotation alone."""
    angle = 0.8 * np.arange(12)
    turn = np.stack([np.cos(angle), -np.sin(angle), np.sin(angle), np.cos(angle)], -1).reshape(-1, 2, 2)
    rotation = np.tile(np.eye(3), (12, 1, 1))
    rotation[:, :2, :2] = turn
    room = np.concatenate([rotation, facing(ROOM - 12)])
    poses = VECTORS(jnp.zeros((ROOM, 3)), jnp.asarray(room), jnp.arange(ROOM) < 12, 0.2)
    np.testing.assert_allclose(poses[:4, 5], 0.2 * angle[:4], atol=1e-5)
    assert float(decision(np.zeros((12, 3)), rotation).whole_body) == 0
    still = decision(np.zeros((12, 3)), rotation, settings=ModeSettings(rotation_weight=1e-4))
    assert float(still.whole_body) == 1


def test_what_is_masked_does_not_matter():
    assert float(decision(row(20, 0.4)).statistic) == pytest.approx(
        float(decision(row(20, 0.4), room=100).statistic), rel=1e-5
    )


def test_the_decision_softens_with_the_temperature():
    position = row(12, 0.04)
    value = float(decision(position).statistic)
    lower = default_thresholds(variance_lower=value + 0.01)
    assert float(decision(position, thresholds=lower).whole_body) == 1
    warm = default_thresholds(variance_lower=value + 0.01, mode_temperature=0.05)
    assert 0.5 < float(decision(position, thresholds=warm).whole_body) < 0.7
    cold = default_thresholds(variance_lower=value + 0.01, mode_temperature=1e-4)
    assert float(decision(position, thresholds=cold).whole_body) > 0.999


def test_gradients_agree_with_differences(x64):
    rng = np.random.default_rng(3)
    position = jnp.asarray(row(12, 0.04) + 0.005 * rng.standard_normal((12, 3)))
    thresholds = default_thresholds(mode_temperature=0.05)

    @jax.jit
    @jax.value_and_grad
    def share(position):
        return decide(position, jnp.asarray(facing(12)), jnp.ones(12, bool), thresholds).whole_body

    _, slope = share(position)
    change = rng.standard_normal((12, 3))
    ahead, behind = (share(position + k * change)[0] for k in (1e-6, -1e-6))
    assert float(jnp.sum(slope * change)) == pytest.approx(float(ahead - behind) / 2e-6, rel=1e-4)
    on_one_spot = share(jnp.zeros((12, 3)))
    assert np.isfinite(on_one_spot[0]) and np.all(np.isfinite(on_one_spot[1]))
