"""The room and the wall with things before it: what is seen where, and what hides the canvas."""

import jax
import jax.numpy as jnp
import mujoco
import numpy as np

from sims.scenes import Objects, Room, default_canvas, make_wall, objects, room, scene_mjcf


@jax.jit
def _cast(scene, origins, directions):
    return jax.vmap(scene.raycast)(origins, directions)


def _look(scene, start, directions):
    directions = np.asarray(directions, dtype=float)
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return _cast(
        scene, jnp.tile(jnp.asarray(start, dtype=float), (len(directions), 1)), jnp.asarray(directions)
    )


def _around(count, rise=0.0):
    angle = np.linspace(-np.pi, np.pi, count, endpoint=False)
    return np.column_stack([np.cos(angle), np.sin(angle), np.full(count, rise)])


def test_the_lidar_sees_all_four_walls_and_the_column(x64):
    scene, here = room(), np.array([-1.5, 0.0, 0.3])
    along = [[1.0, 0, 0], [0, 1.0, 0], [-1.0, 0, 0], [0, -1.0, 0], [-1.4, -1.6, 0]]
    hits = _look(scene, here, along)
    to_column = np.hypot(1.4, 1.6) - Room().column_radius
    np.testing.assert_allclose(hits.distance, [1.5, 2.5, 2.5, 2.5, to_column], atol=1e-9)
    np.testing.assert_allclose(hits.normal[:4], [[-1, 0, 0], [0, -1, 0], [1, 0, 0], [0, 1, 0]], atol=1e-12)
    assert np.all(_look(scene, here, _around(720)).valid)


def test_the_door_opens_on_to_the_corridor(x64):
    config = Room()
    start = [config.door_x, 0.0, 1.0]
    through, above, beside = _look(room(), start, [[0, 1.0, 0], [0, 1.0, 0.6], [0.3, 1.0, 0]]).distance
    half = 0.5 * config.width
    assert float(through) == np.float64(half + config.thickness + config.corridor)
    np.testing.assert_allclose([above, beside], half * np.array([np.hypot(1, 0.6), np.hypot(1, 0.3)]))


def test_the_room_and_its_model_are_one_place_all_round(x64):
    """Also through the door, past its jambs and round the column."""
    scene = room()
    model = mujoco.MjModel.from_xml_string(scene_mjcf(scene))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    geom = np.zeros(1, dtype=np.int32)
    for start in ([-1.5, 0.1, 1.0], [-2.6, 1.5, 1.4]):
        directions = np.concatenate([_around(300, rise) for rise in (-0.4, 0.0, 0.25)])
        hits = _look(scene, start, directions)
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        found = np.array(
            [
                mujoco.mj_ray(model, data, np.array(start), along, None, 1, -1, geom, None)
                for along in directions
            ]
        )
        met = np.asarray(hits.valid)
        assert met.mean() > 0.95
        np.testing.assert_allclose(found[met], np.asarray(hits.distance)[met], atol=1e-5)


def _hidden(scene, canvas):
    """Of a fine grid of the canvas: (u, v) of the wall along each ray, and which rays meet a thing first."""
    u, v = np.meshgrid(np.linspace(-0.5, 0.5, 241), np.linspace(-0.5, 0.5, 61))
    uv = jnp.asarray(np.stack([u, v], axis=-1).reshape(-1, 2), dtype=float) * canvas.size
    start = canvas.to_map(uv)
    hits = _cast(scene, start, jnp.tile(canvas.ray, (len(uv), 1)))
    assert np.all(hits.valid)
    x = np.asarray(start[:, 0] + hits.distance)
    return np.stack([-np.asarray(start[:, 1]), np.asarray(start[:, 2])], axis=1), x < -1e-6


def test_things_hide_a_little_of_the_default_canvas(x64):
    scene = make_wall("objects")
    canvas = default_canvas(scene)
    np.testing.assert_allclose(canvas.size, [2.4, 0.6])
    where, hidden = _hidden(scene, canvas)
    assert 0.02 < hidden.mean() < 0.1
    config = Objects()
    post = np.abs(where[:, 0] + config.post) < config.post_radius
    np.testing.assert_array_equal(hidden & post, post & (where[:, 1] <= config.post_height))
    ball = np.hypot(where[:, 0] + config.ball, where[:, 1] - config.crate_size[2] - config.ball_radius)
    assert np.all(hidden[ball < config.ball_radius - 1e-6]) and (ball < config.ball_radius).any()
    frame = np.all(
        np.abs(where - [-config.frame[0], config.frame[1]]) < 0.5 * np.array(config.frame_size), axis=1
    )
    assert frame.any() and np.all(hidden[frame])


def test_the_canvas_of_the_objects_lies_in_front_of_them(x64):
    scene = make_wall("objects")
    canvas, config = default_canvas(scene), Objects()
    nearest = -config.gap - 2 * config.ball_radius
    # The ball's foremost point may lie between two of the rays that looked for it, or below the canvas.
    assert nearest - 0.06 < float(canvas.center[0]) < nearest - 0.03
    assert float(default_canvas(make_wall("room")).center[0]) == float(
        default_canvas(make_wall("flat")).center[0]
    )


def test_configs_move_things(x64):
    scene = objects(Objects(post=0.3, post_height=2.0))
    hit = _look(scene, [-1.0, 0.3, 1.8], [[1.0, 0, 0]])
    np.testing.assert_allclose(hit.distance, [1.0 - Objects().gap - 2 * Objects().post_radius], atol=1e-9)
    small = room(Room(width=3.0))
    np.testing.assert_allclose(_look(small, [-1.5, 0, 1.0], [[0, -1.0, 0]]).distance, [1.5])
