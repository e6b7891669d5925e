"""Strokes show what is across them, and only as far as the base can move that way."""

import jax
import jax.numpy as jnp
import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from jaxpaint.localisation import Belief, StrokeSettings, correct, match_stroke

match = jax.jit(match_stroke)
after = jax.jit(correct)
START = np.array([0.01, 0.01, 0.005])
BASE = np.array([0.0, 0.0, 0.0])
WALL = np.array([-1.0, 0.0, 0.0])


def marks(slants):
    """Marks on the wall x = 1 with strokes at these angles from level, 0.1 m apart."""
    slants = np.asarray(slants, float)
    place = np.stack([np.ones_like(slants), 0.1 * np.arange(len(slants)), 1 + 0 * slants], axis=1)
    along = np.stack([0 * slants, np.cos(slants), np.sin(slants)], axis=1)
    return place, along, np.tile(WALL, (len(slants), 1))


def shifted(place, error):
    """The marks where a base that is off by `error` sees them."""
    x, y = place[:, 0], place[:, 1]
    c, s = np.cos(error[2]), np.sin(error[2])
    return np.stack([c * x - s * y + error[0], s * x + c * y + error[1], place[:, 2]], axis=1)


def looked(slants, error, settings=None, *, valid=None, seen=None):
    place, along, normal = marks(slants)
    seen = shifted(place, error) if seen is None else seen
    valid = np.ones(len(place), bool) if valid is None else valid
    arrays = [jnp.asarray(x) for x in (seen, place, along, normal, valid, BASE[:2] + error[:2])]
    return match(*arrays, settings)


def test_an_upright_stroke_shows_what_is_along_the_wall():
    error = np.array([0.0, 0.004, 0.0])
    evidence = looked([np.pi / 2] * 4, error)
    got = after(Belief(jnp.asarray(error), jnp.diag(jnp.asarray([1e-8, 1e-4, 1e-8]))), evidence)
    np.testing.assert_allclose(got.pose[1], 0, atol=2e-4)
    # Where the strokes were laid is not known better than that.
    np.testing.assert_allclose(np.sqrt(got.covariance[1, 1]), np.sqrt(1e-6 / 4 + 1e-6), rtol=0.02)


def test_a_level_stroke_shows_nothing():
    evidence = looked([0.0] * 4, np.array([0.003, 0.004, 0.002]))
    np.testing.assert_allclose(evidence.information, 0, atol=1e-3)


@given(slant=st.floats(0.2, 2.9), slide=st.floats(-0.02, 0.02))
def test_what_slides_along_a_stroke_is_not_seen(slant, slide):
    place, along, _ = marks([slant] * 4)
    evidence = looked([slant] * 4, BASE, seen=place + slide * along)
    np.testing.assert_allclose(evidence.residual, 0, atol=1e-6)
    across = np.sin(slant)  # the share of the across direction that a base can move in
    np.testing.assert_allclose(evidence.information[1, 1], 4 * across**2 / (1e-6 + 4e-6), rtol=1e-3)


def test_a_mark_of_another_stroke_does_not_spoil_it():
    error = np.array([0.0, 0.004, 0.0])
    place, _, _ = marks([np.pi / 2] * 8)
    seen = shifted(place, error)
    seen[3, 1] += 0.03
    evidence = looked([np.pi / 2] * 8, error, seen=seen)
    got = after(Belief(jnp.asarray(error), jnp.diag(jnp.asarray([1e-8, 1e-4, 1e-8]))), evidence)
    np.testing.assert_allclose(got.pose[1], 0, atol=5e-4)


def test_marks_that_are_not_seen_say_nothing():
    for valid, seen in ((np.zeros(4, bool), None), (None, np.full((4, 3), np.nan))):
        evidence = looked([np.pi / 2] * 4, BASE, valid=valid, seen=seen)
        assert float(evidence.used) == 0 and not np.any(evidence.information)
        assert np.isfinite(evidence.residual)
    settings = StrokeSettings(gate=0.001)
    assert float(looked([np.pi / 2] * 4, np.array([0.0, 0.01, 0.0]), settings).used) == 0
