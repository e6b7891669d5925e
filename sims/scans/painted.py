"""A picture whose colours are made once a pixel, not once a pixel and body.

Each body of a scene colours what its ray meets before the nearest is known. With seven bodies and patterns
that any of them may have, that is nine tenths of the time that a picture takes.
"""

from dataclasses import replace

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from sims.scans.colours import AnyTexture
from sims.scenes.scene import Scene
from sims.scenes.textures import AbstractTexture
from sims.sensors.camera import Camera
from sims.sensors.rgbd import RGBD, render


class _Mark(AbstractTexture):
    """Says where a body was met, and which it is, in place of a colour."""

    number: Float[Array, ""]

    def colour(self, uv: Float[Array, "2"]) -> Float[Array, "3"]:
        return jnp.append(uv, self.number)


def render_painted(
    scene: Scene, camera: Camera, p_map_camera: Float[Array, "3"], R_map_camera: Float[Array, "3 3"]
) -> RGBD:
    """What `render` returns, for a scene all of whose textures are `AnyTexture`."""
    textures = [primitive.texture for primitive in scene.primitives]
    if not all(isinstance(texture, AnyTexture) for texture in textures):
        found = sorted({type(texture).__name__ for texture in textures})
        raise ValueError(f"scene: all textures are AnyTexture; found {', '.join(found)}")
    marks = tuple(
        replace(primitive, texture=_Mark(jnp.asarray(number, float)))
        for number, primitive in enumerate(scene.primitives)
    )
    picture = render(replace(scene, primitives=marks), camera, p_map_camera, R_map_camera)
    table = jax.tree.map(lambda *leaves: jnp.stack(leaves), *textures)
    colours = jax.vmap(_colour, in_axes=(None, 0))(table, picture.colour.reshape(-1, 3))
    colours = jnp.where(picture.valid[..., None], colours.reshape(picture.colour.shape), 0.0)
    return replace(picture, colour=colours)


def _colour(table: AnyTexture, mark: Float[Array, "3"]) -> Float[Array, "3"]:
    number = mark[2].astype(jnp.int32)
    return jax.tree.map(lambda leaf: leaf[number], table).colour(mark[:2])
