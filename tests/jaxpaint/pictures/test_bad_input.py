"""Files that cannot be painted are refused in one line that names them, before anything is built of them."""

from pathlib import Path

import pytest

from jaxpaint.errors import InputError
from jaxpaint.pictures import read, read_drawing, svg

SVG = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 10 10" fill="none" stroke="black">'
LINE = '<path d="M0 0L9 9"/>'

ENTITIES = {
    "external": '<!DOCTYPE svg [<!ENTITY x SYSTEM "file:///etc/passwd">]>' + SVG + "<text>&x;</text></svg>",
    "external with parameter": '<!DOCTYPE svg [<!ENTITY % x SYSTEM "http://localhost/x"> %x;]>'
    + SVG
    + LINE
    + "</svg>",
    "nested": '<!DOCTYPE svg [<!ENTITY a "aaaaaaaa">'
    + "".join(f'<!ENTITY {b} "{f"&{a};" * 10}">' for a, b in zip("abcdefghi", "bcdefghij", strict=True))
    + f"]>{SVG}<text>&j;</text></svg>",
    "harmless": f'<!DOCTYPE svg [<!ENTITY red "#f00">]>{SVG}{LINE}</svg>',
}

BROKEN = {
    "empty": ("", "empty file"),
    "blank": (" \n\t\n", "empty file"),
    "truncated": (SVG + LINE, "broken or truncated"),
    "cut in a tag": (SVG + LINE[:9], "broken or truncated"),
    "text": ("a list of things to buy", "broken or truncated"),
    "png": ("\x89PNG\r\n\x1a\n\0\0", "broken or truncated"),
    "no svg": ("<html><body/></html>", "root element <html>"),
    "svg of another kind": ('<svg xmlns="urn:other"/>', "root element <urn:other svg>"),
    "unknown encoding": ('<?xml version="1.0" encoding="klingon"?>' + SVG + "</svg>", "encoding"),
    "too deep": (SVG + "<g>" * 2000 + "</g>" * 2000 + "</svg>", "nested 100 deep"),
    "too many elements": (SVG + "<g/>" * 60_000 + "</svg>", "50000"),
}

NOTHING = {
    "no element": "",
    "text only": "<text>hello</text>",
    "display": f'<g display="none">{LINE}</g>',
    "display in a style": f'<g style="display:none">{LINE}</g>',
    "visibility": f'<g visibility="hidden">{LINE}</g>',
    "opacity": f'<g opacity="0">{LINE}</g>',
    "stroke opacity": f'<g stroke-opacity="0%">{LINE}</g>',
    "no paint": f'<g stroke="none">{LINE}</g>',
    "transparent": f'<g stroke="#00000000">{LINE}</g>',
    "no width": f'<g stroke-width="0">{LINE}</g>',
    "defs": f"<defs>{LINE}</defs>",
    "symbol": f"<symbol>{LINE}</symbol>",
    "clip and mask": f"<clipPath>{LINE}</clipPath><mask>{LINE}</mask><marker>{LINE}</marker>",
    "foreign": f'<o:g xmlns:o="urn:other">{LINE}</o:g>',
    "dot": '<path d="M3 3h0"/>',
    "shapes without size": '<rect width="0" height="5"/><circle r="0"/><polygon points="1,1"/><path d=""/>',
    "flattened": f'<g transform="scale(0)">{LINE}</g>',
    "page without size": f'<svg width="0" height="10">{LINE}</svg>',
    "paper": '<rect width="100%" height="100%" fill="white" stroke="none"/>',
}

