"""Small SVG files for the tests of pictures."""

from collections.abc import Callable
from pathlib import Path

import pytest

from jaxpaint.pictures import Drawing, read_drawing


@pytest.fixture
def svg_file(tmp_path: Path) -> Callable[..., Path]:
    """Writes a page of 100 x 100; lines are black and areas empty unless the body says otherwise."""

    def write(
        body: str, head: str = 'viewBox="0 0 100 100" fill="none" stroke="black"', before: str = ""
    ) -> Path:
        path = tmp_path / "picture.svg"
        namespaces = 'xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink"'
        path.write_text(f"{before}<svg {namespaces} {head}>{body}</svg>")
        return path

    return write


@pytest.fixture
def draw(svg_file: Callable[..., Path]) -> Callable[..., Drawing]:
    """The drawing of a page with this body."""
    return lambda *args, **kwargs: read_drawing(svg_file(*args, **kwargs))
