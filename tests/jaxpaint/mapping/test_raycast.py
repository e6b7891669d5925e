import hypothesis
import hypothesis.strategies as st
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from jaxpaint.mapping import Cause, Mapped, MappingSettings, cast, count_by_cause

RAYS = 128


def wave():
    x = np.linspace(-0.5, 0.5, RAYS)
    return np.stack([0.8 * x, 0.15 * np.sin(9 * x)], -1)


def row(width: float = 0.8) -> np.ndarray:
    return np.stack([np.linspace(-width / 2, width / 2, RAYS), np.full(RAYS, 0.013)], -1)


def hits(mapped: Mapped) -> np.ndarray:
    return mapped.status == Cause.HIT


def lean(mapped: Mapped, normal: np.ndarray) -> np.ndarray:
    """Angle between the normals [deg]."""
    return np.degrees(np.arccos(np.clip(np.sum(mapped.normal.astype(float) * normal, -1), -1, 1)))


def correlated_noise(cloud: np.ndarray, sigma: float, seed: int) -> np.ndarray:
    """Noise along x that is smooth over about two spacings, as of a depth camera."""
    field = gaussian_filter(np.random.default_rng(seed).standard_normal((200, 200)), 1.0)
    place = np.round(cloud[:, 1:] / 0.01).astype(int) + 100
    return cloud + np.stack(
        [sigma * field[place[:, 0], place[:, 1]] / field.std()] + [0 * cloud[:, 0]] * 2, -1
    )


@pytest.mark.parametrize("name", ["flat", "corner", "column"])
def test_without_noise_hits_are_on_the_surface_and_square_to_it(mapping, walls, name):
    wall = getattr(walls, name)()
    mapped = mapping(wall.cloud)
    hit = hits(mapped)
    assert hit.mean() > 0.9
    assert np.abs(wall.height(mapped.p_map.astype(float)))[hit].max() < 1e-3
    assert lean(mapped, wall.normal(mapped.p_map))[hit].max() < 1.0


def test_hits_lie_on_their_rays(mapping, walls, at):
    canvas = at(-0.3, 0.2)
    mapped = mapping(walls.column().cloud, canvas)
    across, depth = canvas.to_canvas(jnp.asarray(mapped.p_map))
    assert hits(mapped).mean() > 0.9
    np.testing.assert_allclose(across, wave(), atol=1e-6)
    assert np.all(depth[hits(mapped)] > 0.25)


def test_noise_is_averaged(mapping, walls):
    wall = walls.flat()
    mapped = mapping(correlated_noise(wall.cloud, 0.0015, seed=3))
    assert hits(mapped).all()
    assert np.sqrt(np.mean(wall.height(mapped.p_map) ** 2)) < 1.25e-3
    assert lean(mapped, wall.normal(mapped.p_map)).mean() < 2.0


def test_a_canvas_may_lie_on_the_surface(mapping, walls, at):
    cloud = correlated_noise(walls.flat().cloud, 0.0015, seed=3)
    before, on = mapping(cloud), mapping(cloud, at(0.0))
    assert hits(on).all()
    np.testing.assert_allclose(on.p_map, before.p_map, atol=1e-5)
    beyond = mapping(cloud, at(0.2))
    assert np.all(beyond.status == Cause.MISS)


def test_a_hole_is_not_bridged(mapping, walls):
    cloud = walls.flat().cloud
    cloud = cloud[np.hypot(cloud[:, 1], cloud[:, 2]) > 0.05]
    mapped = mapping(cloud, uv=row())
    inside = np.abs(row()[:, 0]) < 0.05 - 0.015
    outside = np.abs(row()[:, 0]) > 0.05 + 0.015
    assert inside.sum() > 5
    assert np.all(mapped.status[inside] == Cause.MISS)
    assert np.all(hits(mapped)[outside])


def test_off_the_wall_is_a_miss(mapping, walls):
    mapped = mapping(walls.flat().cloud, uv=row(1.3))
    off = np.abs(row(1.3)[:, 0]) > 0.51
    assert np.all(mapped.status[off] == Cause.MISS)
    assert hits(mapped)[~off].mean() > 0.95


