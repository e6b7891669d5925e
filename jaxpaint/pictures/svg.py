"""From the elements of an SVG file to the shapes that its picture consists of."""

import re
from collections import Counter
from dataclasses import dataclass, replace

import numpy as np
import shapely
import svgelements
from jaxtyping import Float

from jaxpaint.errors import InputError
from jaxpaint.pictures.curves import Curve
from jaxpaint.pictures.drawing import Colour
from jaxpaint.pictures.markup import MAX_DEPTH, MAX_ELEMENTS, Element, excerpt
from jaxpaint.pictures.palette import alike
from jaxpaint.pictures.regions import filled
from jaxpaint.pictures.shapes import MAX_NUMBER, TAGS, curves_of, length, symbols_in
from jaxpaint.pictures.style import Paint, cascade, is_shown, paint
from jaxpaint.pictures.stylesheet import Style, StyleSheet

MAX_SYMBOLS = 600_000
MAX_STYLE = 1_000_000
MAX_LINES = 20_000

_FUNCTION = r"(?:matrix|translate[XY]?|scale[XY]?|rotate|skew[XY])\s*\((?:[\s\d.,eE+-]|deg|g?rad|turn|px)*\)"
_TRANSFORMS = re.compile(rf"(?:[\s,]*{_FUNCTION})*[\s,]*")
_PAGE = (300.0, 150.0)  # what CSS gives a picture that states no size
_WHOLE = 0.98  # of the page: a shape that fills so much of it is paper; its corners may be round
_SIDES = 100  # segments of an outline: paper has few, and looking at it must stay cheap
_WHITE: Colour = (1.0, 1.0, 1.0)


@dataclass(frozen=True, eq=False)
class Ink:
    """A shape that shows: its curves in the coordinates of the page (y down), and how they are painted.

    fill: of the area that the curves enclose, by the rule "nonzero" or "evenodd"; stroke: of the curves as
    lines, `width` wide on the page. None where there is no such paint.
    """

    curves: tuple[Curve, ...]
    fill: Colour | None
    stroke: Colour | None
    rule: str = "nonzero"
    width: float = 1.0


@dataclass(frozen=True, eq=False)
class _Place:
    """Where an element stands: map to the page, viewport that percentages refer to, style, uses, nesting."""

    matrix: Float[np.ndarray, "3 3"]
    viewport: tuple[float, float]
    style: Style
    uses: tuple[str, ...] = ()
    depth: int = 0

    def moved(self, matrix: Float[np.ndarray, "3 3"]) -> "_Place":
        product = self.matrix @ matrix
        if np.abs(product).max() > MAX_NUMBER:
            raise InputError(
                f"found transforms that magnify beyond {MAX_NUMBER:.0e}; allowed are smaller ones"
            )
        return replace(self, matrix=product)


