"""Batch-last evaluation is vmap, and its barriers hold in the compiled program."""

import importlib

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.compiling import batch_last, batched, one_by_one, rules
from jaxpaint.compiling.batched import CPU_OPTIONS
from jaxpaint.compiling.rules import Value

WORLDS = 11
batch_last_module = importlib.import_module("jaxpaint.compiling.batch_last")


def everything(x, y, scale):
    """One of each construct that the programs of this project use."""
    A = jnp.outer(x, y) + scale * jnp.eye(3)

    def step(c, i):
        c = A @ c / (1 + jnp.abs(A @ c).sum())
        return jnp.where(c[0] > 0, c, c[::-1]), c.sum() * i

    carried, rows = jax.lax.scan(step, x, jnp.arange(4.0))
    return {
        "scan": (carried, rows),
        "while": jax.lax.while_loop(lambda t: t > 1, lambda t: t * 0.5, jnp.abs(x[0]) * 10),
        "fori": jax.lax.fori_loop(0, 3, lambda i, c: c * y[i], x),
        "cond": jax.lax.cond(x[1] > 0, lambda a: a * 2, lambda a: a - 1, y),
        "take": x[jnp.argmax(y)],
        "slice": jax.lax.dynamic_slice_in_dim(x, jnp.argmin(y), 2),
        "update": jax.lax.dynamic_update_index_in_dim(x, 7.0, 1, 0),
        "sort": jnp.sort(x),
        "random": jax.random.normal(jax.random.key(jnp.int32(y[0] * 100)), (2,)),
        "einsum": jnp.einsum("ij,kj->ik", A, A),
        "empty": A[:, :0] @ A[:0],
        "pad": jnp.pad(x, (1, 2)),
        "constant": jnp.zeros(2),
        "cumsum": jnp.cumsum(x)[::-1],
        "stack": jnp.stack([x, 2 * y, jnp.ones(3)], axis=1),
        "unstack": jnp.unstack(A, axis=1),
        "split": jnp.split(A, [1], axis=1),
        "places": A[np.array([2, 0]), :],
        "places inside": A[:, np.array([2, 0])],
        "element": A[np.array([1]), np.array([2])],
        "set": A.at[np.array([2, 0])].set(y[:2, None]),
        "add": A.at[:, np.array([1, 1])].add(x[:, None]),
        "extreme": jnp.abs(A).max(),
    }


def inputs():
    rng = np.random.default_rng(0)
    x = rng.normal(size=(WORLDS, 3)).astype(np.float32)
    return x, (0.3 * x[:, ::-1]).copy(), np.float32(0.1)


def gradient(x, y, scale):
    return jax.grad(lambda x: sum(jnp.sum(leaf) for leaf in everything(x, y, scale)["scan"]))(x)


@pytest.mark.parametrize("function", [everything, gradient])
@pytest.mark.parametrize("chunk", [4, 32])
def test_equals_vmap(function, chunk):
    args = inputs()
    ours = batched(function, in_axes=(0, 0, None), chunk=chunk)(*args)
    reference = jax.vmap(function, in_axes=(0, 0, None))(*args)
    jax.tree.map(lambda a, b: np.testing.assert_allclose(a, b, rtol=2e-6, atol=1e-6), ours, reference)


@pytest.mark.parametrize("function", [everything, gradient])
def test_loops_in_blocks_equal_vmap(function):
    args = inputs()
    ours = batched(function, in_axes=(0, 0, None), chunk=8, block=2)(*args)
    reference = jax.vmap(function, in_axes=(0, 0, None))(*args)
    jax.tree.map(lambda a, b: np.testing.assert_allclose(a, b, rtol=2e-6, atol=1e-6), ours, reference)


def places(x, y, scale):
    """Operations that the worlds need not be moved for."""
    found = everything(x, y, scale)
    return {k: found[k] for k in ("stack", "unstack", "split", "places", "places inside", "set", "add")}


def places_gradient(x, y, scale):
    return jax.grad(lambda x: sum(jnp.sum(leaf) for leaf in jax.tree.leaves(places(x, y, scale))))(x)


@pytest.mark.parametrize("function", [places, places_gradient])
def test_worlds_stay_last(function, monkeypatch):
    """JAX's own batching rules move them to the front and back, and take whole programs apart."""
    moved = []
    monkeypatch.setattr(rules, "fallback", lambda equation, *_: moved.append(equation.primitive.name))
    monkeypatch.setattr(batch_last_module, "fallback", rules.fallback)
    batched(function, in_axes=(0, 0, None), chunk=8)(*inputs())
    assert moved == []


def test_blocks_divide_a_chunk():
    with pytest.raises(ValueError, match="block: chunk is a multiple"):
        batched(everything, in_axes=(0, 0, None), chunk=8, block=3)


def test_one_by_one_equals_vmap():
    args = inputs()
    ours = one_by_one(everything, in_axes=(0, 0, None))(*args)
    reference = jax.vmap(everything, in_axes=(0, 0, None))(*args)
    jax.tree.map(lambda a, b: np.testing.assert_allclose(a, b, rtol=2e-6, atol=1e-6), ours, reference)


def test_values_change_without_a_new_trace():
    run = batched(everything, in_axes=(0, 0, None), chunk=4)
    x, y, scale = inputs()
    run(x, y, scale)
    spent = run.compile_s
    run(2 * x, y + 1, np.float32(0.7))
    assert run.traces == 1
    assert run.compile_s == spent > 0


def test_a_world_does_not_depend_on_its_neighbours():
    run = batched(everything, in_axes=(0, 0, None), chunk=4)
    x, y, scale = inputs()
    alone = run(x[:6], y[:6], scale)
    broken = x.copy()
    broken[2] = np.nan
    beside = run(broken, y, scale)
    kept = [0, 1, 3, 4, 5]
    jax.tree.map(
        lambda a, b: np.testing.assert_array_equal(np.asarray(a)[kept], np.asarray(b)[kept]), alone, beside
    )


def test_sizes_that_do_not_match_are_refused():
    x, y, scale = inputs()
    with pytest.raises(ValueError, match="in_axes"):
        batched(everything, in_axes=(0, 0, None))(x, y[:-1], scale)


def rotations(angles):
    """A chain in which every value is read twice, as in kinematics."""
    x, y = jnp.ones(()), jnp.zeros(())
    for i in range(angles.shape[0]):
        c, s = jnp.cos(angles[i]), jnp.sin(angles[i])
        x, y = c * x - s * y, s * x + c * y
    return x, y


def chain_program(options):
    def program(angles):
        out = batch_last(jax.make_jaxpr(rotations)(angles[:, 0]), [Value(angles, True)], 8)
        return [v.array for v in out]

    text = jax.jit(program).lower(jnp.ones((6, 8))).compile(compiler_options=options).as_text()
    assert text is not None
    return text


@pytest.mark.skipif(jax.default_backend() != "cpu", reason="the options are for the CPU")
def test_barriers_hold_with_our_options_and_only_with_them():
    """If a release renames the pass, barriers vanish from the program and speed with them."""
    assert chain_program(CPU_OPTIONS).count("opt-barrier(") >= 6
    assert "opt-barrier(" not in chain_program(None)
