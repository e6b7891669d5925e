"""What walls and rooms are built from: plates, plaster, a floor."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from sims.scenes.charts import FoldChart, PlaneChart
from sims.scenes.primitives import Floor, Rectangle
from sims.scenes.textures import Plaster, Wood


def plate(
    chart: PlaneChart | FoldChart, left: float, right: float, height: float, texture: Plaster
) -> Rectangle:
    """The flat part of a chart between two values of u, from the floor up."""
    middle = numbers(0.5 * (left + right), 0.5 * height)
    normal = chart.normal(middle)
    up = numbers(0, 0, 1)
    return Rectangle(
        center=chart.point(middle),
        R_map_plate=jnp.stack([jnp.cross(up, normal), up, normal], axis=1),
        half=numbers(0.5 * (right - left), 0.5 * height),
        texture=texture,
    )


def plaster(red: float = 0.86, green: float = 0.85, blue: float = 0.80) -> Plaster:
    """Light plaster, the look of a wall that nobody photographed."""
    return Plaster(base=numbers(red, green, blue), contrast=numbers(0.06)[0], grain=numbers(0.35)[0])


def wooden_floor() -> Floor:
    """Boards at z = 0."""
    wood = Wood(base=numbers(0.62, 0.48, 0.34), contrast=numbers(0.12)[0], board=numbers(0.18)[0])
    return Floor(height=numbers(0)[0], texture=wood)


def numbers(*values: float) -> Float[Array, "n"]:
    """An array of floats of the usual type."""
    return jnp.asarray(values, dtype=float)
