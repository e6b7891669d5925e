"""Colours of surfaces as functions of the surface's own coordinates [m]."""

import abc

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float


class AbstractTexture(eqx.Module):
    """A colour in 0..1 at each point of a surface."""

    @abc.abstractmethod
    def colour(self, uv: Float[Array, "2"]) -> Float[Array, "3"]:
        """Colour at surface coordinates uv [m]."""


class Plain(AbstractTexture):
    """One colour all over."""

    base: Float[Array, "3"]

    def colour(self, uv: Float[Array, "2"]) -> Float[Array, "3"]:
        return self.base


class Plaster(AbstractTexture):
    """Soft irregular shading. grain: its coarsest wavelength [m]. contrast: share of the base colour."""

    base: Float[Array, "3"]
    contrast: Float[Array, ""]
    grain: Float[Array, ""]

    def shade(self, uv: Float[Array, "2"]) -> Float[Array, ""]:
        """What the base colour is multiplied by."""
        u, v = uv[0] * (2 * jnp.pi) / self.grain, uv[1] * (2 * jnp.pi) / self.grain
        # Waves whose lengths share no common multiple never visibly repeat.
        waves = jnp.sin(u + 0.7 * v) + jnp.sin(1.618 * v - 0.9 * u + 1.0) * 0.8
        waves = waves + jnp.sin(2.414 * u + 1.3 * v + 2.0) * 0.6 + jnp.sin(3.303 * v - 2.1 * u + 0.5) * 0.5
        return 1 + self.contrast * waves / 2.9

    def colour(self, uv: Float[Array, "2"]) -> Float[Array, "3"]:
        return jnp.clip(self.base * self.shade(uv), 0.0, 1.0)


class Checker(AbstractTexture):
    """Squares of two colours. size: edge of a square [m]."""

    first: Float[Array, "3"]
    second: Float[Array, "3"]
    size: Float[Array, ""]

    def is_second(self, uv: Float[Array, "2"]) -> Bool[Array, ""]:
        """Whether the square there has the second colour."""
        return _remainder(jnp.floor(uv[0] / self.size) + jnp.floor(uv[1] / self.size), 2.0) > 0.5

    def colour(self, uv: Float[Array, "2"]) -> Float[Array, "3"]:
        return jnp.where(self.is_second(uv), self.second, self.first)


class Bricks(AbstractTexture):
    """Running bond. size: width and height of a brick with its joint [m]; joint: width of the mortar [m]."""

    brick: Float[Array, "3"]
    mortar: Float[Array, "3"]
    size: Float[Array, "2"]
    joint: Float[Array, ""]

    def is_mortar(self, uv: Float[Array, "2"]) -> Bool[Array, ""]:
        """Whether there is a joint."""
        course = jnp.floor(uv[1] / self.size[1])
        across = _remainder(uv[0] + 0.5 * self.size[0] * _remainder(course, 2.0), self.size[0])
        up = _remainder(uv[1], self.size[1])
        return (across < self.joint) | (up < self.joint)

    def colour(self, uv: Float[Array, "2"]) -> Float[Array, "3"]:
        return jnp.where(self.is_mortar(uv), self.mortar, self.brick)


class Wood(AbstractTexture):
    """Boards along u with a wavy grain. board: height of a board [m]; contrast: share of the base colour."""

    base: Float[Array, "3"]
    contrast: Float[Array, ""]
    board: Float[Array, ""]

    def colour(self, uv: Float[Array, "2"]) -> Float[Array, "3"]:
        along, across = uv[0] / self.board, uv[1] / self.board
        wave = across * 7 + 0.6 * jnp.sin(1.3 * along + 2.1 * jnp.floor(across))
        joint = jnp.mod(across, 1.0) < 0.03
        shade = jnp.sin(2 * jnp.pi * wave) * 0.5 - jnp.where(joint, 1.5, 0.0)
        return jnp.clip(self.base * (1 + self.contrast * shade), 0.0, 1.0)


class Photograph(AbstractTexture):
    """Colours as captured, on the cells of a height map; (left, low) is the middle of cell (0, 0) [m]."""

    image: Float[Array, "V U 3"]
    left: Float[Array, ""]
    low: Float[Array, ""]
    cell: Float[Array, ""]

    def colour(self, uv: Float[Array, "2"]) -> Float[Array, "3"]:
        rows, columns = self.image.shape[:2]
        column = jnp.clip(jnp.round((uv[0] - self.left) / self.cell), 0, columns - 1).astype(int)
        row = jnp.clip(jnp.round((uv[1] - self.low) / self.cell), 0, rows - 1).astype(int)
        return self.image[row, column]


def _remainder(value: Float[Array, ""], size: Float[Array, ""] | float) -> Float[Array, ""]:
    """`value` modulo `size`. Not `jnp.mod`: on CPUs that is the library's fmod, one number at a time, and
    takes ten times as long as all else in a picture.
    """
    return value - size * jnp.floor(value / size)
