"""A depth camera's fixed pattern: what it errs by at each pixel, the same in every picture."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

# So many waves make a field whose variance is within some percent of one; the cost grows with them.
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
    row, column = (spacing * jnp.arange(size, dtype=dtype)[:, None] for size in shape)
    down, across = row * wave[0] + phase, column * wave[1]
    left = jnp.concatenate([jnp.cos(down), -jnp.sin(down)], axis=1)
    right = jnp.concatenate([jnp.cos(across), jnp.sin(across)], axis=1)
    return jnp.sqrt(2 / _WAVES).astype(dtype) * (left @ right.T)
