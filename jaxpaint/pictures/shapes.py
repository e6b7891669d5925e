"""The curves of SVG's basic shapes and paths, in the element's own coordinates."""

import re
from collections.abc import Iterable

import numpy as np
import svgelements

from jaxpaint.errors import InputError
from jaxpaint.pictures.curves import Curve, chain, straight
from jaxpaint.pictures.markup import Element, excerpt

TAGS = ("circle", "ellipse", "line", "path", "polygon", "polyline", "rect")

MAX_NUMBER = 1e9

_NUMBER = re.compile(r"[-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d+)?")
_SYMBOL = re.compile(rf"{_NUMBER.pattern}|[a-zA-Z]")
_LENGTH = re.compile(rf"\s*({_NUMBER.pattern})\s*([a-zA-Z%]*)\s*")
_PATH = re.compile(r"[MmZzLlHhVvCcSsQqTtAa\d\s.,eE+-]*")
_POINTS = re.compile(r"[\d\s.,eE+-]*")
_LONGEST = 100  # characters of a length; patterns take quadratic time on absurd ones
_INCH = 96.0
_UNITS = {"": 1.0, "px": 1.0, "in": _INCH, "pt": _INCH / 72, "pc": _INCH / 6, "em": 16.0, "ex": 8.0}
_UNITS |= {"cm": _INCH / 2.54, "mm": _INCH / 25.4, "q": _INCH / 101.6}


def symbols_in(element: Element) -> int:
    """How many numbers and commands the geometry of an element is written with: what reading it will cost."""
    return sum(1 for key in ("d", "points") for _ in _SYMBOL.finditer(element.attributes.get(key, "")))


def curves_of(element: Element, viewport: tuple[float, float]) -> list[Curve]:
    """The curves of a shape; percentages refer to the viewport (width, height). Broken data: InputError."""
    if element.tag == "path":
        return _path(element.attributes.get("d", ""))
    if element.tag in ("polygon", "polyline"):
        return _points(element.attributes.get("points", ""), closed=element.tag == "polygon")
    return _basic(element, viewport)


def length(element: Element, name: str, viewport: tuple[float, float], default: str = "0") -> float:
    """An attribute that is a length, in user units."""
    text = _stated(element, name) or default
    match = _LENGTH.fullmatch(text[:_LONGEST])
    if match is None or match[2].lower() not in (*_UNITS, "%"):
        raise InputError(
            f"found {name}='{excerpt(text)}' in <{element.tag}>; allowed is a length such as 12 or 3mm"
        )
    _check_size(text)
    if match[2] == "%":
        return float(match[1]) / 100 * _across(name, viewport)
    return float(match[1]) * _UNITS[match[2].lower()]


def _stated(element: Element, name: str) -> str:
    """The text of an attribute; empty where it is absent or leaves the choice to us."""
    text = element.attributes.get(name, "").strip()
    return "" if text == "auto" else text


def _across(name: str, viewport: tuple[float, float]) -> float:
    """The length of the viewport that 100 % of an attribute stands for."""
    if name in ("x", "x1", "x2", "cx", "rx", "width"):
        return viewport[0]
    if name in ("y", "y1", "y2", "cy", "ry", "height"):
        return viewport[1]
    return float(np.hypot(*viewport) / np.sqrt(2))


def _basic(element: Element, viewport: tuple[float, float]) -> list[Curve]:
    def get(name: str, default: str = "0") -> float:
        return length(element, name, viewport, default)

    if element.tag == "line":
        ends = np.array([[get("x1"), get("y1")], [get("x2"), get("y2")]])
        return [chain(ends, closed=False)]
    if element.tag == "rect":
        radii = [get(name) if _stated(element, name) else None for name in ("rx", "ry")]
        size = get("width"), get("height")
        return _segments(svgelements.Rect(get("x"), get("y"), *size, *radii)) if min(size) > 0 else []
    radii = [get("r")] * 2 if element.tag == "circle" else [get("rx"), get("ry")]
    return _segments(svgelements.Ellipse(get("cx"), get("cy"), *radii)) if min(radii) > 0 else []


