"""From the shapes of an SVG file to a drawing: flattened, filled by their rules, later ink over earlier."""

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from jaxpaint.errors import InputError
from jaxpaint.pictures.curves import Curve
from jaxpaint.pictures.drawing import Drawing, Polyline, is_closed
from jaxpaint.pictures.layers import Layer, laid, nothing
from jaxpaint.pictures.palette import alike
from jaxpaint.pictures.regions import filled
from jaxpaint.pictures.svg import Ink, SvgReader

MAX_POINTS = 200_000
MAX_COORDINATE = 1e7

# All relative to the drawing's size.
_TOLERANCE = 1e-4  # a quarter of a millimetre on a drawing 2.4 m wide
_SAME = 1e-5  # lines that agree to this are one line
_MEETING = 1e-6  # ends that are nearer meet
_ROUNDING = 1e-9  # shorter steps are none


def vector_drawing(reader: SvgReader, name: str) -> Drawing:
    """The ink with v up, each line once. Raises InputError where there is nothing or too much to draw."""
    size = _size(reader.ink)
    _check_points(reader.ink, _TOLERANCE * size)
    lines = _lines_of(reader, size)
    layers: list[Layer] = []
    for ink, mine in zip(reader.ink, lines, strict=True):
        if ink.fill is not None:
            layers.append(Layer(ink.fill, _area(ink, size)))
        if ink.stroke is not None:
            covers = _covered(mine, ink.width) if alike(ink.stroke, reader.paper) else shapely.Polygon()
            layers.append(Layer(ink.stroke, shapely.Polygon(), mine, covers))
    return laid(layers, reader.paper, name, reader.ignored)


def _area(ink: Ink, size: float) -> BaseGeometry:
    """What the curves of a shape enclose; those that are open are closed by a straight line."""
    return filled([_polyline(curve.closing(), size) for curve in ink.curves], ink.rule)


def _covered(lines: tuple[Polyline, ...], width: float) -> BaseGeometry:
    """Where paper-coloured lines hide what is below them."""
    return shapely.unary_union([shapely.LineString(line).buffer(width / 2) for line in lines])


def _lines_of(reader: SvgReader, size: float) -> list[tuple[Polyline, ...]]:
    """Per shape its lines, each only where it is drawn last, which is what is seen of it; dots are none."""
    drawn: list[list[Polyline]] = [[] for _ in reader.ink]
    shown: dict[bytes, tuple[int, int]] = {}
    for i, ink in enumerate(reader.ink):
        for curve in ink.curves if ink.stroke is not None else ():
            line = _polyline(curve, size)
            if len(line) < 2:
                reader.ignored["dot"] += 1
                continue
            key = _identity(line, size)
            if key in shown:
                reader.ignored["duplicate"] += 1
            if key not in shown or _hides(ink, reader.ink[shown[key][0]], reader):
                shown[key] = i, len(drawn[i])
            drawn[i].append(line)
    kept = set(shown.values())
    return [tuple(line for j, line in enumerate(of) if (i, j) in kept) for i, of in enumerate(drawn)]


def _hides(upper: Ink, lower: Ink, reader: SvgReader) -> bool:
    """Whether a line takes the place of the same one below it: paper leaves rims of a wider one."""
    assert upper.stroke is not None
    return not alike(upper.stroke, reader.paper) or upper.width >= lower.width


def _size(ink: list[Ink]) -> float:
    """The larger side of the box around all control points."""
    controls = [curve.controls.reshape(-1, 2) for piece in ink for curve in piece.curves]
    if not controls:
        raise nothing()
    points = np.concatenate(controls)
    if np.abs(points).max() > MAX_COORDINATE:
        raise InputError(f"found coordinates beyond {MAX_COORDINATE:.0e}; allowed are smaller ones")
    size = float(np.ptp(points, axis=0).max())
    if size == 0:
        raise nothing()
    return size


def _check_points(ink: list[Ink], tolerance: float):
    count = sum(int(curve.pieces(tolerance).sum()) for piece in ink for curve in piece.curves)
    if count > MAX_POINTS:
        raise InputError(f"found a drawing of {count} points; allowed are {MAX_POINTS}")


def _polyline(curve: Curve, size: float) -> Polyline:
    """A curve's points, v up, without repeated ones; what ends where it starts does so exactly."""
    points = curve.flattened(_TOLERANCE * size) * [1, -1]
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    points = points[np.concatenate([[True], steps > _ROUNDING * size])]
    if len(points) > 3 and np.linalg.norm(points[-1] - points[0]) <= _MEETING * size:
        points[-1] = points[0]
    return points


def _identity(line: Polyline, size: float) -> bytes:
    """The same for the same line drawn from its other end, or a closed one from another of its points."""
    cells = np.round(line / (_SAME * size)).astype(np.int64)
    if not is_closed(line):
        return min(cells.tobytes(), cells[::-1].tobytes())
    ring = cells[:-1]
    return min(_from_lowest(ring), _from_lowest(ring[::-1]))


def _from_lowest(ring: np.ndarray) -> bytes:
    start = np.lexsort((ring[:, 1], ring[:, 0]))[0]
    return np.roll(ring, -start, axis=0).tobytes()
