"""The numbers that the paper sets by hand, as one traced pytree."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float


class Thresholds(eqx.Module):
    """What decides between motions, with a temperature for each decision.

    At temperature 0 a decision is the hard rule, which alone is scored; above 0 it is a smooth relaxation
    that has gradients. Every leaf is traced: a sweep over any of them compiles once.

    halt_travel: Theta of S1-(13), base travel after which the base halts [m]; infinity never halts. dwell:
    least time that a halted base stays halted [s]. release_margin: distance of the brush from its best place
    before the arm at which a halted base is let go again [m]; 0 lets go at once. low_speed_scale: the
    operator S of S1-(12): the base goes to its station at this multiple of the brush's speed at most, slower
    as it comes near, but not slower than `ControllerSettings.base_least_speed`, or stands still; 0 switches
    the rule off, and the base creeps after the brush. one_sided: above 0, S1-(12) as printed, bounds from
    below only; the halt is then a plain latch. The literal reading of S1-(13) is, besides, dwell and
    release_margin 0: the base halts for one control step. park: above 0, the base moves only while the pen is
    up, and the plan waits until it has arrived (park, operate, park; S1's rival). variance_lower,
    variance_upper: the band of S1-(7) inside which poses count as independent waypoints. halt_temperature
    [m], release_temperature [m], mode_temperature [-]: temperatures of the decisions.
    """

    halt_travel: Float[Array, ""]
    dwell: Float[Array, ""]
    release_margin: Float[Array, ""]
    low_speed_scale: Float[Array, ""]
    one_sided: Float[Array, ""]
    park: Float[Array, ""]
    variance_lower: Float[Array, ""]
    variance_upper: Float[Array, ""]
    halt_temperature: Float[Array, ""]
    release_temperature: Float[Array, ""]
    mode_temperature: Float[Array, ""]


def default_thresholds(**changes: float) -> Thresholds:
    """The defaults, with the named ones changed; S1 gives the band only, the rest is ours."""
    values = {
        "halt_travel": 0.40,
        "dwell": 0.5,
        "release_margin": 0.24,
        "low_speed_scale": 3.0,
        "one_sided": 0.0,
        "park": 0.0,
        "variance_lower": 0.3,
        "variance_upper": 0.8,
        "halt_temperature": 0.0,
        "release_temperature": 0.0,
        "mode_temperature": 0.0,
    }
    unknown = set(changes) - set(values)
    if unknown:
        raise ValueError(f"thresholds: unknown {sorted(unknown)}, allowed are {sorted(values)}")
    return Thresholds(**{name: jnp.asarray(float(value)) for name, value in {**values, **changes}.items()})
