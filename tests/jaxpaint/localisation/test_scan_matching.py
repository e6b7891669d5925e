"""Scans correct what can be seen, and only that."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jaxpaint.compiling import batched
from jaxpaint.localisation import Belief, ScanSettings, correct, match_scan
from jaxpaint.steering import wrap

MOUNT = 0.25, -0.05, 0.1
START = 0.03, 0.03, 0.0175
AROUND = {
    "flat": (1.6, 0.4, 0.2),
    "corner": (1.7, 0.9, 0.7),
    "room": (1.8, 2.3, 1.0),
    "column": (0.9, 0.1, 0.1),
}


def lidar(base):
    """Where the scanner of a base at (x, y, yaw) stands."""
    c, s = np.cos(base[2]), np.sin(base[2])
    return np.array(
        [base[0] + c * MOUNT[0] - s * MOUNT[1], base[1] + s * MOUNT[0] + c * MOUNT[1], base[2] + MOUNT[2]]
    )


@jax.jit
def looked(outline, belief, ranges, bearings):
    """The belief and the evidence after one look."""
    evidence = match_scan(outline, belief.pose, jnp.asarray(MOUNT), ranges, jnp.isfinite(ranges), bearings)
    return correct(belief, evidence), evidence


def found(place, outline, true, error, bearings, *, noise=None, looks=2):
    """What is left of an error of the pose after some looks at the same scan, and the last evidence."""
    ranges = jnp.asarray(place.ranges(lidar(true), noise=noise))
    pose, covariance, evidence = jnp.asarray(true + error), jnp.diag(jnp.asarray(START) ** 2), None
    for _ in range(looks):
        belief, evidence = looked(outline, Belief(pose, covariance), ranges, bearings)
        pose = belief.pose
    return np.asarray(pose, float) - true, evidence, np.asarray(belief.covariance, float)


@pytest.mark.parametrize(("name", "position", "yaw"), [("room", 0.0025, 0.0015), ("corner", 0.003, 0.0015)])
def test_a_room_gives_the_pose_to_the_noise(places, bearings, name, position, yaw):
    """In the room 1.8 mm and 0.9 mrad with 90 beams: 10 mm over the root of 45, and the map's own error."""
    rng, left, normalised = np.random.default_rng(0), [], []
    for _ in range(60):
        true = np.array(AROUND[name]) + rng.normal(size=3) * [0.2, 0.2, 0.2]
        outline = places[name].outline(rng)
        error, _, covariance = found(
            places[name], outline, true, rng.normal(size=3) * np.array(START), bearings, noise=rng
        )
        left.append(error)
        normalised.append(error @ np.linalg.solve(covariance, error))
    rms = np.sqrt(np.mean(np.square(left), axis=0))
    assert (rms[:2] < position).all() and rms[2] < yaw
    # 3 where the covariance is right. It is some 20 % too wide: walls here are true planes, echoes all count.
    assert 1.5 < np.mean(normalised) < 3.6


@pytest.mark.parametrize("name", ["room", "corner"])
@given(error=st.tuples(*[st.floats(-1, 1)] * 3))
def test_without_noise_two_corrections_find_it(places, bearings, name, error):
    error = np.array(error) * [0.05, 0.05, 0.0175]
    outline = places[name].outline()
    left, _, _ = found(places[name], outline, np.array(AROUND[name]), error, bearings, looks=3)
    assert np.abs(left).max() < 4e-4


def test_one_flat_wall_shows_distance_and_yaw_alone(places, bearings):
    place = places["flat"]
    true, error = np.array(AROUND["flat"]), np.array([0.02, 0.03, 0.01])
    left, evidence, covariance = found(place, place.outline(), true, error, bearings)
    values = np.linalg.eigvalsh(np.asarray(evidence.information, float))
    assert values[0] < 1e-5 * values[1]
    assert abs(left[0]) < 1e-3 and abs(left[2]) < 5e-4
    assert abs(left[1] - error[1]) < 1e-4  # what is along the wall is not touched
    np.testing.assert_allclose(covariance[1, 1], START[1] ** 2, rtol=1e-3)


def test_a_column_does_not_show_where_along_it_one_stands(places, bearings):
    """The direction that it cannot see is a turn of the base about the column's axis."""
    place, true = places["column"], np.array(AROUND["column"])
    outline = place.outline(np.random.default_rng(3))
    _, evidence, _ = found(place, outline, true, np.zeros(3), bearings, noise=np.random.default_rng(4))
    arm = true[:2] - np.array([4.0, 0.0])
    blind = np.array([-arm[1], arm[0], 1.0])
    information = np.asarray(evidence.information, float)
    # Of the map's circle, which is off by some mm: not as blind as the true one, but worth less than 0.1 rad.
    assert blind @ information @ blind < 100
    assert np.linalg.eigvalsh(information)[1] > 1e3


