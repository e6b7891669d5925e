"""A capture becomes a wall: where it stands, how true and smooth it is, where the canvas goes."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.clouds import Cloud, read_cloud
from jaxpaint.errors import InputError
from sims.scenes import canvas_for, captured
from sims.scenes.orientation import find_wall, parse_axis

RAYS = 441
REAL_WALLS = {"pcl_capture0001": 0.020, "o3d_fragment": 0.002}


def _cloud(points):
    return Cloud(np.asarray(points, dtype=float), None, 0, None, "cloud", np.zeros(3))


def _to_map(wall, points):
    transform = wall.report.T_map_capture
    return points @ transform[:3, :3].T + transform[:3, 3]


@jax.jit
def _cast(scene, origins, directions):
    return jax.vmap(scene.raycast)(origins, directions)


@jax.jit
def _normals(chart, uv):
    return jax.vmap(chart.normal)(uv), jax.vmap(chart.on_surface)(uv)


def _square_on(scene, start):
    """What a ray along x from `start` meets."""
    origins = jnp.tile(jnp.asarray(start, dtype=float), (RAYS, 1))
    return jax.tree.map(
        lambda leaf: leaf[0], _cast(scene, origins, jnp.tile(jnp.asarray([1.0, 0, 0]), (RAYS, 1)))
    )


def _inside(wall, points, border=0.08):
    """Which points the height map knows, away from its own border, the hole and the box."""
    surface = wall.scene.chart.surface
    valid = np.asarray(surface.valid)
    reach = int(border / float(surface.cell))
    rows = np.round((points[:, 2] - float(surface.low)) / float(surface.cell)).astype(int)
    columns = np.round((-points[:, 1] - float(surface.left)) / float(surface.cell)).astype(int)
    ok = (rows >= reach) & (columns >= reach)
    ok &= (rows < valid.shape[0] - reach) & (columns < valid.shape[1] - reach)
    shifts = [(i, j) for i in range(-reach, reach + 1, 3) for j in range(-reach, reach + 1, 3)]
    for i, j in shifts:
        ok &= valid[np.clip(rows + i, 0, valid.shape[0] - 1), np.clip(columns + j, 0, valid.shape[1] - 1)]
    return ok


def test_the_surface_is_the_truth_without_the_noise(capture, captured_wall):
    points = _to_map(captured_wall, capture.points)
    normals = capture.normals @ captured_wall.report.T_map_capture[:3, :3].T
    known = _inside(captured_wall, points)
    assert known.mean() > 0.5
    chart = captured_wall.scene.chart
    uv, height = jax.jit(jax.vmap(chart.to_uv))(jnp.asarray(points[known], dtype=float))
    # The capture has 2 mm of noise; the surface is a third of a millimetre from the truth.
    assert np.sqrt(np.mean(np.square(height))) < 0.5e-3
    found = np.asarray(_normals(chart, uv)[0])
    angles = np.rad2deg(np.arccos(np.clip(np.sum(found * normals[known], axis=1), -1, 1)))
    assert np.sqrt(np.mean(angles**2)) < 0.7


def test_residual_is_at_most_the_noise_of_the_capture(captured_wall):
    report = captured_wall.report
    assert report.residual_rms <= report.noise_rms * 1.02
    assert report.residual_rms == pytest.approx(0.002, rel=0.15)


def test_the_wall_stands_in_front_of_the_robot(capture, captured_wall):
    points = _to_map(captured_wall, capture.points)
    assert np.abs(np.median(points[:, 0])) < 0.01
    assert np.percentile(np.abs(points[:, 0]), 99) < 0.03
    # The box was to the left of the camera's middle; it is to the left of the robot's.
    box = _to_map(captured_wall, capture.cloud.points[-1:])[0]
    hole_side = points[:, 1].min()
    assert box[0] == pytest.approx(-0.35, abs=0.05) and box[1] > hole_side
    assert np.linalg.det(captured_wall.report.T_map_capture[:3, :3]) == pytest.approx(1.0)


def test_objects_and_holes_stay_apart_from_the_wall(capture, captured_wall):
    chart = captured_wall.scene.chart
    box = _to_map(captured_wall, capture.cloud.points[-1300:]).mean(axis=0)
    on_box = _square_on(captured_wall.scene, [-1.0, box[1], box[2]])
    assert bool(on_box.valid) and float(on_box.distance) == pytest.approx(0.65, abs=0.01)
    np.testing.assert_allclose(on_box.normal, [-1, 0, 0], atol=0.02)
    # The hole lay 1.1 m to the right of the box and 0.8 m above it.
    hole = np.array([-box[1] + 1.1, box[2] + 0.8])
    assert not bool(chart.on_surface(jnp.asarray(hole, dtype=float)))
    assert not bool(_square_on(captured_wall.scene, [-1.0, -hole[0], hole[1]]).valid)


def test_the_canvas_lies_on_free_wall(captured_wall):
    canvas, report = captured_wall.canvas, captured_wall.report
    np.testing.assert_allclose(canvas.center[1:], [0.0, 1.1], atol=1e-6)
    assert report.clearance > 0.05
    u, v = np.meshgrid(np.linspace(-0.5, 0.5, 21), np.linspace(-0.5, 0.5, 21))
    uv = jnp.asarray(np.stack([u, v], axis=-1).reshape(-1, 2), dtype=float) * (canvas.size + report.clearance)
    hits = _cast(captured_wall.scene, canvas.to_map(uv), jnp.tile(canvas.ray, (RAYS, 1)))
    assert np.all(hits.valid) and np.all((hits.distance > 0) & (hits.distance < 0.12))
    assert np.array_equal(canvas_for(captured_wall.scene, default=canvas).center, canvas.center)


def test_a_canvas_that_does_not_fit_names_the_largest_that_does(capture):
    with pytest.raises(InputError, match=r"2 x 1 m finds no free wall.*fits is (\d\.\d\d) x") as raised:
        captured(capture.cloud, up="-y", canvas_size=(2.0, 1.0))
    width = float(str(raised.value).split("fits is ")[1].split(" ")[0])
    assert 0.8 < width < 1.8
    fits = captured(capture.cloud, up="-y", canvas_size=(width, width / 2))
    assert fits.report.canvas_size == (width, width / 2)


def test_height_is_that_of_the_lowest_point(capture):
    wall = captured(capture.cloud, up="-y", height=0.3, canvas_size=(0.4, 0.4))
    assert _to_map(wall, capture.cloud.points)[:, 2].min() == pytest.approx(0.3, abs=0.01)
    assert wall.report.height == pytest.approx(0.3) and not wall.report.height_guessed


def test_up_is_guessed_and_said(capture):
    wall = captured(capture.cloud)
    assert wall.report.up == "-y" and wall.report.up_guessed
    text = "\n".join(wall.report.lines())
    assert "up -y (guessed)" in text and "mm rms" in text


@pytest.mark.parametrize("heading", [0.0, 1.0, 2.5, 4.0])
def test_any_heading_gives_the_same_wall(capture, heading):
    cos, sin = np.cos(heading), np.sin(heading)
    # From the camera's axes to z up, then turned about z: the sensor stays at the origin.
    level = capture.cloud.points @ np.array([[1.0, 0, 0], [0, 0, -1.0], [0, 1.0, 0]])
    turned = level @ np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1.0]]).T
    stance = find_wall(_cloud(turned), "z")
    wall = turned @ stance.R_wall_capture.T
    inlier = np.abs(wall[:, 0] - stance.offset) < 0.02
    assert inlier.mean() > 0.85 and stance.offset == pytest.approx(2.0, abs=0.01)
    np.testing.assert_allclose(stance.R_wall_capture[2], [0, 0, 1], atol=0.02)
    assert stance.side == "the sensor's"


def test_objects_tell_the_side_where_the_origin_lies_on_the_wall(capture):
    stance = find_wall(capture.cloud, "-y")
    middle = stance.offset * stance.R_wall_capture[0]
    moved = find_wall(_cloud(capture.cloud.points - middle), "-y")
    assert moved.side == "the objects'"
    np.testing.assert_allclose(moved.R_wall_capture, stance.R_wall_capture, atol=0.01)


@pytest.mark.parametrize(("name", "axis"), [("x", "+x"), ("+y", "+y"), ("-z", "-z")])
def test_axes(name, axis):
    assert parse_axis(name) == axis


@pytest.mark.parametrize("name", ["", "w", "--y", "y-", "up", "yz"])
def test_unknown_axes_are_refused(name):
    with pytest.raises(InputError, match=r"--up: .*allowed: x, y, z, \+x"):
        parse_axis(name)


@pytest.mark.parametrize("shape", ["line", "strip", "ball", "floor", "few"])
def test_clouds_without_a_wall_are_refused_in_one_line(shape):
    generator = np.random.default_rng(9)
    points = {
        "line": np.column_stack([np.linspace(0, 2, 400), np.zeros(400), np.ones(400)]),
        "strip": np.column_stack(
            [generator.uniform(-1, 1, (900, 1)), np.full(900, 2.0), np.arange(900) % 3 / 50]
        ),
        "ball": generator.normal(size=(3000, 3)),
        "floor": np.column_stack([generator.uniform(-1, 1, (3000, 2)), 0.002 * generator.normal(size=3000)]),
        "few": np.column_stack([np.full(120, 2.0), generator.uniform(-1, 1, (120, 2))]),
    }[shape]
    with pytest.raises(InputError) as raised:
        captured(_cloud(points), up="z", canvas_size=(0.6, 0.6))
    assert "\n" not in str(raised.value)


def test_a_captured_column_is_a_bent_wall():
    generator = np.random.default_rng(12)
    angle, up = generator.uniform(-0.7, 0.7, 30_000), generator.uniform(0, 1.5, 30_000)
    radius = 1.5 + 0.001 * generator.normal(size=30_000)
    wall = captured(
        _cloud(np.column_stack([3.5 - radius * np.cos(angle), radius * np.sin(angle), up])),
        up="z",
        canvas_size=(0.8, 0.6),
    )
    u = np.linspace(-0.35, 0.35, 15)
    normals = _normals(wall.scene.chart, jnp.asarray(np.column_stack([u, np.full(15, 1.1)]), dtype=float))[0]
    turn = np.arctan2(-np.asarray(normals)[:, 1], -np.asarray(normals)[:, 0])
    # Over a chord of 0.7 m a column of 1.5 m radius turns by 2 asin(0.35 / 1.5), less where it stands askew.
    assert np.ptp(turn) == pytest.approx(2 * np.arcsin(0.35 / 1.5), rel=0.1)
    assert wall.report.residual_rms == pytest.approx(0.001, rel=0.2)


@pytest.fixture(scope="module")
def real_wall(shared_data):
    """Walls of real captures by name, each baked once."""
    walls = {}

    def find(name):
        if name not in walls:
            cloud = read_cloud(shared_data / "clouds" / f"{name}.pcd")
            walls[name] = captured(cloud, up="-y", canvas_size=(0.6, 0.6))
        return walls[name]

    return find


@pytest.mark.realdata
@pytest.mark.parametrize("name", REAL_WALLS)
def test_real_captures(real_wall, name):
    wall = real_wall(name)
    report = wall.report
    assert report.residual_rms <= report.noise_rms <= REAL_WALLS[name]
    assert report.clearance > 0.01
    # On the canvas the normals change by well under a degree over the width of a brush.
    u, v = np.meshgrid(np.linspace(-0.3, 0.3, 31), np.linspace(-0.3, 0.3, 31))
    uv = jnp.asarray(np.stack([u, v + 1.1], axis=-1).reshape(-1, 2), dtype=float)
    normals, known = _normals(wall.scene.chart, uv)
    change = np.rad2deg(np.linalg.norm(np.diff(np.asarray(normals).reshape(31, 31, 3), axis=1), axis=-1))
    assert np.sqrt(np.mean(change**2)) < 0.7
    assert np.all(known)


@pytest.mark.realdata
def test_the_lamp_and_the_picture_are_not_painted(real_wall):
    wall = real_wall("o3d_fragment")
    # Where they are in the capture, of which the data's README tells.
    lamp, picture, plaster = _to_map(wall, np.array([[1.5, 1.95, 0.8], [3.0, 1.7, 1.25], [2.2, 1.7, 1.3]]))
    canvas = np.asarray(wall.canvas.center)
    assert abs(plaster[1] - canvas[1]) < 0.3
    for thing in (lamp, picture):
        assert abs(thing[1] - canvas[1]) > 0.3 + wall.report.clearance
    assert lamp[0] < -0.3
