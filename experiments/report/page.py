"""A report as one self-contained HTML page: verdict, key figures, sections of pictures and tables."""

import base64
import dataclasses
from html import escape
from importlib.resources import files
from typing import Literal

from experiments.tables import Table, in_words, is_figure

KINDS = {b"\x89PNG": "image/png", b"<?xml": "image/svg+xml", b"<svg": "image/svg+xml"}


@dataclasses.dataclass(frozen=True)
class Figure:
    """A picture (PNG or SVG, as bytes) with what it shows in one sentence."""

    image: bytes
    caption: str


@dataclasses.dataclass(frozen=True)
class Section:
    """A heading with a few sentences, pictures and tables; tables stand side by side where they fit."""

    title: str
    text: str = ""
    figures: tuple[Figure, ...] = ()
    tables: tuple[Table, ...] = ()


@dataclasses.dataclass(frozen=True)
class Tile:
    """One key figure: what it is, its value with unit, and a remark."""

    name: str
    value: str
    remark: str = ""


@dataclasses.dataclass(frozen=True)
class Page:
    """A whole report. verdict: the result in one line; mood: how good it is."""

    title: str
    verdict: str
    mood: Literal["good", "mixed", "bad"] = "good"
    tiles: tuple[Tile, ...] = ()
    sections: tuple[Section, ...] = ()
    footer: str = ""


def render(page: Page) -> str:
    """The page as HTML; everything it shows is inside."""
    style = files("experiments.report").joinpath("page.css").read_text(encoding="utf-8")
    body = [
        f'<header class="{page.mood}"><p class="title">{_text(page.title)}</p>',
        f"<h1>{_text(page.verdict)}</h1></header>",
        _tiles(page.tiles),
        *[_section(section) for section in page.sections],
        f"<footer>{_text(page.footer)}</footer>",
    ]
    return _DOCUMENT.format(title=_text(page.title), style=style, body="\n".join(body))


_DOCUMENT = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<style>
{style}</style>
</head>
<body>
<main>
{body}
</main>
</body>
</html>
"""


def _tiles(tiles: tuple[Tile, ...]) -> str:
    cells = [
        f"<div><dt>{_text(tile.name)}</dt><dd>{_text(tile.value)}</dd><small>{_text(tile.remark)}</small></div>"
        for tile in tiles
    ]
    return f'<dl class="tiles">{"".join(cells)}</dl>' if cells else ""


def _section(section: Section) -> str:
    parts = [f"<section><h2>{_text(section.title)}</h2>"]
    if section.text:
        parts.append(f"<p>{_text(section.text)}</p>")
    parts += [_figure(figure) for figure in section.figures]
    if section.tables:
        parts.append(f'<div class="tables">{"".join(_table(table) for table in section.tables)}</div>')
    return "\n".join([*parts, "</section>"])


def _figure(figure: Figure) -> str:
    kind = next((kind for start, kind in KINDS.items() if figure.image.startswith(start)), None)
    if kind is None:
        raise ValueError(f"image: found bytes that start with {figure.image[:8]!r}, allowed: PNG or SVG")
    data = base64.b64encode(figure.image).decode("ascii")
    caption = _text(figure.caption)
    alt = escape(figure.caption, quote=True)
    image = f'<img alt="{alt}" src="data:{kind};base64,{data}">'
    return f"<figure>{image}<figcaption>{caption}</figcaption></figure>"


def _table(table: Table) -> str:
    right = [' class="figure"' if is_figure(table, column) else "" for column in range(len(table.columns))]
    head = "".join(f"<th{end}>{_text(name)}</th>" for name, end in zip(table.columns, right, strict=True))
    rows = [
        "".join(f"<td{end}>{_text(in_words(cell))}</td>" for cell, end in zip(row, right, strict=True))
        for row in table.rows
    ]
    caption = f"<caption>{_text(table.title)}</caption>" if table.title else ""
    body = "".join(f"<tr>{row}</tr>" for row in rows)
    inside = f"{caption}<thead><tr>{head}</tr></thead><tbody>{body}</tbody>"
    return f'<div class="table"><table>{inside}</table></div>'


def _text(text: str) -> str:
    """Text as HTML; bytes of file names that are no text become question marks."""
    return escape(text.encode("utf-8", "replace").decode("utf-8"), quote=False)
