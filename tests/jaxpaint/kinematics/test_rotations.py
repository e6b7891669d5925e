"""Rotations: inverses of each other, against SciPy's, and with gradients where the formulas are singular."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from jaxpaint.kinematics import (
    compose,
    cross,
    exponential,
    frame_from_axis,
    quaternion_from_rotation,
    rotate,
    rotation_from_quaternion,
    swing_twist,
    transpose,
)


@pytest.fixture
def vectors():
    """Rotation vectors, half of them close to half a turn, where quaternions have a small real part."""
    w = np.random.default_rng(0).normal(size=(12, 3))
    w[::2] *= (np.pi - 1e-3) / np.linalg.norm(w[::2], axis=1, keepdims=True)
    return w


@pytest.fixture
def rotations(vectors):
    return Rotation.from_rotvec(vectors).as_matrix()


def over(function, *arguments):
    """One compilation for all cases."""
    return jax.jit(jax.vmap(function))(*map(jnp.asarray, arguments))


def test_products(rotations, x64):
    v = np.random.default_rng(1).normal(size=(12, 3))
    np.testing.assert_allclose(
        over(compose, rotations, rotations[::-1]), rotations @ rotations[::-1], atol=1e-12
    )
    np.testing.assert_allclose(over(rotate, rotations, v), np.einsum("nij,nj->ni", rotations, v), atol=1e-12)
    np.testing.assert_allclose(over(transpose, rotations), np.linalg.inv(rotations), atol=1e-12)


@pytest.mark.parametrize("axis", [-1, 0])
def test_cross(axis, strict_ranks):
    a, b = (np.random.default_rng(k).normal(size=(3, 3)).astype(np.float32) for k in (0, 1))
    np.testing.assert_allclose(cross(a, b, axis=axis), np.cross(a, b, axis=axis), atol=1e-6)


def test_quaternions(rotations, vectors, x64):
    q = over(quaternion_from_rotation, rotations)
    expected = Rotation.from_rotvec(vectors).as_quat(canonical=True, scalar_first=True)
    np.testing.assert_allclose(q, expected, atol=1e-12)
    np.testing.assert_allclose(over(rotation_from_quaternion, 3 * q), rotations, atol=1e-12)


def test_exponential(vectors, x64):
    sizes = np.array([0.0, 1e-9, 1e-5, 1e-4, 1e-3, 0.1, 1, 1, 1, 1, 1, 1])[:, None]
    expected = Rotation.from_rotvec(vectors * sizes).as_matrix()
    np.testing.assert_allclose(over(exponential, vectors * sizes), expected, atol=1e-14)


def test_swing_twist_takes_a_rotation_apart(rotations, x64):
    x, y, turn = np.asarray(over(swing_twist, rotations)).T
    swing, twist = np.stack([x, y, 0 * x], 1), np.stack([0 * x, 0 * x, turn], 1)
    again = Rotation.from_rotvec(swing) * Rotation.from_rotvec(twist)
    np.testing.assert_allclose(again.as_matrix(), rotations, atol=1e-11)


def test_gradients_are_finite_at_the_identity_and_at_half_turns():
    R = np.stack([np.eye(3), np.diag([1.0, -1, -1]), np.diag([-1.0, -1, 1])]).astype(np.float32)
    for function in (swing_twist, lambda R: exponential(swing_twist(R))):
        assert bool(jnp.isfinite(over(jax.jacrev(function), R)).all())


def test_small_parts_are_the_rotation_vector(x64):
    """At the identity, swing and twist are the rotation vector to first order."""
    at_zero = jax.jit(jax.jacfwd(lambda w: swing_twist(exponential(w))))(jnp.zeros(3))
    np.testing.assert_allclose(at_zero, np.eye(3), atol=1e-12)


def test_frame_from_axis(x64):
    to_the_right = jnp.array([0.0, -1.0, 0.0])
    normal = np.array([-0.8, 0.36, 0.48])
    R = np.asarray(jax.jit(frame_from_axis)(jnp.asarray(-normal), to_the_right))
    np.testing.assert_allclose(R.T @ R, np.eye(3), atol=1e-12)
    assert np.linalg.det(R) == pytest.approx(1)
    np.testing.assert_allclose(R[:, 2], -normal, atol=1e-12)
    assert R[1, 0] < -0.9  # x still points to the right
    assert bool(jnp.isfinite(jax.jit(jax.jacrev(frame_from_axis))(to_the_right, to_the_right)).all())
