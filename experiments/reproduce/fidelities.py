"""Where `kinematic`, `dynamic` and `wheeled` agree and where they part; the slip of the one fitted to the
other; and a minute of painting on wheels.
"""

import dataclasses

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from matplotlib.figure import Figure

from experiments.fidelities import (
    MOTIONS,
    Followed,
    Walk,
    fit_walk,
    follow,
    moves_of,
    random_moves,
    way_of,
)
from experiments.fidelities.figure import fidelity_figure
from experiments.fidelities.painting import painted_minute
from experiments.reproduce.result import ReproduceResult, ReproduceSettings, Row
from jaxpaint.compiling import PerWorld
from sims.dynamics import dynamic
from sims.limits import robot_limits
from sims.noise import noise_preset
from sims.odometry import OdometryNoise
from sims.robots import load_robot, robot_model
from sims.wheeled import wheeled
from sims.worlds import Fidelity, Kinematic

NAME = "fidelities"
FRICTIONS = (0.3, 0.5, 0.8, 1.0)
WORLDS, MOVES = 64, 6
# What of `Walk` is in which unit.
_UNITS = {
    "walk": "m/sqrt(m)",
    "yaw_walk": "rad/sqrt(m)",
    "scrub": "m/sqrt(rad)",
    "yaw_scrub": "rad/sqrt(rad)",
}


def run(settings: ReproduceSettings | None = None, worlds: int = WORLDS) -> ReproduceResult:
    """Rows: each motion's end off what was told, and off odometry; fitted slip, and what it is worth on other
    moves; a minute of painting.
    """
    seed = (settings or ReproduceSettings()).seed
    ways = {name: _told(fidelity) for name, fidelity in _fidelities().items()}
    rows = [row for name, found in ways.items() for row in _ends(name, found)]
    for friction in FRICTIONS:
        rows += _slip(friction, worlds, seed)
    return ReproduceResult.of([*rows, *_painting(seed, worlds)], {"ways": _figure(ways)})


def _fidelities() -> dict[str, Fidelity]:
    rolling = _wheeled()
    grips = {f"wheeled, friction {f:g}": _with_friction(rolling, f, len(MOTIONS)) for f in FRICTIONS}
    return {"kinematic": Kinematic(), "dynamic": dynamic(robot_model()), **grips}


def _wheeled() -> Fidelity:
    return wheeled(robot_model(), np.asarray(load_robot().home, float))


def _with_friction(fidelity: Fidelity, friction: float, worlds: int) -> Fidelity:
    rows = PerWorld(jnp.full((worlds,), friction))
    return eqx.tree_at(lambda f: f.physics.friction, fidelity, rows)


def _followed(fidelity: Fidelity, told, steer, noise: OdometryNoise | None = None, shocks=None) -> Followed:
    robot = load_robot()
    perfect = noise_preset("none").odometry
    limits = robot_limits(robot, clearance=False)
    return follow(fidelity, limits, noise or perfect, robot.home, told, steer, shocks)


def _told(fidelity: Fidelity) -> Followed:
    told, steer = (np.stack(x) for x in zip(*(motion.rows() for motion in MOTIONS), strict=True))
    return _followed(fidelity, told, steer)


def _ends(name: str, found: Followed) -> list[Row]:
    rows = []
    for k, motion in enumerate(MOTIONS):
        end, read = found.base[k, -1], found.odometry[k, -1]
        meant = way_of(motion.rows()[0])[-1]
        rows += [
            Row(f"{motion.name}: end off what was told [m]", name, None, _far(end, meant)),
            Row(f"{motion.name}: end off odometry [m]", name, None, _far(end, read)),
            Row(f"{motion.name}: heading off odometry [rad]", name, None, float(abs(end[2] - read[2]))),
        ]
    return rows


def _far(a: np.ndarray, b: np.ndarray) -> float:
    return float(np.linalg.norm(a[:2] - b[:2]))


def _slip(friction: float, worlds: int, seed: int) -> list[Row]:
    """Fitted on one half of the worlds, held against the other."""
    moves = [random_moves(MOVES, seed=1000 * seed + k) for k in range(worlds)]
    told, steer = (np.stack(x) for x in zip(*moves, strict=True))
    found = _followed(_with_friction(_wheeled(), friction, worlds), told, steer)
    half = worlds // 2
    walk = fit_walk(moves_of(Followed(*(x[:half] for x in found))))
    rng = np.random.default_rng(seed)
    noise = walking(walk)
    there = _followed(Kinematic(), told[half:], steer[half:], noise, rng.normal(size=told[half:].shape))
    rows = [
        Row(
            f"{field.name} [{_UNITS[field.name]}]",
            f"fitted, friction {friction:g}",
            None,
            getattr(walk, field.name),
        )
        for field in dataclasses.fields(walk)
    ]
    true, ours = _drift(Followed(*(x[half:] for x in found))), _drift(there)
    for (name, value), mine in zip(true.items(), ours.values(), strict=True):
        rows.append(Row(name, f"wheeled, friction {friction:g}", None, value))
        rows.append(Row(name, f"kinematic as fitted, friction {friction:g}", None, mine))
    return rows


def walking(walk: Walk) -> OdometryNoise:
    """Odometry with this random walk, and no other error."""
    perfect = noise_preset("none").odometry
    values = [jnp.asarray(x) for x in (walk.walk, walk.yaw_walk, walk.scrub, walk.yaw_scrub)]
    return eqx.tree_at(lambda n: [n.walk, n.yaw_walk, n.scrub, n.yaw_scrub], perfect, values)


def _drift(found: Followed) -> dict[str, float]:
    """Root mean squares over worlds after all moves."""
    off = found.base[:, -1] - found.odometry[:, -1]
    return {
        "drift of random moves, place [m]": float(np.sqrt((off[:, :2] ** 2).sum(1).mean())),
        "drift of random moves, heading [rad]": float(np.sqrt((off[:, 2] ** 2).mean())),
    }


def _painting(seed: int, worlds: int) -> list[Row]:
    found = painted_minute(worlds, seed)
    return [Row(f"a minute of painting: {name}", "wheeled", None, value) for name, value in found.items()]


def _figure(ways: dict[str, Followed]) -> Figure:
    return fidelity_figure(ways, {m.name: way_of(m.rows()[0]) for m in MOTIONS})
