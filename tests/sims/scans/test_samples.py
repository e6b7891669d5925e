"""Samples are functions of their keys, sets never meet, and settings never compile anew."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from sims.scans import SPLITS, ScanSettings, closest_point, sample_keys
from sims.sensors import DepthNoise


def test_keys_of_different_sets_seeds_and_indices_never_meet():
    keys = [
        np.asarray(jax.random.key_data(sample_keys(split, seed, first, 1000)))
        for split in SPLITS
        for seed in range(4)
        for first in (0, 1000)
    ]
    keys = np.concatenate(keys)
    assert len(np.unique(keys, axis=0)) == len(keys)


def test_an_index_has_its_key_whatever_it_is_drawn_with():
    many, few = sample_keys("test", 3, 0, 20), sample_keys("test", 3, 12, 4)
    assert np.all(jax.random.key_data(many)[12:16] == jax.random.key_data(few))


def test_an_unknown_set_is_refused():
    with pytest.raises(ValueError, match="split: 'dev' found, allowed: train, validation, test"):
        sample_keys("dev", 0, 0, 1)


def test_a_sample_is_a_function_of_its_key(batch):
    again = batch.sampler(jnp.roll(sample_keys("train", 0, 0, len(batch.samples.kind)), 7), batch.settings)
    for one, other in zip(jax.tree.leaves(again), jax.tree.leaves(batch.samples), strict=True):
        np.testing.assert_array_equal(one, np.roll(np.asarray(other), 7, axis=0))
    other = batch.more("validation")
    assert not np.any(np.all(other.scan.rays == batch.samples.scan.rays, axis=(1, 2)))


def test_settings_are_traced(batch):
    traces = batch.sampler.traces
    settings = ScanSettings(
        shares=(0.0, 1.0, 0.0),
        distance=(1.0, 1.0),
        incidence=0.2,
        bend=0.0,
        gap=0.1,
        camera=batch.settings.camera,
        noise=DepthNoise(correlation=3.4),
    )
    samples = batch.more("validation", 1, settings)
    assert batch.sampler.traces == traces
    assert np.all(np.asarray(samples.kind) == 1)
    origin, T = samples.scene.chart.origin, samples.T_map_camera
    np.testing.assert_allclose(((origin - T.p) * T.R[:, :, 2]).sum(1), 1.0, atol=1e-5)


def test_without_noise_scans_lie_on_the_surface(batch):
    quiet = replace(batch.settings, noise=DepthNoise.zero())
    samples = batch.more("validation", 2, quiet)
    nearest = jax.jit(jax.vmap(jax.vmap(closest_point, in_axes=(None, 0))))
    _, distance = nearest(samples.scene, samples.scan.points)
    valid = np.asarray(samples.scan.valid)
    assert valid.mean() > 0.8
    assert np.asarray(distance)[valid].max() < 1e-5


def test_noise_is_of_the_camera_that_was_asked_for(batch):
    samples = batch.samples
    nearest = jax.jit(jax.vmap(jax.vmap(closest_point, in_axes=(None, 0))))
    _, distance = nearest(samples.scene, samples.scan.points)
    valid = np.asarray(samples.scan.valid)
    assert 0.001 < np.median(np.asarray(distance)[valid]) < 0.01