def _points(text: str, closed: bool) -> list[Curve]:
    numbers = [float(number) for number in _NUMBER.findall(text)]
    if not _POINTS.fullmatch(text) or len(numbers) % 2:
        raise InputError(f"found points='{excerpt(text)}'; allowed are pairs of numbers")
    _check_size(text)
    points = np.array(numbers).reshape(-1, 2)
    return [chain(points, closed)] if len(points) > 1 else []


def _path(text: str) -> list[Curve]:
    """The sub-paths of path data. svgelements passes over letters that it does not know: they end here."""
    stripped = text.strip()
    if not _PATH.fullmatch(stripped) or stripped[:1] not in ("", "M", "m"):
        raise InputError(
            f"found path data '{excerpt(text)}'; allowed are SVG path commands that begin with M"
        )
    _check_size(stripped)
    try:
        # SVG 1.1 lets a number end with its point, which svgelements does not read.
        return _segments(_Path(re.sub(r"(?<=\d)\.(?![\deE])", " ", stripped)))
    except (ValueError, TypeError, IndexError, ZeroDivisionError, OverflowError):
        raise InputError(
            f"found path data '{excerpt(text)}' with numbers missing; allowed is complete path data"
        ) from None


def _check_size(text: str):
    """Numbers so large that what is computed from them could overflow are an error, not a picture."""
    if any(abs(float(number)) > MAX_NUMBER for number in _NUMBER.findall(text)):
        raise InputError(
            f"found numbers beyond {MAX_NUMBER:.0e} in '{excerpt(text)}'; allowed are smaller ones"
        )


class _Path(svgelements.Path):
    """Path data, with smooth segments that continue only a curve of their own kind, as SVG has it."""

    def smooth_cubic(self, *points, **options):
        if isinstance(self[-1], svgelements.QuadraticBezier):
            return self.cubic(self.current_point, *points, **options)
        return super().smooth_cubic(*points, **options)

    def smooth_quad(self, *points, **options):
        if isinstance(self[-1], svgelements.CubicBezier):
            return self.quad(self.current_point, *points, **options)
        return super().smooth_quad(*points, **options)


def _segments(shape: svgelements.Shape) -> list[Curve]:
    """svgelements' segments as curves; a sub-path ends at the next move or where it is closed."""
    curves, controls = [], []
    for segment in shape.segments(transformed=False):
        if isinstance(segment, svgelements.Move) and controls:
            curves.append(Curve(np.array(controls), closed=False))
            controls = []
        controls.extend(_controls(segment))
        if isinstance(segment, svgelements.Close) and controls:
            curves.append(Curve(np.array(controls), closed=True))
            controls = []
    return [*curves, Curve(np.array(controls), closed=False)] if controls else curves


def _controls(segment: svgelements.PathSegment) -> Iterable[np.ndarray]:
    """The control points of one segment; none for a move, or for a close that is there already."""
    if isinstance(segment, svgelements.Move):
        return []
    if isinstance(segment, svgelements.CubicBezier):
        return [np.array([segment.start, segment.control1, segment.control2, segment.end], dtype=float)]
    if isinstance(segment, svgelements.QuadraticBezier):
        start, middle, end = np.array([segment.start, segment.control, segment.end], dtype=float)
        return [np.array([start, start + (middle - start) * 2 / 3, end + (middle - end) * 2 / 3, end])]
    if isinstance(segment, svgelements.Arc) and segment.rx > 0 and segment.ry > 0:
        return [piece for cubic in segment.as_cubic_curves() for piece in _controls(cubic)]
    start, end = np.array([segment.start, segment.end], dtype=float)
    if isinstance(segment, svgelements.Close) and (start == end).all():
        return []
    return [straight(start, end)]