def test_the_first_surface_wins(mapping, walls):
    """A plate before the wall: rays meet the plate or the wall, and nothing in between."""
    cloud = walls.flat().cloud
    plate = cloud[(np.abs(cloud[:, 1]) < 0.101) & (np.abs(cloud[:, 2]) < 0.101)] - [0.1, 0, 0]
    mapped = mapping(np.concatenate([cloud, plate]), uv=row())
    x, u = mapped.p_map[:, 0], row()[:, 0]
    hit = hits(mapped)
    assert np.all(np.minimum(np.abs(x), np.abs(x + 0.1))[hit] < 1e-4)
    assert np.all(hit[np.abs(u) < 0.08]) and np.all(x[np.abs(u) < 0.08] < -0.05)
    assert np.all(hit[np.abs(u) > 0.13]) and np.all(x[np.abs(u) > 0.13] > -0.05)
    # a wide brush beside the plate would touch it
    wide = mapping(np.concatenate([cloud, plate]), uv=row(), settings=MappingSettings(brush_radius=0.03))
    assert np.all(wide.status[(np.abs(u) > 0.12) & (np.abs(u) < 0.135)] == Cause.CLEARANCE)


def test_single_flying_points_do_not_count(mapping, walls):
    rng = np.random.default_rng(0)
    cloud = walls.flat().cloud
    flying = cloud[:: len(cloud) // 60] - rng.uniform(0.03, 0.2, (len(cloud[:: len(cloud) // 60]), 1)) * [
        1,
        0,
        0,
    ]
    mapped = mapping(np.concatenate([cloud, flying]))
    assert hits(mapped).all()
    assert np.abs(mapped.p_map[:, 0]).max() < 1e-3


def test_points_without_a_surface_are_no_hit(mapping):
    """A fog of points, each at its own depth."""
    u, v = np.meshgrid(np.arange(-0.45, 0.45, 0.01), np.arange(-0.2, 0.2, 0.01))
    depth = 0.2 + 2.0 * np.random.default_rng(1).random(u.size)
    mapped = mapping(np.stack([depth, -u.ravel(), v.ravel()], -1))
    assert (mapped.status == Cause.FRONT).mean() > 0.9
    assert not hits(mapped).any()


@pytest.mark.parametrize(("turn", "cause"), [(60, Cause.HIT), (72, Cause.HIT), (79, Cause.STEEP)])
def test_steep_surfaces_are_refused(mapping, walls, at, turn, cause):
    wall = walls.flat(turn=np.radians(turn))
    uv = row(0.8 * np.cos(np.radians(turn)))
    mapped = mapping(wall.cloud, at(-0.8), uv)
    assert (mapped.status == cause).mean() > 0.95
    if cause == Cause.HIT:
        assert np.abs(wall.height(mapped.p_map)).max() < 1e-4


@pytest.mark.parametrize(("radius", "strip"), [(0.010, 0.020), (0.020, 0.030)])
def test_a_strip_is_left_out_at_an_inside_corner(mapping, walls, radius, strip):
    settings = MappingSettings(brush_radius=radius)
    uv = row(0.2)
    mapped = mapping(walls.corner().cloud, uv=uv, settings=settings)
    from_edge = np.abs(uv[:, 0]) * np.sqrt(2)
    assert np.all(hits(mapped)[from_edge > strip + 0.003])
    assert not hits(mapped)[from_edge < strip - 0.005].any()
    assert (mapped.status == Cause.CLEARANCE)[from_edge < strip - 0.005].mean() > 0.5


def test_an_outside_edge_is_sharp(mapping, walls):
    wall = walls.corner(sign=-1.0)
    uv = row(0.2)
    mapped = mapping(wall.cloud, uv=uv)
    from_edge = np.abs(uv[:, 0]) * np.sqrt(2)
    assert np.all(mapped.status[from_edge < 0.004] == Cause.SHARP)
    assert np.all(hits(mapped)[from_edge > 0.025])
    assert lean(mapped, wall.normal(mapped.p_map))[from_edge > 0.025].max() < 1.0


