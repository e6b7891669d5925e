"""What every reader of a cloud file hands over."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float


@dataclass(frozen=True)
class Records:
    """The rows of a file as they stand, missing points (NaN) included."""

    points: Float[np.ndarray, "N 3"]
    colours: Float[np.ndarray, "N 3"] | None
    shape: tuple[int, int] | None
    viewpoint: Float[np.ndarray, "3"]

    @staticmethod
    def of(
        points: np.ndarray,
        *,
        colours: np.ndarray | None = None,
        shape: tuple[int, int] | None = None,
        viewpoint: np.ndarray | None = None,
    ) -> "Records":
        """Brings a reader's arrays to one form; colours in 0..255 are brought to 0..1."""
        points = np.asarray(points, dtype=np.float64)
        return Records(
            points=points,
            colours=None if colours is None else _unit_colours(colours, len(points)),
            shape=shape,
            viewpoint=np.zeros(3) if viewpoint is None else np.asarray(viewpoint, dtype=np.float64),
        )


def _unit_colours(colours: np.ndarray, count: int) -> Float[np.ndarray, "N 3"] | None:
    if colours.size != 3 * count:
        return None
    whole = np.issubdtype(colours.dtype, np.integer)
    values = colours.reshape(count, 3).astype(np.float64)
    finite = np.where(np.isfinite(values), values, 0.0)
    full = 65535.0 if colours.dtype == np.uint16 else 255.0
    return np.clip(finite / full if whole or finite.max(initial=0.0) > 1.0 else finite, 0.0, 1.0)
