"""The paper's controller as printed, ours, and ours without each of its parts: all one compiled program."""

import dataclasses

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from experiments.tracking.study import Study
from jaxpaint.decisions.thresholds import Thresholds, default_thresholds


@dataclasses.dataclass(frozen=True)
class Variant:
    """thresholds: of the decisions. lidar, depth, strokes: whether those correct the belief. weights: of base
    effort and slack in M, where they are not the study's. drift: how much odometry drifts as the robot takes
    it, as share of what it truly does.
    """

    thresholds: Thresholds
    lidar: bool = True
    depth: bool = True
    strokes: bool = True
    weights: tuple[float, float] | None = None
    drift: float = 1.0


# What a tracking controller sees of its own error [m].
_ERROR = 1e-4


def literal(theta: float) -> Variant:
    """S1-(10) to (13) as printed, on odometry alone.

    S1-(12): lower bounds only; S takes the brush's own speed (a factor of 1: none is printed). S1-(13): the
    base halts when it has travelled Theta [m], for one control step, and is let go whatever the arm's reach.
    M: weights of S1's reference [26], 0.01 for the arm, 0.01 / e for the base and 1 / e for the slack, with e
    the error of the position, here 0.1 mm (any below 1 mm gives the same). Of ours it keeps what S1 does not
    print: the plan's clock waits where the brush is far off, manipulability, acceleration limits, dampers and
    clearance.
    """
    printed = default_thresholds(
        one_sided=1.0, low_speed_scale=1.0, halt_travel=theta, dwell=0.0, release_margin=0.0
    )
    return Variant(printed, lidar=False, depth=False, strokes=False, weights=(0.01 / _ERROR, 1 / _ERROR))


def _blind(**changes: float) -> Variant:
    return Variant(default_thresholds(**changes), lidar=False, depth=False, strokes=False)


def variants() -> dict[str, Variant]:
    """Ours, and ours without each of its parts, or with one alone."""
    return {
        "ours": Variant(default_thresholds()),
        "without looking": _blind(),
        "without lidar": Variant(default_thresholds(), lidar=False),
        "without depth": Variant(default_thresholds(), depth=False),
        "without strokes": Variant(default_thresholds(), strokes=False),
        "lidar alone": Variant(default_thresholds(), depth=False, strokes=False),
        "depth alone": Variant(default_thresholds(), lidar=False, strokes=False),
        "strokes alone": Variant(default_thresholds(), lidar=False, depth=False),
        "drift taken for half": Variant(default_thresholds(), drift=0.5),
        "drift taken for double": Variant(default_thresholds(), drift=2.0),
        "without halting": Variant(default_thresholds(halt_travel=np.inf)),
        "without low-speed rule": Variant(default_thresholds(low_speed_scale=0.0)),
        "without low-speed rule and looking": _blind(low_speed_scale=0.0),
        "without low-speed rule, halting and looking": _blind(low_speed_scale=0.0, halt_travel=np.inf),
    }


def varied(study: Study, variant: Variant) -> Study:
    """The study under a variant."""
    job = eqx.tree_at(
        lambda j: (j.thresholds, j.sight.lidar, j.sight.depth, j.sight.strokes),
        study.job,
        (
            variant.thresholds,
            *(jnp.asarray(float(x)) for x in (variant.lidar, variant.depth, variant.strokes)),
        ),
    )
    drift = jax.tree.map(lambda variance: variant.drift**2 * variance, job.sight.drift)
    job = eqx.tree_at(lambda j: j.sight.drift, job, drift)
    if variant.weights is not None:
        base, slack = variant.weights
        s = job.settings
        heavy = jnp.full_like(s.base_effort, base), jnp.full_like(s.slack_cost, slack)
        job = eqx.tree_at(lambda j: (j.settings.base_effort, j.settings.slack_cost), job, heavy)
    return dataclasses.replace(study, job=job)
