"""Ink laid over ink: what of each layer is still seen."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from jaxpaint.errors import InputError
from jaxpaint.pictures.drawing import Area, Colour, Drawing, Polyline, polyline_length
from jaxpaint.pictures.palette import alike, merged, too_many
from jaxpaint.pictures.regions import areas_of, line_strings, polygons

# Of the drawing's size, the longer side of all layers together:
_RIM = 1e-4  # a line so near to the rim of what covers it is still seen; what is left of an area is not
_SLIVER = 1e-8  # and of its square: smaller pieces are rounding where areas meet


@dataclass(frozen=True, eq=False)
class Layer:
    """One shape: an area or lines, of one colour. covers: what it hides of the layers below."""

    colour: Colour
    area: BaseGeometry
    lines: tuple[Polyline, ...] = ()
    covers: BaseGeometry | None = None

    @property
    def hides(self) -> BaseGeometry:
        return self.area if self.covers is None else self.covers


def laid(layers: Sequence[Layer], paper: Colour | None, name: str, ignored: Mapping[str, int]) -> Drawing:
    """The drawing that layers make, from the lowest to the topmost. What has the paper's colour only hides.

    Raises InputError where nothing is left to paint.
    """
    size = _size(layers)
    ink = [paper is None or not alike(layer.colour, paper) for layer in layers]
    seen = [layer if shown else None for layer, shown in zip(_visible(layers, size), ink, strict=True)]
    # Slivers go before there is a palette: each of its colours is a pass with a tool of its own.
    kept = [layer for layer in seen if layer is not None and (layer.lines or _has_area(layer, size))]
    if not kept:
        raise nothing()
    colours, place = merged([layer.colour for layer in kept], [_weight(layer) for layer in kept])
    lost = too_many([layer.colour for layer in kept])
    lines = [(line, int(k)) for layer, k in zip(kept, place, strict=True) for line in layer.lines]
    areas = [area for k in range(len(colours)) for area in _one_colour(kept, place, k, size)]
    return Drawing(
        tuple(line for line, _ in lines),
        tuple(k for _, k in lines),
        tuple(areas),
        colours,
        name,
        dict(ignored) | ({"colour": ignored.get("colour", 0) + lost} if lost else {}),
    )


def nothing() -> InputError:
    """The error for a picture without ink."""
    return InputError("found nothing to draw; allowed is a drawing with visible strokes or fills")


def _size(layers: Sequence[Layer]) -> float:
    """The longer side of all layers together."""
    parts = [layer.area for layer in layers if not layer.area.is_empty]
    corners = [np.array(part.bounds).reshape(2, 2) for part in parts]
    points = np.concatenate([np.zeros((0, 2)), *corners, *(line for layer in layers for line in layer.lines)])
    return float(np.ptp(points, axis=0).max()) if len(points) else 0.0


def _has_area(layer: Layer, size: float) -> bool:
    return any(True for _ in areas_of(layer.area, 0, least=_SLIVER * size**2))


def _visible(layers: Sequence[Layer], size: float) -> list[Layer]:
    """The layers without what later ones hide of them."""
    hides = [layer.hides for layer in layers]
    tree = shapely.STRtree(hides)
    seen = []
    for k, layer in enumerate(layers):
        whole = [layer.area, *(shapely.LineString(line) for line in layer.lines)]
        above = sorted({int(j) for part in whole if not part.is_empty for j in tree.query(part) if j > k})
        hidden = shapely.unary_union([hides[j] for j in above])
        seen.append(layer if hidden.is_empty else _without(layer, hidden, size))
    return seen


def _without(layer: Layer, hidden: BaseGeometry, size: float) -> Layer:
    """A layer without what is hidden of it. A line along the rim of what hides it stays."""
    if not layer.lines:
        return Layer(layer.colour, _rest(layer.area, hidden, _RIM * size))
    core = hidden.buffer(-_RIM * size)
    lines = []
    for line in layer.lines:
        string = shapely.LineString(line)
        if string.intersects(core):
            rest = line_strings(shapely.line_merge(string.difference(core)))
            lines += [part for part in rest if polyline_length(part) > _RIM * size]
        else:
            lines.append(line)
    return Layer(layer.colour, layer.area, tuple(lines))


def _rest(area: BaseGeometry, hidden: BaseGeometry, rim: float) -> BaseGeometry:
    """What is left of an area, but for the fringe where both end alike and differ by rounding alone."""
    rest = area.difference(hidden)
    if area.buffer(-rim).is_empty:  # thin as it was drawn
        return rest
    return shapely.unary_union([part for part in polygons(rest) if not part.buffer(-rim).is_empty])


def _one_colour(layers: Sequence[Layer], place: np.ndarray, colour: int, size: float) -> list[Area]:
    """The areas of one colour, joined where they touch."""
    union = shapely.unary_union(
        [
            layer.area
            for layer, k in zip(layers, place, strict=True)
            if k == colour and not layer.area.is_empty
        ]
    )
    return list(areas_of(union, colour, least=_SLIVER * size**2))


def _weight(layer: Layer) -> float:
    """How much of a layer is seen, to choose among colours that are nearly the same."""
    return layer.area.area + 1e-3 * sum(polyline_length(line) for line in layer.lines)
