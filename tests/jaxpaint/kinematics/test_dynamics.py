"""Newton and Euler against closed forms; against MuJoCo in tests/sims/robots/test_inertia.py."""

import jax
import jax.numpy as jnp
import numpy as np

from jaxpaint.kinematics import Inertia, KinematicChain, inverse_dynamics


def pendulum(kinds=("hinge",), length=0.7, mass=2.0) -> tuple[KinematicChain, Inertia]:
    """A point mass on a bar that turns about the map's y axis, bar along x at zero."""
    n = len(kinds)
    R = np.tile(np.eye(3), (n, 1, 1))
    R[0] = [[1, 0, 0], [0, 0, 1], [0, -1, 0]]  # local z is the map's y
    chain = KinematicChain(
        *map(jnp.asarray, (R, np.zeros((n, 3)), np.eye(3), np.zeros(3))), kinds, ("j",) * n
    )
    zero = np.zeros(n)
    center = np.zeros((n, 3))
    center[:, 0] = length
    return chain, Inertia(
        *map(jnp.asarray, (zero + mass, center, np.zeros((n, 3, 3)), zero + 0.3, zero + 0.5, [0, 0, -9.81]))
    )


def test_a_pendulum(x64):
    chain, inertia = pendulum()
    q, v, a = 0.4, 1.5, -2.0
    found = jax.jit(inverse_dynamics)(chain, inertia, *(jnp.array([x]) for x in (q, v, a)))
    # turning about y lowers the bar's end
    wanted = (2.0 * 0.7**2 + 0.3) * a - 2.0 * 9.81 * 0.7 * np.cos(q) + 0.5 * v
    np.testing.assert_allclose(found, [wanted], rtol=1e-12)


def test_torque_is_linear_in_acceleration_and_quadratic_in_speed(x64):
    chain, inertia = pendulum(("hinge", "slide"))
    rng = np.random.default_rng(0)
    q, v, a = (jnp.asarray(rng.normal(size=2)) for _ in range(3))
    still = jax.tree.map(jnp.asarray, Inertia(**{**vars(inertia), "damping": jnp.zeros(2)}))
    torque = jax.jit(lambda v, a: inverse_dynamics(chain, still, q, v, a))
    rest = torque(0 * v, 0 * a)
    both = torque(3 * v, 2 * a) - rest
    np.testing.assert_allclose(
        both, 9 * (torque(v, 0 * a) - rest) + 2 * (torque(0 * v, a) - rest), rtol=1e-12
    )
