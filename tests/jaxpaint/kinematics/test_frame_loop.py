"""The loop along the chain against the kinematics."""

import jax
import jax.numpy as jnp
import numpy as np

from jaxpaint.kinematics import KinematicChain
from jaxpaint.kinematics.chain import frames
from jaxpaint.kinematics.frame_loop import looped_frames
from sims.robots import load_robot


def test_it_agrees_with_the_kinematics_at_every_joint(x64):
    robot = load_robot()
    chain = jax.tree.map(lambda x: jnp.asarray(x, float), robot.chain)
    assert isinstance(chain, KinematicChain) and {"slide", "hinge"} == set(chain.kinds)
    q = np.random.default_rng(0).uniform(-2, 2, (5, chain.size))
    found = jax.jit(jax.vmap(lambda row: looped_frames(chain, row)))(q)
    wanted = jax.jit(jax.vmap(lambda row: frames(chain, row)))(q)
    np.testing.assert_allclose(found.p, wanted.p, atol=1e-12)
    np.testing.assert_allclose(found.R, wanted.R, atol=1e-12)
