"""A mesh as the wall: true to it within a millimetre, holes open, arc length, canvases in reach."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import trimesh

from sims.scenes import canvas_for, mesh_wall
from sims.scenes.arc_length import ArcScale

RADIUS, HALF_TURN = 1.2, 1.1
HOLE = (0.35, 1.2, 0.12)
REAL = {
    "noether_raw_mesh.ply": {"up": "y"},
    "noether_wavy_mesh_with_hole.ply": {"up": "y", "scale": 0.2},
    "trimesh_cylinder.stl": {},
    "trimesh_tube.obj": {"scale": 0.5},
    "trimesh_wallhole.obj": {"up": "z", "scale": 0.25},
}


def _sheet(depth, across, up, hole=None, pitch=0.02):
    """An open sheet over (u, v), its middle at u = 0, as a robot at x < 0 sees it."""
    u, v = np.meshgrid(
        np.arange(-across, across + 1e-9, pitch), np.arange(0, up + 1e-9, pitch), indexing="ij"
    )
    corner = np.arange(u.size).reshape(u.shape)
    a, b, c, d = (corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:])
    faces = np.concatenate([np.stack(x, axis=-1).reshape(-1, 3) for x in ((a, b, c), (a, c, d))])
    points = np.column_stack([depth(u, v).ravel(), -u.ravel(), v.ravel()])
    if hole is not None:
        middle = points[faces].mean(axis=1)
        faces = faces[np.hypot(-middle[:, 1] - hole[0], middle[:, 2] - hole[1]) > hole[2]]
    return trimesh.Trimesh(points, faces, process=False)


@pytest.fixture(scope="module")
def walls(tmp_path_factory):
    """Walls of our own making: a bent sheet with a hole, and a closed column that stands elsewhere."""
    folder = tmp_path_factory.mktemp("meshes")
    bent = _sheet(lambda u, v: 0.05 * np.cos(2 * u) * np.sin(1.5 * v), 0.9, 2.0, HOLE)
    column = trimesh.creation.cylinder(RADIUS, 2.4, sections=180)
    bent.export(folder / "bent.ply")
    column.apply_translation([5, 3, 1]).export(folder / "column.stl")
    return {
        "bent": (mesh_wall(folder / "bent.ply", up="z"), bent),
        "column": (mesh_wall(folder / "column.stl"), column),
    }


@jax.jit
def _cast(scene, origins, directions):
    return jax.vmap(scene.raycast)(origins, directions)


@jax.jit
def _to_uv(chart, points):
    uv, height = jax.vmap(chart.to_uv)(points)
    return uv, height, jax.vmap(chart.on_surface)(uv), jax.vmap(chart.point)(uv)


def _in_map(wall, mesh):
    transform = wall.report.T_map_mesh
    return (mesh.vertices @ transform[:3, :3].T + transform[:3, 3])[mesh.faces]


def _first_hit(corners, origin, direction):
    """Distance to the nearest triangle from either side, by Moller and Trumbore, inf where none is."""
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    across = np.cross(direction, second)
    turn = np.sum(first * across, axis=1)
    safe = np.where(np.abs(turn) > 1e-14, turn, 1.0)
    start = origin - corners[:, 0]
    u = np.sum(start * across, axis=1) / safe
    up = np.cross(start, first)
    v, t = up @ direction / safe, np.sum(second * up, axis=1) / safe
    met = (np.abs(turn) > 1e-14) & (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0)
    return float(np.min(np.where(met, t, np.inf)))


@pytest.mark.parametrize("name", ["bent", "column"])
def test_rays_meet_the_mesh_itself(walls, name):
    wall, mesh = walls[name]
    corners = _in_map(wall, mesh)
    generator = np.random.default_rng(3)
    origins = generator.uniform([-1.5, -0.6, 0.6], [-0.8, 0.6, 1.8], (150, 3))
    targets = generator.uniform([0.0, -0.6, 0.4], [0.05, 0.6, 1.7], (150, 3))
    along = (targets - origins) / np.linalg.norm(targets - origins, axis=1, keepdims=True)
    hits = _cast(wall.scene, jnp.asarray(origins, float), jnp.asarray(along, float))
    truth = np.array([_first_hit(corners, *ray) for ray in zip(origins, along, strict=True)])
    # Only rays within a cell of a rim may disagree on whether there is a wall.
    solid = np.isfinite(truth)
    agree = np.asarray(hits.valid) == solid
    floor = np.asarray(hits.normal[:, 2]) > 0.9
    assert np.mean(agree | floor) > 0.97
    met = np.asarray(hits.valid) & solid & ~floor
    assert met.sum() > 80
    error = np.abs(np.asarray(hits.distance)[met] - truth[met])
    assert np.percentile(error, 95) < 1e-3 and error.max() < 3e-3


@pytest.mark.parametrize("name", ["bent", "column"])
def test_the_surface_is_the_mesh_within_a_millimetre(walls, name):
    """Points of the mesh itself, drawn from its faces, lie on the chart's surface."""
    wall, mesh = walls[name]
    points = trimesh.sample.sample_surface(
        trimesh.Trimesh(
            _in_map(wall, mesh).reshape(-1, 3), np.arange(3 * len(mesh.faces)).reshape(-1, 3), process=False
        ),
        4000,
        seed=1,
    )[0]
    points = points[(points[:, 0] < 0.5) & (points[:, 2] > 0.1) & (points[:, 2] < 1.9)]
    _, height, on_surface, _ = _to_uv(wall.scene.chart, jnp.asarray(points, float))
    height = np.abs(np.asarray(height))[np.asarray(on_surface)]
    assert np.mean(on_surface) > 0.9
    assert np.sqrt(np.mean(height**2)) < 0.5e-3 and np.percentile(height, 95) < 1e-3
    assert wall.report.residual_p95 < 1e-3 and "NOT" not in "\n".join(wall.report.lines())