WRONG = {
    "nan in a path": ('<path d="M0 0L NaN 3"/>', "path data"),
    "letters in a path": ('<path d="M0 0 X 3"/>', "path data"),
    "path without a move": ('<path d="L 3 4"/>', "begin with M"),
    "numbers missing": ('<path d="M0 0 C 1 2 3"/>', "missing"),
    "infinite": ('<path d="M0 0 L 1e999 0"/>', "beyond 1e+09"),
    "absurd": ('<path d="M0 0 L 3e8 0"/>', "beyond 1e+07"),
    "nan in points": ('<polyline points="0,0 nan,3"/>', "pairs of numbers"),
    "odd points": ('<polyline points="0,0 3"/>', "pairs of numbers"),
    "nan in a length": ('<circle r="NaN"/>', "r='NaN'"),
    "unknown unit": ('<rect width="3 apples" height="2"/>', "length"),
    "unknown transform": ('<g transform="warp(3)"/>', "transform"),
    "nan in a transform": ('<g transform="scale(nan)"/>', "transform"),
    "infinite transform": ('<g transform="translate(1e999)"/>', "transform"),
    "matrix too short": ('<g transform="matrix(1 2 3)"/>', "transform"),
    "transforms that multiply": ('<g transform="scale(1e6)">' * 9 + LINE + "</g>" * 9, "magnify"),
    "view box": ('<svg viewBox="0 0 nan 3"/>', "viewBox"),
    "view box too short": ('<svg viewBox="0 0 3"/>', "viewBox"),
    "use of itself": ('<g id="a"><use href="#a"/></g>', "within itself"),
    "uses in a circle": ('<g id="a"><use href="#b"/></g><g id="b"><use href="#a"/></g>', "within itself"),
    "uses too deep": (
        f'<g id="a0">{LINE}</g>'
        + "".join(f'<g id="a{k}"><use href="#a{k - 1}"/></g>' for k in range(1, 120)),
        "deep",
    ),
    "too many numbers": (f'<polyline points="{"1 2 " * 300_001}"/>', "600000 numbers"),
    "too many commands": (f'<path d="M0 0{"z" * 700_000}"/>', "600000 numbers and commands"),
    "too much style": (f"<style>{'a{b:c}' * 200_000}</style>", "1000000 characters"),
    "too many points": (f'<polyline points="{"1 2 3 4 " * 100_002}"/>', "200000"),
}


def refused(path: Path) -> str:
    """The one line with which a file is refused."""
    with pytest.raises(InputError) as caught:
        read_drawing(path)
    message = str(caught.value)
    assert message.startswith(f"{path}: ")
    assert "\n" not in message and "allowed" in message
    return message


def written(folder: Path, text: str, name: str = "picture.svg") -> Path:
    path = folder / name
    path.write_text(text, encoding="latin-1")
    return path


def test_no_such_file(tmp_path):
    assert "no such file" in refused(tmp_path / "absent.svg")


def test_folder(tmp_path):
    folder = tmp_path / "drawings.svg"
    folder.mkdir()
    assert "folder" in refused(folder)


@pytest.mark.parametrize(
    ("name", "found"),
    [("a.png", "an SVG drawing"), ("a.JPG", "an SVG drawing"), ("a.pdf", "'.pdf'"), ("a", "''")],
)
def test_other_formats(tmp_path, name, found):
    assert found in refused(written(tmp_path, SVG + LINE + "</svg>", name))


def test_too_large(tmp_path):
    path = written(tmp_path, SVG + LINE + "</svg>")
    with path.open("a") as file:
        file.truncate(20_000_001)
    assert "20 MB" in refused(path)


@pytest.mark.parametrize("case", BROKEN)
def test_broken(tmp_path, case):
    text, found = BROKEN[case]
    assert found in refused(written(tmp_path, text))


@pytest.mark.parametrize("case", ENTITIES)
def test_entities_stop_the_file_before_anything_is_built_from_it(tmp_path, monkeypatch, case):
    monkeypatch.setattr(read, "SvgReader", lambda root: pytest.fail("the file got through"))
    assert "entit" in refused(written(tmp_path, ENTITIES[case]))


def test_defaults_of_attributes_cannot_explode(tmp_path):
    """A default of 100 kB for each of 20,000 elements would be 2 GB; only what is written counts."""
    doctype = f'<!DOCTYPE svg [<!ATTLIST g transform CDATA "{"rotate(1)" * 11_000}">]>'
    drawing = read_drawing(written(tmp_path, doctype + SVG + "<g/>" * 20_000 + f"<g>{LINE}</g></svg>"))
    assert len(drawing.lines) == 1


@pytest.mark.parametrize("case", NOTHING)
def test_nothing_to_draw(tmp_path, case):
    assert "nothing to draw" in refused(written(tmp_path, f"{SVG}{NOTHING[case]}</svg>"))


@pytest.mark.parametrize("case", WRONG)
def test_wrong_content(tmp_path, case):
    body, found = WRONG[case]
    assert found in refused(written(tmp_path, f"{SVG}{body}</svg>"))


@pytest.mark.parametrize(
    ("limit", "found"), [("MAX_ELEMENTS", "multiply"), ("MAX_LINES", "lines"), ("MAX_SYMBOLS", "numbers")]
)
def test_uses_that_multiply(tmp_path, monkeypatch, limit, found):
    """A billion lines in a kilobyte. The limits are lowered, because reaching them takes a second each."""
    monkeypatch.setattr(svg, limit, 400)
    groups = [f'<g id="g{k + 1}">{f"""<use href="#g{k}"/>""" * 10}</g>' for k in range(8)]
    assert found in refused(written(tmp_path, f'{SVG}<g id="g0">{LINE * 10}</g>{"".join(groups)}</svg>'))
