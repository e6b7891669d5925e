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
        """Angles after `dt` [s] of turning towards what the twist asks for, within the rate limit."""

    @abc.abstractmethod
    def rolled(self, twist: Float[Array, "3"], angle: Float[Array, "w"]) -> Float[Array, "w"]:
        """Rim speeds that the twist asks of wheels at these angles [m/s]; linear in the twist."""

    @abc.abstractmethod
    def load(self, twist: Float[Array, "3"], angle: Float[Array, "w"]) -> Float[Array, ""]:
        """The largest share of a limit that the twist asks for, with wheels at these angles; 1 is the limit.

        It grows in proportion with the twist.
        """

    @abc.abstractmethod
    def motion(self, twist: Float[Array, "3"], angle: Float[Array, "w"], dt: Float[Array, ""]) -> WheelMotion:
        """What the encoders read while the twist is driven for `dt` [s] by wheels that stood at `angle`."""

    @abc.abstractmethod
    def odometry(self, motion: WheelMotion) -> Odometry:
        """The twist that fits the wheels best, by least squares, and what is left over."""

    @abc.abstractmethod
    def twist(self, angle: Float[Array, "w"], speed: Float[Array, "w"]) -> Float[Array, "3"]:
        """The twist of `odometry`, where turning axes do not matter."""

    @abc.abstractmethod
    def readiness(self, twist: Float[Array, "3"], angle: Float[Array, "w"]) -> Float[Array, ""]:
        """1 where wheels at these angles can make the twist, 0 where they must turn first."""