def test_a_hole_is_open(walls):
    wall, _ = walls["bent"]
    rim = wall.report.T_map_mesh @ np.array([0.0, -HOLE[0], HOLE[1], 1.0])
    start = jnp.tile(jnp.asarray([[-1.0, rim[1], rim[2]]], float), (150, 1))
    hits = _cast(wall.scene, start, jnp.tile(jnp.asarray([[1.0, 0, 0]], float), (150, 1)))
    assert np.all(np.isinf(hits.distance))
    beside = _cast(
        wall.scene, start - jnp.asarray([0, 0, 1.3 * HOLE[2]]), jnp.tile(jnp.asarray([1.0, 0, 0]), (150, 1))
    )
    assert np.all(beside.valid)
    over = _to_uv(wall.scene.chart, start[:1])[2]
    assert not bool(over[0])
    assert len(wall.report.checks.holes) == 1
    assert wall.report.checks.holes[0] == pytest.approx(2 * HOLE[2], abs=0.05)


def test_a_closed_mesh_shows_the_side_that_faces_the_robot(walls):
    wall, _ = walls["column"]
    assert wall.report.up == "+z" and wall.report.up_guessed and wall.report.height == pytest.approx(0.0)
    middle = wall.report.T_map_mesh @ np.array([5.0, 3.0, 1.0, 1.0])
    np.testing.assert_allclose(middle[:3], [RADIUS, 0.0, 1.2], atol=0.01)
    # Free is what turns away by up to 40 degrees to either side, 1.6 m of its height; of the canvases up to
    # 1.2 m high in it, a square has the largest area.
    assert wall.report.free_area == pytest.approx(2 * RADIUS * np.sin(np.deg2rad(40)) * 1.6, rel=0.02)
    np.testing.assert_allclose(wall.canvas.size, 1.2, atol=0.011)
    low, high = (float(wall.canvas.center[2]) + sign * 0.5 * float(wall.canvas.size[1]) for sign in (-1, 1))
    assert 0.29 < low < high < 1.91


