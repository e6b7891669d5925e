"""A serial chain of hinges and slides: where its frames are, and how they move."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jax.custom_derivatives import SymbolicZero
from jaxtyping import Array, Float

from jaxpaint.kinematics.pose import Pose
from jaxpaint.kinematics.rotations import compose, cross, rotate


class KinematicChain(eqx.Module):
    """A chain from the map to a tool, as a product of exponentials in local frames.

    T_map_tool = prod_i [T_i exp(q_i xi)] T_tool, where xi turns about (hinge) or moves along (slide) the
    local z: whoever makes a chain folds the direction of each axis into the fixed T_i.

    R_offset, p_offset: T_i, the frame of joint i at zero seen from the frame before. R_tool, p_tool: T_tool
    seen from the last frame. kinds: "hinge" or "slide". names: of the joints.
    """

    R_offset: Float[Array, "joints 3 3"]
    p_offset: Float[Array, "joints 3"]
    R_tool: Float[Array, "3 3"]
    p_tool: Float[Array, "3"]
    kinds: tuple[str, ...] = eqx.field(static=True)
    names: tuple[str, ...] = eqx.field(static=True)

    @property
    def size(self) -> int:
        """The number of joints."""
        return len(self.kinds)


@jax.custom_jvp
def frames(chain: KinematicChain, q: Float[Array, " joints"]) -> Pose:
    """T_map_i behind each joint, which acts on its z axis; stacked: p [joints, 3], R [joints, 3, 3]."""
    return _composed(chain, q)


def _change_of_frames(primals, tangents):
    """Where joints alone move, frames move by sums over the joints before them: fewer operations, above all
    on the way back, than the derivatives of all the products.
    """
    chain, q = primals
    change, speed = (jax.tree.map(_filled, t, is_leaf=_is_zero) for t in tangents)
    if not all(_is_zero(x) for x in jax.tree.leaves(tangents[0], is_leaf=_is_zero)):
        return jax.jvp(_composed, primals, (change, speed))
    links = frames(chain, q)
    return links, _velocities(chain, links, speed)


frames.defjvp(_change_of_frames, symbolic_zeros=True)


def _is_zero(x) -> bool:
    return isinstance(x, SymbolicZero)


def _filled(x):
    return jnp.zeros(x.shape, x.dtype) if _is_zero(x) else x


def _velocities(chain: KinematicChain, links: Pose, speed: Float[Array, " joints"]) -> Pose:
    """Of origins and axes of all frames, at these speeds of the joints."""
    hinges, axis = _hinges(chain)[:, None], links.R[..., 2] * speed[:, None]
    turning = _sums_from_base(jnp.where(hinges, axis, 0))
    # Of the point of each link that is at the map's origin.
    moving = _sums_from_base(jnp.where(hinges, cross(links.p, axis), axis))
    columns = [cross(turning, links.R[..., k]) for k in range(3)]
    return Pose(moving + cross(turning, links.p), jnp.stack(columns, axis=-1))


def _sums_from_base(terms: Float[Array, "joints 3"]) -> Float[Array, "joints 3"]:
    """Row k: the sum of rows 0 to k, by doubling."""
    reach, size = 1, terms.shape[0]
    while reach < size:
        terms = terms + jnp.concatenate([jnp.zeros_like(terms[:reach]), terms[:-reach]])
        reach *= 2
    return terms


def _composed(chain: KinematicChain, q: Float[Array, " joints"]) -> Pose:
    R, p = _joint_transforms(chain, q)
    p_map, R_map = [p[0]], [R[0]]
    for i in range(1, chain.size):
        p_map.append(p_map[-1] + rotate(R_map[-1], p[i]))
        R_map.append(compose(R_map[-1], R[i]))
    return Pose(jnp.stack(p_map), jnp.stack(R_map))


def _joint_transforms(chain: KinematicChain, q):
    """T_i exp(q_i xi) of every joint at once."""
    hinges = _hinges(chain)
    angle = jnp.where(hinges, q, 0)
    c, s = jnp.cos(angle)[:, None], jnp.sin(angle)[:, None]
    x, y, z = chain.R_offset[..., 0], chain.R_offset[..., 1], chain.R_offset[..., 2]
    R = jnp.stack([c * x + s * y, c * y - s * x, z], axis=-1)
    return R, chain.p_offset + (q - angle)[:, None] * z


def _hinges(chain: KinematicChain) -> np.ndarray:
    return np.array([kind == "hinge" for kind in chain.kinds])


def tool_pose(chain: KinematicChain, links: Pose) -> Pose:
    """T_map_tool from the chain's frames."""
    return Pose(links.p[-1], links.R[-1]) @ Pose(chain.p_tool, chain.R_tool)


def forward(chain: KinematicChain, q: Float[Array, " joints"]) -> Pose:
    """T_map_tool at joint positions q [rad, m]."""
    return tool_pose(chain, frames(chain, q))


def jacobian(chain: KinematicChain, q: Float[Array, " joints"]) -> tuple[Pose, Float[Array, "6 joints"]]:
    """T_map_tool and its geometric Jacobian: J q' = (velocity of the tool's origin, angular velocity).

    Rows as MuJoCo's mj_jacSite, in the map: three linear [m/s], three angular [rad/s].
    """
    return tool_jacobian(chain, frames(chain, q))


def tool_jacobian(chain: KinematicChain, links: Pose) -> tuple[Pose, Float[Array, "6 joints"]]:
    """`jacobian` from the chain's frames, where these are needed for more."""
    pose = tool_pose(chain, links)
    axis = links.R[..., 2]
    hinges = _hinges(chain)[:, None]
    linear = jnp.where(hinges, cross(axis, pose.p[None] - links.p), axis)
    return pose, jnp.concatenate([linear, jnp.where(hinges, axis, 0)], axis=-1).T


def arm_chain(chain: KinematicChain, q_base: Float[Array, " base"]) -> KinematicChain:
    """The chain with its first joints held at `q_base`: what remains, still seen from the map."""
    held = q_base.shape[0]
    base = KinematicChain(
        R_offset=chain.R_offset[:held],
        p_offset=chain.p_offset[:held],
        R_tool=chain.R_offset[held],
        p_tool=chain.p_offset[held],
        kinds=chain.kinds[:held],
        names=chain.names[:held],
    )
    first = forward(base, q_base)
    return KinematicChain(
        R_offset=jnp.concatenate([first.R[None], chain.R_offset[held + 1 :]]),
        p_offset=jnp.concatenate([first.p[None], chain.p_offset[held + 1 :]]),
        R_tool=chain.R_tool,
        p_tool=chain.p_tool,
        kinds=chain.kinds[held:],
        names=chain.names[held:],
    )


def with_tool(chain: KinematicChain, T_tool_new: Pose) -> KinematicChain:
    """The same joints with another tool frame, given in the present one: a camera beside the brush, say."""
    tool = Pose(chain.p_tool, chain.R_tool) @ T_tool_new
    return eqx.tree_at(lambda c: (c.p_tool, c.R_tool), chain, (tool.p, tool.R))
