"""Leaves of their own for each world, inside of an argument that worlds share."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.compiling import PerWorld, batched, one_by_one, per_world, repeated, without_marks

MODEL = {"mass": jnp.arange(3.0), "length": jnp.asarray(2.0)}


def weighed(model, x):
    return model["mass"] * model["length"] * x


@pytest.mark.parametrize(
    "compiled", [batched(weighed, in_axes=(None, 0), chunk=4), one_by_one(weighed, in_axes=(None, 0))]
)
def test_a_marked_leaf_has_a_row_for_each_world(compiled):
    x = jnp.arange(5.0)
    masses = jnp.asarray(np.random.default_rng(0).normal(size=(5, 3)), jnp.float32)
    found = compiled({**MODEL, "mass": PerWorld(masses)}, x)
    np.testing.assert_allclose(found, masses * 2 * x[:, None], rtol=1e-6)


def test_values_and_their_ranges_compile_once():
    run = batched(weighed, in_axes=(None, 0), chunk=4)
    for scale in (1.0, 2.0, 3.0):
        run({**MODEL, "mass": PerWorld(scale * jnp.ones((5, 3)))}, jnp.arange(5.0))
    assert run.traces == 1


def test_other_counts_of_worlds_are_refused():
    run = batched(weighed, in_axes=(None, 0), chunk=4)
    with pytest.raises(ValueError, match="leading size"):
        run({**MODEL, "mass": PerWorld(jnp.ones((4, 3)))}, jnp.arange(5.0))


def test_marks_are_what_vmap_calls_axes():
    tree = {"mass": jnp.ones((5, 3)), "length": jnp.asarray(2.0)}
    marked = per_world(tree, {"mass": 0, "length": None})
    assert isinstance(marked["mass"], PerWorld) and not isinstance(marked["length"], PerWorld)
    batch = without_marks(marked)
    assert batch.in_axes == {"mass": 0, "length": None}
    found = jax.vmap(weighed, in_axes=(batch.in_axes, 0))(batch.tree, jnp.arange(5.0))
    np.testing.assert_allclose(found, 2 * np.arange(5.0)[:, None] * np.ones(3))
    with pytest.raises(ValueError, match="0 or None"):
        per_world(tree, {"mass": 1, "length": None})


def test_rows_are_repeated():
    found = repeated({"a": PerWorld(jnp.arange(2)), "b": jnp.ones(3)}, 2)
    assert found["a"].value.tolist() == [0, 0, 1, 1] and found["b"].shape == (3,)
