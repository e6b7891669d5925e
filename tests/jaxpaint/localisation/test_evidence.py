"""Evidence adds up as measurements do."""

import jax
import jax.numpy as jnp
import numpy as np

from jaxpaint.localisation import no_evidence
from jaxpaint.localisation.evidence import evidence_of


def test_two_halves_are_the_whole(strict_ranks):
    rng = np.random.default_rng(0)
    rows, residual, precision, share = (
        jnp.asarray(x)
        for x in (rng.normal(size=(9, 3)), rng.normal(size=9), rng.uniform(1, 2, 9), rng.uniform(0, 1, 9))
    )
    whole = evidence_of(rows, residual, precision, share)
    halves = [evidence_of(rows[k], residual[k], precision[k], share[k]) for k in (slice(4), slice(4, 9))]
    jax.tree.map(lambda a, b: np.testing.assert_allclose(a, b, rtol=1e-5), halves[0] + halves[1], whole)
    nothing = no_evidence(jnp.float32)
    jax.tree.map(lambda a, b: np.testing.assert_allclose(a, b, rtol=1e-6), nothing + whole, whole)
    jax.tree.map(lambda a, b: np.testing.assert_array_equal(a, b), nothing + nothing, nothing)


def test_it_is_a_gauss_newton_step():
    """Rows that were off by J d lead back to d."""
    rng = np.random.default_rng(1)
    rows, error = rng.normal(size=(6, 3)), np.array([0.01, -0.02, 0.03])
    one = jnp.ones(6)
    found = evidence_of(jnp.asarray(rows), jnp.asarray(-rows @ error), 4 * one, one)
    np.testing.assert_allclose(np.linalg.solve(found.information, found.vector), error, rtol=1e-3)
    np.testing.assert_allclose(found.residual, np.sqrt(np.mean((rows @ error) ** 2)), rtol=1e-5)
