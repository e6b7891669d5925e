import hypothesis
import hypothesis.strategies as st
import jax
import jax.numpy as jnp
import numpy as np

from jaxpaint.mapping.planes import norm, unit, weighted_plane

PLANE = jax.jit(weighted_plane)


@hypothesis.given(st.integers(0, 10_000))
def test_the_plane_is_that_of_the_principal_components(seed):
    rng = np.random.default_rng(seed)
    points = rng.standard_normal((3, 40)) * rng.uniform([[0.1], [0.1], [0.001]], [[1], [1], [0.05]])
    turn, _ = np.linalg.qr(rng.standard_normal((3, 3)))
    points, weight = turn @ points + rng.standard_normal((3, 1)), rng.random(40)
    side = turn[:, 2] + 0.3 * rng.standard_normal(3)
    centre, normal = PLANE(jnp.asarray(points), jnp.asarray(weight), jnp.asarray(side / np.linalg.norm(side)))
    middle = points @ weight / weight.sum()
    local = points - middle[:, None]
    wanted = np.linalg.eigh((weight * local) @ local.T)[1][:, 0]
    np.testing.assert_allclose(centre, middle, atol=1e-5)
    assert abs(float(jnp.dot(normal, wanted))) > 1 - 1e-4
    assert float(jnp.dot(normal, side)) > 0


def test_no_plane_gives_the_guess_and_finite_gradients():
    guess = jnp.array([0.0, 0.0, -1.0])
    for points in (jnp.zeros((3, 5)), jnp.ones((3, 5))):
        centre, normal = PLANE(points, jnp.zeros(5), guess)
        np.testing.assert_array_equal(normal, guess)
        assert np.all(np.isfinite(centre))
        slope = jax.grad(lambda points: jnp.sum(weighted_plane(points, jnp.ones(5), guess)[1]))(points)
        assert np.all(np.isfinite(slope))


def test_lengths_of_nothing_have_no_gradient():
    zero, ahead = jnp.zeros(3), jnp.array([1.0, 0.0, 0.0])
    np.testing.assert_array_equal(jax.grad(norm)(zero), zero)
    np.testing.assert_array_equal(unit(zero, otherwise=ahead), ahead)
    np.testing.assert_array_equal(jax.jacobian(unit)(zero, ahead), np.zeros((3, 3)))
