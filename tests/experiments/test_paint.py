"""Worlds in groups."""

import inspect

import jax
import numpy as np
import pytest

from experiments.paint import CHUNK, MOST, groups_of
from jaxpaint.compiling import batched


@pytest.mark.parametrize("worlds", [1, 64, 65, 200, 600])
def test_a_group_is_one_chunk_for_each_core(worlds):
    groups = groups_of(worlds)
    np.testing.assert_array_equal(np.concatenate(groups), np.arange(worlds))
    assert max(len(group) for group in groups) <= CHUNK * jax.local_device_count()
    assert len(groups) == -(-worlds // (CHUNK * jax.local_device_count())), "no more than it takes"


def test_the_chunk_is_the_one_that_programs_are_filled_up_to():
    assert inspect.signature(batched).parameters["chunk"].default == CHUNK


@pytest.mark.parametrize(("backend", "cores"), [("gpu", 1), ("cpu", 64)])
def test_a_group_never_needs_more_memory_than_there_is(backend, cores, monkeypatch):
    monkeypatch.setattr(jax, "default_backend", lambda: backend)
    monkeypatch.setattr(jax, "local_device_count", lambda: cores)
    assert [len(group) for group in groups_of(2 * MOST)] == [MOST, MOST]