class SvgReader:
    """Walks an SVG tree once and gathers its ink and its paper; counts by name what it leaves out."""

    def __init__(self, root: Element):
        self.ink: list[Ink] = []
        self.ignored: Counter[str] = Counter()
        self.paper: Colour = _WHITE
        elements = list(root.walk())
        self._sheet = _style_sheet(elements)
        self._by_id = {element.attributes.get("id", ""): element for element in reversed(elements)}
        self._visits = self._symbols = self._curves = 0
        self._page: Float[np.ndarray, "2 2"] | None = None
        self._background: Ink | None = None
        self._visit(root, _Place(np.eye(3), _page_size(root), {}))
        self._keep_bare_page()

    def _visit(self, element: Element, parent: _Place):
        """One element below its parent: nothing if it cannot show, else what its kind asks for."""
        self._visits += 1
        if self._visits > MAX_ELEMENTS or parent.depth > MAX_DEPTH:
            found = "found <use> elements that multiply"
            raise InputError(f"{found}; allowed are {MAX_ELEMENTS} elements, nested {MAX_DEPTH} deep")
        style = cascade(element, parent.style, self._sheet)
        if not is_shown(style):
            return
        self.ignored.update(name for name in ("clip-path", "mask") if style.get(name, "none") != "none")
        place = replace(parent, style=style, depth=parent.depth + 1)
        if "transform" in style:
            place = place.moved(_transform(style["transform"]))
        if element.tag in ("g", "a", "switch"):
            self._visit_all(element.children, place)
        elif element.tag == "svg":
            self._visit_viewport(element, place)
        elif element.tag == "use":
            self._visit_use(element, place)
        elif element.tag in TAGS:
            self._draw(element, place)
        elif element.tag in ("text", "image", "foreignObject"):
            self.ignored[element.tag] += 1

    def _visit_all(self, elements: list[Element], place: _Place):
        for element in elements:
            self._visit(element, place)

    def _visit_viewport(self, element: Element, place: _Place):
        """An <svg>, or a <symbol> in use: its viewBox laid into its own rectangle."""
        x, y = (0.0, 0.0) if self._page is None else (length(element, name, place.viewport) for name in "xy")
        size = (
            length(element, "width", place.viewport, "100%"),
            length(element, "height", place.viewport, "100%"),
        )
        box = _view_box(element, size)
        if min(*size, *box[2:]) <= 0:
            return
        aspect = element.attributes.get("preserveAspectRatio")
        inner = _transform(svgelements.Viewbox.viewbox_transform(x, y, *size, *box, aspect))
        if self._page is None:
            corners = np.array([[box[0], box[1], 1], [box[0] + box[2], box[1] + box[3], 1]])
            self._page = (corners @ inner.T)[:, :2]
        self._visit_all(element.children, replace(place, viewport=(box[2], box[3])).moved(inner))

    def _visit_use(self, element: Element, place: _Place):
        """A copy of another element of the same file, drawn here."""
        link = element.attributes.get("href", "").strip()
        target = self._by_id.get(link[1:]) if link.startswith("#") and len(link) > 1 else None
        if target is None:
            self.ignored["use"] += 1
            return
        if link in place.uses:
            raise InputError(
                f"found a <use> of '{excerpt(link)}' within itself; allowed is <use> without a circle"
            )
        shift = np.eye(3)
        shift[:2, 2] = [length(element, name, place.viewport) for name in "xy"]
        place = replace(place, uses=(*place.uses, link)).moved(shift)
        if target.tag in ("symbol", "svg"):
            own = {key: value for key, value in element.attributes.items() if key in ("width", "height")}
            target = replace(target, tag="svg", attributes=target.attributes | own)
        self._visit(target, place)

    def _draw(self, element: Element, place: _Place):
        """A shape, if its area or its line shows."""
        shows = paint(place.style)
        if not (shows.fill or shows.stroke):
            return
        self._symbols += symbols_in(element)
        if self._symbols > MAX_SYMBOLS:
            raise InputError(
                f"found more than {MAX_SYMBOLS} numbers and commands; allowed are simpler drawings"
            )
        curves = tuple(curve.moved(place.matrix) for curve in curves_of(element, place.viewport))
        self._curves += len(curves)
        if self._curves > MAX_LINES:
            raise InputError(f"found more than {MAX_LINES} lines; allowed are simpler drawings")
        self._add(curves, shows, place)

    def _add(self, curves: tuple[Curve, ...], shows: Paint, place: _Place):
        """Ink of these curves. The first thing that fills the whole page is the paper."""
        areas = any(curve.encloses_area(1e-9 * _span(curve)) for curve in curves)
        fill = shows.fill if areas else None
        if not (fill or shows.stroke):
            return
        scale = float(np.sqrt(abs(np.linalg.det(place.matrix[:2, :2]))))
        ink = Ink(curves, fill, shows.stroke, shows.rule, shows.width * scale)
        self.ignored.update(["gradient"] if shows.unresolved else [])
        if fill and not shows.stroke and not self.ink and self._is_page(ink):
            # The black that stands for a gradient would swallow black ink.
            self.paper, self._background = _WHITE if shows.unresolved else fill, ink
            self.ignored["background"] += 1
            return
        self.ink.append(ink)

    def _is_page(self, ink: Ink) -> bool:
        """Whether a shape covers the whole page: paper that a program laid under its picture."""
        if len(ink.curves) != 1 or self._page is None or len(ink.curves[0].controls) > _SIDES:
            return False
        outline = ink.curves[0].closing()
        page = shapely.box(*self._page.ravel())
        covered = filled([outline.flattened(1e-4 * _span(outline))], ink.rule).intersection(page)
        return bool(covered.area >= _WHOLE * page.area)

    def _keep_bare_page(self):
        """A page in a colour with nothing else on it is the picture itself, on white paper."""
        colours = [colour for ink in self.ink for colour in (ink.fill, ink.stroke) if colour is not None]
        if self._background is not None and all(alike(colour, self.paper) for colour in colours):
            self.ink.insert(0, self._background)
            self.paper = _WHITE
            del self.ignored["background"]


def _span(curve: Curve) -> float:
    """The larger side of the box around a curve's control points."""
    return float(np.ptp(curve.controls.reshape(-1, 2), axis=0).max())


def _style_sheet(elements: list[Element]) -> StyleSheet:
    texts = [element.text for element in elements if element.tag == "style"]
    if sum(len(text) for text in texts) > MAX_STYLE:
        raise InputError(f"found style sheets of more than {MAX_STYLE} characters; allowed are shorter ones")
    return StyleSheet(texts)


def _page_size(root: Element) -> tuple[float, float]:
    """The size that percentages on the outermost <svg> refer to: its viewBox, where it has one."""
    box = _view_box(root, _PAGE)
    return (box[2], box[3]) if min(box[2:]) > 0 else _PAGE


def _view_box(element: Element, size: tuple[float, float]) -> tuple[float, float, float, float]:
    """The viewBox (x, y, width, height) of an element; without one, its own size."""
    text = element.attributes.get("viewBox", "")
    if not text.strip():
        return (0.0, 0.0, *size)
    try:
        x, y, width, height = (float(number) for number in text.replace(",", " ").split())
        if not all(abs(number) <= MAX_NUMBER for number in (x, y, width, height)):
            raise ValueError
    except ValueError:
        raise InputError(f"found viewBox='{excerpt(text)}'; allowed are four numbers") from None
    return x, y, width, height


def _transform(text: str) -> Float[np.ndarray, "3 3"]:
    """The affine map of a list of transforms such as `translate(3, 4) rotate(30)`."""
    if text == "none":
        return np.eye(3)
    try:
        if not _TRANSFORMS.fullmatch(text):
            raise ValueError
        m = svgelements.Matrix(text)
    except (ValueError, TypeError, IndexError):
        raise InputError(
            f"found transform='{excerpt(text)}'; allowed are SVG transforms such as rotate(30)"
        ) from None
    matrix = np.array([[m.a, m.c, m.e], [m.b, m.d, m.f], [0.0, 0.0, 1.0]], dtype=float)
    if not np.abs(matrix).max() <= MAX_NUMBER:
        raise InputError(f"found transform='{excerpt(text)}'; allowed are numbers up to {MAX_NUMBER:.0e}")
    return matrix
