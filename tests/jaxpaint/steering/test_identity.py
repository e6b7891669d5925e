"""Twist to wheels and back is the identity, for 10,000 random twists and geometries of every kind of base."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.steering import CasterWheels, SteeredWheels, differential, driven, mecanum, wheel_commands
from jaxpaint.steering.drive import WheelMotion

CASES, DT = 10_000, 0.02


def steered(case):
    drive = SteeredWheels(case["position"], case["limit"], case["limit"])
    command = wheel_commands(drive, case["twist"], case["angle"])
    return drive, WheelMotion(command.angle, command.speed, 0 * command.speed)


def caster(case):
    return at_once(CasterWheels(case["position"], case["offset"], case["limit"], case["limit"]), case)


def with_rollers(case):
    return at_once(mecanum(case["position"], case["roller"], case["limit"]), case)


def two_wheels(case):
    return at_once(differential(case["track"], case["axle"], case["limit"]), case)


def at_once(drive, case):
    angle = case["angle"][: drive.size]
    return drive, driven(drive, case["twist"], angle, jnp.asarray(DT, angle.dtype)).motion


def cases(dtype):
    """Wheels anywhere in the four quadrants, 5 to 60 cm off both axes of a base frame that may lie aside."""
    rng = np.random.default_rng(0)
    corners = np.array([[1, 1], [1, -1], [-1, 1], [-1, -1]])
    drawn = {
        "twist": rng.normal(size=(CASES, 3)),
        "angle": rng.uniform(-np.pi, np.pi, (CASES, 4)),
        "position": corners * rng.uniform(0.05, 0.6, (CASES, 4, 2)),
        "offset": rng.uniform(0.02, 0.15, CASES),
        "roller": rng.uniform(0.5, 1.0, CASES),
        "track": rng.uniform(0.2, 0.8, CASES),
        "axle": rng.uniform(-0.3, 0.3, CASES),
        "limit": np.full(CASES, 1e4),  # nothing is held back
    }
    return {name: jnp.asarray(value, dtype) for name, value in drawn.items()}


def there_and_back(kind, case):
    if kind is two_wheels:  # the twists that it can make
        case = case | {"twist": case["twist"].at[1].set(-case["axle"] * case["twist"][2])}
    drive, motion = kind(case)
    back = drive.odometry(motion)
    off = jnp.sqrt(((back.twist - case["twist"]) ** 2).sum())
    return off, off / jnp.sqrt((case["twist"] ** 2).sum()), back.residual


@pytest.mark.parametrize("kind", [steered, caster, with_rollers, two_wheels])
@pytest.mark.parametrize("double", [True, False])
def test_twist_to_wheels_and_back_is_the_identity(kind, double):
    with jax.enable_x64(double):
        drawn = cases(jnp.float64 if double else jnp.float32)
        found = jax.jit(jax.vmap(lambda case: there_and_back(kind, case)))(drawn)
        off, relative, residual = (np.asarray(x) for x in found)
    assert off.dtype == (np.float64 if double else np.float32)
    assert np.isfinite(off).all()
    bar = off if double else relative
    assert bar.max() < (1e-10 if double else 1e-5)
    assert residual.max() < (1e-10 if double else 1e-5)
