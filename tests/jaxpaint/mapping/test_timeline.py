from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.mapping import (
    Cause,
    Mapped,
    MoveSettings,
    PathSettings,
    colour_at,
    duration,
    plan_path,
    sample,
)

STROKE, STROKES, RUNS, STEPS, DT = 40, 3, 4, 2048, 0.02
NUMBER = STROKE * STROKES
U_AXIS = np.array([0.0, -1.0, 0.0])
RADIUS = 0.5


def flat(u, v):
    zero = 0 * u
    return np.stack([zero, -u, 1 + v], -1), np.stack([zero - 1, zero, zero], -1)


def column(u, v):
    angle = u / RADIUS
    out = np.stack([-np.cos(angle), -np.sin(angle), 0 * u], -1)
    return RADIUS * out + [RADIUS, 0, 1] + v[:, None] * [0, 0, 1], out


def corner(u, v):
    q, side = np.sqrt(0.5), np.where(u < 0, 1.0, -1.0)
    out = np.stack([-q + 0 * u, -q * side, 0 * u], -1)
    return np.stack([-np.abs(u) * q, -u * q, 1 + v], -1), out


SURFACES = {"flat": flat, "column": column, "corner": corner}


def height(kind: str, p: np.ndarray) -> np.ndarray:
    """Distance of points from the surface, on the robot's side."""
    if kind == "flat":
        return -p[:, 0]
    if kind == "column":
        return np.hypot(p[:, 0] - RADIUS, p[:, 1]) - RADIUS
    return -np.sqrt(0.5) * (p[:, 0] + np.abs(p[:, 1]))


def drawing(kind: str) -> tuple[Mapped, jax.Array]:
    """A short wavy stroke at the left, one at the right, and one at the left again."""
    x = np.linspace(0, 0.15, STROKE)
    u = np.concatenate([x - 0.55, 0.4 + x, x - 0.55])
    v = np.concatenate([0.02 * np.sin(40 * x), 0.1 + 0.5 * x, 0.1 - 4 * (x - 0.05) ** 2])
    point, normal = SURFACES[kind](u, v)
    status = jnp.zeros(NUMBER, jnp.int32)
    return Mapped(jnp.asarray(point), jnp.asarray(normal), status), jnp.arange(NUMBER) // STROKE


@jax.jit
def plan(mapped, stroke, settings, obstacles):
    return plan_path(mapped, stroke, jnp.asarray(U_AXIS), settings, obstacles=obstacles, max_runs=RUNS)


@jax.jit
def plan_in_colours(mapped, stroke, settings, colour):
    return plan_path(mapped, stroke, jnp.asarray(U_AXIS), settings, colour=colour, max_runs=RUNS)


SAMPLE = jax.jit(lambda path: sample(path, DT, STEPS))
SPEED = 0.05


@pytest.fixture(autouse=True)
def doubles(x64):
    """One precision, so that one program serves all tests here."""


def walked(kind: str, mapped=None, stroke=None, obstacles=None):
    whole, strokes = drawing(kind)
    obstacles = jnp.full((9, 3), jnp.nan) if obstacles is None else obstacles
    settings = PathSettings(speed=SPEED)
    path = plan(mapped or whole, strokes if stroke is None else stroke, settings, obstacles)
    return path, jax.tree.map(np.asarray, SAMPLE(path))


@pytest.fixture(params=list(SURFACES))
def kind(request) -> str:
    return request.param


def test_velocities_are_the_derivatives_of_the_poses(kind):
    path, walk = walked(kind)
    assert walk.position.dtype == np.float64
    velocity = (walk.position[2:] - walk.position[:-2]) / (2 * DT)
    np.testing.assert_allclose(walk.velocity[1:-1], velocity, atol=2e-3)
    turn = np.einsum("tij,tkj->tik", (walk.rotation[2:] - walk.rotation[:-2]) / (2 * DT), walk.rotation[1:-1])
    spin = np.stack([turn[:, 2, 1], turn[:, 0, 2], turn[:, 1, 0]], -1)
    np.testing.assert_allclose(walk.angular_velocity[1:-1], spin, atol=5e-3)
    # the same to rounding, where the step is small
    short = sample(path, 1e-5, 3)
    steep = (np.asarray(short.position[2]) - np.asarray(short.position[0])) / 2e-5
    np.testing.assert_allclose(short.velocity[1], steep, atol=1e-7)


def test_rotations_are_brush_frames(kind):
    _, walk = walked(kind)
    x, y, z = np.moveaxis(walk.rotation, -1, 0)
    np.testing.assert_allclose(
        np.einsum("tij,tik->tjk", walk.rotation, walk.rotation), np.tile(np.eye(3), (STEPS, 1, 1)), atol=1e-12
    )
    np.testing.assert_allclose(np.cross(x, y), z, atol=1e-12)
    assert np.all(x @ U_AXIS > 0.4) and np.all(z[:, 0] > 0.4)


