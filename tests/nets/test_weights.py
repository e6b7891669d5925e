"""Weights in files."""

import jax
import numpy as np
import pytest

from jaxpaint.errors import InputError
from nets import weights
from nets.perceptron import Perceptron


def network(width=3, seed=0):
    return Perceptron.of([2, width, 1], key=jax.random.key(seed))


def test_what_was_written_is_read(tmp_path):
    path = tmp_path / "net.npz"
    weights.save(path, network(), {"seed": 7, "score": 0.9})
    found = weights.load(path, network(seed=1))
    for a, b in zip(jax.tree.leaves(found), jax.tree.leaves(network()), strict=True):
        np.testing.assert_array_equal(a, b)
    assert weights.about(path) == {"seed": 7, "score": 0.9}
    assert list(tmp_path.iterdir()) == [path]


def test_weights_of_another_network_are_refused(tmp_path):
    path = tmp_path / "net.npz"
    weights.save(path, network(), {})
    with pytest.raises(InputError, match="another network"):
        weights.load(path, network(width=4))


@pytest.mark.parametrize("content", [None, b"", b"no archive", "pickle", "cut"])
def test_what_is_no_file_of_weights_is_refused(content, tmp_path):
    path = tmp_path / "net.npz"
    if content == "pickle":
        np.savez(path, leaf=np.asarray([{}], object))
    elif content == "cut":
        weights.save(path, network(), {})
        path.write_bytes(path.read_bytes()[:200])
    elif content is not None:
        path.write_bytes(content)
    with pytest.raises(InputError, match=r"net\.npz: no"):
        weights.load(path, network())


def test_other_arrays_are_no_weights(tmp_path):
    np.savez(tmp_path / "net.npz", points=np.zeros(3))
    with pytest.raises(InputError, match="'about' is missing"):
        weights.about(tmp_path / "net.npz")


def test_nothing_is_left_where_it_cannot_be_written(tmp_path):
    with pytest.raises(TypeError):
        weights.save(tmp_path / "net.npz", network(), {"a set": {1}})
    assert list(tmp_path.iterdir()) == []
