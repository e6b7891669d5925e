"""What is between a base's twist and its wheels: the interface."""

import abc
from typing import NamedTuple

import equinox as eqx
from jaxtyping import Array, Float


class WheelMotion(NamedTuple):
    """What the encoders of a base read. angle: of the steering axes [rad], 0 where nothing steers. speed: of
    the rims [m/s]. rate: of the steering axes [rad/s].
    """

    angle: Float[Array, "w"]
    speed: Float[Array, "w"]
    rate: Float[Array, "w"]


class Stance(NamedTuple):
    """How wheels stand. angle: of the steering axes [rad], 0 where nothing steers. way: 1 for a wheel that
    was last to roll forwards, -1 backwards, 0 for one that was not told yet; see `wheel_commands`. It stays
    as it is where wheels have no choice.
    """

    angle: Float[Array, "w"]
    way: Float[Array, "w"]


class Step(NamedTuple):
    """What wheels are told for one step. stance: at its end. motion: what the encoders read meanwhile. scale:
    share of the twist that the limits left, in [0, 1].
    """

    stance: Stance
    motion: WheelMotion
    scale: Float[Array, ""]


class Odometry(NamedTuple):
    """twist: the one that fits the wheels best. residual: root mean square of what its equations are off by
    [m/s]; 0 where wheels agree.
    """

    twist: Float[Array, "3"]
    residual: Float[Array, ""]


class AbstractDrive(eqx.Module):
    """Turns a base twist (v_x, v_y [m/s], w [rad/s], in the base frame, S1-(8)) into wheels and back.

    Wheels are told by the angles of their steering axes [rad] and the speeds of their rims [m/s]. Where
    nothing steers, the angles stay 0. speed_limit: of the rims [m/s], above 0.
    """

    speed_limit: eqx.AbstractVar[Float[Array, ""]]

    @property
    @abc.abstractmethod
    def size(self) -> int:
        """The number of wheels."""

    @property
    @abc.abstractmethod
    def nonholonomic_rows(self) -> Float[Array, "k 3"]:
        """G with G twist = 0 for every twist that the base can ever make; k = 0 where it can make all."""

    @abc.abstractmethod
    def steered(
        self, twist: Float[Array, "3"], angle: Float[Array, "w"], dt: Float[Array, ""]
    ) -> Float[Array, "w"]:
        """Angles after `dt` [s] of turning towards what the twist asks for, within the rate limit.

        Without memory of the way that wheels went: see `step`.
        """

    @abc.abstractmethod
    def rolled(self, twist: Float[Array, "3"], angle: Float[Array, "w"]) -> Float[Array, "w"]:
        """Rim speeds that the twist asks of wheels at these angles [m/s]; linear in the twist."""

    @abc.abstractmethod
    def load(self, twist: Float[Array, "3"], angle: Float[Array, "w"]) -> Float[Array, ""]:
        """The largest share of a limit that the twist asks for, with wheels at these angles; 1 is the limit.

        It grows in proportion with the twist.
        """

    @abc.abstractmethod
    def step(
        self, twist: Float[Array, "3"], steer_twist: Float[Array, "3"], stance: Stance, dt: Float[Array, ""]
    ) -> Step:
        """One step of `dt` [s]: rims roll the twist, scaled whole to be within the limits.

        What has to turn before it rolls turns towards `steer_twist`, which may be ahead of the twist, or
        asked for at rest. What turns by rolling does not mind it.
        """

    @abc.abstractmethod
    def odometry(self, motion: WheelMotion) -> Odometry:
        """The twist that fits the wheels best, by least squares, and what is left over."""

    @abc.abstractmethod
    def twist(self, angle: Float[Array, "w"], speed: Float[Array, "w"]) -> Float[Array, "3"]:
        """The twist of `odometry`, where turning axes do not matter."""

    @abc.abstractmethod
    def readiness(self, twist: Float[Array, "3"], angle: Float[Array, "w"]) -> Float[Array, ""]:
        """1 where wheels at these angles can make the twist, 0 where they must turn first."""
