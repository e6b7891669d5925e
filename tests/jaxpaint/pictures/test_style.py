"""The cascade: attributes, style sheets by specificity, style attributes."""

import pytest

from jaxpaint.pictures.markup import Element
from jaxpaint.pictures.style import Paint, cascade, is_shown, paint
from jaxpaint.pictures.stylesheet import StyleSheet

ELEMENT = Element("path", {"id": "i", "class": "c d", "stroke": "attribute"})


def stroke_under(css: str, element: Element = ELEMENT) -> str:
    return cascade(element, {}, StyleSheet([css]))["stroke"]


@pytest.mark.parametrize(
    ("css", "winner"),
    [
        ("", "attribute"),
        ("path{stroke:tag}", "tag"),
        ("* { stroke : all }", "all"),
        ("path{stroke:first} path{stroke:second}", "second"),
        (".c{stroke:class} path{stroke:tag}", "class"),
        ("#i{stroke:id} .c{stroke:class} path.c.d{stroke:both}", "id"),
        ("path.c{stroke:both} .c{stroke:class}", "both"),
        (".c.d{stroke:two} .d{stroke:one}", "two"),
        ("circle, #other, .c.x, circle.c {stroke:no}", "attribute"),
        ("rect,path{stroke:either}", "either"),
        ("/* path{stroke:no} */ path/**/{stroke:yes}", "yes"),
        ("@media print {path{stroke:print} .c{stroke:print}} path{stroke:yes}", "yes"),
        ("@charset 'utf-8'; path{stroke:yes}", "yes"),
        ("g path{stroke:unknown} path>path{stroke:unknown}", "attribute"),
        ("path{stroke:yes !important}", "yes"),
        ("path{stroke:open", "attribute"),
        ("}}}{{{ path{stroke:lost", "attribute"),
    ],
)
def test_rules(css, winner):
    assert stroke_under(css) == winner


def test_a_style_attribute_comes_last():
    element = Element(
        "path", {"id": "i", "style": "stroke:own; ; nonsense; fill:none", "stroke": "attribute"}
    )
    assert stroke_under("#i{stroke:id}", element) == "own"


def test_what_is_handed_down_and_what_is_not():
    parent = {"stroke": "red", "opacity": "0.5", "transform": "scale(2)", "display": "inline"}
    assert cascade(Element("g", {}), parent, StyleSheet([])) == {"stroke": "red"}
    inheriting = Element("g", {"class": "c", "style": "stroke:inherit; fill:initial"})
    assert cascade(inheriting, {**parent, "fill": "red"}, StyleSheet([".c{stroke:blue}"])) == {
        "stroke": "red"
    }


@pytest.mark.parametrize(
    ("style", "fill", "stroke"),
    [
        ({}, True, False),
        ({"fill": "none"}, False, False),
        ({"fill": "none", "stroke": "#000"}, False, True),
        ({"fill": "none", "stroke": "url(#gradient)"}, False, True),
        ({"fill": "transparent", "stroke": "rgba(0,0,0,0)"}, False, False),
        ({"fill": "#12345600", "stroke": "rgba(0,0,0,0.1)"}, False, True),
        ({"fill": "hsla(0,0%,0%,0)"}, False, False),
        ({"fill": "currentColor", "color": "transparent"}, False, False),
        ({"stroke": "currentColor"}, True, True),
        ({"fill-opacity": "0"}, False, False),
        ({"stroke": "red", "stroke-opacity": "0%"}, True, False),
        ({"stroke": "red", "stroke-width": "0.0"}, True, False),
        ({"stroke": "red", "stroke-width": "2px"}, True, True),
        ({"stroke": "red", "visibility": "hidden"}, False, False),
    ],
)
def test_what_shows(style, fill, stroke):
    shown = paint(style)
    assert (shown.fill is not None, shown.stroke is not None) == (fill, stroke)


@pytest.mark.parametrize(
    ("colour", "rgb"),
    [
        ("red", (255, 0, 0)),
        ("RED", (255, 0, 0)),
        ("#f80", (255, 136, 0)),
        ("#102030", (16, 32, 48)),
        ("rgb(1, 2,3)", (1, 2, 3)),
        ("rgb(0%,100%,0%)", (0, 255, 0)),
        ("hsl(240,100%,50%)", (0, 0, 255)),
        ("currentColor", (0, 128, 128)),
        ("url(#gradient) blue", (0, 0, 255)),
        ("url(#gradient)", (0, 0, 0)),
        ("no such colour", (0, 0, 0)),
    ],
)
def test_colours(colour, rgb):
    found = paint({"fill": colour, "color": "teal"}).fill
    assert found == pytest.approx(tuple(c / 255 for c in rgb), abs=1e-9)


def test_rule_and_width():
    shown = paint({"stroke": "red", "stroke-width": "2.5", "fill-rule": "evenodd"})
    assert shown == Paint((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), "evenodd", 2.5)
    assert paint({"fill": "url(#g)"}).unresolved and not shown.unresolved


@pytest.mark.parametrize(
    ("style", "shown"),
    [({}, True), ({"display": "none"}, False), ({"opacity": "0"}, False), ({"opacity": "1%"}, True)],
)
def test_what_hides_all_below(style, shown):
    assert is_shown(style) == shown
