"""What a stereo depth camera adds to the truth, after Intel's D435."""

from dataclasses import replace
from typing import Self

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int, PRNGKeyArray

from sims.parameters import scalar
from sims.sensors.camera import Camera
from sims.sensors.distortion import distortion_field
from sims.sensors.rgbd import RGBD


def _seed(value: Array | int) -> Array:
    return jnp.asarray(value, jnp.int32)


class DepthNoise(eqx.Module):
    """Parameters of the errors; pixels are those of the full sensor, before decimation. See docs/sensors.md.

    disparity_sigma: standard deviation of the disparity [px]; depth errs by z^2 sigma / (f b). Intel's tuning
        guide gives 0.08 px on well-textured surfaces. All of it is taken as random here, the harder choice: a
        fixed part would go with calibration. Fitted to a real Kinect: 0.053 px.
    correlation: length of the error's correlation exp(-(d / length)^2 / 2) [px], fitted to planes in pictures
        of a real Kinect (`sims.sensors.noise_fit`, `jaxpaint reproduce sensor-noise`). Neighbours share their
        matching window, which spans as many pixels in both cameras, 7 to 9, so it is not scaled.
    quantum: step in which the disparity is delivered [px]; the D4 chip works in 1/32 px, a Kinect in 1/8 px.
    distortion, distortion_length, distortion_seed: standard deviation [px] of a smooth error that is the same
        in all pictures of one camera, the length of its correlation exp(-(d / length)^2 / 2) [px], and which
        camera it is. Calibration removes it: 0 here. A real Kinect that nobody calibrated has about 0.06 px
        and 20 px.
    edge_step: relative jump of inverse depth between neighbouring pixels that counts as a depth edge [1].
    flying: share of the pixels at a depth edge that take a value between its two sides [1].
    grazing, grazing_width: angle of incidence at which half of the pixels are lost, and the scale of that
        transition [rad]: the pattern on a surface seen edge-on is foreshortened differently in both eyes.
    dark, dark_width: luminance (0 to 1) at which half of the pixels are lost, and its scale [1]: dark paint
        returns too little of the projected infrared pattern.
    """

    disparity_sigma: Float[Array, ""] = eqx.field(converter=scalar, default=0.08)
    correlation: Float[Array, ""] = eqx.field(converter=scalar, default=3.1)
    quantum: Float[Array, ""] = eqx.field(converter=scalar, default=1 / 32)
    distortion: Float[Array, ""] = eqx.field(converter=scalar, default=0.0)
    distortion_length: Float[Array, ""] = eqx.field(converter=scalar, default=20.0)
    distortion_seed: Int[Array, ""] = eqx.field(converter=_seed, default=0)
    edge_step: Float[Array, ""] = eqx.field(converter=scalar, default=0.03)
    flying: Float[Array, ""] = eqx.field(converter=scalar, default=0.5)
    grazing: Float[Array, ""] = eqx.field(converter=scalar, default=1.37)
    grazing_width: Float[Array, ""] = eqx.field(converter=scalar, default=0.03)
    dark: Float[Array, ""] = eqx.field(converter=scalar, default=0.03)
    dark_width: Float[Array, ""] = eqx.field(converter=scalar, default=0.008)

    @classmethod
    def zero(cls) -> Self:
        """No error of any kind."""
        off = cls(disparity_sigma=0.0, correlation=0.0, quantum=0.0, flying=0.0)
        # Thresholds that no pixel passes.
        return replace(off, grazing=scalar(10.0), dark=scalar(-10.0))


def observe(rgbd: RGBD, camera: Camera, noise: DepthNoise, *, key: PRNGKeyArray) -> RGBD:
    """The picture as the camera delivers it: flying pixels, distortion, disparity noise, quantisation, holes.

    The key is this picture's; the distortion is the camera's and has its seed in `noise`.
    """
    mix_key, disparity_key, hole_key = jax.random.split(key, 3)
    inverse = _mix_at_edges(rgbd, noise, mix_key)
    disparity_per_inverse = camera.fx * camera.decimation * camera.baseline
    field = correlated_normal(
        (camera.height, camera.width),
        noise.correlation / camera.decimation,
        key=disparity_key,
        dtype=rgbd.depth.dtype,
    )
    pattern = distortion_field(
        (camera.height, camera.width),
        camera.decimation,
        noise.distortion_length,
        noise.distortion_seed,
        dtype=rgbd.depth.dtype,
    )
    disparity = disparity_per_inverse * inverse + noise.disparity_sigma * field + noise.distortion * pattern
    disparity = _quantise(disparity, noise.quantum)
    seen = rgbd.valid & (disparity > 0)
    depth = disparity_per_inverse / jnp.where(seen, disparity, 1)
    seen &= (depth >= camera.near) & (depth <= camera.far) & ~_holes(rgbd, noise, hole_key)
    return RGBD(
        depth=jnp.where(seen, depth, 0),
        colour=jnp.where(seen[..., None], rgbd.colour, 0),
        incidence=rgbd.incidence,
        valid=seen,
    )


