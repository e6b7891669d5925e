"""Rotation matrices, written as sums of products so that they vectorise over worlds."""

import jax.numpy as jnp
from jax import lax
from jaxtyping import Array, Float


def rotate(R: Float[Array, "3 3"], v: Float[Array, "3"]) -> Float[Array, "3"]:
    """R v."""
    return R[:, 0] * v[0] + R[:, 1] * v[1] + R[:, 2] * v[2]


def compose(R_a_b: Float[Array, "3 3"], R_b_c: Float[Array, "3 3"]) -> Float[Array, "3 3"]:
    """R_a_c, the product of the two."""
    return R_a_b[:, :1] * R_b_c[:1] + R_a_b[:, 1:2] * R_b_c[1:2] + R_a_b[:, 2:] * R_b_c[2:]


def transpose(R: Float[Array, "3 3"]) -> Float[Array, "3 3"]:
    """The inverse rotation."""
    return R.T


def cross(a: Float[Array, "*shape"], b: Float[Array, "*shape"], axis: int = -1) -> Float[Array, "*shape"]:
    """The vector products along an axis of length 3."""
    (ax, ay, az), (bx, by, bz) = _components(a, axis), _components(b, axis)
    return jnp.stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx], axis=axis)


def _components(v, axis: int):
    return (lax.index_in_dim(v, k, axis, keepdims=False) for k in range(3))


def frame_from_axis(z: Float[Array, "3"], x_hint: Float[Array, "3"]) -> Float[Array, "3 3"]:
    """The rotation whose z axis is the unit vector `z` and whose x axis is `x_hint` made orthogonal to it.

    For a brush: z = -normal, x_hint = the canvas's u axis. Undefined where the two are parallel (then x is
    0).
    """
    x = x_hint - z * (z * x_hint).sum()
    square = (x * x).sum()
    safe = jnp.where(square > 0, square, 1)
    x = jnp.where(square > 0, x / jnp.sqrt(safe), 0)
    return jnp.stack([x, cross(z, x), z], axis=-1)


def swing_twist(R: Float[Array, "3 3"]) -> Float[Array, "3"]:
    """The rotation vector (x, y) that swings the z axis into place, and the turn about z left after it [rad].

    R = exp([x, y, 0]) exp([0, 0, turn]). Singular only for a swing of pi, where the direction is undefined
    and 0 is returned.
    """
    x, y, cosine = -R[1, 2], R[0, 2], R[2, 2]
    square = x * x + y * y
    safe = jnp.where(square > 0, square, 1)  # the root's gradient is infinite at zero swing
    sine = jnp.sqrt(safe)
    scale = jnp.where(square > 0, jnp.arctan2(sine, cosine) / sine, 1)
    numerator, denominator = R[1, 0] - R[0, 1], R[0, 0] + R[1, 1]
    undefined = (numerator == 0) & (denominator == 0)
    turn = jnp.arctan2(jnp.where(undefined, 0, numerator), jnp.where(undefined, 1, denominator))
    return jnp.stack([x * scale, y * scale, turn])


def exponential(w: Float[Array, "3"]) -> Float[Array, "3 3"]:
    """The rotation by |w| [rad] about w (Rodrigues)."""
    square = (w * w).sum()
    safe = jnp.where(square > 0, square, 1)
    angle = jnp.sqrt(safe)
    small = square < 1e-8  # below, the series is exact to rounding, in float32 as in float64
    a = jnp.where(small, 1 - square / 6, jnp.sin(angle) / angle)
    b = jnp.where(small, 0.5 - square / 24, 2 * jnp.sin(angle / 2) ** 2 / safe)
    zero = jnp.zeros_like(square)
    x, y, z = w[0], w[1], w[2]
    skew = jnp.stack([jnp.stack([zero, -z, y]), jnp.stack([z, zero, -x]), jnp.stack([-y, x, zero])])
    return jnp.eye(3, dtype=w.dtype) + a * skew + b * compose(skew, skew)


def rotation_from_quaternion(q: Float[Array, "4"]) -> Float[Array, "3 3"]:
    """The rotation of a quaternion (w, x, y, z), normalised here."""
    w, x, y, z = q / jnp.sqrt((q * q).sum())
    return jnp.stack(
        [
            jnp.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)]),
            jnp.stack([2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)]),
            jnp.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]),
        ]
    )


def quaternion_from_rotation(R: Float[Array, "3 3"]) -> Float[Array, "4"]:
    """The unit quaternion (w, x, y, z) with w >= 0 of a rotation."""
    d = jnp.stack([R[0, 0], R[1, 1], R[2, 2]])
    square = 1 + jnp.stack([d[0] + d[1] + d[2], d[0] - d[1] - d[2], d[1] - d[0] - d[2], d[2] - d[0] - d[1]])
    a, b, c = R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]
    e, f, g = R[1, 0] + R[0, 1], R[0, 2] + R[2, 0], R[2, 1] + R[1, 2]
    rows = jnp.stack(
        [
            jnp.stack([square[0], a, b, c]),
            jnp.stack([a, square[1], e, f]),
            jnp.stack([b, e, square[2], g]),
            jnp.stack([c, f, g, square[3]]),
        ]
    )
    q = rows[jnp.argmax(square)]  # the largest component: each row is q times four of its own entry
    q = q / jnp.sqrt((q * q).sum())
    return jnp.where(q[0] < 0, -q, q)
