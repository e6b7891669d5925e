"""Areas as sets of points of the plane (shapely geometries), and back."""

from collections.abc import Iterator, Sequence

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from jaxpaint.errors import InputError
from jaxpaint.pictures.drawing import Area, Polyline

_MAX_WORK = 1e9  # faces times segments of one self-crossing fill
_CHUNK = 4_000_000  # of those at a time
_GRID = 1e-9  # of a region's size: coordinates are rounded to it where outlines are cut at their crossings


def region_of(area: Area) -> BaseGeometry:
    """The points of an area: inside of an odd number of its rings."""
    outer, *others = area.rings
    region = shapely.Polygon(outer, others)
    return region if region.is_valid else filled(area.rings, "evenodd")


def areas_of(region: BaseGeometry, colour: int, least: float = 0.0) -> Iterator[Area]:
    """The connected pieces of a region, those larger than `least` (in its own unit of area)."""
    for piece in polygons(region):
        if piece.area > least:
            yield Area(
                (np.array(piece.exterior.coords), *(np.array(hole.coords) for hole in piece.interiors)),
                colour,
            )


def polygons(region: BaseGeometry) -> list[shapely.Polygon]:
    """The connected pieces of a region that have an area."""
    parts = shapely.get_parts(region, return_index=False)
    flat = [
        inner for part in parts for inner in (shapely.get_parts(part) if hasattr(part, "geoms") else [part])
    ]
    return [part for part in flat if isinstance(part, shapely.Polygon) and not part.is_empty]


def line_strings(geometry: BaseGeometry) -> list[Polyline]:
    """The polylines of a geometry: its lines, and the rims of its polygons."""
    lines = []
    for part in shapely.get_parts(geometry):
        if isinstance(part, shapely.Polygon):
            lines += [np.array(ring.coords) for ring in (part.exterior, *part.interiors)]
        elif hasattr(part, "geoms"):
            lines += line_strings(part)
        elif isinstance(part, shapely.LineString) and not part.is_empty:
            lines.append(np.array(part.coords))
    return lines


def filled(rings: Sequence[Polyline], rule: str) -> BaseGeometry:
    """What closed outlines enclose, by SVG's fill rule "nonzero" or "evenodd"; they may cross as they like.

    The outlines are cut at their crossings, and each face between them is in or out by its winding number.
    """
    rings = [ring for ring in rings if len(ring) > 3]
    if not rings:
        return shapely.Polygon()
    if len(rings) == 1:
        simple = shapely.Polygon(rings[0])
        if simple.is_valid:
            return simple
    size = float(np.ptp(np.concatenate(rings), axis=0).max())
    cut = shapely.unary_union([shapely.LineString(ring) for ring in rings], grid_size=_GRID * size)
    faces = shapely.get_parts(shapely.polygonize(shapely.get_parts(cut)))
    segments = np.concatenate([np.stack([ring[:-1], ring[1:]], axis=1) for ring in rings])
    if len(faces) * len(segments) > _MAX_WORK:
        found = f"found a fill whose outline crosses itself into {len(faces)} pieces"
        raise InputError(f"{found}; allowed are simpler fills")
    if len(faces) == 0:
        return shapely.Polygon()
    inner = shapely.get_coordinates(shapely.point_on_surface(faces))
    winding = _winding(inner, segments)
    inside = winding % 2 == 1 if rule == "evenodd" else winding != 0
    return shapely.unary_union(faces[inside])


def _winding(points: np.ndarray, segments: np.ndarray) -> np.ndarray:
    """How often outlines go round each point: upward less downward crossings of the ray to its right."""
    (x0, y0), (x1, y1) = segments[:, 0].T, segments[:, 1].T
    winding = np.zeros(len(points), dtype=int)
    step = max(1, _CHUNK // len(segments))
    for first in range(0, len(points), step):
        x, y = points[first : first + step, :1], points[first : first + step, 1:]
        side = (x1 - x0) * (y - y0) - (x - x0) * (y1 - y0)
        up, down = (y0 <= y) & (y1 > y) & (side > 0), (y1 <= y) & (y0 > y) & (side < 0)
        winding[first : first + step] = up.sum(axis=1) - down.sum(axis=1)
    return winding
