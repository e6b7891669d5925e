"""Scans with their truth, made on the fly: to train on, to choose by, and to score on.

A sample is a function of its key alone. Keys of different sets, seeds or indices never meet.
"""

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Int, Key, PRNGKeyArray, UInt32

from jaxpaint.compiling import batched
from jaxpaint.kinematics.pose import Pose
from sims.scans.painted import render_painted
from sims.scans.random_scenes import random_scene
from sims.scans.scan import Scan, as_scan
from sims.scans.settings import ScanSettings
from sims.scans.visible import Visible, visible_surface
from sims.scans.window import random_window
from sims.scenes.scene import Scene
from sims.sensors.camera import Camera
from sims.sensors.depth_noise import observe

SPLITS = ("train", "validation", "test")
"""The sets, by their number. The test set is for scores only: nothing is chosen by it."""

# Samples that an accelerator makes side by side.
_ON_GPU = 16


class Sample(eqx.Module):
    """A scan and what is true of it.

    scene: of which it is; `closest_point` has its exact surface. visible: samples of what the scan saw.
    camera, T_map_camera: the window that took it, and from where. kind: number in `KINDS`.
    """

    scan: Scan
    scene: Scene
    visible: Visible
    camera: Camera
    T_map_camera: Pose
    kind: Int[Array, ""]


def sample_keys(split: str, seed: int, first: int, count: int) -> Key[Array, "count"]:
    """The keys of samples `first` to `first + count - 1` of a set: split, seed, index folded in, in turn."""
    if split not in SPLITS:
        raise ValueError(f"split: '{split}' found, allowed: {', '.join(SPLITS)}")
    of_split = jax.random.fold_in(jax.random.key(0), SPLITS.index(split))
    of_seed = jax.random.fold_in(of_split, seed)
    return jax.vmap(jax.random.fold_in, in_axes=(None, 0))(of_seed, first + jnp.arange(count))


def sample_scan(
    settings: ScanSettings, width: int, height: int, visible: int, *, key: PRNGKeyArray
) -> Sample:
    """One random scene, a scan of it of `width` x `height` pixels, and `visible` points of what that saw."""
    keys = jax.random.split(key, 5)
    drawn = jax.random.uniform(keys[0]) * settings.shares.sum()
    kind = (drawn >= jnp.cumsum(settings.shares)[:-1]).sum().astype(jnp.int32)
    camera = random_window(settings.camera, width, height, key=keys[1])
    scene, T_map_camera = random_scene(kind, camera, settings, key=keys[2])
    truth = render_painted(scene, camera, T_map_camera.p, T_map_camera.R)
    picture = observe(truth, camera, settings.noise, key=keys[3])
    seen = visible_surface(scene, T_map_camera, camera, truth, picture.valid, visible, key=keys[4])
    return Sample(as_scan(picture, camera, T_map_camera), scene, seen, camera, T_map_camera, kind)


class Sampler:
    """A compiled program that makes the samples of many keys, stacked.

    One compilation for each number of keys, whatever the settings. With barriers (`batched`) a scan takes a
    CPU a ninth of the time that it takes by `jax.vmap` or `one_by_one`. `traces` and `compile_s` as of
    `Batched`.
    """

    def __init__(self, width: int = 128, height: int = 128, visible: int = 2000):
        def one(data: UInt32[Array, "2"], settings: ScanSettings) -> Sample:
            return sample_scan(settings, width, height, visible, key=jax.random.wrap_key_data(data))

        # One picture at a time stays in a CPU's cache: four take half as long again for each.
        chunk = 1 if jax.default_backend() == "cpu" else _ON_GPU
        self._program = batched(one, in_axes=(0, None), chunk=chunk)

    def __call__(self, keys: Key[Array, "n"], settings: ScanSettings) -> Sample:
        """One sample for each key: of `sample_keys`, or `jax.random.split` from one of them."""
        # As numbers: where devices share the work, numbers can be padded and keys cannot.
        return self._program(jax.random.key_data(keys), settings)

    @property
    def traces(self) -> int:
        """How often the function of one sample was traced."""
        return self._program.traces

    @property
    def compile_s(self) -> float:
        """Seconds that tracing and compiling took."""
        return self._program.compile_s
