"""Noise presets: one set of figures for each of the papers' settings, frozen and named."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxpaint.errors import InputError
from sims.odometry import OdometryNoise
from sims.sensors import DepthNoise


class NoisePreset(eqx.Module):
    """odometry, depth: what disturbs them. start: standard deviation of the robot's start pose about the
    nominal one (x, y [m], yaw [rad]); odometry starts there without error, it is where the map begins.
    """

    odometry: OdometryNoise
    depth: DepthNoise
    start: Float[Array, "3"]


def s1_simulation() -> NoisePreset:
    """S1's Gazebo runs (table I); provisional until calibrated against its 24 mm.

    Dead band 5 mm/s at the rim. Over worlds: 0.3 % of travel, 0.3 % of rotation, 0.04 deg/m. Along the way:
    0.7 mm and 0.03 deg per square root of a metre. Scrub: 0.2 mm and 0.01 deg a radian. Start: 30 mm, 30 mm,
    1 deg. Depth: as `DepthNoise()`, a D435.
    """
    return _preset([0.005, 0.003, 0.0007, 0.003, 0.0007, 0.0005, 0.0002, 0.00017], [0.03, 0.03, 0.0175])


def none() -> NoisePreset:
    """A perfect world: nothing slips, everything is measured; the start pose varies as in `s1_simulation`."""
    perfect = _preset([0.0] * 8, [0.03, 0.03, 0.0175])
    return NoisePreset(perfect.odometry, DepthNoise.zero(), perfect.start)


def _preset(odometry: list[float], start: list[float]) -> NoisePreset:
    return NoisePreset(OdometryNoise(*(jnp.asarray(x) for x in odometry)), DepthNoise(), jnp.asarray(start))


PRESETS = {"s1-simulation": s1_simulation, "none": none}


def noise_preset(name: str) -> NoisePreset:
    """The preset of that name."""
    if name not in PRESETS:
        raise InputError(f"--noise: unknown preset '{name}', allowed are {', '.join(sorted(PRESETS))}")
    return PRESETS[name]()
