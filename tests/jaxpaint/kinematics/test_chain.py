"""Chains: products of exponentials, Jacobians against differentiation."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.linalg import expm

from jaxpaint.kinematics import (
    KinematicChain,
    Pose,
    Spheres,
    arm_chain,
    forward,
    frames,
    jacobian,
    matrix_from_pose,
    pose_from_matrix,
    sphere_centers,
    with_tool,
)

KINDS = ("slide", "hinge", "hinge", "slide", "hinge")


def random_rotations(rng, n):
    turns = np.linalg.qr(rng.normal(size=(n, 3, 3)))[0]
    return turns * np.sign(np.linalg.det(turns))[:, None, None]


def random_chain(seed=0) -> KinematicChain:
    rng = np.random.default_rng(seed)
    n = len(KINDS)
    turns = random_rotations(rng, n + 1)
    return KinematicChain(
        R_offset=jnp.asarray(turns[:n]),
        p_offset=jnp.asarray(rng.normal(size=(n, 3)) * 0.4),
        R_tool=jnp.asarray(turns[n]),
        p_tool=jnp.asarray(rng.normal(size=3) * 0.2),
        kinds=KINDS,
        names=tuple(f"joint_{i}" for i in range(n)),
    )


def matrix(R, p):
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R, p
    return T


@pytest.fixture
def chain(x64):
    return random_chain()


@pytest.fixture
def q(x64):
    return jnp.asarray(np.random.default_rng(5).uniform(-2, 2, len(KINDS)))


def test_forward_is_the_product_of_exponentials(chain, q):
    """The textbook form, in the map: prod exp([S_i] q_i) M, with the screws S_i read off at zero."""

    @jax.jit
    def read(q):
        return frames(chain, q), forward(chain, q)

    zero, M = jax.tree.map(np.asarray, read(jnp.zeros(chain.size)))
    T = np.eye(4)
    for i, kind in enumerate(chain.kinds):
        x, y, z = axis = zero.R[i, :, 2]
        screw = np.zeros((4, 4))
        if kind == "hinge":
            screw[:3, :3] = [[0, -z, y], [z, 0, -x], [-y, x, 0]]
            screw[:3, 3] = np.cross(zero.p[i], axis)
        else:
            screw[:3, 3] = axis
        T = T @ expm(screw * float(q[i]))
    found = read(q)[1]
    np.testing.assert_allclose(matrix(found.R, found.p), T @ matrix(M.R, M.p), atol=1e-10)


def test_jacobian_is_the_derivative_of_the_pose(chain, q):
    pose, J = jax.tree.map(np.asarray, jax.jit(jacobian)(chain, q))
    slope = jax.tree.map(np.asarray, jax.jit(jax.jacfwd(lambda q: forward(chain, q)))(q))
    np.testing.assert_allclose(J[:3], slope.p, atol=1e-12)
    for i in range(chain.size):
        skew = slope.R[..., i] @ pose.R.T  # dR/dq_i = [w_i]x R
        np.testing.assert_allclose(J[3:, i], [skew[2, 1], skew[0, 2], skew[1, 0]], atol=1e-12)


@pytest.mark.parametrize("moving", ["joints", "chain", "both"])
def test_frames_change_as_differences_say(chain, q, moving):
    """There and on the way back: by rules of their own where joints alone move."""
    rng = np.random.default_rng(3)
    along = jax.tree.map(lambda x: jnp.asarray(rng.normal(size=x.shape)), (chain, q))
    parts = {"joints": (False, True), "chain": (True, False), "both": (True, True)}[moving]
    weight = jax.tree.map(lambda x: jnp.asarray(rng.normal(size=x.shape)), frames(chain, q))

    def total(length):
        at = jax.tree.map(lambda x, d: x + length * d, (chain, q), along)
        links = frames(*(a if p else b for a, b, p in zip(at, (chain, q), parts, strict=True)))
        return sum(
            (a * b).sum() for a, b in zip(jax.tree.leaves(links), jax.tree.leaves(weight), strict=True)
        )

    value = jax.jit(total)
    numeric = (value(1e-6) - value(-1e-6)) / 2e-6
    forwards, back = jax.jit(jax.jacfwd(total))(0.0), jax.jit(jax.grad(total))(0.0)
    np.testing.assert_allclose([forwards, back], float(numeric), rtol=1e-8)


def test_the_jacobian_can_be_differentiated(chain, q):
    """In reverse, as a rollout does, against central differences."""

    def total(q):
        return (jacobian(chain, q)[1] * jnp.arange(6 * chain.size).reshape(6, -1)).sum()

    steps = 1e-6 * np.eye(chain.size)
    around = np.asarray(jax.jit(jax.vmap(total))(jnp.asarray(np.concatenate([q + steps, q - steps]))))
    numeric = (around[: chain.size] - around[chain.size :]) / 2e-6
    np.testing.assert_allclose(jax.jit(jax.grad(total))(q), numeric, atol=1e-6)


def test_an_arm_on_a_held_base_is_the_rest_of_the_chain(chain, q):
    arm = jax.jit(arm_chain)(chain, q[:2])
    assert arm.names == chain.names[2:]
    pose, J = jax.jit(jacobian)(arm, q[2:])
    whole, J_whole = jax.jit(jacobian)(chain, q)
    np.testing.assert_allclose(pose.p, whole.p, atol=1e-12)
    np.testing.assert_allclose(pose.R, whole.R, atol=1e-12)
    np.testing.assert_allclose(J, J_whole[:, 2:], atol=1e-12)


def test_another_tool_on_the_same_joints(chain, q):
    T = matrix(random_rotations(np.random.default_rng(9), 1)[0], [0.1, -0.2, 0.3])

    @jax.jit
    def both(q):
        moved = with_tool(chain, pose_from_matrix(jnp.asarray(T)))
        return matrix_from_pose(forward(chain, q)), matrix_from_pose(forward(moved, q))

    brush, camera = both(q)
    np.testing.assert_allclose(camera, np.asarray(brush) @ T, atol=1e-12)


def test_spheres_ride_on_their_links(chain, q):
    spheres = Spheres(jnp.array([0, 4, 2]), jnp.arange(9.0).reshape(3, 3) / 10, jnp.ones(3))
    links = jax.tree.map(np.asarray, jax.jit(frames)(chain, q))
    found = jax.jit(sphere_centers)(chain, spheres, q)
    for k, i in enumerate((0, 4, 2)):
        np.testing.assert_allclose(
            found[k], links.p[i] + links.R[i] @ np.asarray(spheres.center[k]), atol=1e-12
        )


def test_worlds_side_by_side_equal_one_after_another(strict_ranks):
    chain = random_chain(3)
    qs = jnp.asarray(np.random.default_rng(0).uniform(-2, 2, (5, chain.size)), jnp.float32)
    together = jax.jit(jax.vmap(jacobian, in_axes=(None, 0)))(chain, qs)[1]
    alone = jax.jit(jacobian)
    for k in range(5):
        np.testing.assert_allclose(together[k], alone(chain, qs[k])[1], atol=1e-6)


def test_poses_compose_invert_and_move_points(x64):
    rng = np.random.default_rng(1)
    A, B = (matrix(R, rng.normal(size=3)) for R in random_rotations(rng, 2))
    points = rng.normal(size=(4, 3))

    @jax.jit
    def all_three(A, B):
        a, b = pose_from_matrix(A), pose_from_matrix(B)
        return (
            matrix_from_pose(a @ b),
            matrix_from_pose(a.inverse()),
            a.apply(jnp.asarray(points)),
            a @ Pose(b.p, b.R),
        )

    product, inverse, moved, again = all_three(jnp.asarray(A), jnp.asarray(B))
    np.testing.assert_allclose(product, A @ B, atol=1e-12)
    np.testing.assert_allclose(again.p, (A @ B)[:3, 3], atol=1e-12)
    np.testing.assert_allclose(inverse, np.linalg.inv(A), atol=1e-12)
    np.testing.assert_allclose(moved, points @ A[:3, :3].T + A[:3, 3], atol=1e-12)