def test_a_world_alone_and_among_others_is_the_same(mapping, walls, at):
    clouds = [walls.flat().cloud, walls.column().cloud]
    alone = [mapping(cloud) for cloud in clouds]
    room = np.full((2, 8192, 3), np.nan)
    for k, cloud in enumerate(clouds):
        room[k, : len(cloud)] = cloud
    many = jax.jit(jax.vmap(cast, in_axes=(None, None, 0, 0)))(
        jnp.asarray(wave()), at(-0.3), jnp.asarray(room), jnp.isfinite(jnp.asarray(room)).all(-1)
    )
    for k, one in enumerate(alone):
        np.testing.assert_allclose(many.p_map[k], one.p_map, atol=1e-5)
        np.testing.assert_allclose(many.normal[k], one.normal, atol=1e-4)
        np.testing.assert_array_equal(many.status[k], one.status)


def test_duplicates_change_nothing(mapping, walls):
    """The same view merged twice is denser, but no other surface."""
    cloud = walls.column(spacing=0.014).cloud
    once, twice = mapping(cloud), mapping(np.concatenate([cloud, cloud]))
    np.testing.assert_array_equal(hits(twice), hits(once))
    np.testing.assert_allclose(twice.p_map[hits(once)], once.p_map[hits(once)], atol=5e-4)


def test_missing_and_invalid_points_are_left_out(walls, mapping):
    cloud = walls.flat().cloud
    wrong = cloud - [0.1, 0, 0]
    points = np.full((8192, 3), np.nan)
    points[: len(cloud)] = cloud
    points[len(cloud) : len(cloud) + 1000] = wrong[:1000]
    # half of the wrong ones are marked, the others have one NaN
    points[len(cloud) + 500 : len(cloud) + 1000, 1] = np.nan
    valid = np.ones(8192, bool)
    valid[len(cloud) : len(cloud) + 500] = False
    mapped = mapping(points, valid=valid)
    np.testing.assert_allclose(mapped.p_map, mapping(cloud).p_map, atol=1e-6)


def test_an_empty_cloud_is_all_misses(mapping):
    mapped = mapping(np.zeros((0, 3)))
    assert np.all(mapped.status == Cause.MISS)
    assert np.all(np.isfinite(mapped.p_map)) and np.all(np.isfinite(mapped.normal))


def test_each_ray_is_counted_once(mapping, walls):
    mapped = mapping(walls.corner().cloud, uv=row(0.2))
    counts = np.asarray(count_by_cause(jnp.asarray(mapped.status)))
    assert counts.sum() == RAYS
    assert counts[Cause.HIT] == hits(mapped).sum() and counts[Cause.CLEARANCE] > 0


def test_the_cosine_metric_is_too_narrow_near_the_canvas(mapping, walls, at):
    """S1's tolerance is an angle, so it needs distance to find points between which a ray passes."""
    cloud = walls.flat().cloud
    assert hits(mapping(cloud, at(-0.8), metric="cosine")).all()
    near = at(-0.05)
    assert hits(mapping(cloud, near, metric="cosine")).mean() < 0.2
    assert hits(mapping(cloud, near)).all()


@hypothesis.given(st.floats(-3.0, 3.0), st.floats(-2.0, 2.0), st.floats(-2.0, 2.0))
def test_turning_everything_turns_the_result(mapping, walls, at, yaw, x, y):
    wall = walls.column()
    turn = np.array([[np.cos(yaw), -np.sin(yaw), 0], [np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]])
    shift = np.array([x, y, 0.0])
    canvas = at(-0.3, yaw)
    canvas = type(canvas)(jnp.asarray(turn @ [-0.3, 0, 0] + shift, float), canvas.yaw, canvas.size)
    here, there = mapping(wall.cloud), mapping(wall.cloud @ turn.T + shift, canvas)
    hit = hits(here) & hits(there)
    assert hit.mean() > 0.95
    np.testing.assert_allclose(there.p_map[hit], (here.p_map @ turn.T + shift)[hit], atol=2e-4)
    np.testing.assert_allclose(there.normal[hit], (here.normal @ turn.T)[hit], atol=5e-3)
