"""From pixels to a drawing: ink as centre-lines where it is line art, else as areas with sub-pixel rims."""

from collections.abc import Iterator
from dataclasses import replace
from functools import reduce
from operator import add
from pathlib import Path

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from jaxpaint.errors import InputError
from jaxpaint.pictures.dots import EVEN, parted
from jaxpaint.pictures.drawing import Drawing, Polyline, is_closed
from jaxpaint.pictures.ink import Ink, inks_of
from jaxpaint.pictures.ink_settings import RasterSettings
from jaxpaint.pictures.layers import Layer, laid, nothing
from jaxpaint.pictures.pixels import read_pixels
from jaxpaint.pictures.reading import Reading
from jaxpaint.pictures.reading_measure import reading_of
from jaxpaint.pictures.regions import filled
from jaxpaint.pictures.skeleton import CentreLine, centre_lines, half_width, sampled

MAX_RINGS = 5_000
_TOLERANCE = 0.15  # pixels that rims and centre-lines may be simplified by
_THIN = 0.04  # of the ink's longer side: wider lines are areas; on 1.2 m that is 48 mm, two brushes and more
# Length times width of lines, over the area of their ink: 1 for lines. Crossings, which count twice, and
# widths measured in whole pixels move it by less than this; solid shapes by more.
_FILLS = (0.7, 1.3)


def raster_drawing(path: Path, settings: RasterSettings) -> Drawing:
    """The drawing of a PNG or JPEG file, in its pixels; v up. Raises InputError."""
    settings.check()
    pixels = read_pixels(path)
    inks = inks_of(pixels, settings)
    if not inks:
        raise nothing()
    read = [_read(ink, settings) for ink in inks]
    layers = [layer for some, _ in read for layer in some]
    readings = [reading for _, reading in read if reading is not None]
    # Inks do not cover each other; the paper's colour was left out when they were found.
    others = sum(ink.others for ink in inks)
    ignored = dict.fromkeys(pixels.noted, 1) | ({"colour": others} if others else {})
    drawing = laid(layers, None, path.stem, ignored)
    return replace(drawing, reading=reduce(add, readings)) if readings else drawing


def _read(ink: Ink, settings: RasterSettings) -> tuple[list[Layer], Reading | None]:
    """The layers of one ink, and how well it was read if it is line art."""
    mask = ink.field > 0
    if settings.style != "area":
        lines = centre_lines(mask)
        if settings.style == "skeleton" or is_line_art(mask, lines):
            return _line_art(ink, mask, lines)
    return [Layer(ink.colour, _area(ink.field))], None


def _line_art(ink: Ink, mask: np.ndarray, lines: list[CentreLine]) -> tuple[list[Layer], Reading]:
    """Lines and dots, and dots wider than the lines as areas."""
    found = parted(mask, lines)
    drawn = [*_polylines(found.lines), *(np.stack([middle, middle]) for middle in found.dots)]
    layers = [Layer(ink.colour, shapely.Polygon(), tuple(_up(line) for line in drawn))]
    if found.blots.any():
        blots = _area(np.where(mask & ~found.blots, -1e-3, ink.field))
        layers = [Layer(ink.colour, blots), *layers]
    return layers, reading_of(ink.specked, drawn, found.blots)


def is_line_art(mask: np.ndarray, lines: list[CentreLine]) -> bool:
    """Whether ink is lines of an even width that is small against the picture's size."""
    if not lines:
        return False
    half = half_width(mask) + 0.25  # pixels of a thin line's middle measure a little less than half of it
    along = sampled(half, np.concatenate([line.points for line in lines]))
    width, wide = 2 * np.quantile(along, [0.5, 0.9])
    rows, columns = np.nonzero(mask)
    size = max(np.ptp(rows), np.ptp(columns)) + 1
    length = sum(np.linalg.norm(np.diff(line.points, axis=0), axis=1).sum() for line in lines)
    covers = (length * width + len(lines) * width**2 / 2) / mask.sum()
    return bool(width <= _THIN * size and wide <= EVEN * width and _FILLS[0] <= covers <= _FILLS[1])


def _polylines(lines: list[CentreLine]) -> Iterator[Polyline]:
    """Centre-lines without needless points."""
    for line in lines:
        points = np.array(shapely.LineString(line.points).simplify(_TOLERANCE).coords)
        if is_closed(line.points):
            points[-1] = points[0]
        yield points


def _up(points: Polyline) -> Polyline:
    """From (column, row) of pixels' middles to u to the right, v up, the picture's top left at the origin."""
    return (points + 0.5) * [1, -1]


def _area(field: np.ndarray) -> BaseGeometry:
    """Where a field is above 0, its rims found between pixels."""
    from skimage.measure import find_contours

    padded = np.pad(field, 1, constant_values=-max(float(field.max()), 1e-3))
    rings = [ring[:, ::-1] - 1 for ring in find_contours(padded, 0.0)]
    if len(rings) > MAX_RINGS:
        found = f"found {len(rings)} separate patches of ink"
        raise InputError(f"{found}; allowed are {MAX_RINGS} (leave out specks, or choose another threshold)")
    closed = [_up(ring) for ring in rings if is_closed(ring) and len(ring) > 3]
    return shapely.simplify(filled(closed, "evenodd"), _TOLERANCE)
