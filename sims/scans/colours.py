"""Random colours of surfaces, dark and bright: they must not give a scan's shapes away.

Patterns change colour within a plane, and bodies side by side often look alike.
"""

import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from sims.scenes.textures import AbstractTexture, Bricks, Checker, Plaster

_PLASTER, _CHECKER, _BRICKS, _LOOKS = 1, 2, 3, 4
# Share of the bodies that look as the first does, which is the wall.
_ALIKE = 0.4


class AnyTexture(AbstractTexture):
    """One of four looks, so that any surface can have any look in one compiled program.

    look: 0 plain, 1 plaster, 2 checker, 3 bricks. The patterns say where the second colour is, and how dark
    plaster is; their own colours are not read: a choice between four colours takes four times as long.
    """

    look: Int[Array, ""]
    first: Float[Array, "3"]
    second: Float[Array, "3"]
    plaster: Plaster
    checker: Checker
    bricks: Bricks

    def colour(self, uv: Float[Array, "2"]) -> Float[Array, "3"]:
        squares = (self.look == _CHECKER) & self.checker.is_second(uv)
        joints = (self.look == _BRICKS) & self.bricks.is_mortar(uv)
        shade = jnp.where(self.look == _PLASTER, self.plaster.shade(uv), 1.0)
        return jnp.clip(jnp.where(squares | joints, self.second, self.first) * shade, 0.0, 1.0)


def random_textures(scale: Float[Array, ""], draws: Float[Array, "count 14"]) -> tuple[AnyTexture, ...]:
    """Random looks for `count` bodies, of draws even over 0..1; some of the later look as the first does.

    scale: the distance at which they are seen [m]; the patterns' lengths are shares of it.
    """
    draws = jnp.where(draws[:, 13:] < _ALIKE, draws[:1], draws)
    return tuple(_texture(scale, draws[number]) for number in range(len(draws)))


def _texture(scale: Float[Array, ""], draws: Float[Array, "14"]) -> AnyTexture:
    first, second = _colour(draws[:4]), _colour(draws[4:8])
    width = scale * (0.08 + 0.2 * draws[8])
    grain = scale * (0.05 + 0.5 * draws[9])
    return AnyTexture(
        look=jnp.floor(_LOOKS * draws[10]).astype(jnp.int32),
        first=first,
        second=second,
        plaster=Plaster(first, contrast=0.02 + 0.2 * draws[11], grain=grain),
        checker=Checker(first, second, size=scale * (0.05 + 0.6 * draws[12])),
        bricks=Bricks(first, second, size=jnp.stack([width, 0.35 * width]), joint=0.06 * width),
    )


def _colour(draws: Float[Array, "4"]) -> Float[Array, "3"]:
    """A colour of any brightness, near black included, mostly pale as paints of walls are."""
    return jnp.clip((0.02 + 0.93 * draws[0]) * (1 + 0.7 * (draws[1:] - 0.5)), 0.0, 1.0)
