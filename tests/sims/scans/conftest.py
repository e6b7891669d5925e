"""Samples that all tests of a session share: small pictures, one compiled program."""

from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from sims.scans import KINDS, Sample, Sampler, ScanSettings, sample_keys
from sims.sensors import Camera

COUNT = 300


@dataclass(frozen=True)
class Batch:
    """A program for samples, and samples of all kinds that it made.

    Other numbers of samples would compile anew: tests ask for `COUNT` too, by `batch.more`.
    """

    sampler: Sampler
    settings: ScanSettings
    samples: Sample

    def more(self, split: str, seed: int = 0, settings: ScanSettings | None = None) -> Sample:
        """Samples of a set, with these settings or the usual."""
        return self.sampler(sample_keys(split, seed, 0, COUNT), settings or self.settings)

    def of(self, kind: str) -> Sample:
        """Those of one kind."""
        chosen = np.flatnonzero(np.asarray(self.samples.kind) == KINDS.index(kind))
        return jax.tree.map(lambda x: jnp.asarray(np.asarray(x)[chosen]), self.samples)


@pytest.fixture(scope="session")
def batch() -> Batch:
    sampler = Sampler(24, 16, visible=60)
    # Windows of 24 x 16 pixels are nearly all of this picture, and as wide as those of 128 of a D435.
    camera = Camera(width=26, height=18, cx=12.5, cy=8.5, fx=20.0, fy=20.0, decimation=22)
    settings = ScanSettings(camera=camera)
    return Batch(sampler, settings, sampler(sample_keys("train", 0, 0, COUNT), settings))
