"""Views planned for the walls see them truly, few as they are; what cannot be seen is said."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.kinematics import Pose, forward
from jaxpaint.planning.postures import OWN_ROOM
from jaxpaint.planning.surroundings import stands_clear
from jaxpaint.trajectories import own_gap_at
from sims.painting.survey import survey
from sims.painting.views_seen import seen_points, share_seen
from sims.robots import load_robot
from sims.scenes.canvases import canvas_for, make_canvas
from sims.scenes.primitives import Box
from sims.scenes.scene import Scene
from sims.scenes.walls import make_wall, plaster
from sims.sensors import Camera

KEY = jax.random.key(3)
FIELD = 1.512, 1.012  # a D435's angles of view [rad]


@pytest.fixture(scope="module")
def robot():
    return load_robot()


@pytest.fixture(scope="module")
def camera():
    return Camera.with_field_of_view(106, 60, *FIELD)


def poses(robot, views):
    """Where the arm's joints truly put the camera."""
    found = [
        forward(robot.camera_chain, jnp.asarray(np.concatenate([b, q]), float))
        for b, q in zip(views.base, views.joints, strict=True)
    ]
    return Pose(jnp.stack([f.p for f in found]), jnp.stack([f.R for f in found]))


@pytest.mark.parametrize("kind", ["flat", "corner", "cylinder", "room"])
@pytest.mark.parametrize("size", [None, (1.2, 1.2)])
def test_few_views_see_the_whole_area(robot, camera, kind, size):
    scene = make_wall(kind)
    canvas = canvas_for(scene, size)
    views, _ = survey(scene, canvas, robot, camera, key=KEY)
    assert views.reachable
    assert views.clear
    assert views.lower_bound <= views.candidate_bound <= len(views)
    assert len(views) <= views.lower_bound + 1
    reached = poses(robot, views)
    np.testing.assert_allclose(reached.p, views.camera, atol=1e-3)
    np.testing.assert_allclose(reached.R, views.rotation, atol=5e-3)
    assert own_gaps(robot, views).min() >= OWN_ROOM - 1e-3
    points, seen = seen_points(scene, canvas, camera, reached)
    assert len(points) > 500
    assert seen.mean() >= 0.99
    assert share_seen(scene, canvas, camera, views) == pytest.approx(seen.mean(), abs=0.005)
    # None is there for nothing.
    without = [seen_by_others(scene, canvas, camera, reached, k) for k in range(len(views))]
    assert without[0] < 0.9
    assert max(without) < 0.95


def own_gaps(robot, views):
    """Of the robot to itself, its brush included, as it looks [m]."""
    whole = robot.body_and_brush

    def gap(base, q):
        return own_gap_at(robot.chain, whole, robot.at_home(base), jnp.concatenate([base, q]))

    return np.asarray(
        jax.jit(jax.vmap(gap))(jnp.asarray(views.base, float), jnp.asarray(views.joints, float))
    )


def seen_by_others(scene, canvas, camera, poses, left_out):
    """The share that is seen without one of the views."""
    others = jax.tree.map(lambda x: np.delete(np.asarray(x), left_out, axis=0), poses)
    return seen_points(scene, canvas, camera, others)[1].mean()


def test_views_out_of_reach_see_nothing(robot, camera):
    scene = make_wall("flat")
    canvas = make_canvas((0.5, 0.3), (-0.05, 0.0, 2.8, 0.0))
    views, _ = survey(scene, canvas, robot, camera, key=KEY)
    assert share_seen(scene, canvas, camera, views) == 0


def test_a_wide_canvas_is_left_at_its_left(robot, camera):
    scene = make_wall("flat")
    views, _ = survey(scene, canvas_for(scene, (3.6, 0.5)), robot, camera, key=KEY)
    stops = views.base[np.sort(np.unique(views.base, axis=0, return_index=True)[1])]
    assert len(stops) == 2
    assert stops[0, 1] < stops[-1, 1]  # the map's y points to the robot's left
    changes = (np.diff(views.base, axis=0) != 0).any(1).sum()
    assert changes == 1  # views from one stop follow each other


def test_a_canvas_out_of_reach_says_so(robot, camera):
    scene = make_wall("flat")
    views, _ = survey(scene, make_canvas((0.5, 0.3), (-0.05, 0.0, 2.8, 0.0)), robot, camera, key=KEY)
    assert not views.reachable
    assert views.coverage == 0
    assert len(views) >= 1


def test_the_part_in_reach_is_seen(robot, camera):
    scene = make_wall("flat")
    canvas = make_canvas((0.5, 2.2), (-0.05, 0.0, 1.9, 0.0))
    views, _ = survey(scene, canvas, robot, camera, key=KEY)
    assert views.reachable
    assert 0.5 < views.coverage < 0.95
    points, seen = seen_points(scene, canvas, camera, poses(robot, views))
    assert seen.mean() == pytest.approx(views.coverage, abs=0.1)
    assert points[seen, 2].mean() < points[~seen, 2].mean()


def test_stops_keep_clear_of_a_box_before_the_wall(robot, camera):
    wall = make_wall("flat")
    box = Box(jnp.asarray([-0.75, -0.8, 0.3]), jnp.eye(3), jnp.asarray([0.25, 0.25, 0.3]), plaster())
    scene = Scene((*wall.primitives, box), wall.chart, "flat")
    canvas = canvas_for(scene, (3.6, 0.5))
    free, _ = survey(wall, canvas, robot, camera, key=KEY)
    kept, echoes = survey(scene, canvas, robot, camera, key=KEY)
    known = echoes[np.isfinite(echoes).all(1)]
    footprint = np.asarray(robot.footprint, float)
    assert any(not stands_clear(stop, footprint, known, 0.05) for stop in free.base)
    assert all(stands_clear(stop, footprint, known, 0.05) for stop in kept.base)
    assert kept.coverage > 0.9