def test_the_pen_is_down_on_the_surface_at_brush_speed(kind):
    path, walk = walked(kind)
    down = walk.pen == 1
    assert np.abs(height(kind, walk.position[down])).max() < 1e-4
    speed = np.linalg.norm(walk.velocity[down], axis=1)
    assert np.median(speed) == pytest.approx(SPEED, rel=0.01)
    assert speed.max() < 1.02 * SPEED
    drawn = np.bincount(walk.run[down], minlength=STROKES) * DT * SPEED
    np.testing.assert_allclose(drawn.sum(), path.down, rtol=0.1)
    assert set(walk.run[down]) == {0, 1, 2}


def test_moves_keep_clear_of_the_surface_and_within_limits(kind):
    _, walk = walked(kind)
    limits = MoveSettings()
    up = walk.pen == 0
    speed = np.linalg.norm(walk.velocity, axis=1)
    gain = np.linalg.norm(np.diff(walk.velocity, axis=0), axis=1) / DT
    assert speed.max() < 1.05 * float(limits.speed)
    assert gain.max() < 1.15 * float(limits.acceleration)
    assert np.linalg.norm(walk.angular_velocity, axis=1).max() < 1.05 * float(limits.turn_rate)
    # the acceleration itself has no jumps with the pen up: it builds up in a tenth of a second
    jerk = np.linalg.norm(np.diff(walk.velocity, 2, axis=0), axis=1) / DT**2
    assert jerk[up[1:-1]].max() < 1.15 * float(limits.acceleration) / 0.1
    # further than a little from where it touched, the pen is well clear
    ends = walk.position[np.flatnonzero(np.diff(walk.pen))]
    away = up & (np.linalg.norm(walk.position[:, None] - ends, axis=-1).min(1) > 0.03)
    assert away.sum() > 100
    assert height(kind, walk.position[away]).min() > 0.02


def test_the_path_starts_and_ends_lifted_and_still(kind):
    path, walk = walked(kind)
    last = int(float(duration(path)) / DT) + 2
    assert last < STEPS and walk.live[: last - 2].all() and not walk.live[last:].any()
    for k in (0, last):
        assert height(kind, walk.position[k : k + 1])[0] == pytest.approx(0.05, abs=1e-3)
        np.testing.assert_allclose(walk.velocity[k], 0, atol=1e-9)
    np.testing.assert_array_equal(walk.position[last:], np.tile(walk.position[last], (STEPS - last, 1)))


def test_a_dropped_point_splits_the_run(kind):
    mapped, _ = drawing(kind)
    path, walk = walked(kind, Mapped(mapped.p_map, mapped.normal, mapped.status.at[60].set(Cause.MISS)))
    assert int(path.runs.live.sum()) == 4
    near = np.linalg.norm(walk.position - np.asarray(mapped.p_map[60]), axis=1) < 0.002
    assert not np.any(near & (walk.pen == 1))


