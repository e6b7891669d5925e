"""Real pictures and meshes, painted whole: what the toolkit promises of them. Minutes each."""

import contextlib
import re

import pytest

from experiments.commands.paint_options import PaintOptions
from experiments.paint import run

pytestmark = [pytest.mark.slow, pytest.mark.realdata]

SIZE, WORLDS = (1.2, 1.2), 16


@contextlib.contextmanager
def silent(title, total):
    class Bar:
        def advance(self, amount=1.0):
            """Nobody looks."""

    yield Bar()


def paint(**options):
    asked = PaintOptions(worlds=WORLDS, **options)
    asked.check()
    return run(asked, silent)


def check(summary, coverage=0.97, excess=0.05, stroke_error=0.004):
    assert summary["status"]["ok"] == WORLDS
    assert summary["paint"]["coverage"] >= coverage
    assert summary["paint"]["excess"] <= excess
    assert summary["paint"]["stroke_error"]["mean"] <= stroke_error


@pytest.mark.parametrize(
    ("name", "radius"),
    [("ski_horse.png", 0.010), ("ski_text.png", 0.004), ("gnu.svg", 0.004), ("few_beziers.svg", 0.010)],
)
def test_a_picture_on_a_flat_wall(shared_data, name, radius):
    found = paint(image=shared_data / "images" / name, canvas_size=SIZE, brush_radius=radius)
    check(found.summary)


def test_two_colours(shared_data, tmp_path):
    """python.svg with its lower half in another colour: two passes, each judged by its own paint."""
    source = (shared_data / "images" / "python.svg").read_text()
    head, body = source.split('<path d="', 1)
    data, tail = body.split('"', 1)
    upper, lower = data.split("zm13.09 3.95", 1)
    # the lower half begins where the upper one's eye ended: (14.25 .18) + (-6.3 1.98) + (13.09 3.95)
    halves = f'<path fill="#3776ab" d="{upper}z"/><path fill="#ffd43b" d="M21.04 6.11{lower}"'
    picture = tmp_path / "python.svg"
    picture.write_text(f"{head}{halves}{tail}")
    found = paint(image=picture, canvas_size=SIZE)
    assert len(found.summary["path"]["passes"]) == 2
    check(found.summary)


@pytest.mark.parametrize(
    ("name", "options"),
    [("noether_raw_mesh.ply", {}), ("trimesh_cylinder.stl", {"wall_scale": 1.0})],
)
def test_a_mesh_as_the_wall(shared_data, name, options):
    """On the canvas that is found in it."""
    wall, picture = shared_data / "meshes" / name, shared_data / "images" / "few_beziers.svg"
    found = paint(wall=wall, image=picture, **options)
    check(found.summary)
    assert name.split(".")[0] in found.notes[0]


def test_strokes_over_a_hole_in_a_mesh_are_named(shared_data):
    """The picture is wider than what is whole: it lies over the hole, and all around it is painted."""
    wall, picture = (
        shared_data / "meshes" / "trimesh_wallhole.obj",
        shared_data / "images" / "few_beziers.svg",
    )
    found = paint(wall=wall, wall_scale=0.25, image=picture, canvas_size=(2.4, 1.2))
    check(found.summary)
    (left_out,) = [note for note in found.notes if note.startswith("left out, over a hole")]
    assert re.search(r"points, in strokes? \d", left_out)
