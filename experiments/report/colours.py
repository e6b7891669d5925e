"""A wall in the picture's own colours."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float

Palette = Sequence[tuple[float, float, float]]

_FAINT = 0.02  # of the full film: thinner is not shown


def wanted_colours(
    wanted: Bool[np.ndarray, "colours rows columns"], palette: Palette
) -> Float[np.ndarray, "rows columns 4"]:
    """RGBA of the picture as wanted: the last colour on top, clear where none is."""
    picture = np.zeros((*wanted.shape[1:], 4))
    for where, colour in zip(wanted, palette, strict=True):
        picture[where] = (*colour, 1)
    return picture


def paint_colours(
    films: Float[np.ndarray, "colours rows columns"], palette: Palette, full: float
) -> Float[np.ndarray, "rows columns 4"]:
    """RGBA of paint laid in the order of the colours; a film hides what is below it at `full` [m]."""
    shape = films.shape[1:]
    colour, clear = np.zeros((*shape, 3)), np.ones(shape)
    for film, own in zip(films, palette, strict=True):
        share = np.clip(film / full, 0, 1)
        share = np.where(share > _FAINT, share, 0)
        colour = share[..., None] * np.asarray(own) + (1 - share[..., None]) * colour
        clear = clear * (1 - share)
    held = np.maximum(1 - clear, 1e-9)[..., None]
    return np.concatenate([np.clip(colour / held, 0, 1), 1 - clear[..., None]], axis=-1)
