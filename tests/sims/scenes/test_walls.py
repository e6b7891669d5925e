"""The walls by name, their default canvases, and canvases that users ask for."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.errors import InputError
from sims.scenes import WALLS, canvas_for, default_canvas, make_wall

BARE = [kind for kind in WALLS if kind != "objects"]


@jax.jit
def _cast(scene, origins, directions):
    return jax.vmap(scene.raycast)(origins, directions)


def _grid(canvas, across=20, up=5):
    u, v = np.meshgrid(np.linspace(-0.5, 0.5, across), np.linspace(-0.5, 0.5, up))
    return jnp.asarray(np.stack([u, v], axis=-1).reshape(-1, 2), dtype=float) * canvas.size


@pytest.mark.parametrize("kind", BARE)
def test_rays_agree_with_the_chart(x64, strict_ranks, kind):
    scene = make_wall(kind)
    uv = np.random.default_rng(1).uniform([-1.4, 0.3], [1.4, 2.5], (100, 2))
    origins = jnp.tile(jnp.asarray([[-1.0, 0.15, 1.2]]), (100, 1))
    targets = jax.vmap(scene.chart.point)(jnp.asarray(uv))
    length = jnp.linalg.norm(targets - origins, axis=1, keepdims=True)
    hits = _cast(scene, origins, (targets - origins) / length)
    np.testing.assert_allclose(hits.distance, length[:, 0], atol=1e-9)
    np.testing.assert_allclose(hits.normal, jax.vmap(scene.chart.normal)(jnp.asarray(uv)), atol=1e-9)
    assert np.all(hits.valid)


@pytest.mark.parametrize("kind", WALLS)
def test_the_floor_is_seen_below_the_wall(x64, kind):
    starts, directions = jnp.tile(jnp.asarray([[-1.0, 0, 1.0], [0.6, 0, -0.8]])[:, None], (1, 100, 1))
    hits = _cast(make_wall(kind), starts, directions)
    np.testing.assert_allclose([hits.distance[0], *hits.normal[0]], [1.25, 0, 0, 1], atol=1e-9)


@pytest.mark.parametrize("kind", BARE)
def test_the_default_canvas_covers_the_arc_length_asked_for(x64, kind):
    scene = make_wall(kind)
    canvas = default_canvas(scene)
    uv = _grid(canvas)
    hits = _cast(scene, canvas.to_map(uv), jnp.tile(canvas.ray, (len(uv), 1)))
    assert np.all(hits.valid)
    points = canvas.to_map(uv) + hits.distance[:, None] * canvas.ray
    on_wall = np.asarray(jax.vmap(lambda p: scene.chart.to_uv(p)[0])(points))
    np.testing.assert_allclose(np.ptp(on_wall, axis=0), [2.4, 0.6], atol=1e-9)
    np.testing.assert_allclose(
        np.mean([on_wall.min(axis=0), on_wall.max(axis=0)], axis=0), [0, 1.1], atol=1e-9
    )


def test_contract_of_the_bent_walls():
    fold, column = make_wall("corner"), make_wall("cylinder")
    half = 0.5 * float(default_canvas(fold).size[0])
    assert half / np.sin(0.5 * float(fold.chart.interior)) >= 0.4
    arc = 2 * np.arcsin(0.5 * float(default_canvas(column).size[0]) / float(column.chart.radius))
    assert np.rad2deg(arc) >= 60


def test_unknown_wall_names_the_allowed_ones():
    with pytest.raises(InputError, match="'brick' found, allowed: flat, corner, cylinder, objects, room"):
        make_wall("brick")


def test_users_canvas_takes_size_and_pose():
    canvas = canvas_for(make_wall("flat"), (0.8, 0.4), (-0.3, 0.5, 1.4, 0.2))
    np.testing.assert_allclose(
        [*canvas.size, *canvas.center, canvas.yaw], [0.8, 0.4, -0.3, 0.5, 1.4, 0.2], rtol=1e-6
    )
    only_size = canvas_for(make_wall("flat"), (0.8, 0.4))
    np.testing.assert_allclose(only_size.center, default_canvas(make_wall("flat")).center)


def test_a_canvas_too_high_to_reach_is_no_bad_input():
    assert float(canvas_for(make_wall("flat"), None, (-0.05, 0, 2.6, 0)).center[2]) == pytest.approx(2.6)


@pytest.mark.parametrize(
    ("pose", "share"),
    [
        ((-0.05, 5.0, 1.1, 0.0), "0%"),  # beside the wall
        ((0.5, 0.0, 1.1, 0.0), "0%"),  # behind it
        ((-2.0, 0.0, 1.1, 0.0), "0%"),  # too far in front
        ((-0.05, 0.0, 1.1, 3.14), "0%"),  # looking away
        ((-0.05, 0.0, 3.1, 0.0), "33%"),  # most of it above the top
    ],
)
def test_a_canvas_off_the_wall_is_refused_with_the_share_found(pose, share):
    with pytest.raises(InputError, match=f"{share} of the canvas") as raised:
        canvas_for(make_wall("flat"), None, pose)
    assert "\n" not in str(raised.value) and "--canvas-pose" in str(raised.value)


@pytest.mark.parametrize("size", [(0.0, 1.0), (1.0, -1.0), (float("nan"), 1.0)])
def test_a_canvas_has_a_size(size):
    with pytest.raises(InputError, match="--canvas-size"):
        canvas_for(make_wall("flat"), size)


def test_a_canvas_has_finite_numbers():
    with pytest.raises(InputError, match="--canvas-pose"):
        canvas_for(make_wall("flat"), None, (float("inf"), 0, 1, 0))
