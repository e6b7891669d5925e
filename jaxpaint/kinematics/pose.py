"""Rigid transforms: a position and a rotation matrix."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from jaxpaint.kinematics.rotations import compose, rotate, transpose


class Pose(eqx.Module):
    """T_a_b: frame b seen from frame a. p: origin of b in a [m]. R: columns are the axes of b in a.

    Leading axes, where there are any, stack poses; the methods are for a single one.
    """

    p: Float[Array, "*stack 3"]
    R: Float[Array, "*stack 3 3"]

    def __matmul__(self, other: "Pose") -> "Pose":
        """T_a_c = T_a_b @ T_b_c."""
        return Pose(self.p + rotate(self.R, other.p), compose(self.R, other.R))

    def inverse(self) -> "Pose":
        """T_b_a."""
        R = transpose(self.R)
        return Pose(-rotate(R, self.p), R)

    def apply(self, p_b: Float[Array, "*points 3"]) -> Float[Array, "*points 3"]:
        """Points given in b, seen from a."""
        x, y, z = p_b[..., :1], p_b[..., 1:2], p_b[..., 2:]
        return self.p + x * self.R[:, 0] + y * self.R[:, 1] + z * self.R[:, 2]


def pose_from_matrix(T: Float[Array, "4 4"]) -> Pose:
    """The pose of a homogeneous matrix."""
    return Pose(T[:3, 3], T[:3, :3])


def matrix_from_pose(pose: Pose) -> Float[Array, "4 4"]:
    """The homogeneous matrix of a pose."""
    top = jnp.concatenate([pose.R, pose.p[:, None]], axis=1)
    return jnp.concatenate([top, jnp.eye(4, dtype=top.dtype)[3:]])
