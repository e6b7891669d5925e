"""The report: self-contained, with the figures it should have; and each figure from odd data."""

import base64
import dataclasses
import io
import re

import numpy as np
import pytest
from PIL import Image

from experiments.commands.paint_options import PaintOptions
from experiments.options import to_config
from experiments.report import (
    Figure,
    Page,
    Section,
    Spread,
    SurfacePath,
    Tile,
    TrackingError,
    paint,
    painted_wall,
    render,
    spread,
    style,
    surface_path,
    tracking_error,
)
from experiments.report.page import KINDS
from experiments.report.paint import build_page
from experiments.report.surface_path import brushes, strokes
from experiments.tables import Table

PIXEL = base64.b64decode(
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg=="
)


@pytest.fixture(scope="module")
def page(made_up) -> Page:
    summary = {
        "config": {**to_config(PaintOptions()), "image": "a/few <b> curves.svg"},
        "versions": {"jaxpaint": "0.1.0"},
        "device": "2 x cpu",
        "compile_s": 3.0,
        "run_s": 5.0,
        **made_up.summary,
    }
    return build_page(made_up.report, summary, made_up.worlds, made_up.notes)


def pictures(html: str) -> list[bytes]:
    return [base64.b64decode(data) for data in re.findall(r'src="data:[^;]+;base64,([^"]+)"', html)]


def test_the_page_is_self_contained(page):
    html = render(page)
    assert len(pictures(html)) == len(re.findall("<img", html)) == 4
    outside = re.compile(
        r"""(?:src|href|srcset|action|data)\s*=\s*["'](?!data:)|url\(|@import|https?:|file:|<script"""
    )
    assert outside.findall(html) == []
    assert all(size_of(Figure(data, ""))[0] >= 1000 for data in pictures(html) if data.startswith(b"\x89PNG"))
    for picture in pictures(html):
        text = picture.decode("latin-1")
        assert not re.findall(r"""href="(?!#)|url\((?!#)""", text)


def test_the_page_leads_with_the_verdict(page):
    assert page.verdict == "23 of 24 worlds painted, median tracking error 3.70 mm RMSE"
    assert page.mood == "mixed"
    html = render(page)
    assert html.index(page.verdict) < html.index("<img")
    assert [section.title for section in page.sections] == [
        "Painted wall",
        "Path on the surface",
        "Tracking",
        "All worlds",
        "Settings",
    ]
    for shown in (
        "98.1 %",
        "unreachable",
        "off the surface",
        "brush-radius",
        "Up is taken to be -y.",
        "0.1.0",
    ):
        assert shown in html
    assert "too steep" not in html, "a cause without points"


def test_names_are_no_html(page):
    html = render(page)
    assert "few &lt;b&gt; curves.svg" in html
    assert "<b>" not in html


def test_a_missing_figure_is_a_dash(made_up, monkeypatch):
    for name in ("painted_wall", "surface_path", "tracking_error"):
        monkeypatch.setattr(paint, name, lambda *_: Figure(PIXEL, ""))
    nothing = {"x": None, "y": None, "z": None, "total": None, "p95": None, "max": None}
    summary = {**made_up.summary, "status": {"ok": 0, "diverged": 24}, "tracking_rmse": nothing}
    summary |= {
        "config": to_config(PaintOptions()),
        "versions": {},
        "device": "cpu",
        "compile_s": 0.0,
        "run_s": 0.0,
    }
    worlds = {
        name: column if name in ("world", "status") else column * np.nan
        for name, column in made_up.worlds.items()
    }
    nowhere = build_page(made_up.report, summary, worlds)
    assert nowhere.mood == "bad"
    assert nowhere.verdict == "0 of 24 worlds painted"
    assert "–" in render(nowhere)


def size_of(figure: Figure) -> tuple[int, int]:
    return Image.open(io.BytesIO(figure.image)).size


@pytest.fixture
def coarse(monkeypatch):
    """Pictures of fewer dots, which are drawn sooner."""
    monkeypatch.setattr(style, "SHARP", 70)


def test_paint_and_what_is_missing_are_seen(made_up, coarse):
    """Covered, missed and excess have their colours in the difference, and vanish with what they show."""
    data = made_up.report
    covered, missed, excess = (46, 125, 107), (214, 69, 69), (232, 163, 61)
    legend_only = painted_wall(data.wanted, (dataclasses.replace(data.walls[0], painted=data.wanted),))
    seen = [
        Image.open(io.BytesIO(f.image)).convert("RGB")
        for f in (painted_wall(data.wanted, data.walls), legend_only)
    ]
    counts = [{colour: count for count, colour in image.getcolors(2**24) or []} for image in seen]
    assert all(counts[0].get(colour, 0) > 2 * counts[1].get(colour, 0) for colour in (missed, excess))
    assert counts[1][covered] > 700