@pytest.mark.parametrize("share", [0.1, 0.2])
def test_things_that_are_not_on_the_map_do_not_spoil_it(places, bearings, share):
    """A crate or people stand before the walls, from touching them to far off, for a share of the beams."""
    rng, place, left = np.random.default_rng(1), places["room"], []
    outline = place.outline(rng)
    for _ in range(30):
        true = np.array(AROUND["room"]) + rng.normal(size=3) * 0.1
        ranges = place.ranges(lidar(true), noise=rng)
        first, count = rng.integers(0, 90), int(share * 90)
        ranges[(first + np.arange(count)) % 90] -= rng.uniform(0.03, 0.8)
        pose = jnp.asarray(true + rng.normal(size=3) * np.array(START))
        for _ in range(3):
            belief, _ = looked(
                outline, Belief(pose, jnp.diag(jnp.asarray(START) ** 2)), jnp.asarray(ranges), bearings
            )
            pose = belief.pose
        left.append(np.asarray(pose, float) - true)
    rms = np.sqrt(np.mean(np.square(left), axis=0))
    assert (rms[:2] < 0.006).all() and rms[2] < 0.003


def test_what_is_not_seen_changes_nothing(places, bearings):
    place, true = places["room"], np.array(AROUND["room"])
    outline, belief = place.outline(), Belief(jnp.asarray(true + 0.01), jnp.diag(jnp.asarray(START) ** 2))
    ranges = place.ranges(lidar(true))
    for bad in (np.full(90, np.nan), np.full(90, np.inf), np.full(90, 0.05)):
        after, evidence = looked(outline, belief, jnp.asarray(bad), bearings)
        assert float(evidence.used) == 0 and float(evidence.residual) == 0
        np.testing.assert_array_equal(after.pose, belief.pose)
        np.testing.assert_array_equal(after.covariance, belief.covariance)
    holes = np.where(np.arange(90) % 3 == 0, np.nan, ranges)
    short = jnp.asarray(ranges)[np.arange(90) % 3 != 0]
    several = looked(outline, belief, jnp.asarray(holes), bearings)[1]
    fewer = looked(outline, belief, short, bearings[np.arange(90) % 3 != 0])[1]
    np.testing.assert_allclose(several.information, fewer.information, rtol=1e-4, atol=1)
    nothing = dataclasses.replace(outline, live=jnp.zeros_like(outline.live))
    assert float(looked(nothing, belief, jnp.asarray(ranges), bearings)[1].used) == 0


def test_many_echoes_of_one_piece_are_no_better_than_the_piece(places, bearings):
    place, true = places["flat"], np.array(AROUND["flat"])
    outline = dataclasses.replace(place.outline(), sigma=jnp.full(32, 0.02))
    settings = ScanSettings(looks=4.0)
    ranges = jnp.asarray(place.ranges(lidar(true)))
    evidence = jax.jit(match_scan)(
        outline, jnp.asarray(true), jnp.asarray(MOUNT), ranges, jnp.ones(90, bool), bearings, settings
    )
    assert 0.95 < float(evidence.information[0, 0]) * 4 * 0.02**2 < 1


def scene(places, name="room"):
    """Arguments of a look whose pose is off, with noise, in doubles."""
    rng, place, true = np.random.default_rng(5), places[name], np.array(AROUND[name])
    ranges = place.ranges(lidar(true), noise=rng)
    return (
        place.outline(rng),
        true + np.array([0.01, -0.02, 0.008]),
        np.where(np.isfinite(ranges), ranges, np.nan),
    )


def loss(pose, shift, sigma, outline, ranges, bearings):
    """A number made of all that a look and its correction give."""
    measured = ranges + shift * jnp.cos(3 * bearings)
    settings, mount = ScanSettings(range_sigma=sigma), jnp.asarray(MOUNT)
    evidence = match_scan(outline, pose, mount, measured, jnp.isfinite(measured), bearings, settings)
    after = correct(Belief(pose, jnp.diag(jnp.asarray(START) ** 2)), evidence)
    deviation = jnp.sqrt(jnp.diagonal(after.covariance)) / jnp.asarray(START)
    return (jnp.asarray([0.3, -0.5, 0.9]) * (after.pose + deviation)).sum() + evidence.residual


value = batched(loss, in_axes=(0, 0, 0, None, None, None))
gradient = batched(jax.grad(loss, argnums=(0, 1, 2)), in_axes=(0, 0, 0, 0, 0, None))


