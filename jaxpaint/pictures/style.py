"""Which elements show ink: the cascade of attributes, style sheets and style attributes."""

import re
from dataclasses import dataclass

from svgelements import Color

from jaxpaint.pictures.drawing import BLACK, Colour
from jaxpaint.pictures.markup import Element
from jaxpaint.pictures.stylesheet import Style, StyleSheet, declarations

_INHERITED = (
    "color",
    "fill",
    "fill-opacity",
    "fill-rule",
    "stroke",
    "stroke-opacity",
    "stroke-width",
    "visibility",
)
_OWN = ("clip-path", "display", "mask", "opacity", "transform")
_KNOWN = frozenset(_INHERITED + _OWN)
_DEFAULTS = {"fill": "black", "stroke": "none"}
_AMOUNT = re.compile(r"\s*([-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d+)?)\s*(%|[a-zA-Z]*)\s*")
_LONGEST = 100  # characters of a number or colour; patterns take quadratic time on absurd ones


@dataclass(frozen=True)
class Paint:
    """The colours of a shape's area and of its line (None: it does not show), and how they are painted.

    rule: which points are inside, "nonzero" or "evenodd". width: of the line, in user units. unresolved:
    whether a colour is a gradient or a pattern, for which black stands.
    """

    fill: Colour | None
    stroke: Colour | None
    rule: str = "nonzero"
    width: float = 1.0
    unresolved: bool = False


def cascade(element: Element, parent: Style, sheet: StyleSheet) -> Style:
    """The style of an element: what its parent hands down, its attributes, the sheet, its style attribute."""
    inherited = {key: value for key, value in parent.items() if key in _INHERITED}
    style = dict(inherited)
    inline = declarations(element.attributes.get("style", ""))
    for settings in (element.attributes, sheet.settings(element), inline):
        for key in _KNOWN & settings.keys():
            value = settings[key].strip()
            style[key] = inherited.get(key, "") if value == "inherit" else value
    return {key: value for key, value in style.items() if value not in ("", "initial")}


def is_shown(style: Style) -> bool:
    """Whether an element and what is below it can show at all."""
    return style.get("display", "").lower() != "none" and _amount(style.get("opacity"), 1.0) > 0


def paint(style: Style) -> Paint:
    """What of a shape shows, and in which colours; half transparent ink counts as ink."""
    if style.get("visibility", "").lower() in ("hidden", "collapse"):
        return Paint(None, None)
    width = _amount(style.get("stroke-width"), 1.0)
    rule = "evenodd" if style.get("fill-rule", "").lower() == "evenodd" else "nonzero"
    shown = {key: _shows(style, key, default) for key, default in _DEFAULTS.items()}
    shown["stroke"] = shown["stroke"] and width > 0
    fill, stroke = (_rgb(_colour(style, key, _DEFAULTS[key])) if shown[key] else None for key in _DEFAULTS)
    unresolved = any(shown[key] and _colour(style, key, "").startswith("url") for key in _DEFAULTS)
    return Paint(fill, stroke, rule, width, unresolved)


def _amount(value: str | None, default: float) -> float:
    """A number or percentage as CSS has it; what is neither is the default."""
    match = _AMOUNT.fullmatch((value or "")[:_LONGEST])
    if match is None:
        return default
    return float(match[1]) / (100 if match[2] == "%" else 1)


def _shows(style: Style, key: str, default: str) -> bool:
    colour = _colour(style, key, default)
    if colour in ("none", "transparent") or _amount(style.get(f"{key}-opacity"), 1.0) <= 0:
        return False
    # Only these two forms carry transparency; gradients and patterns are ink.
    return not colour.startswith(("#", "rgba", "hsla")) or Color(colour[:_LONGEST]).alpha != 0


def _colour(style: Style, key: str, default: str) -> str:
    colour = style.get(key, default).lower()
    return style.get("color", "black").lower() if colour == "currentcolor" else colour


def _rgb(colour: str) -> Colour:
    """sRGB of a colour as CSS writes it; black for what is none (gradients, patterns, unknown names)."""
    if colour.startswith("url"):
        colour = colour.partition(")")[2].strip() or "black"
    try:
        found = Color(colour[:_LONGEST])
        channels = found.red, found.green, found.blue
    except (ValueError, TypeError, IndexError):
        return BLACK
    if any(channel is None for channel in channels):
        return BLACK
    return tuple(min(max(int(channel), 0), 255) / 255 for channel in channels)  # type: ignore[return-value]