def test_left_and_low_stay_left_and_low(made_up, coarse):
    """Row 0 is the lowest, column 0 the leftmost."""
    data = made_up.report
    wanted = np.zeros_like(data.wanted)
    wanted[10:20, 10:20] = True  # low and left
    wanted[150:152, 290:292] = True  # keeps the window open
    walls = (dataclasses.replace(data.walls[0], painted=wanted, thickness=wanted * 1e-4),)
    image = np.asarray(Image.open(io.BytesIO(painted_wall(wanted, walls).image)).convert("RGB")).astype(int)
    ink = np.abs(image - (43, 52, 64)).sum(-1) < 6
    panel = ink[: image.shape[0] // 2, : image.shape[1] // 2]
    rows, columns = np.nonzero(panel[25:])  # below the title
    assert np.median(columns) < panel.shape[1] / 2
    assert np.median(rows) > len(panel[25:]) / 2


def test_a_wall_without_paint_and_a_tall_one_are_drawn(made_up, coarse):
    data = made_up.report
    bare = dataclasses.replace(
        data.walls[0], painted=data.wanted & False, thickness=data.walls[0].thickness * 0
    )
    assert painted_wall(data.wanted & False, (bare,), surface=data.wanted).image
    tall = np.zeros((300, 40), bool)
    tall[20:280, 18:22] = True
    wall = dataclasses.replace(bare, thickness=tall * 1e-4, painted=tall, lower=(0.0, 0.0), upper=(0.4, 3.0))
    width, height = size_of(painted_wall(tall, (wall, wall)))
    assert width > height


def test_strokes_and_travel_join(made_up):
    path = made_up.report.path
    down, up = strokes(path, down=True), strokes(path, down=False)
    assert [len(run) for run in down] == [300, 300]
    assert [len(run) for run in up] == [42]
    np.testing.assert_array_equal(up[0][0], down[0][-1])
    np.testing.assert_array_equal(up[0][-1], down[1][0])


def test_brush_directions_point_into_the_wall(made_up):
    tips, directions = brushes(made_up.report.path)
    assert len(tips) >= 30
    assert (directions[:, 0] > 0.7).all()


def test_holes_in_the_surface_are_left_open(made_up, coarse):
    path = made_up.report.path
    surface = path.surface.copy()
    surface[5:9, 10:20] = np.nan
    assert surface_path(dataclasses.replace(path, surface=surface)).image


def test_a_tall_narrow_picture_is_shown_to_its_top(coarse):
    u, v = np.meshgrid(np.linspace(-0.2, 0.2, 12), np.linspace(0.2, 2.4, 24))
    climb = np.linspace(0.25, 2.35, 300)
    path = SurfacePath(
        p_map=np.stack([0 * climb, 0.1 * np.sin(9 * climb), climb], axis=-1),
        normal=np.tile([-1.0, 0.0, 0.0], (300, 1)),
        pen=np.ones(300, bool),
        surface=np.stack([0 * u, -u, v], axis=-1),
        base=np.asarray([[-0.9, -0.2], [-0.9, 0.2]]),
    )
    image = np.asarray(Image.open(io.BytesIO(surface_path(path).image)).convert("RGB")).astype(int)
    space = image[:, : int(0.55 * image.shape[1])]
    rows = np.flatnonzero((np.abs(space - (31, 95, 191)).sum(-1) < 20).any(axis=1))
    assert rows[0] > 0.085 * len(image)


def test_the_error_of_pen_up_travel_sets_no_scale(made_up):
    """The same figure, whatever happens while the pen is up."""
    error = made_up.report.tracking
    wild = dataclasses.replace(
        error, median=np.where(error.pen, error.median, 9.0), high=np.where(error.pen, error.high, 9.0)
    )
    assert tracking_error(error).image == tracking_error(wild).image
    higher = dataclasses.replace(error, high=error.high * 2)
    assert tracking_error(error).image != tracking_error(higher).image


def test_worlds_that_are_equal_or_have_no_score_are_drawn():
    scores = tuple(
        Spread(name, "mm", np.array(values), 2.0)
        for name, values in (("a", [1.0, 1.0]), ("b", [np.nan] * 2), ("c", [0.0]), ("d", [1.0, 2.0]))
    )
    assert spread(scores).image.startswith(b"<?xml")


def test_a_page_takes_sections_of_any_command():
    table = Table(("name", "ours"), (("RMSE", 0.0123), ("other", None)))
    section = Section("Table I", "As printed.", (Figure(PIXEL, 'a "dot"'),), (table,))
    html = render(Page("reproduce", "close", tiles=(Tile("a", "1"),), sections=(section,)))
    assert "0.0123" in html
    assert 'alt="a &quot;dot&quot;"' in html
    assert next(iter(KINDS.values())) in html


def test_a_figure_that_is_no_picture_is_refused():
    page = Page("a", "b", sections=(Section("c", figures=(Figure(b"GIF89a", "d"),)),))
    with pytest.raises(ValueError, match="image"):
        render(page)


def test_a_run_that_never_moved_is_drawn(made_up, coarse):
    path, error = made_up.report.path, made_up.report.tracking
    nothing = dataclasses.replace(
        path, p_map=path.p_map[:0], normal=path.normal[:0], pen=path.pen[:0], base=path.base[:0]
    )
    assert surface_path(nothing).image
    first = {field.name: getattr(error, field.name)[:1] for field in dataclasses.fields(error)}
    lost = {name: first[name] * np.nan for name in ("low", "median", "high")}
    assert tracking_error(TrackingError(**{**first, **lost})).image
