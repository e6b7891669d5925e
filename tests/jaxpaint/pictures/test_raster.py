"""Ink from pixels: which side is ink, uneven light, colours, sub-pixel rims, line art."""

import colorsys

import cv2
import numpy as np
import pytest
import shapely
from PIL import Image, ImageDraw
from scipy.ndimage import gaussian_filter

from jaxpaint.errors import InputError
from jaxpaint.pictures import RasterSettings, read_drawing
from jaxpaint.pictures.drawing import polyline_length
from jaxpaint.pictures.regions import region_of


@pytest.fixture
def saved(tmp_path):
    """Writes pixels (0 to 1, grey or RGB) or a picture, and gives back the file."""

    def save(picture, name: str = "a.png"):
        if not isinstance(picture, Image.Image):
            picture = Image.fromarray(np.uint8(np.clip(picture, 0, 1) * 255 + 0.5))
        picture.save(tmp_path / name)
        return tmp_path / name

    return save


def disc(size: int = 120, radius: float = 40.3, middle=(60.2, 57.7)) -> np.ndarray:
    """A black disc on white with a rim as smooth as a scanner's: shares of pixels."""
    v, u = np.mgrid[:size, :size] + 0.5
    return np.clip(np.hypot(u - middle[0], v - middle[1]) - radius + 0.5, 0, 1)


def lettering(size=(260, 400)) -> np.ndarray:
    """Lines of even width: a cross, a ring and a wave; 0 is ink."""
    picture = np.full(size, 255, np.uint8)
    cv2.line(picture, (30, 30), (150, 200), 0, 7, cv2.LINE_AA)
    cv2.line(picture, (150, 30), (30, 200), 0, 7, cv2.LINE_AA)
    cv2.circle(picture, (300, 80), 45, 0, 7, cv2.LINE_AA)
    u = np.linspace(190, 380, 200)
    wave = np.stack([u, 200 + 25 * np.sin(u / 15)], axis=1)
    cv2.polylines(picture, [np.rint(wave * 16).astype(np.int32)], False, 0, 7, cv2.LINE_AA, shift=4)
    return picture / 255


def area_of(drawing, colour=0) -> float:
    return sum(region_of(area).area for area in drawing.areas if area.colour == colour)


def test_rims_lie_between_pixels(saved):
    drawing = read_drawing(saved(disc()))
    (area,) = drawing.areas
    (ring,) = area.rings
    np.testing.assert_allclose(np.hypot(*(ring - [60.2, -57.7]).T), 40.3, atol=0.25)
    assert area_of(drawing) == pytest.approx(np.pi * 40.3**2, rel=0.005)
    assert drawing.colours == ((0, 0, 0),)


@pytest.mark.parametrize("turned", [False, True])
def test_the_paper_is_what_the_border_shows(saved, turned):
    drawing = read_drawing(saved(1 - disc() if turned else disc()))
    assert area_of(drawing) == pytest.approx(np.pi * 40.3**2, rel=0.02)
    asked = RasterSettings(ink="dark" if turned else "light")
    assert area_of(read_drawing(saved(1 - disc() if turned else disc()), asked)) > 1.5 * area_of(drawing)


@pytest.mark.parametrize(("ink", "shown"), [((0, 0, 0), 0), ((255, 255, 255), 1), ((255, 0, 0), 1)])
def test_transparent_is_paper(saved, ink, shown):
    picture = Image.new("RGBA", (60, 60), (90, 200, 30, 0))
    picture.paste((*ink, 255), (10, 10, 40, 50))
    drawing = read_drawing(saved(picture))
    assert area_of(drawing) == pytest.approx(30 * 40, rel=0.02)
    assert drawing.colours[0][0] == pytest.approx(shown, abs=0.02)


def test_uneven_light_is_followed(saved):
    """A page twice as bright on one side as on the other: dark paper is darker than bright ink."""
    rng = np.random.default_rng(0)
    light = np.linspace(0.35, 1.0, 400) * np.linspace(1.0, 0.8, 260)[:, None]
    page = gaussian_filter(light * (0.25 + 0.75 * lettering()) + rng.normal(0, 0.01, light.shape), 0.6)
    settings = RasterSettings(style="area")
    drawing = read_drawing(saved(page), settings)
    wanted = (lettering() < 0.5).sum()
    assert area_of(drawing) == pytest.approx(wanted, rel=0.1)
    globally = read_drawing(saved(page), RasterSettings(style="area", threshold="global"))
    assert abs(area_of(globally) - wanted) > 0.5 * wanted