def test_gradients_are_those_of_differences(x64, places, bearings):
    scenes = [scene(places, name) for name in ("room", "column")]
    bearings = jnp.asarray(np.asarray(bearings, float))
    at = [np.stack([[*pose, 0.0, 0.01]]) for _, pose, _ in scenes]
    outlines = jax.tree.map(lambda *leaves: jnp.stack(leaves), *(outline for outline, _, _ in scenes))
    ranges = jnp.asarray(np.stack([r for _, _, r in scenes]))

    def split(numbers):
        return jnp.asarray(numbers[:, :3]), jnp.asarray(numbers[:, 3]), jnp.asarray(numbers[:, 4])

    slopes = gradient(*split(np.concatenate(at)), outlines, ranges, bearings)
    slopes = np.concatenate([np.reshape(x, (2, -1)) for x in slopes], axis=1)
    steps = 1e-6 * np.concatenate([np.eye(5), -np.eye(5)])
    for k, (outline, _, _) in enumerate(scenes):
        values = np.asarray(value(*split(at[k] + steps), outline, ranges[k], bearings))
        np.testing.assert_allclose(slopes[k], (values[:5] - values[5:]) / 2e-6, rtol=1e-4, atol=1e-5)


def test_gradients_are_finite_where_nothing_is_seen(x64, places, bearings):
    outline, pose, _ = scene(places)
    bearings = jnp.asarray(np.asarray(bearings, float))
    at = jnp.stack([jnp.asarray(pose)] * 2), jnp.zeros(2), jnp.full(2, 0.01)
    outlines = jax.tree.map(lambda leaf: jnp.stack([leaf, leaf]), outline)
    ranges = jnp.asarray(np.stack([np.full(90, np.nan), np.full(90, 2.0)]))
    for slope in gradient(*at, outlines, ranges, bearings):
        assert np.isfinite(slope).all()


def test_float32_is_enough(places, bearings):
    outline, pose, ranges = scene(places)
    answers = []
    for doubles in (False, True):
        with jax.enable_x64(doubles):
            number = jnp.float64 if doubles else jnp.float32
            cast = jax.tree.map(lambda x, number=number: jnp.asarray(np.asarray(x), number), outline)
            belief = Belief(jnp.asarray(pose, number), jnp.diag(jnp.asarray(START, number) ** 2))
            beams = jnp.asarray(np.asarray(bearings), number)
            after, evidence = looked(cast, belief, jnp.asarray(ranges, number), beams)
            assert after.pose.dtype == after.covariance.dtype == evidence.residual.dtype == number
            answers.append([np.asarray(x, float) for x in (after.pose, after.covariance, evidence.residual)])
    (pose, covariance, residual), (pose64, covariance64, residual64) = answers
    np.testing.assert_allclose(pose, pose64, atol=2e-6)
    np.testing.assert_allclose(covariance, covariance64, atol=2e-4 * covariance64.max())
    np.testing.assert_allclose(residual, residual64, rtol=1e-4)


def test_many_worlds_are_a_loop(places, bearings, strict_ranks):
    rng, names = np.random.default_rng(2), ["room", "corner", "flat", "column"]
    outlines = [places[name].outline(rng) for name in names]
    poses = [np.array(AROUND[name]) for name in names]
    ranges = [places[name].ranges(lidar(pose), noise=rng) for name, pose in zip(names, poses, strict=True)]
    beliefs = [Belief(jnp.asarray(pose + 0.01), jnp.diag(jnp.asarray(START) ** 2)) for pose in poses]

    def stacked(trees):
        return jax.tree.map(lambda *leaves: jnp.stack(leaves), *trees)

    ranges = [jnp.asarray(r) for r in ranges]
    program = batched(looked.__wrapped__, in_axes=(0, 0, 0, None))
    together = program(stacked(outlines), stacked(beliefs), jnp.stack(ranges), bearings)
    alone = stacked([looked(*args, bearings) for args in zip(outlines, beliefs, ranges, strict=True)])
    jax.tree.map(lambda a, b: np.testing.assert_allclose(a, b, rtol=2e-3, atol=2e-5), together, alone)


def test_thresholds_and_outlines_are_traced(places, bearings):
    outline, pose, ranges = scene(places)
    traces = []

    @jax.jit
    def look(outline, settings):
        traces.append(1)
        return match_scan(
            outline,
            jnp.asarray(pose),
            jnp.asarray(MOUNT),
            jnp.asarray(ranges),
            jnp.ones(90, bool),
            bearings,
            settings,
        ).used

    wide, narrow = look(outline, ScanSettings()), look(places["corner"].outline(), ScanSettings(gate=0.05))
    assert len(traces) == 1 and float(narrow) < float(wide)


def test_a_turn_of_the_base_is_the_same_look(places, bearings):
    """A whole turn more of yaw changes nothing but the yaw itself."""
    outline, pose, ranges = scene(places)
    covariance = jnp.diag(jnp.asarray(START) ** 2)
    once = looked(outline, Belief(jnp.asarray(pose), covariance), jnp.asarray(ranges), bearings)[0].pose
    turned = jnp.asarray(pose + np.array([0, 0, 2 * np.pi]))
    again = looked(outline, Belief(turned, covariance), jnp.asarray(ranges), bearings)[0].pose
    assert float(again[2]) > 2 * np.pi
    np.testing.assert_allclose(wrap(again[2]), wrap(once[2]), atol=2e-5)
    np.testing.assert_allclose(again[:2], once[:2], atol=2e-5)
