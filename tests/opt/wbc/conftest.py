"""A closed loop about the whole-body controller: odometry is right, wheels and joints do what they are
told."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.compiling import batched
from jaxpaint.decisions import Thresholds, default_thresholds
from jaxpaint.kinematics import forward
from opt.controller import Measured
from opt.plan import Samples
from opt.wbc import ControllerSettings, RobotLimits, WholeBodyController, default_settings
from sims.limits import robot_limits
from sims.odometry import moved
from sims.robots import load_robot

DT = 0.02


class Trial(NamedTuple):
    """One world. rows: of the reference, every DT. station: of the base. base, arm: where they start."""

    settings: ControllerSettings
    thresholds: Thresholds
    rows: np.ndarray
    station: np.ndarray
    base: np.ndarray
    arm: np.ndarray


class Seen(NamedTuple):
    """What happened, [worlds, steps, ...]. base_velocity: map frame. twist: what the wheels rolled."""

    error: np.ndarray
    base: np.ndarray
    arm: np.ndarray
    base_velocity: np.ndarray
    arm_velocity: np.ndarray
    twist: np.ndarray
    status: np.ndarray
    halted: np.ndarray
    clock: np.ndarray


def straight(start, velocity, steps, turn) -> np.ndarray:
    """Rows of a reference that goes straight from `start` with a fixed rotation."""
    time = DT * np.arange(steps)[:, None]
    velocity = np.broadcast_to(np.asarray(velocity, float), (steps, 3))
    still = np.tile(np.asarray(turn, float).reshape(-1), (steps, 1))
    rest = np.zeros((steps, 3)), np.ones((steps, 1))
    return np.concatenate([np.asarray(start) + time * velocity, still, velocity, *rest], axis=1).astype("f")


def closed_loop(limits: RobotLimits, steps: int, speed: float = 0.05):
    """Runs trials, each in a world of its own: `run(trials)`; `run.program.traces` counts compilations."""

    def one(limits, trial: Trial) -> Seen:
        unit = jnp.ones((), trial.rows.dtype)
        controller = WholeBodyController(
            robot=limits,
            settings=trial.settings,
            thresholds=trial.thresholds,
            reference=Samples(trial.rows, DT * unit, 0 * unit),
            stations=Samples(jnp.stack([trial.station] * 2), unit, 0 * unit),
            speed=speed * unit,
            pace=unit,
            duration=steps * DT * unit,
        )

        def step(carry, _):
            memory, base, arm, angle, clock = carry
            decision, memory = controller.decide(memory, Measured(base, arm, angle), clock, DT * unit)
            command = decision.command
            brush = forward(limits.chain, limits.joints(base, arm)).p
            error = jnp.sqrt(((decision.planned - brush) ** 2).sum())
            angle = limits.drive.steered(command.steer_twist, angle, DT * unit)
            rolled = limits.drive.twist(angle, limits.drive.rolled(command.base_twist, angle))
            seen = Seen(
                error,
                base,
                arm,
                memory.base_velocity,
                memory.arm_velocity,
                rolled,
                decision.fault,
                decision.halted,
                clock,
            )
            after = moved(base, rolled * DT), arm + DT * command.arm_velocity, angle
            return (memory, *after, clock + DT * decision.rate), seen

        angle = jnp.zeros(limits.drive.size)
        begin = controller.initial(Measured(trial.base, trial.arm, angle))
        return jax.lax.scan(step, (begin, trial.base, trial.arm, angle, 0 * unit), length=steps)[1]

    program = batched(one, in_axes=(None, 0), chunk=4)

    def run(*trials: Trial) -> Seen:
        stacked = jax.tree.map(lambda *x: np.stack([np.asarray(v, np.float32) for v in x]), *trials)
        return jax.tree.map(np.asarray, program(limits, stacked))

    run.program = program
    return run


@pytest.fixture(scope="session")
def robot():
    return load_robot()


@pytest.fixture(scope="session")
def limits(robot) -> RobotLimits:
    return robot_limits(robot)


@pytest.fixture(scope="session")
def brush(robot):
    """The brush's pose at home, the base at the origin."""
    return jax.tree.map(np.asarray, forward(robot.chain, robot.at_home(jnp.zeros(3))))


STEPS = 400


@pytest.fixture(scope="session")
def follow(limits):
    """The reference robot's closed loop: 400 steps."""
    return closed_loop(limits, STEPS)


@pytest.fixture(scope="session")
def ordinary(robot, brush) -> Trial:
    """A brush that goes sideways at 50 mm/s, the base's station beside it."""
    rows = straight(brush.p, [0, 0.05, 0], STEPS, brush.R)
    station = np.array([0, 0.4, 0], np.float32)
    return Trial(
        default_settings(), default_thresholds(), rows, station, np.zeros(3, "f"), np.asarray(robot.home)
    )
