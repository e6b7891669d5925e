"""Pictures from files."""

from pathlib import Path

import numpy as np

from jaxpaint.errors import InputError
from jaxpaint.pictures.curves import Curve
from jaxpaint.pictures.drawing import Drawing, Polyline, is_closed
from jaxpaint.pictures.markup import check_file, load_markup
from jaxpaint.pictures.svg import Ink, SvgReader

MAX_POINTS = 200_000
MAX_COORDINATE = 1e7

# All relative to the drawing's size.
_TOLERANCE = 1e-4  # a quarter of a millimetre on a drawing 2.4 m wide
_SAME = 1e-5  # lines that agree to this are one line
_MEETING = 1e-6  # ends that are nearer meet
_ROUNDING = 1e-9  # shorter steps are none


def read_drawing(path: Path) -> Drawing:
    """The lines of a picture file (.svg), curves flattened to 1e-4 of the drawing's size, corners kept.

    Strokes give their centre-lines (a dashed one as a whole), fills their outlines; a shape with both gives
    its outline once, and a line drawn twice counts once. Text, raster images, clips and masks are left out
    and counted. Whatever is wrong with the file is an InputError of one line that names it.
    """
    path = Path(path)
    try:
        check_file(path)
        _check_format(path.suffix.lower())
        reader = SvgReader(load_markup(path))
        return _drawing(reader, path.stem)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


def _check_format(suffix: str):
    if suffix in (".png", ".jpg", ".jpeg"):
        raise InputError(f"found a raster picture ({suffix}), which cannot be read yet; allowed is .svg")
    if suffix != ".svg":
        raise InputError(f"found the extension '{suffix}'; allowed is .svg")


def _drawing(reader: SvgReader, name: str) -> Drawing:
    """The ink as polylines with v up, each line once."""
    size = _size(reader.ink)
    _check_points(reader.ink, _TOLERANCE * size)
    lines: dict[bytes, tuple[Polyline, bool]] = {}
    for ink in reader.ink:
        line = _polyline(ink.curve, size)
        if len(line) < 2:
            reader.ignored["dot"] += 1
            continue
        key = _identity(line, size)
        reader.ignored.update(["duplicate"] if key in lines else [])
        lines.setdefault(key, (line, ink.filled))
    if not lines:
        raise _nothing()
    polylines, filled = zip(*lines.values(), strict=True)
    return Drawing(polylines, filled, name, dict(reader.ignored))


def _size(ink: list[Ink]) -> float:
    """The larger side of the box around all control points."""
    if not ink:
        raise _nothing()
    points = np.concatenate([piece.curve.controls.reshape(-1, 2) for piece in ink])
    if np.abs(points).max() > MAX_COORDINATE:
        raise InputError(f"found coordinates beyond {MAX_COORDINATE:.0e}; allowed are smaller ones")
    size = float(np.ptp(points, axis=0).max())
    if size == 0:
        raise _nothing()
    return size


def _check_points(ink: list[Ink], tolerance: float):
    count = sum(int(piece.curve.pieces(tolerance).sum()) for piece in ink)
    if count > MAX_POINTS:
        raise InputError(f"found a drawing of {count} points; allowed are {MAX_POINTS}")


def _nothing() -> InputError:
    return InputError("found nothing to draw; allowed is a drawing with visible strokes or fills")


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
