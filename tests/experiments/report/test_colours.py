"""A wall in the picture's own colours."""

import io

import numpy as np
import pytest
from PIL import Image

from experiments.report import PaintedWall, painted_wall, style
from experiments.report.colours import paint_colours, wanted_colours

RED, BLUE = (0.8, 0.2, 0.2), (0.2, 0.2, 0.6)  # whole numbers of 255ths


def test_the_last_colour_lies_on_top():
    wanted = np.zeros((2, 1, 3), bool)
    wanted[0, 0, :2] = wanted[1, 0, 1:] = True
    picture = wanted_colours(wanted, (RED, BLUE))
    np.testing.assert_allclose(picture[0], [(*RED, 1), (*BLUE, 1), (*BLUE, 1)])


def test_thin_paint_lets_through_what_is_below():
    films = np.asarray([[[1.0, 1.0, 0.0, 0.0]], [[0.0, 0.5, 0.5, 2.0]]])
    picture = paint_colours(films, (RED, BLUE), 1.0)[0]
    np.testing.assert_allclose(picture[0], (*RED, 1))
    np.testing.assert_allclose(picture[1], (*np.add(RED, BLUE) / 2, 1))
    np.testing.assert_allclose(picture[2], (*BLUE, 0.5))
    np.testing.assert_allclose(picture[3], (*BLUE, 1))
    assert (paint_colours(0 * films, (RED, BLUE), 1.0)[..., 3] == 0).all()


@pytest.mark.parametrize("palette", [(RED, BLUE), (BLUE, RED)])
def test_the_report_shows_each_colour_and_what_lacks_its_own(palette, monkeypatch):
    monkeypatch.setattr(style, "SHARP", 70)
    wanted = np.zeros((2, 60, 80), bool)
    wanted[0, 10:50, 10:40] = wanted[1, 10:50, 40:70] = True
    films = 1e-4 * wanted[::-1]  # swapped
    wall = PaintedWall(films, films > 5e-5, (0.0, 0.0), (0.8, 0.6), "a world")
    image = Image.open(io.BytesIO(painted_wall(wanted, (wall,), palette=palette).image)).convert("RGB")
    counts = {colour: count for count, colour in image.getcolors(2**24) or []}
    shown = [counts.get(tuple(round(255 * x) for x in colour), 0) for colour in palette]
    assert min(shown) > 1000
    missed, covered = counts.get((214, 69, 69), 0), counts.get((46, 125, 107), 0)
    assert missed > 20 * covered
