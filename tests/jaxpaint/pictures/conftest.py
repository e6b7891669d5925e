"""Small SVG files for the tests of pictures, and a brush as a disc on pixels."""

from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest

from jaxpaint.pictures import Drawing, Strokes, read_drawing


@pytest.fixture
def svg_file(tmp_path: Path) -> Callable[..., Path]:
    """Writes a page of 100 x 100; lines are black and areas empty unless the body says otherwise."""

    def write(
        body: str, head: str = 'viewBox="0 0 100 100" fill="none" stroke="black"', before: str = ""
    ) -> Path:
        path = tmp_path / "picture.svg"
        namespaces = 'xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink"'
        path.write_text(f"{before}<svg {namespaces} {head}>{body}</svg>")
        return path

    return write


@pytest.fixture
def draw(svg_file: Callable[..., Path]) -> Callable[..., Drawing]:
    """The drawing of a page with this body."""
    return lambda *args, **kwargs: read_drawing(svg_file(*args, **kwargs))


CELL = 0.0005
_PAD = 0.03


class Wall:
    """Pixels of half a millimetre around a drawing in canvas metres: what strokes cover of ink, found without
    the code that plans them.
    """

    def __init__(self, drawing: Drawing):
        lower, upper = drawing.bounds
        self.origin = lower - _PAD
        self.shape = tuple(int(n) for n in np.ceil((upper - lower + 2 * _PAD) / CELL)[::-1])
        self.areas = [self._area(area.rings) for area in drawing.areas]
        self.ink = np.any(self.areas, axis=0)

    def painted(self, strokes: Strokes, radius: float) -> np.ndarray:
        """Pixels within a radius of a stroke."""
        picture = np.full(self.shape, 255, np.uint8)
        cv2.polylines(picture, [self._fixed(line) for line in strokes.lines], False, 0, shift=4)
        return cv2.distanceTransform(picture, cv2.DIST_L2, cv2.DIST_MASK_PRECISE) * CELL <= radius

    def coverage(self, paint: np.ndarray) -> float:
        """Of the area that is covered least."""
        return min(float((area & paint).sum() / area.sum()) for area in self.areas)

    def excess(self, paint: np.ndarray, margin: float = 0.005) -> float:
        """Paint further than a margin outside the ink, over the ink."""
        away = cv2.distanceTransform((~self.ink).astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE) * CELL
        return float((paint & (away > margin)).sum() / self.ink.sum())

    def _area(self, rings) -> np.ndarray:
        picture = np.zeros(self.shape, np.uint8)
        cv2.fillPoly(picture, [self._fixed(ring) for ring in rings], 1, shift=4)
        return picture.astype(bool)

    def _fixed(self, line: np.ndarray) -> np.ndarray:
        return np.rint((line - self.origin) / CELL * 16).astype(np.int32)


@pytest.fixture(scope="session")
def wall() -> type[Wall]:
    """Makes the pixels around a drawing."""
    return Wall
