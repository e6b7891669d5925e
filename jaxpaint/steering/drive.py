"""What is between a base's twist and its wheels: the interface."""

import abc

import equinox as eqx
from jaxtyping import Array, Float


class AbstractDrive(eqx.Module):
    """Turns a base twist (v_x, v_y [m/s], w [rad/s], in the base frame) into wheels and back.

    Wheels are told by the angles of their steering axes [rad] and the speeds of their rims [m/s]. Where
    nothing steers, the angles stay 0. speed_limit: of the rims [m/s].
    """

    speed_limit: eqx.AbstractVar[Float[Array, ""]]

    @property
    @abc.abstractmethod
    def size(self) -> int:
        """The number of wheels."""

    @abc.abstractmethod
    def steered(
        self, twist: Float[Array, "3"], angle: Float[Array, "w"], dt: Float[Array, ""]
    ) -> Float[Array, "w"]:
        """Angles after `dt` [s] of turning towards what the twist asks for."""

    @abc.abstractmethod
    def rolled(self, twist: Float[Array, "3"], angle: Float[Array, "w"]) -> Float[Array, "w"]:
        """Rim speeds that the twist asks of wheels at these angles [m/s]."""

    @abc.abstractmethod
    def twist(self, angle: Float[Array, "w"], speed: Float[Array, "w"]) -> Float[Array, "3"]:
        """The twist that fits the wheels best, by least squares: odometry."""

    @abc.abstractmethod
    def readiness(self, twist: Float[Array, "3"], angle: Float[Array, "w"]) -> Float[Array, ""]:
        """1 where wheels at these angles can make the twist, 0 where they must turn first."""
