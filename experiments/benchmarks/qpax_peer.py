"""Peer of the batched QP: qpax, vmapped, with its defaults. Needs the extra `bench`."""

import time

import jax
import jax.numpy as jnp
import numpy as np
import qpax

from experiments.benchmarks.qp_loop_peer import QpAnswers, QpCases


def qpax_answers(cases: QpCases) -> QpAnswers:
    """In float32, as ours; the bounds are inequality rows to it."""
    inputs = _inputs(cases)
    start = time.perf_counter()
    x, converged = jax.block_until_ready(_SOLVE(*inputs))
    rate = len(cases) / (time.perf_counter() - start)
    return QpAnswers(np.asarray(x, float), np.asarray(converged) == 1, rate)


def _inputs(cases: QpCases) -> list[jax.Array]:
    count, n = cases.linear.shape
    eye = np.broadcast_to(np.eye(n), (count, n, n))
    rows = np.concatenate([eye, -eye, cases.rows], axis=1)
    limit = np.concatenate([cases.upper, -cases.lower, cases.limit], axis=1)
    arrays = (cases.hessian, cases.linear, cases.jacobian, cases.twist, rows, limit)
    return [jnp.asarray(x, jnp.float32) for x in arrays]


@jax.jit
@jax.vmap
def _SOLVE(*problem):
    solved = qpax.solve_qp(*problem)
    return solved[0], solved[4]
