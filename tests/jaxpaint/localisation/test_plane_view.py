"""A patch of depth shows distance and yaw, and never what is along a blank wall."""

import jax
import jax.numpy as jnp
import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from jaxpaint.localisation import Belief, PlaneSettings, correct, match_plane

match = jax.jit(match_plane)
after = jax.jit(correct)
START = np.array([0.02, 0.02, 0.01])
TRUE = np.array([1.0, 0.3, 0.4])


def patch(normal, point, *, width=0.4, height=0.3):
    """8 x 6 points of a plane about one of its points. [48, 3]"""
    aside = np.array([-normal[1], normal[0], 0]) / np.hypot(normal[0], normal[1])
    up = np.cross(normal, aside)
    u, v = np.meshgrid(np.linspace(-width, width, 8) / 2, np.linspace(-height, height, 6) / 2)
    return point + u.reshape(-1, 1) * aside + v.reshape(-1, 1) * up


def believed(points, error):
    """Points that a base at TRUE sees, placed by one that is off by `error`."""
    pose = TRUE + error
    turn = np.array([[np.cos(error[2]), -np.sin(error[2])], [np.sin(error[2]), np.cos(error[2])]])
    level = (points[:, :2] - TRUE[:2]) @ turn.T + pose[:2]
    return np.concatenate([level, points[:, 2:]], axis=1), pose


@given(error=st.tuples(*[st.floats(-1, 1)] * 3), heading=st.floats(-3, 3))
def test_distance_and_yaw_are_found_and_the_rest_is_kept(error, heading):
    error = np.array(error) * START
    normal = -np.array([np.cos(heading), np.sin(heading), 0.0])
    along = np.array([-np.sin(heading), np.cos(heading)])
    point = np.array([*TRUE[:2], 1.2]) - 0.9 * normal
    points, pose = believed(patch(normal, point), error)
    belief, arrays = Belief(jnp.asarray(pose), jnp.diag(jnp.asarray(START) ** 2)), (point, normal)
    arrays = [jnp.asarray(x) for x in arrays]
    for _ in range(3):
        evidence = match(jnp.asarray(points), jnp.ones(48, bool), belief.pose[:2], *arrays)
        values = np.linalg.eigvalsh(np.asarray(evidence.information, float))
        assert values[0] < 1e-5 * values[2]
        belief = Belief(after(belief, evidence).pose, belief.covariance)
        points, _ = believed(patch(normal, point), np.asarray(belief.pose, float) - TRUE)
    left = np.asarray(belief.pose, float) - TRUE
    # Seen is where the wall is and how it lies; that leaves the base anywhere along it.
    assert abs(left[:2] @ normal[:2]) < 1e-3 and abs(left[2]) < 1.5e-3
    assert abs((left - error)[:2] @ along) < 2e-3


def test_neighbouring_pixels_count_as_few():
    points = patch(np.array([-1.0, 0, 0]), np.array([2.0, 0.3, 1.2]))
    arrays = [jnp.asarray(x) for x in (points, np.ones(48, bool), TRUE[:2], [2.0, 0.3, 1.2], [-1.0, 0, 0])]
    settings = PlaneSettings(sigma=0.002, count=6.0, surface_sigma=0.001)
    expected = 6 / (0.002**2 + 6 * 0.001**2)
    np.testing.assert_allclose(match(*arrays, settings).information[0, 0], expected, rtol=1e-4)
    half = [*arrays[:1], jnp.arange(48) % 12 == 0, *arrays[2:]]
    expected = 4 / (0.002**2 + 4 * 0.001**2)
    np.testing.assert_allclose(match(*half, settings).information[0, 0], expected, rtol=1e-4)


def test_a_hand_before_the_wall_does_not_count():
    points = patch(np.array([-1.0, 0, 0]), np.array([2.0, 0.3, 1.2]))
    rng = np.random.default_rng(0)
    points[:, 0] += 0.012 + 0.001 * rng.normal(size=48)
    points[::5, 0] -= 0.06
    arrays = [jnp.asarray(x) for x in (points, np.ones(48, bool), TRUE[:2], [2.0, 0.3, 1.2], [-1.0, 0, 0])]
    got = after(Belief(jnp.asarray(TRUE), jnp.diag(jnp.asarray(START) ** 2)), match(*arrays))
    np.testing.assert_allclose(got.pose[0] - TRUE[0], -0.012, atol=1.5e-3)


def test_nothing_seen_says_nothing():
    for points in (np.full((48, 3), np.nan), patch(np.array([-1.0, 0, 0]), np.array([5.0, 0.3, 1.2]))):
        arrays = [
            jnp.asarray(x) for x in (points, np.ones(48, bool), TRUE[:2], [2.0, 0.3, 1.2], [-1.0, 0, 0])
        ]
        evidence = match(*arrays)
        assert float(evidence.used) == 0 and not np.any(evidence.information)
    floor = [
        jnp.asarray(x) for x in (np.zeros((48, 3)), np.ones(48, bool), TRUE[:2], [0.0, 0, 0], [0.0, 0, 1])
    ]
    assert not np.any(match(*floor).information)
