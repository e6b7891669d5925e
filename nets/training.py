"""Training: steps that depend on the seed and their number alone, so that one may stop and go on anywhere."""

from collections.abc import Callable
from typing import Any, NamedTuple, Protocol

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import optax
from jaxtyping import Array, Bool, Float, PRNGKeyArray

from jaxpaint.compiling import one_by_one
from nets.agn.anchors import Patch
from nets.agn.blocks import block_order
from nets.losses import Distances, LossWeights, distances, laplacian, loss

_AT_ONCE = 1024
"""Points whose nearest places on the surface are looked for at once."""


class Lesson(eqx.Module):
    """A scan with its truth. ray: unit, from the camera. scene: what `closest` understands. truth: samples of
    the scene's surface as far as the camera saw it, even by area; there: which of them are real.
    """

    points: Float[Array, "n 3"]
    valid: Bool[Array, " n"]
    ray: Float[Array, "n 3"]
    colour: Float[Array, "n 3"]
    scene: Any
    truth: Float[Array, "q 3"]
    there: Bool[Array, " q"]


class Network(Protocol):
    """What can be trained: from a patch to the refined cloud and which of its points are real."""

    def refined(self, patch: Patch) -> tuple[Float[Array, "n 3"], Bool[Array, " n"]]: ...


class TrainingSettings(eqx.Module):
    """steps: how many. batch: scans in each. rate: the highest learning rate, a tenth of the way in (one
    cycle of a cosine). norm: gradients longer than this are cut. hidden: share of the scans whose views, and
    of those whose colours, are not told. weights: of the loss. seed: of weights and scans.
    """

    steps: int = eqx.field(static=True, default=4000)
    batch: int = eqx.field(static=True, default=4)
    rate: float = eqx.field(static=True, default=3e-3)
    norm: float = eqx.field(static=True, default=1.0)
    hidden: float = eqx.field(static=True, default=0.25)
    seed: int = eqx.field(static=True, default=0)
    weights: LossWeights = eqx.field(default_factory=LossWeights)


class State(eqx.Module):
    """Where training stands: the network, what the optimiser keeps, and how many steps were made."""

    network: Any
    optimiser: Any
    step: Float[Array, ""]


class Step(NamedTuple):
    """Of one scan: the loss, and distances to the true surface of the raw and of the refined cloud."""

    loss: Float[Array, ""]
    raw: Distances
    refined: Distances


class Trainer:
    """Trains a network on lessons that `sample_batch(key, count)` draws, stacked.

    closest: of a scene and a point its nearest point on the scene's surface [3]. The scans of step k are
    those of fold_in(seed, k): a run that was stopped goes on with the same ones.
    """

    def __init__(
        self,
        sample_batch: Callable[[PRNGKeyArray, int], Lesson],
        closest: Callable[[Any, Float[Array, "3"]], Float[Array, "3"]],
        settings: TrainingSettings,
    ) -> None:
        self.settings, self._sample, self._closest = settings, sample_batch, closest
        s = settings
        schedule = optax.cosine_onecycle_schedule(s.steps, s.rate, pct_start=0.1)
        self._optimiser = optax.chain(optax.clip_by_global_norm(s.norm), optax.adam(schedule))
        self._slopes = one_by_one(self._slope, in_axes=(None, 0, 0))
        self._scores = one_by_one(self._score, in_axes=(None, 0))
        self._update = jax.jit(self._updated)

    def start(self, network: Network) -> State:
        """Before the first step."""
        return State(network, self._optimiser.init(_weights(network)), jnp.zeros((), jnp.int32))

    def advance(self, state: State) -> tuple[State, Step]:
        """One step; what the loss was before it, of each scan of the batch."""
        key = jax.random.fold_in(jax.random.key(self.settings.seed), state.step)
        lessons = self._sample(jax.random.fold_in(key, 0), self.settings.batch)
        keys = jax.random.key_data(jax.random.split(jax.random.fold_in(key, 1), self.settings.batch))
        step, slopes = self._slopes(state.network, lessons, keys)
        return self._update(state, slopes), step

    def validate(self, state: State, lessons: Lesson) -> Step:
        """What the loss is on lessons that were not trained with; nothing hidden."""
        return self._scores(state.network, lessons)

    def _slope(self, network, lesson: Lesson, key):
        dynamic, static = eqx.partition(network, eqx.is_inexact_array)
        lesson, coloured = self._less_told(lesson, jax.random.wrap_key_data(key))

        def value(dynamic):
            step = self._step(eqx.combine(dynamic, static), lesson, coloured)
            return step.loss, step

        (_, step), slope = jax.value_and_grad(value, has_aux=True)(dynamic)
        return step, slope

    def _score(self, network, lesson: Lesson) -> Step:
        return self._step(network, lesson, jnp.ones((), bool))

    def _less_told(self, lesson: Lesson, key: PRNGKeyArray) -> tuple[Lesson, Bool[Array, ""]]:
        """Views may be hidden, and colours: which is the second."""
        hidden = jax.random.uniform(key, (2,)) < self.settings.hidden
        ray = jnp.where(hidden[0], 0, lesson.ray)
        return eqx.tree_at(lambda s: s.ray, lesson, ray), ~hidden[1]

    def _step(self, network: Network, lesson: Lesson, coloured: Bool[Array, ""]) -> Step:
        order = block_order(lesson.points, lesson.valid)
        points, valid = lesson.points[order], lesson.valid[order]
        middle = jnp.where(valid[:, None], points, 0).sum(0) / jnp.maximum(valid.sum(), 1)
        local = jnp.where(valid[:, None], points - middle, 0)
        patch = Patch(local, valid, lesson.ray[order], lesson.colour[order], coloured)
        refined, real = network.refined(patch)
        raw = self._distances(lesson, points, valid)
        found = self._distances(lesson, refined + middle, real)
        value = loss(self.settings.weights, raw, found, laplacian(refined, real))
        return Step(value, raw, found)

    def _distances(self, lesson: Lesson, cloud, valid) -> Distances:
        fixed = jax.lax.stop_gradient(cloud)
        nearest = jax.lax.map(lambda p: self._closest(lesson.scene, p), fixed, batch_size=_AT_ONCE)
        return distances(cloud, valid, nearest, lesson.truth, lesson.there)

    def _updated(self, state: State, slopes) -> State:
        slope = jax.tree.map(lambda leaf: leaf.mean(0), slopes)
        change, optimiser = self._optimiser.update(slope, state.optimiser, _weights(state.network))
        return State(eqx.apply_updates(state.network, change), optimiser, state.step + 1)


def gains(step: Step) -> dict[str, np.ndarray]:
    """Of each scan the share of the cloud's distance to the surface that is gone: `l1` of the mean distance,
    `l2` of the mean square; one way, cloud to surface.
    """
    pairs = {
        "l1": (step.refined.there, step.raw.there),
        "l2": (step.refined.there_squared, step.raw.there_squared),
    }
    return {name: 1 - np.asarray(after) / np.asarray(before) for name, (after, before) in pairs.items()}


def _weights(network):
    return eqx.filter(network, eqx.is_inexact_array)
