"""Paint of many worlds in groups, and of several colours."""

from types import SimpleNamespace

import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.mapping.canvas import Canvas
from jaxpaint.pictures.drawing import Drawing
from sims.paint import Brush, PaintGrid
from sims.painting import films
from sims.painting.films import Films, split
from sims.painting.lay import Truth, lay, paint_scores
from sims.scenes.walls import flat
from sims.scoring import wanted_area

WORLDS, TIME = 5, 120
GRID = PaintGrid.covering(np.asarray([-0.2, 0.9]), np.asarray([0.2, 1.1]), 0.004)
JOB = SimpleNamespace(scene=flat(), brush=Brush(), dt=jnp.asarray(0.02))


def run():
    """A brush that goes along u at a height of its own in each world."""
    u = np.linspace(-0.15, 0.15, TIME)
    height = 1.0 + 0.01 * np.arange(WORLDS)
    place = np.stack(
        [np.zeros((WORLDS, TIME)), np.tile(-u, (WORLDS, 1)), np.tile(height[:, None], (1, TIME))], axis=-1
    ).astype(np.float32)
    axis = np.broadcast_to(np.asarray([1, 0, 0], np.float32), place.shape)
    none, live = np.zeros_like(place), np.ones((WORLDS, TIME), bool)
    pen = live.astype(np.float32)
    record = SimpleNamespace(
        planned=place, pen=pen, live=live, odometry=none, base=none, halted=np.zeros_like(pen)
    )
    return SimpleNamespace(record=record), Truth(place, axis)


@pytest.fixture(scope="module")
def whole():
    return lay(JOB, GRID, *run())


def test_one_colour_has_an_axis_of_its_own(whole):
    assert whole.thickness.shape == (WORLDS, 1, *GRID.shape) == np.asarray(whole.thickness).shape
    middle = np.asarray(whole.thickness)[:, 0, :, 50].argmax(axis=1) * 0.004 + 0.902
    np.testing.assert_allclose(middle, 1.0 + 0.01 * np.arange(WORLDS), atol=0.011)
    np.testing.assert_array_equal(whole.thickness[3], np.asarray(whole.thickness)[3])


def test_groups_have_the_same_bits_as_all_at_once(whole, monkeypatch):
    monkeypatch.setattr(films, "HELD", 2.5 * 4 * np.prod(GRID.shape))
    parts = lay(JOB, GRID, *run())
    sizes = [len(worlds) for worlds, _ in parts.thickness.groups()]
    assert sum(sizes) == WORLDS
    assert max(sizes) <= 2
    np.testing.assert_array_equal(np.asarray(parts.thickness), np.asarray(whole.thickness))
    for world in (4, 0, 2):
        np.testing.assert_array_equal(parts.thickness[world], whole.thickness[world])
    np.testing.assert_array_equal(parts.uv, whole.uv)
    np.testing.assert_array_equal(parts.tracking.total, whole.tracking.total)


def test_each_colour_lies_where_it_was_in_hand(whole):
    colour = np.zeros((WORLDS, TIME), int)
    colour[:, TIME // 2 :] = 2
    laid = lay(JOB, GRID, *run(), colour=colour, colours=3)
    thickness = np.asarray(laid.thickness)
    assert thickness.shape == (WORLDS, 3, *GRID.shape)
    np.testing.assert_allclose(thickness.sum(axis=1), np.asarray(whole.thickness)[:, 0], atol=1e-10)
    assert not thickness[:, 1].any()
    columns = thickness[0].max(axis=1) > 1e-6
    assert columns[0].nonzero()[0].max() < 56
    assert columns[2].nonzero()[0].min() > 44


def test_scores_look_at_the_colour_in_hand():
    colour = np.zeros((WORLDS, TIME), int)
    colour[:, TIME // 2 :] = 1
    canvas = Canvas(jnp.asarray([-1.0, 0.0, 1.0]), jnp.asarray(0.0), jnp.asarray([0.4, 0.2]))
    ends = np.asarray([[-0.15, 0.0], [0.0, 0.0], [0.15, 0.0]])
    drawing = Drawing((ends[:2], ends[1:]), (0, 1), (), ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)), "made up")
    extent = np.asarray([-0.2, 0.9]), np.asarray([0.2, 1.1])
    wanted = wanted_area(drawing, JOB.scene, canvas, extent, 0.010)
    found = {}
    for name, hand in (("right", colour), ("swapped", 1 - colour)):
        laid = lay(JOB, GRID, *run(), colour=hand, colours=2)
        down = np.ones((WORLDS, TIME), bool)
        found[name] = paint_scores(wanted, GRID, laid, down, film=float(JOB.brush.film))
    assert len(found["right"]) == WORLDS
    assert found["right"][0].coverage > 0.95
    assert found["right"][0].stroke_error_mean < 1e-3
    assert found["right"][3].stroke_error_mean == pytest.approx(0.03, abs=1.5e-3)
    assert found["swapped"][0].coverage < 0.2, "only the brush's own round reaches over"
    assert found["swapped"][0].stroke_error_mean > 0.03


def test_groups_are_of_one_length_and_leave_nobody_out():
    for worlds, size in ((64, 5e7), (7, 3e8), (1, 1e12), (16, 1.0)):
        groups = split(worlds, size)
        assert len({len(group) for group in groups}) == 1
        assert set(np.concatenate(groups)) == set(range(worlds))


def test_films_are_laid_only_when_asked_for():
    asked = []

    def laid(worlds):
        asked.append(worlds.tolist())
        return np.broadcast_to(worlds[:, None, None, None] * 1.0, (len(worlds), 1, 2, 2))

    held = Films((5, 1, 2, 2), (np.arange(2), np.arange(2, 4), np.arange(3, 5)), laid)
    assert asked == []
    assert held[3].max() == 3
    assert held[2].max() == 2
    assert asked == [[2, 3]]
    np.testing.assert_array_equal(np.asarray(held)[:, 0, 0, 0], np.arange(5))
    assert [film.max() for film in held] == list(range(5))
    for world in (-1, 5, -6):
        with pytest.raises(IndexError, match=f"found {world}, allowed: 0 to 4"):
            held[world]