def correlated_normal(
    shape: tuple[int, int], length: Float[Array, ""], *, key: PRNGKeyArray, dtype
) -> Float[Array, "height width"]:
    """A standard normal field with correlation exp(-(d / length)^2 / 2), d and length in pixels; 0 is white.

    Two dense products with banded matrices: on CPUs faster than a separable convolution, and any length is
    possible without a static kernel size. Rows have unit norm, so the variance is one up to the border.
    """
    white = jax.random.normal(key, shape, dtype)
    return _smoother(shape[0], length, dtype) @ white @ _smoother(shape[1], length, dtype).T


def _smoother(size: int, length: Float[Array, ""], dtype) -> Float[Array, "size size"]:
    steps = jnp.arange(size, dtype=dtype)
    squares = (steps[:, None] - steps[None, :]) ** 2
    # A kernel of exp(-(d/l)^2) correlates with itself as exp(-(d/l)^2 / 2). The floor keeps 0 / 0 out.
    weights = jnp.exp(-squares / jnp.maximum(length, 1e-2).astype(dtype) ** 2)
    return weights / jnp.sqrt((weights * weights).sum(1, keepdims=True))


def _quantise(disparity: Float[Array, "*image"], quantum: Float[Array, ""]) -> Float[Array, "*image"]:
    step = jnp.where(quantum > 0, quantum, 1)
    return jnp.where(quantum > 0, jnp.round(disparity / step) * step, disparity)


def _mix_at_edges(rgbd: RGBD, noise: DepthNoise, key: PRNGKeyArray) -> Float[Array, "height width"]:
    """Inverse depth, with a share of the pixels at depth edges moved between the two sides."""
    inverse = jnp.where(rgbd.valid, 1 / jnp.where(rgbd.valid, rgbd.depth, 1), 0)
    edge, low, high = _edges(inverse, rgbd.valid, noise.edge_step)
    # One draw decides and, rescaled, says how far between the sides.
    draw = jax.random.uniform(key, inverse.shape, inverse.dtype)
    between = low + draw / jnp.maximum(noise.flying, 1e-6) * (high - low)
    return jnp.where(edge & (draw < noise.flying), between, inverse)


def _edges(
    inverse: Float[Array, "height width"], valid: Bool[Array, "height width"], step: Float[Array, ""]
) -> tuple[Bool[Array, "height width"], Float[Array, "height width"], Float[Array, "height width"]]:
    """Where inverse depth jumps, with the lowest and highest value around.

    The second difference is used because inverse depth is linear over a plane, however slanted it is.
    """
    edge, low, high = jnp.zeros_like(valid), inverse, inverse
    for axis in (0, 1):
        before, after = jnp.roll(inverse, 1, axis), jnp.roll(inverse, -1, axis)
        whole = valid & jnp.roll(valid, 1, axis) & jnp.roll(valid, -1, axis) & _inside(valid.shape, axis)
        jump = whole & (jnp.abs(before - 2 * inverse + after) > step * inverse)
        edge |= jump
        low = jnp.where(jump, jnp.minimum(low, jnp.minimum(before, after)), low)
        high = jnp.where(jump, jnp.maximum(high, jnp.maximum(before, after)), high)
    return edge, low, high


def _inside(shape: tuple[int, ...], axis: int) -> Bool[Array, "height width"]:
    """False on the two border lines across `axis`, where a rolled image wraps around."""
    index = jnp.arange(shape[axis])
    inside = (index > 0) & (index < shape[axis] - 1)
    return jnp.broadcast_to(inside[:, None] if axis == 0 else inside[None, :], shape)


def _holes(rgbd: RGBD, noise: DepthNoise, key: PRNGKeyArray) -> Bool[Array, "height width"]:
    """Pixels without a value, because the surface is seen edge-on or is too dark."""
    angle = jnp.arccos(jnp.clip(rgbd.incidence, 0, 1))
    luminance = 0.299 * rgbd.colour[..., 0] + 0.587 * rgbd.colour[..., 1] + 0.114 * rgbd.colour[..., 2]
    kept = jax.nn.sigmoid((noise.grazing - angle) / noise.grazing_width)
    kept *= jax.nn.sigmoid((luminance - noise.dark) / noise.dark_width)
    return jax.random.uniform(key, kept.shape, kept.dtype) >= kept
