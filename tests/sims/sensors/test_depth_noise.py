"""Each effect of the depth noise by its statistics, with the others switched off."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from sims.parameters import scalar
from sims.sensors import RGBD, Camera, DepthNoise, observe, render
from sims.sensors.depth_noise import correlated_normal

CAMERA = Camera()
KEY = jax.random.key(0)
RENDER = jax.jit(render)
TRACES = []
FIELD = jax.jit(correlated_normal, static_argnums=0, static_argnames="dtype")


@jax.jit
def compiled_observe(*args, key):
    """`observe`, compiled once for all tests; notes each time it is traced."""
    TRACES.append(args)
    return observe(*args, key=key)


def frontal(depth, *, grey=0.5, incidence=1.0):
    """A wall across the optical axis."""
    shape = CAMERA.height, CAMERA.width
    return RGBD(
        depth=jnp.full(shape, depth, float),
        colour=jnp.full((*shape, 3), grey, float),
        incidence=jnp.full(shape, incidence, float),
        valid=jnp.ones(shape, bool),
    )


def only(**effects):
    return replace(DepthNoise.zero(), **{name: scalar(float(value)) for name, value in effects.items()})


def test_zero_changes_nothing(plane, R_map_camera):
    truth = RENDER(plane(), CAMERA, jnp.asarray([-1.0, 0, 1]), R_map_camera)
    seen = compiled_observe(truth, CAMERA, DepthNoise.zero(), key=KEY)
    np.testing.assert_array_equal(seen.valid, truth.valid)
    np.testing.assert_allclose(seen.depth, truth.depth, rtol=1e-6)


@pytest.mark.parametrize("depth", [0.5, 1.0, 2.0])
def test_depth_error_grows_with_the_square_of_depth(depth):
    seen = compiled_observe(frontal(depth), CAMERA, only(disparity_sigma=0.1), key=KEY)
    focal = 848 / 2 / np.tan(np.radians(87 / 2))
    expected = depth**2 * 0.1 / (focal * 0.05)
    assert np.std(seen.depth) == pytest.approx(expected, rel=0.03)


def test_error_is_correlated_over_the_given_length():
    keys = jax.random.split(KEY, 50)
    fields = [FIELD((60, 80), jnp.asarray(3.0), key=key, dtype=jnp.float32) for key in keys]
    samples = np.asarray(fields)
    np.testing.assert_allclose(samples.std(0).mean(), 1, atol=0.05)
    for lag in (3, 6):
        expected = np.exp(-0.5 * (lag / 3) ** 2)
        assert (samples[:, :, lag:] * samples[:, :, :-lag]).mean() == pytest.approx(expected, abs=0.05)
        assert (samples[:, lag:] * samples[:, :-lag]).mean() == pytest.approx(expected, abs=0.05)


def test_a_picture_is_correlated_over_pixels_of_the_full_sensor():
    """The picture has every fourth of them."""
    noise = only(disparity_sigma=0.1, correlation=8.0)
    error = np.asarray(
        [compiled_observe(frontal(1.0), CAMERA, noise, key=jax.random.key(k)).depth for k in range(4)]
    )
    error -= 1.0
    for lag in (1, 2, 3):
        expected = np.exp(-0.5 * (4 * lag / 8) ** 2)
        along = (error[:, :, lag:] * error[:, :, :-lag]).mean() / error.var()
        down = (error[:, lag:] * error[:, :-lag]).mean() / error.var()
        assert along == pytest.approx(expected, abs=0.05)
        assert down == pytest.approx(expected, abs=0.05)


def test_length_zero_is_white():
    samples = np.asarray(FIELD((100, 100), jnp.asarray(0.0), key=KEY, dtype=jnp.float32))
    assert samples.std() == pytest.approx(1, abs=0.03)
    assert abs((samples[:, 1:] * samples[:, :-1]).mean()) < 0.03


def test_disparity_comes_in_steps(plane, R_map_camera):
    turned = jnp.asarray([[0.0, 0.3, 1], [-1, 0, 0], [0, -1, 0]])
    truth = RENDER(plane(), CAMERA, jnp.asarray([-1.0, 0, 1]), turned)
    seen = compiled_observe(truth, CAMERA, only(quantum=1 / 32), key=KEY)
    product = float(CAMERA.fx) * 4 * 0.05
    steps = product / np.asarray(seen.depth)[np.asarray(seen.valid)] * 32
    assert np.abs(steps - np.rint(steps)).max() < 0.01
    assert len(np.unique(np.rint(steps))) > 50
    errors = np.abs(product / np.asarray(truth.depth) - product / np.asarray(seen.depth))
    assert 0.9 / 64 < errors[np.asarray(seen.valid)].max() < 1.02 / 64
    # As of even odds between two steps.
    assert np.sqrt(np.mean(errors[np.asarray(seen.valid)] ** 2)) == pytest.approx(
        1 / 32 / np.sqrt(12), rel=0.06
    )


def test_pixels_fly_at_depth_edges_and_nowhere_else(step_wall, R_map_camera):
    truth = RENDER(step_wall, CAMERA, jnp.asarray([-1.3, 0, 1]), R_map_camera)
    seen = compiled_observe(truth, CAMERA, only(flying=0.6), key=KEY)
    moved = np.asarray(jnp.abs(seen.depth - truth.depth) > 1e-4)
    # The two columns beside the step.
    columns = np.flatnonzero(moved.any(0))
    assert len(columns) == 2
    assert np.diff(columns) == 1
    assert moved[:, columns].mean() == pytest.approx(0.6, abs=0.1)
    between = np.asarray(seen.depth)[moved]
    assert (between > 1.0 - 1e-5).all()
    assert (between < 1.3 + 1e-5).all()
    assert np.std(1 / between) == pytest.approx((1 - 1 / 1.3) / np.sqrt(12), rel=0.2)


@pytest.mark.parametrize(("edge_step", "moves"), [(0.2, True), (0.35, False)])
def test_only_a_jump_beyond_the_limit_is_an_edge(step_wall, R_map_camera, edge_step, moves):
    truth = RENDER(step_wall, CAMERA, jnp.asarray([-1.3, 0, 1]), R_map_camera)
    seen = compiled_observe(truth, CAMERA, only(flying=1.0, edge_step=edge_step), key=KEY)
    assert bool((jnp.abs(seen.depth - truth.depth) > 1e-4).any()) == moves


def test_a_slanted_wall_is_no_edge(plane, R_map_camera):
    c, s = np.cos(0.8), np.sin(0.8)
    turned = jnp.asarray([[c, -s, 0.0], [s, c, 0], [0, 0, 1]]) @ R_map_camera
    truth = RENDER(plane(), CAMERA, jnp.asarray([-1.0, 0, 1]), turned)
    seen = compiled_observe(truth, CAMERA, only(flying=1.0), key=KEY)
    kept = np.asarray(seen.valid)
    np.testing.assert_allclose(np.asarray(seen.depth)[kept], np.asarray(truth.depth)[kept], rtol=1e-5)


# A width beyond the middle of a logistic transition 1 / (1 + e) is left.
LOGISTIC = 1 / (1 + np.e)


@pytest.mark.parametrize(
    ("degrees", "lost"),
    [
        (60, 0),
        (78.5 - np.degrees(0.03), LOGISTIC),
        (78.5, 0.5),
        (78.5 + np.degrees(0.03), 1 - LOGISTIC),
        (88, 1),
    ],
)
def test_grazing_pixels_are_lost(degrees, lost):
    noise = only(grazing=np.radians(78.5), grazing_width=0.03)
    seen = compiled_observe(frontal(1.0, incidence=np.cos(np.radians(degrees))), CAMERA, noise, key=KEY)
    assert 1 - np.mean(seen.valid) == pytest.approx(lost, abs=0.02)
    assert (np.asarray(seen.depth)[~np.asarray(seen.valid)] == 0).all()


@pytest.mark.parametrize(
    ("grey", "lost"), [(0.3, 0), (0.048, LOGISTIC), (0.04, 0.5), (0.032, 1 - LOGISTIC), (0.0, 1)]
)
def test_dark_pixels_are_lost(grey, lost):
    seen = compiled_observe(frontal(1.0, grey=grey), CAMERA, only(dark=0.04, dark_width=0.008), key=KEY)
    assert 1 - np.mean(seen.valid) == pytest.approx(lost, abs=0.02)


def test_same_key_same_picture_and_another_key_another():
    a, b, c = (
        compiled_observe(frontal(1.0), CAMERA, DepthNoise(), key=jax.random.key(k)).depth for k in (1, 1, 2)
    )
    np.testing.assert_array_equal(a, b)
    assert np.mean(np.asarray(a) != np.asarray(c)) > 0.5


def test_sweeping_a_parameter_does_not_trace_again():
    compiled_observe(frontal(1.0), CAMERA, DepthNoise(), key=KEY)
    before = len(TRACES)
    spreads = [
        np.std(compiled_observe(frontal(1.0), CAMERA, only(disparity_sigma=s), key=KEY).depth)
        for s in (0.1, 0.2)
    ]
    assert spreads[1] > 1.9 * spreads[0]
    assert len(TRACES) == before > 0