def test_u_is_arc_length_on_a_column(walls):
    wall = walls["column"][0]
    chart, (x, y) = wall.scene.chart, (wall.report.T_map_mesh @ np.array([5.0, 3.0, 1.0, 1.0]))[:2]
    angle = np.linspace(-HALF_TURN, HALF_TURN, 41)
    points = np.column_stack([x - RADIUS * np.cos(angle), y - RADIUS * np.sin(angle), np.full(41, 1.3)])
    uv, height, on_surface, back = _to_uv(chart, jnp.asarray(points, float))
    # The middle of the canvas, where u is 0, may lie beside the middle of the column by half a cell.
    np.testing.assert_allclose(uv[:, 0] - uv[20, 0], RADIUS * angle, atol=1e-3)
    assert abs(float(uv[20, 0])) < wall.report.cell
    np.testing.assert_allclose(np.ptp(uv[:, 1]), 0.0, atol=1e-3)
    np.testing.assert_allclose(back, points, atol=1e-3)
    assert np.all(on_surface) and np.all(np.abs(height) < 1e-3)


def test_there_and_back_and_gradients_on_the_arc(walls, x64):
    chart = jax.tree.map(
        lambda leaf: leaf.astype(float) if leaf.dtype != bool else leaf, walls["bent"][0].scene.chart
    )
    uv = jnp.asarray(np.random.default_rng(4).uniform([-0.5, 0.6], [0.2, 1.0], (50, 2)))

    def both(at):
        point = chart.point(at)
        return (
            chart.to_uv(point)[0],
            chart.normal(at),
            jax.grad(lambda p: chart.to_uv(p)[1])(point),
            jax.jacfwd(lambda x: chart.to_uv(chart.point(x))[0])(at),
        )

    back, normal, slope, identity = jax.jit(jax.vmap(both))(uv)
    np.testing.assert_allclose(back, uv, atol=1e-9)
    np.testing.assert_allclose(slope, normal, atol=1e-9)
    np.testing.assert_allclose(identity, np.tile(np.eye(2), (50, 1, 1)), atol=1e-6)


def test_a_straight_profile_keeps_its_lengths(x64):
    scale = ArcScale.along(np.full(50, 0.75), -0.2, 0.01)
    base = jnp.linspace(-0.5, 0.6, 23)
    arc = jax.jit(jax.vmap(scale.to_arc))(base)
    np.testing.assert_allclose(arc, 1.25 * base, atol=1e-12)
    np.testing.assert_allclose(jax.jit(jax.vmap(scale.to_base))(arc)[0], base, atol=1e-12)


@pytest.mark.realdata
@pytest.mark.parametrize("name", REAL)
def test_real_meshes(shared_data, name):
    wall = mesh_wall(shared_data / "meshes" / name, **REAL[name])
    report = wall.report
    assert report.residual_p95 < 2e-4 and report.residual_rms < 1e-4
    canvas = canvas_for(wall.scene, default=wall.canvas)
    assert float(canvas.center[0]) == pytest.approx(-0.05) and min(report.canvas_size) > 0.1
    # Against rays through the mesh itself, cast one by one.
    mesh = (
        trimesh.load_mesh(shared_data / "meshes" / name, process=False) if not name.endswith("obj") else None
    )
    if mesh is not None:
        mesh.vertices = mesh.vertices * report.scale
        corners = _in_map(wall, mesh)
        uv = np.random.default_rng(2).uniform(-0.5, 0.5, (150, 2)) * np.asarray(canvas.size)
        start = np.asarray(canvas.to_map(jnp.asarray(uv, float)), float)
        hits = _cast(wall.scene, jnp.asarray(start, float), jnp.tile(canvas.ray, (150, 1)))
        truth = np.array([_first_hit(corners, origin, np.array([1.0, 0, 0])) for origin in start])
        known = np.isfinite(truth) & np.asarray(hits.valid)
        assert known.mean() > 0.95
        assert np.percentile(np.abs(np.asarray(hits.distance)[known] - truth[known]), 95) < 1e-3


@pytest.mark.realdata
def test_the_slot_in_the_wall_is_seen_through(shared_data):
    wall = mesh_wall(
        shared_data / "meshes" / "trimesh_wallhole.obj", up="z", scale=0.25, canvas_size=(2.4, 1.2)
    )
    uv = jnp.asarray(np.random.default_rng(2).uniform(-0.5, 0.5, (150, 2)), float) * wall.canvas.size
    hits = _cast(wall.scene, wall.canvas.to_map(uv), jnp.tile(wall.canvas.ray, (150, 1)))
    share = float(np.mean(hits.valid))
    # The canvas lies over part of the slot, which is half a metre high and 1.25 m long.
    assert 0.7 < share < 0.97
