"""What a controller is: it sees what the robot can see and commands the base and the arm."""

import abc
from typing import NamedTuple

import equinox as eqx
import numpy as np
from jaxtyping import Array, Float, Int, PyTree


class Measured(NamedTuple):
    """What the robot knows of itself: base pose by odometry (x, y, yaw), arm encoders [rad], steering angles
    [rad].
    """

    base: Float[Array, "3"]
    arm: Float[Array, "a"]
    wheel_angle: Float[Array, "w"]


class Command(NamedTuple):
    """What the drives receive.

    base_twist: (v_x, v_y, w) in the base frame. steer_twist: the twist that the wheels turn towards, also at
    rest. arm_velocity: of the joints [rad/s].
    """

    base_twist: Float[Array, "3"]
    steer_twist: Float[Array, "3"]
    arm_velocity: Float[Array, "a"]


class Decision(NamedTuple):
    """A command and what is recorded with it.

    rate: how fast the clock of the plan may go on (1 in time, 0 waits). planned: brush position that the plan
    asks for now [m]. pen: 1 down. halted: 1 while the base is halted. fault: not 0 where the program of this
    step was not solved, or the target was given up (`ControlStatus`).
    """

    command: Command
    rate: Float[Array, ""]
    planned: Float[Array, "3"]
    pen: Float[Array, ""]
    halted: Float[Array, ""]
    fault: Int[Array, ""]


class Surface(NamedTuple):
    """The tangent plane of the mapped surface before the brush. point, normal (unit, out of the wall): map
    frame [m]. known: 1, or 0 where the plan has no surface there.
    """

    point: Float[Array, "3"]
    normal: Float[Array, "3"]
    known: Float[Array, ""]


class Controller(eqx.Module):
    """Follows a plan on the plan's own clock."""

    duration: eqx.AbstractVar[Float[Array | np.ndarray, ""]]

    @abc.abstractmethod
    def initial(self, measured: Measured) -> PyTree:
        """What the controller remembers at the start."""

    @abc.abstractmethod
    def surface(self, clock: Float[Array, ""]) -> Surface | None:
        """What the plan knows of the surface at plan time `clock` [s]; None where it never knows any."""

    @abc.abstractmethod
    def decide(
        self, memory: PyTree, measured: Measured, clock: Float[Array, ""], dt: Float[Array, ""]
    ) -> tuple[Decision, PyTree]:
        """One control step at plan time `clock` [s]."""
