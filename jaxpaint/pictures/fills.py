"""Strokes that fill areas, so that nothing of the ink is left bare."""

from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from jaxpaint.errors import InputError
from jaxpaint.pictures.drawing import Area, Drawing, Polyline
from jaxpaint.pictures.hatching import hatch
from jaxpaint.pictures.middles import Middles, middle_lines
from jaxpaint.pictures.regions import line_strings, polygons, region_of

Style = Literal["hatch", "contour", "outline"]

# Chosen on a simulated brush that wanders 2 mm (one sigma) over decimetres and wets 1.3 mm beyond its radius,
# one seed a picture: coverage 0.99 or more on a silhouette and two logos, 0.967 on handwriting read as areas
# with a 4 mm brush, rims within 3 mm. Less overlap leaves slits between rows.
OVERLAP = 0.35
BLEED = 0.00125  # [m]

_MOST = 0.4  # of the radius: bleed of a small brush
# Half rows of bare ink to either side of a line that covers it alone: just under 1, where that line overlaps
# the passes beside it as rows do.
_ONE_LINE = 0.9
_SLIVER = 0.12  # of the radius, to either side
# Of the bleed: what is wider than the inset by less is painted along its middle alone. Passes along its rims
# would lie on each other, and what a middle leaves of it is less than the bleed.
_SLENDER = 0.5


@dataclass(frozen=True)
class FillSettings:
    """How areas are painted.

    style: "hatch", a pass along the rim and parallel rows inside; "contour", passes along the rim further and
    further inside; "outline", the rims alone, as lines. overlap: share of the brush's width that neighbouring
    rows share. angle: of the rows against the horizontal [rad]; upright rows let a robot drive along the wall
    once. bleed: how far outside the ink the brush's edge goes [m], so that drift leaves no bare rims; at most
    0.4 of the brush's radius, whatever is asked for.
    """

    style: Style = "hatch"
    overlap: float = OVERLAP
    angle: float = np.pi / 2
    bleed: float = BLEED

    def bleed_of(self, radius: float) -> float:
        """The bleed [m] of a brush of this radius [m]: at most 0.4 of it."""
        return min(self.bleed, _MOST * radius)

    def check(self) -> None:
        """Raises InputError for a setting that is not allowed."""
        if self.style not in get_args(Style):
            raise InputError(f"fill: found '{self.style}'; allowed are {', '.join(get_args(Style))}")
        if not 0 <= self.overlap <= 0.8:
            raise InputError(f"fill overlap: found {self.overlap}; allowed are shares from 0 to 0.8")
        if not np.isfinite(self.angle):
            raise InputError(f"fill angle: found {self.angle}; allowed is a finite angle in radians")
        if not (np.isfinite(self.bleed) and self.bleed >= 0):
            raise InputError(f"fill bleed: found {self.bleed}; allowed is a length in metres, 0 or more")


def fill_strokes(areas: list[Area], radius: float, fill: FillSettings) -> list[Polyline]:
    """Pen-down lines [m] that cover areas of one colour by a brush of this radius [m].

    The brush's edge stays within `bleed` of the ink wherever the ink is as wide as the brush; what is
    narrower is painted along its middle.
    """
    inset = radius - fill.bleed_of(radius)
    slender = _SLENDER * fill.bleed_of(radius)
    regions = [region_of(area) for area in areas]
    cores = [region.buffer(-inset - slender).buffer(slender, join_style="mitre") for region in regions]
    inside = _contours if fill.style == "contour" else _rows
    passes = [inside(core, radius, fill) for core in cores]
    middles = Middles(regions, cores, [p.bare for p in passes], [p.solid for p in passes])
    return [line for p in passes for line in p.lines] + middle_lines(middles, radius, inset)


def outlined(drawing: Drawing) -> Drawing:
    """The drawing with the rims of its areas as lines, those left out that are drawn as lines already."""
    if not drawing.areas:
        return drawing
    size = float(np.ptp(np.array(drawing.bounds), axis=0).max())
    drawn = shapely.unary_union([shapely.LineString(line) for line in drawing.lines]).buffer(1e-4 * size)
    rims = [
        (ring, area.colour)
        for area in drawing.areas
        for ring in area.rings
        if not drawn.covers(shapely.LineString(ring))
    ]
    return replace(
        drawing,
        lines=(*drawing.lines, *(ring for ring, _ in rims)),
        line_colours=(*drawing.line_colours, *(colour for _, colour in rims)),
        areas=(),
    )


@dataclass(frozen=True, eq=False)
class _Passes:
    """Lines inside a core; what they leave bare, to be painted along its middle; where they leave nothing."""

    lines: list[Polyline]
    bare: BaseGeometry
    solid: BaseGeometry


def _rows(core: BaseGeometry, radius: float, fill: FillSettings) -> _Passes:
    """A pass along the rim, and rows in what that leaves bare unless one line will do for it."""
    half_row = radius * (1 - fill.overlap)
    bare = core.buffer(-radius * (1 - fill.overlap / 2))
    solid = bare.buffer(-_ONE_LINE * half_row).buffer(_ONE_LINE * half_row)
    rows = solid.buffer(radius * fill.overlap / 2)
    lines = line_strings(core)
    for piece in polygons(core):
        lines += hatch(rows.intersection(piece), piece, radius, fill.overlap, fill.angle)
    return _Passes(lines, _without_slivers(bare.difference(solid.buffer(half_row)), radius), solid)


def _contours(core: BaseGeometry, radius: float, fill: FillSettings) -> _Passes:
    """Passes along the rim further and further inside, until nothing is left but middles between them."""
    step, half = 2 * radius * (1 - fill.overlap), radius * (1 - fill.overlap / 2)
    lines, bare = [], []
    while not core.is_empty:
        lines += line_strings(core)
        inner = core.buffer(-step)
        bare.append(core.buffer(-half).difference(inner.buffer(half)))
        core = inner
    return _Passes(lines, _without_slivers(shapely.unary_union(bare), radius), shapely.Polygon())


def _without_slivers(bare: BaseGeometry, radius: float) -> BaseGeometry:
    """What is left bare, less what lies between two passes that only just do not overlap as they should."""
    tiny = _SLIVER * radius
    return shapely.unary_union(
        [part for part in polygons(bare.buffer(-tiny).buffer(tiny)) if part.length > radius]
    )
