"""Random rotations are rotations, and go everywhere."""

import jax
import jax.numpy as jnp
import numpy as np

from sims.scans.turns import any_turn, frame_about, turn_about_z, upright_frame


def _is_rotation(R):
    np.testing.assert_allclose(np.swapaxes(R, -1, -2) @ R, np.broadcast_to(np.eye(3), R.shape), atol=1e-5)
    np.testing.assert_allclose(np.linalg.det(R), 1, atol=1e-5)


def test_any_turn_is_even_over_all_rotations():
    draws = jax.random.uniform(jax.random.key(0), (4000, 3))
    R = np.asarray(jax.vmap(any_turn)(draws))
    _is_rotation(R)
    # Each axis is even over the sphere: mean 0, and a third of its square along each direction.
    np.testing.assert_allclose(R.mean(0), 0, atol=0.04)
    np.testing.assert_allclose((R**2).mean(0), 1 / 3, atol=0.03)
    angle = np.arccos(np.clip((np.trace(R, axis1=1, axis2=2) - 1) / 2, -1, 1))
    np.testing.assert_allclose(angle.mean(), np.pi / 2 + 2 / np.pi, atol=0.05)


def test_frames_have_the_axis_that_was_asked_for():
    axes = jax.random.normal(jax.random.key(1), (50, 3))
    axes = jnp.concatenate([axes / jnp.linalg.norm(axes, axis=1, keepdims=True), jnp.eye(3), -jnp.eye(3)])
    R = np.asarray(jax.vmap(frame_about)(axes, jnp.linspace(0, 7, 56)))
    _is_rotation(R)
    np.testing.assert_allclose(R[:, :, 2], axes, atol=1e-6)


def test_upright_frames_stand():
    R = np.asarray(upright_frame(jnp.asarray(0.4)))
    _is_rotation(R)
    np.testing.assert_allclose(R[:, 1:].T, [[0, 0, 1], [np.cos(0.4), np.sin(0.4), 0]], atol=1e-6)
    turned = np.asarray(turn_about_z(jnp.asarray(0.4)))
    _is_rotation(turned)
    np.testing.assert_allclose(turned @ [1, 0, 0], [np.cos(0.4), np.sin(0.4), 0], atol=1e-6)
