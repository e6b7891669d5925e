import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxpaint.mapping import Cause, Mapped
from jaxpaint.mapping.runs import find_runs, linked, smooth_normals

NUMBER, STEP = 60, 0.004
LINK = jax.jit(linked)
FIND = jax.jit(find_runs, static_argnames="most")


def straight(status=None) -> Mapped:
    """A row of hits along y on the wall x = 0."""
    place = jnp.arange(NUMBER) * STEP
    point = jnp.stack([0 * place, -place, 0 * place + 1], -1)
    normal = jnp.tile(jnp.array([-1.0, 0.0, 0.0]), (NUMBER, 1))
    return Mapped(point, normal, jnp.zeros(NUMBER, jnp.int32) if status is None else jnp.asarray(status))


def runs_of(mapped, stroke=None, most=8, shortest=0.005):
    stroke = jnp.zeros(NUMBER, jnp.int32) if stroke is None else jnp.asarray(stroke)
    runs, status = FIND(mapped, stroke, LINK(mapped, stroke, 5.0, 0.35), shortest, most)
    ends = [(int(a), int(b)) for a, b, live in zip(runs.first, runs.last, runs.live, strict=True) if live]
    return ends, np.asarray(status), runs


def test_one_stroke_is_one_run():
    ends, status, runs = runs_of(straight())
    assert ends == [(0, NUMBER - 1)]
    assert np.all(status == Cause.HIT) and int(runs.stroke[0]) == 0


@pytest.mark.parametrize("cause", [Cause.MISS, Cause.CLEARANCE, Cause.STEEP])
def test_what_is_no_hit_splits(cause):
    ends, status, _ = runs_of(straight(np.where(np.arange(NUMBER) == 20, cause, 0)))
    assert ends == [(0, 19), (21, NUMBER - 1)]
    assert status[20] == cause


def test_strokes_are_never_joined():
    ends, _, runs = runs_of(straight(), stroke=(np.arange(NUMBER) >= 30) * 3)
    assert ends == [(0, 29), (30, NUMBER - 1)]
    np.testing.assert_array_equal(runs.stroke[:3], [0, 3, -1])


@pytest.mark.parametrize(("steps", "split"), [(4.0, False), (6.0, True)])
def test_a_jump_splits(steps, split):
    mapped = straight()
    moved = mapped.p_map.at[30:, 1].add(-(steps - 1) * STEP)
    ends, _, _ = runs_of(Mapped(moved, mapped.normal, mapped.status))
    assert (len(ends) == 2) == split


def test_an_edge_splits():
    mapped = straight()
    bent = mapped.normal.at[30:].set(jnp.array([-0.7071, 0.7071, 0.0]))
    assert runs_of(Mapped(mapped.p_map, bent, mapped.status))[0] == [(0, 29), (30, NUMBER - 1)]


def test_short_runs_are_dropped_and_counted():
    status = np.zeros(NUMBER, int)
    status[[10, 12]] = Cause.MISS
    ends, status, _ = runs_of(straight(status))
    assert ends == [(0, 9), (13, NUMBER - 1)]
    assert status[11] == Cause.SHORT and np.sum(status == Cause.SHORT) == 1


def test_a_whole_stroke_is_painted_however_short():
    """Two points 4 mm apart; but not one that was cut, nor one that has no length at all."""
    stroke = np.repeat([0, 1, 2, 3, 4], [20, 2, 3, 2, 33])
    status = np.where(np.arange(NUMBER) == 22, Cause.MISS, 0)
    mapped = straight(status)
    still = mapped.p_map.at[26].set(mapped.p_map[25])
    ends, status, _ = runs_of(Mapped(still, mapped.normal, mapped.status), stroke)
    assert ends == [(0, 19), (20, 21), (27, NUMBER - 1)]
    np.testing.assert_array_equal(status[20:27], [0, 0, Cause.MISS, *[Cause.SHORT] * 4])


def test_runs_without_room_are_reported():
    ends, status, _ = runs_of(straight(), stroke=np.arange(NUMBER) // 10, most=4)
    assert ends == [(0, 9), (10, 19), (20, 29), (30, 39)]
    assert np.all(status[40:] == Cause.OVERFLOW) and np.all(status[:40] == Cause.HIT)


def test_nothing_mapped_is_no_run():
    ends, status, runs = runs_of(straight(np.full(NUMBER, Cause.MISS)))
    assert ends == [] and not runs.live.any() and np.all(status == Cause.MISS)


def arc(noise: float, radius: float = 0.3) -> tuple[Mapped, np.ndarray]:
    angle = np.arange(NUMBER) * STEP / radius
    true = np.stack([-np.cos(angle), np.sin(angle), 0 * angle], -1)
    normal = true + noise * np.random.default_rng(0).standard_normal(true.shape)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    return Mapped(jnp.asarray(radius * true), jnp.asarray(normal), jnp.zeros(NUMBER, jnp.int32)), true


def lean(mapped, true):
    return np.degrees(np.arccos(np.clip(np.sum(np.asarray(mapped.normal, float) * true, -1), -1, 1)))


def test_smoothing_keeps_a_steady_turn_up_to_the_ends():
    mapped, true = arc(0.0)
    smooth = smooth_normals(mapped, jnp.arange(NUMBER) > 0, 0.03)
    assert lean(smooth, true).max() < 0.5
    np.testing.assert_allclose(np.linalg.norm(smooth.normal, axis=-1), 1, rtol=1e-5)


def test_smoothing_steadies_the_brush():
    mapped, true = arc(0.05)
    smooth = smooth_normals(mapped, jnp.arange(NUMBER) > 0, 0.03)
    assert lean(smooth, true).mean() < 0.4 * lean(mapped, true).mean()


def test_smoothing_stops_at_splits():
    mapped = straight()
    bent = mapped.normal.at[30:].set(jnp.array([-0.7071068, 0.7071068, 0.0]))
    link = (jnp.arange(NUMBER) > 0) & (jnp.arange(NUMBER) != 30)
    smooth = smooth_normals(Mapped(mapped.p_map, bent, mapped.status), link, 0.03)
    np.testing.assert_allclose(smooth.normal, bent, atol=1e-5)
