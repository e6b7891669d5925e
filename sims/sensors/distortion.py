"""A depth camera's fixed pattern: what it errs by at each pixel, the same in every picture."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

# So many waves make the standard deviation over one wide picture 1.00 +- 0.04; the cost grows with them.
_WAVES = 16


def distortion_field(
    shape: tuple[int, int],
    spacing: int,
    length: Float[Array, ""],
    seed: Int[Array, ""],
    *,
    dtype,
) -> Float[Array, "height width"]:
    """A smooth field of variance one with correlation exp(-(d / length)^2 / 2), the same for the same seed.

    spacing: how many pixels of the full sensor lie between two of the field's; length is in the former.
    A sum of random plane waves, whose wave numbers follow the spectrum of that correlation (Rahimi and Recht,
    Random features for large-scale kernel machines, 2007). The cosine of a sum of angles is two products, so
    the whole field is one thin matrix product and lengths far beyond the picture cost no more.
    """
    wave_key, phase_key = jax.random.split(jax.random.key(seed))
    # The floor keeps 0 / 0 out; the field is then rough and still finite.
    wave = jax.random.normal(wave_key, (2, _WAVES), dtype) / jnp.maximum(length, 1.0).astype(dtype)
    phase = 2 * jnp.pi * jax.random.uniform(phase_key, (_WAVES,), dtype)
    # cos(a + b) = cos a cos b - sin a sin b, with sines as cosines a quarter turn on.
    quarter = jnp.repeat(jnp.asarray([0.0, 0.5 * jnp.pi], dtype), _WAVES)
    wave, phase = jnp.tile(wave, 2), jnp.tile(phase, 2)
    left = jnp.cos(_angles(shape[0], spacing, wave[0], phase + quarter))
    right = jnp.cos(_angles(shape[1], spacing, wave[1], -quarter))
    return jnp.sqrt(2 / _WAVES).astype(dtype) * (left @ right.T)


def _angles(
    size: int, spacing: int, wave: Float[Array, "waves"], phase: Float[Array, "waves"]
) -> Float[Array, "size waves"]:
    """Angles of waves along an axis [rad].

    As a product of matrices, which XLA does not fuse: it would draw the random waves again for every pixel.
    Exact, because products on GPUs would round to TF32 (1e-3).
    """
    place = spacing * jnp.arange(size, dtype=wave.dtype)
    terms = jnp.stack([place, jnp.ones_like(place)], axis=1)
    return jnp.matmul(terms, jnp.stack([wave, phase]), precision=jax.lax.Precision.HIGHEST)
