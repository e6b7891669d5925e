"""AGN on one patch: what must not change it, what it does before any training, gradients."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from nets.agn import AGN, AGNSettings, residuals
from tests.nets.agn.conftest import SMALL, corner

COUNT = 512
RUN = eqx.filter_jit(residuals)
ALL = jnp.ones(COUNT, bool)


def run(network, points, valid=ALL, ray=None, colour=None):
    given = [None if x is None else jnp.asarray(x, jnp.float32) for x in (ray, colour)]
    return np.asarray(RUN(network, jnp.asarray(points, jnp.float32), jnp.asarray(valid), *given))


@pytest.fixture(scope="module")
def scanned():
    return corner(COUNT, 0.01)


@pytest.fixture(scope="module")
def moved(network, scanned):
    return run(network, scanned[0])


def test_untrained_it_smooths_already(network):
    """Almost equal weights make it a plain fit, which is right on a plane."""
    rng = np.random.default_rng(0)
    points = np.column_stack([rng.random((COUNT, 2)), 0.01 * rng.standard_normal(COUNT)])
    refined = points + run(network, points)
    assert refined[:, 2].std() < 0.35 * points[:, 2].std()


def test_the_order_of_points_does_not_matter(network, scanned, moved):
    order = np.random.default_rng(1).permutation(COUNT)
    np.testing.assert_allclose(run(network, scanned[0][order]), moved[order], atol=2e-5)


def test_the_unit_of_points_does_not_matter(network, scanned, moved):
    np.testing.assert_allclose(run(network, 1000 * scanned[0]) / 1000, moved, atol=2e-5)


def test_residuals_turn_with_the_cloud(network, scanned):
    """Where the camera is known; else normals are turned to a side that a turn may change."""
    ray = np.tile([1.0, 0.0, 0.0], (COUNT, 1))
    # About an axis that swaps none of the sides along which halves are cut.
    turn = Rotation.from_euler("x", 90, degrees=True).as_matrix()
    still = run(network, scanned[0], ray=ray)
    turned = run(network, scanned[0] @ turn.T + [3.0, -2.0, 1.0], ray=ray @ turn.T)
    np.testing.assert_allclose(turned, still @ turn.T, atol=5e-5)


def test_what_is_not_valid_changes_nothing_and_stays(network, scanned):
    valid = np.arange(COUNT) < 256
    near, far = scanned[0].copy(), scanned[0].copy()
    far[256:] = 1e6
    first, second = run(network, near, valid), run(network, far, valid)
    np.testing.assert_array_equal(first, second)
    assert (first[256:] == 0).all() and (first[:256] != 0).any()


def test_nothing_valid_is_nothing_to_do(network, scanned):
    np.testing.assert_array_equal(run(network, scanned[0], np.zeros(COUNT, bool)), 0)


@pytest.mark.parametrize("points", [np.zeros((COUNT, 3)), np.linspace(0, 1, COUNT)[:, None] * np.ones(3)])
def test_points_that_coincide_or_lie_in_a_line_are_finite(network, points):
    assert np.abs(run(network, points)).max() < 1e-2


def test_colour_and_view_are_looked_at(network, scanned, moved):
    colour = np.where(scanned[1][:, 1:2] > 0, [0.9, 0.2, 0.1], [0.1, 0.3, 0.8])
    ray = np.tile([1.0, 0.0, 0.0], (COUNT, 1))
    for given in ({"colour": colour}, {"ray": ray}):
        assert not np.allclose(run(network, scanned[0], **given), moved, atol=1e-7)
    # One colour says nothing.
    np.testing.assert_allclose(run(network, scanned[0], colour=np.full((COUNT, 3), 0.5)), moved, atol=1e-4)


@pytest.mark.parametrize("change", [{"descriptors": 1}, {"descriptors": 2}, {"attention": False}])
def test_ablations_run(change, scanned):
    sizes = {name: getattr(SMALL, name) for name in ("features", "width", "heads", "pooled", "coplanar")}
    network = AGN.of(AGNSettings(**sizes, **change), key=jax.random.key(0))
    assert np.isfinite(run(network, scanned[0])).all()
    assert len(network.others) == change.get("descriptors", 3) - 1


def test_gradients_agree_with_differences(x64, network, scanned):
    """Of the refined cloud in the cloud, and of an error in the weights; edges stay as they are."""
    params, static = eqx.partition(network, eqx.is_inexact_array)
    params = jax.tree.map(lambda leaf: leaf.astype(float), params)
    points, truth = (jnp.asarray(x) for x in scanned)
    rng = np.random.default_rng(2)
    pull = jnp.asarray(rng.standard_normal((COUNT, 3)))
    turned = jax.tree.map(lambda leaf: jnp.asarray(rng.standard_normal(leaf.shape)), params)
    shifted = jnp.asarray(rng.standard_normal((COUNT, 3)))

    @jax.jit
    def error(params, points):
        refined = points + residuals(eqx.combine(params, static), points, ALL)
        return (pull * refined).sum() + 50 * ((refined - truth) ** 2).sum()

    by_params, by_points = jax.grad(error, argnums=(0, 1))(params, points)
    step = 1e-6

    def moved(tree, way, direction):
        return jax.tree.map(lambda a, b: a + way * b, tree, direction)

    def along(of_params, of_points):
        ahead, back = (
            error(moved(params, way, of_params), points + way * of_points) for way in (step, -step)
        )
        return (ahead - back) / (2 * step)

    still = jax.tree.map(jnp.zeros_like, params)
    expected = sum(jax.tree.leaves(jax.tree.map(lambda a, b: (a * b).sum(), by_params, turned)))
    np.testing.assert_allclose(along(turned, jnp.zeros_like(points)), expected, rtol=1e-5)
    np.testing.assert_allclose(along(still, shifted), (by_points * shifted).sum(), rtol=1e-5)