def slope(rows: int, columns: int) -> np.ndarray:
    return np.linspace(1.0, 0.5, columns) * np.ones((rows, 1))


def vignette(rows: int, columns: int) -> np.ndarray:
    v, u = np.mgrid[:rows, :columns]
    return 1 - 0.6 * ((u - 0.45 * columns) ** 2 + (v - 0.55 * rows) ** 2) / (0.625 * columns) ** 2


@pytest.mark.parametrize("light", [slope, vignette])
@pytest.mark.parametrize(
    ("turned", "radius", "middle"),
    [
        (False, 40, (200, 150)),
        (False, 90, (200, 150)),
        (False, 90, (60, 70)),
        (True, 40, (200, 150)),
        (True, 90, (200, 150)),
    ],
)
def test_solid_ink_in_uneven_light_is_whole(saved, light, turned, radius, middle):
    """Discs far wider than the neighbourhood in which shadows are followed, dark ones and bright ones."""
    v, u = np.mgrid[:300, :400]
    ink = np.hypot(u - middle[0], v - middle[1]) < radius
    tones = np.where(ink, 0.9, 0.2) if turned else np.where(ink, 0.2, 1.0)
    page = gaussian_filter(light(300, 400) * tones, 0.6)
    settings = RasterSettings(style="area", threshold="local")
    assert area_of(read_drawing(saved(page), settings)) == pytest.approx(ink.sum(), rel=0.02)


def test_shadows_are_followed(saved):
    """A soft shadow over a corner, in which paper is as dark as half of the light makes it."""
    shadow = np.ones((260, 400))
    shadow[120:, 150:] = 0.5
    page = gaussian_filter(gaussian_filter(shadow, 8) * (0.25 + 0.75 * lettering()), 0.6)
    drawing = read_drawing(saved(page), RasterSettings(style="area", threshold="local"))
    assert area_of(drawing) == pytest.approx((lettering() < 0.5).sum(), rel=0.05)


def test_specks_are_left_out(saved):
    rng = np.random.default_rng(1)
    page = disc()
    page[rng.integers(0, 120, 60), rng.integers(0, 120, 60)] = 0
    page[60, 60] = 1
    assert len(read_drawing(saved(page)).areas) <= 4  # a few specks touch each other
    assert len(read_drawing(saved(page), RasterSettings(speck=0)).areas) > 10


def flag() -> Image.Image:
    """Red, blue and a yellow disc over both, with smooth rims, on white."""
    large = Image.new("RGB", (800, 600), "white")
    draw = ImageDraw.Draw(large)
    draw.rectangle((80, 80, 400, 520), fill=(200, 30, 30))
    draw.rectangle((400, 80, 720, 520), fill=(20, 60, 180))
    draw.ellipse((300, 200, 500, 400), fill=(250, 210, 40))
    return large.resize((200, 150), Image.Resampling.BOX)


def test_colours_become_passes_light_before_dark(saved):
    drawing = read_drawing(saved(flag()))
    assert len(drawing.colours) == 3
    expected = np.array([[250, 210, 40], [200, 30, 30], [20, 60, 180]]) / 255
    np.testing.assert_allclose(drawing.colours, expected, atol=0.03)
    sizes = [area_of(drawing, k) for k in range(3)]
    half = 80 * 110 - np.pi * 25**2 / 2
    np.testing.assert_allclose(sizes, [np.pi * 25**2, half, half], rtol=0.02)
    regions = [region_of(area) for area in drawing.areas]
    assert all(a.intersection(b).area < 1 for i, a in enumerate(regions) for b in regions[:i])


def test_a_photograph_of_colours_has_the_same_passes(saved):
    """JPEG blurs colours and rings at rims; there is no grey or brown ink for that."""
    drawing = read_drawing(saved(flag().resize((400, 300)), "a.jpg"))
    expected = np.array([[250, 210, 40], [200, 30, 30], [20, 60, 180]]) / 255
    np.testing.assert_allclose(drawing.colours, expected, atol=0.05)