def test_runs_beyond_the_room_are_reported():
    path, walk = walked("flat", stroke=jnp.arange(NUMBER) // 20)
    assert np.sum(np.asarray(path.status) == Cause.OVERFLOW) == 40
    assert set(walk.run[walk.pen == 1]) == {0, 1, 2, 3}


def test_a_dab_is_the_brush_pressed_down_and_lifted(kind):
    """Two points 2 mm apart between two strokes: some tenths of a second on the spot."""
    x = np.linspace(0, 0.15, 59)
    u, v = np.concatenate([x - 0.55, [-0.201, -0.199], 0.4 + x]), np.repeat([0.0, 0.1, 0.0], [59, 2, 59])
    point, normal = SURFACES[kind](u, v)
    mapped = Mapped(jnp.asarray(point), jnp.asarray(normal), jnp.zeros(NUMBER, jnp.int32))
    path, walk = walked(kind, mapped, jnp.asarray(np.repeat([0, 1, 2], [59, 2, 59])))
    assert int(path.runs.live.sum()) == 3 and not path.status.any()
    dab = (walk.run == 1) & (walk.pen == 1)
    assert 0.2 < dab.sum() * DT < 1.0
    np.testing.assert_allclose(walk.position[dab] - point[59:61].mean(axis=0), 0, atol=1.1e-3)
    assert height(kind, walk.position[walk.run == 1]).max() > 0.02


def test_nothing_to_paint_takes_no_time():
    mapped, _ = drawing("flat")
    path, walk = walked("flat", Mapped(mapped.p_map, mapped.normal, mapped.status + Cause.MISS))
    assert float(duration(path)) == 0 and not walk.live.any() and not walk.pen.any()
    assert np.isfinite(walk.position).all() and not walk.velocity.any()


def test_an_obstacle_between_strokes_is_crossed_above():
    rail = jnp.stack([jnp.full(9, -0.15), jnp.zeros(9), jnp.linspace(0.8, 1.3, 9)], -1).at[0].set(jnp.nan)
    _, walk = walked("flat", obstacles=rail)
    crossing = np.abs(walk.position[:, 1]) < 0.03
    assert crossing.any() and walk.position[crossing, 0].max() < -0.17
    assert np.abs(walk.position[:, 0]).max() < 0.35


def test_another_colour_is_fetched_far_from_the_wall():
    """Strokes of colours 0, 1, 1: one change, at full height, standing still while it takes."""
    mapped, stroke = drawing("flat")
    settings = PathSettings(speed=SPEED, move=MoveSettings(change_height=0.2, change_time=3.0))
    path = plan_in_colours(mapped, stroke, settings, jnp.array([0, 1, 1]))
    plain = plan_in_colours(mapped, stroke, settings, jnp.array([0, 0, 0]))
    walk = jax.tree.map(np.asarray, SAMPLE(path))
    away = height("flat", walk.position)
    still = (np.linalg.norm(walk.velocity, axis=1) < 1e-9) & (walk.pen == 0) & walk.live
    assert away.max() == pytest.approx(0.2, abs=1e-6)
    assert np.sum(still & (away > 0.19)) * DT == pytest.approx(3.0, abs=0.1)
    assert 3.0 < float(duration(path) - duration(plain)) < 7.0
    np.testing.assert_array_equal(path.runs.colour[:3], [0, 1, 1])
    assert [set(walk.colour[(walk.run == k) & (walk.pen == 1)]) for k in range(3)] == [{0}, {1}, {1}]
    np.testing.assert_array_equal(colour_at(path, jnp.arange(STEPS) * DT)[walk.live], walk.colour[walk.live])
    change = np.flatnonzero(np.diff(walk.colour[walk.live]))
    assert len(change) == 1
    assert (away[change[0] : change[0] + 2] > 0.19).all(), "the old tool is in hand until the brush is up"
    # what the pen does does not jump
    jerk = np.linalg.norm(np.diff(walk.velocity, 2, axis=0), axis=1) / DT**2
    assert jerk[walk.pen[1:-1] == 0].max() < 1.15 * float(settings.move.acceleration) / 0.1


def test_a_hop_to_a_neighbour_stays_low_and_is_quick():
    x = np.linspace(0, 0.15, STROKE)
    u, v = np.concatenate([x, x[::-1], x]), np.repeat([0.0, 0.015, 0.03], STROKE)
    point, normal = flat(u, v)
    mapped = Mapped(jnp.asarray(point), jnp.asarray(normal), jnp.zeros(NUMBER, jnp.int32))
    path, walk = walked("flat", mapped)
    begin, draw = np.asarray(path.begins)[1], np.asarray(path.draws)[1]
    assert draw - begin < 1.2
    hop = np.flatnonzero((np.arange(STEPS) * DT > begin) & (np.arange(STEPS) * DT < draw))
    top = height("flat", walk.position[hop]).max()
    assert 0.025 < top < 0.045


def test_many_points_and_runs_are_planned_as_few_are():
    """What is looked at is bounded, and a wall of strokes is crossed clear of what stands out of it."""
    rows, across = 60, np.linspace(0, 0.6, 100)
    u, v = np.tile(across, rows), np.repeat(np.arange(rows) * 0.004, 100)
    point, normal = flat(u, v)
    mapped = Mapped(jnp.asarray(point), jnp.asarray(normal), jnp.zeros(u.size, jnp.int32))
    rail = jnp.stack([jnp.full(200, -0.1), jnp.full(200, -0.3), jnp.linspace(0.9, 1.4, 200)], -1)
    many = jax.jit(lambda m, s: plan_path(m, s, jnp.asarray(U_AXIS), obstacles=rail, max_runs=80))
    path = many(mapped, jnp.asarray(np.repeat(np.arange(rows), 100)))
    assert int(path.runs.live.sum()) == rows
    # each move goes back over the rail
    assert np.linalg.norm(np.asarray(path.moves.bump)[1:rows], axis=1).min() > 0.08


@pytest.mark.slow
def test_gradients_agree_with_differences():
    mapped, stroke = drawing("column")
    weight = jnp.asarray(np.random.default_rng(1).standard_normal((64, 3)))

    @jax.jit
    @partial(jax.value_and_grad, argnums=(0, 1))
    def value(p_map, speed):
        path = plan_path(
            Mapped(p_map, mapped.normal, mapped.status),
            stroke,
            jnp.asarray(U_AXIS),
            PathSettings(speed=speed),
            max_runs=RUNS,
        )
        walk = sample(path, duration(path) / 70.3, 64)
        return jnp.sum(weight * (walk.position + walk.velocity)) + duration(path)

    speed = jnp.asarray(0.04)
    _, slopes = value(mapped.p_map, speed)
    assert all(np.isfinite(slope).all() for slope in slopes)
    change = 1e-3 * np.random.default_rng(2).standard_normal((NUMBER, 3))
    for shift, faster in ((change, 0.0), (0 * change, 1.0)):
        eps = 1e-5
        ahead, behind = (value(mapped.p_map + k * shift, speed + k * faster)[0] for k in (eps, -eps))
        wanted = (ahead - behind) / (2 * eps)
        found = jnp.sum(slopes[0] * shift) + slopes[1] * faster
        assert float(found) == pytest.approx(float(wanted), rel=1e-4)
