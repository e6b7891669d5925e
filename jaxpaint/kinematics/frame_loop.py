"""The frames of a chain by a loop along it: a small program, where time to compile counts more than speed."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from jaxpaint.kinematics.chain import KinematicChain
from jaxpaint.kinematics.pose import Pose
from jaxpaint.kinematics.rotations import compose, rotate


def looped_frames(chain: KinematicChain, q: Float[Array, " joints"]) -> Pose:
    """As `frames`: T_map_i behind each joint; stacked: p [joints, 3], R [joints, 3, 3]."""
    hinges = np.array([kind == "hinge" for kind in chain.kinds])
    angle = jnp.where(hinges, q, 0)

    def step(carry, joint):
        p, R = carry
        R_offset, p_offset, c, s, slide = joint
        x, y, z = R_offset[:, 0], R_offset[:, 1], R_offset[:, 2]
        p = p + rotate(R, p_offset + slide * z)
        R = compose(R, jnp.stack([c * x + s * y, c * y - s * x, z], axis=-1))
        return (p, R), (p, R)

    start = jnp.zeros(3, q.dtype), jnp.eye(3, dtype=q.dtype)
    rows = chain.R_offset, chain.p_offset, jnp.cos(angle), jnp.sin(angle), q - angle
    _, (p, R) = jax.lax.scan(step, start, rows)
    return Pose(p, R)