def test_fewer_colours_on_demand(saved):
    assert len(read_drawing(saved(flag()), RasterSettings(colours=2)).colours) == 2
    assert len(read_drawing(saved(flag()), RasterSettings(colours=1)).colours) == 1


@pytest.mark.parametrize(("count", "colours", "lost"), [(12, 3, 8), (12, 0, 3), (5, 0, 0)])
def test_colours_without_an_ink_are_painted_in_the_nearest(saved, count, colours, lost):
    """Hues in boxes on white; of three inks none is as near to cyan as the paper is."""
    page = np.ones((220, 400, 3))
    corners = [(15 + k // 5 * 70, 20 + k % 5 * 75) for k in range(count)]
    for k, (row, column) in enumerate(corners):
        page[row : row + 50, column : column + 55] = colorsys.hsv_to_rgb(k / count, 1, 1)
    drawing = read_drawing(saved(page), RasterSettings(colours=colours))
    ink = shapely.unary_union([region_of(area) for area in drawing.areas])
    boxes = [shapely.box(column, -row - 50, column + 55, -row) for row, column in corners]
    assert min(ink.intersection(box).area / box.area for box in boxes) > 0.95
    assert drawing.ignored == ({"colour": lost} if lost else {})
    # Twelve tones are told apart at most, and one of them is the paper.
    assert len(drawing.colours) == min(11, count) - lost


def test_line_art_is_read_as_lines_straight_through_the_crossing(saved):
    drawing = read_drawing(saved(lettering()))
    assert not drawing.areas and len(drawing.lines) == 4
    lengths = sorted(polyline_length(line) for line in drawing.lines)
    stroke = np.hypot(120, 170)
    assert lengths[:2] == pytest.approx([stroke, stroke], abs=9)
    (ring,) = [line for line, closed in zip(drawing.lines, drawing.closed, strict=True) if closed]
    np.testing.assert_allclose(np.hypot(*(ring - [300.5, -80.5]).T), 45, atol=0.7)
    for line in drawing.lines:
        ends = line[[0, -1]] * [1, -1]
        if np.abs(np.abs(ends[1] - ends[0]) - [120, 170]).max() < 12:
            step = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
            off = (line * [1, -1] - ends[0]) @ [-step[1], step[0]]
            inner = (np.abs((line * [1, -1]) - [90, 115]) < [50, 75]).all(axis=1)
            assert inner.sum() >= 2 and np.abs(off[inner]).max() < 1.0


def test_both_readings_on_demand(saved):
    path = saved(lettering())
    assert read_drawing(path, RasterSettings(style="area")).areas
    assert read_drawing(saved(disc()), RasterSettings(style="skeleton")).lines


@pytest.mark.realdata
def test_real_pictures(shared_data):
    horse = read_drawing(shared_data / "images" / "ski_horse.png")
    assert (len(horse.areas), len(horse.lines), horse.colours) == (1, 0, ((0, 0, 0),))
    text = read_drawing(shared_data / "images" / "ski_text.png")
    assert 30 <= len(text.lines) <= 70 and not text.areas
    phantom = read_drawing(shared_data / "images" / "ski_phantom.png")
    assert len(phantom.colours) == 2
    low, high = phantom.bounds
    np.testing.assert_allclose(high - low, [276, 368], atol=4)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"style": "dots"}, "picture style: found 'dots'; allowed are auto, skeleton, area"),
        ({"threshold": "x"}, "picture threshold: found 'x'; allowed are auto, global, local"),
        ({"ink": "pink"}, "picture ink: found 'pink'; allowed are auto, dark, light"),
        ({"colours": 9}, "picture colours: found 9; allowed are"),
        (
            {"colours": 3, "threshold": "global"},
            "picture threshold global with picture colours 3: found both",
        ),
        ({"colours": 2, "threshold": "local"}, "picture threshold local with picture colours 2: found both"),
    ],
)
def test_impossible_settings(saved, options, message):
    with pytest.raises(InputError, match=message):
        read_drawing(saved(disc()), RasterSettings(**options))


def test_too_many_patches(saved):
    path = saved((np.random.default_rng(0).random((400, 400)) > 0.5).astype(float))
    with pytest.raises(InputError, match=r"found \d+ separate patches of ink; allowed are 5000"):
        read_drawing(path, RasterSettings(style="area", speck=0, colours=1))
