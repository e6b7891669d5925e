"""Pictures of several colours: the tool is changed clear of the wall, and no colour is forgotten."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
import pytest

from experiments.commands.paint_options import PaintOptions
from experiments.paint import score
from experiments.paint_job import paint_task
from sims.painting import run_mission
from sims.painting.tools import in_hand

# Two strokes of two colours, and a dot of a third that is too short to be one.
PICTURE = """<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 60 60" fill="none">
<path d="M5 10 H40" stroke="red"/><path d="M5 30 Q25 50 50 30" stroke="blue"/>
<path d="M55 55 h0.02" stroke="black"/></svg>"""
WORLDS = 2


@pytest.fixture(scope="module")
def coloured(tmp_path_factory):
    """The task, and its mission in two worlds."""
    picture = tmp_path_factory.mktemp("picture") / "coloured.svg"
    picture.write_text(PICTURE)
    task = paint_task(PaintOptions(image=picture, canvas_size=(0.5, 0.5), worlds=WORLDS))
    return task, run_mission(task.job, task.grid, np.arange(WORLDS))


def test_a_colour_without_a_stroke_is_a_colour_still(coloured):
    task, mission = coloured
    assert np.asarray(task.job.colour).max() == 1, "the dot has no stroke"
    assert task.job.colours == len(task.drawing.colours) == len(task.wanted.layers) == 3
    assert mission.laid.films.shape[1] == 3
    rows = score(task, mission)
    assert [row.status for row in rows] == ["ok"] * WORLDS
    assert min(row.coverage for row in rows) > 0.9


def test_no_paint_of_the_next_colour_lies_on_the_last_stroke(coloured):
    task, mission = coloured
    film, nominal = np.asarray(mission.laid.films), float(task.job.brush.film)
    row, column = np.indices(task.grid.shape)
    uv = np.asarray(task.grid.origin) + float(task.grid.cell) * np.stack([column, row], axis=-1)
    red, blue = (task.wanted.layers[k].tree.query(uv)[0] < 0.02 for k in (0, 1))
    assert not (red & blue).any()
    for world in film:
        assert min(world[0][red].max(), world[1][blue].max()) > 0.5 * nominal
        assert world[0][blue].max() == world[1][red].max() == world[2].max() == 0


def test_a_stroke_of_a_colour_that_is_not_known_is_refused(coloured):
    task, mission = coloured
    job = eqx.tree_at(lambda j: j.colour, task.job, jnp.full_like(task.job.colour, 3))
    with pytest.raises(ValueError, match="found colour 3, allowed: 0 to 2"):
        in_hand(job, mission.painting, np.zeros((WORLDS, 1)), np.ones(WORLDS, bool), None)
