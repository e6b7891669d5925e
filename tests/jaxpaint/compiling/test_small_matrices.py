"""Factorisations written out are those of the library, and no library is called."""

import itertools

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.compiling import batch_last, batched
from jaxpaint.compiling.rules import Value
from jaxpaint.compiling.small_matrices import cholesky, solve_triangular

WORLDS = 5


def positive(size, seed=0):
    A = np.random.default_rng(seed).normal(size=(WORLDS, size, size)).astype(np.float32)
    return A @ A.transpose(0, 2, 1) + size * np.eye(size, dtype=np.float32)


def test_cholesky_is_the_librarys_and_nan_where_there_is_none():
    A = positive(4)[0]
    np.testing.assert_allclose(cholesky(jnp.asarray(A)), np.linalg.cholesky(A), rtol=1e-5, atol=1e-6)
    assert np.isnan(cholesky(-jnp.asarray(A))).any()


@pytest.mark.parametrize("flags", list(itertools.product([True, False], repeat=4)))
def test_triangular_systems_are_solved(flags):
    left_side, lower, transpose_a, unit_diagonal = flags
    A = positive(3)[0]
    A = np.tril(A) if lower else np.triu(A)
    B = np.arange(12, dtype=np.float32).reshape(3, 4) if left_side else np.arange(12.0).reshape(4, 3)
    options = {
        "left_side": left_side,
        "lower": lower,
        "transpose_a": transpose_a,
        "unit_diagonal": unit_diagonal,
    }
    X = np.asarray(solve_triangular(jnp.asarray(A), jnp.asarray(B, jnp.float32), **options))
    op = np.array(A)
    if unit_diagonal:
        np.fill_diagonal(op, 1)
    op = op.T if transpose_a else op
    np.testing.assert_allclose(op @ X if left_side else X @ op, B, atol=1e-4)


def solved(A, b):
    factor = jax.scipy.linalg.cho_factor(A)
    return jax.scipy.linalg.cho_solve(factor, b)


def gradient(A, b):
    return jax.grad(lambda A: (solved(A, b) ** 2).sum())(A)


@pytest.mark.parametrize("function", [solved, gradient])
def test_equals_vmap_and_calls_no_library(function):
    A, b = positive(4), np.ones((WORLDS, 4), np.float32)
    ours = batched(function, in_axes=(0, 0), chunk=4)(A, b)
    np.testing.assert_allclose(ours, jax.vmap(function)(A, b), rtol=1e-4, atol=1e-7)

    def program(A, b):
        return [v.array for v in batch_last(jax.make_jaxpr(function)(A[..., 0], b[..., 0]), values(A, b), 5)]

    def values(*arrays):
        return [Value(x, True) for x in arrays]

    text = jax.jit(program).lower(jnp.moveaxis(A, 0, -1), jnp.moveaxis(b, 0, -1)).as_text()
    assert "custom_call" not in text


def test_large_matrices_are_left_to_the_library():
    A, b = positive(20), np.ones((WORLDS, 20), np.float32)
    ours = batched(solved, in_axes=(0, 0), chunk=4)(A, b)
    np.testing.assert_allclose(ours, jax.vmap(solved)(A, b), rtol=1e-3, atol=1e-6)


def test_what_no_result_needs_is_not_computed():
    def wasteful(x):
        unused = jnp.sin(x)
        return x + 1, jnp.cos(unused) * unused

    def program(x):
        jaxpr = jax.make_jaxpr(lambda x: wasteful(x)[0])(x[..., 0])
        return [v.array for v in batch_last(jaxpr, [Value(x, True)], 3)]

    text = jax.jit(program).lower(jnp.ones((2, 3))).as_text()
    assert "sine" not in text and "barrier" not in text
