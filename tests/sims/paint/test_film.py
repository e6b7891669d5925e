"""The film at points, held against the grid."""

import jax
import jax.numpy as jnp
import numpy as np

from sims.paint import Brush, Contact, Paint, PaintGrid, deposit, film_at, window_cells


def contacts(count=12):
    rng = np.random.default_rng(0)
    uv = np.stack([np.linspace(-0.05, 0.05, count), 0.01 * rng.normal(size=count)], axis=1)
    one = np.ones(count)
    return Contact(
        uv=jnp.asarray(uv),
        height=jnp.asarray(0.001 * rng.normal(size=count)),
        lean=jnp.asarray(0.05 * rng.normal(size=(count, 2))),
        speed=jnp.asarray(0.03 * one),
        duration=jnp.asarray(0.08 * one),
        pen=jnp.asarray(one),
    )


def test_is_what_a_grid_has_there(x64):
    grid = PaintGrid.covering(jnp.asarray([-0.1, -0.05]), jnp.asarray([0.1, 0.05]), 0.002)
    brush = Brush(radius=0.01)
    laid = deposit(Paint.bare(grid), brush, grid, contacts(), window=window_cells(brush, 0.002)).thickness
    points = grid.centres().reshape(-1, 2)
    np.testing.assert_allclose(film_at(brush, contacts(), points).reshape(laid.shape), laid, atol=1e-12)
    assert float(laid.max()) > 1e-6


def test_has_gradients_to_every_field(x64):
    points = jnp.asarray([[0.0, 0.004], [0.02, -0.009]])

    def error(found):
        return (film_at(Brush(radius=0.01), found, points) ** 2).sum() * 1e9

    slope = jax.grad(error)(contacts())
    for name in ("uv", "height", "lean", "speed", "duration"):
        assert np.isfinite(getattr(slope, name)).all(), name
    step = 1e-7
    up, down = (
        contacts().__class__(**{**vars(contacts()), "uv": contacts().uv.at[5, 1].add(s)})
        for s in (step, -step)
    )
    np.testing.assert_allclose((error(up) - error(down)) / (2 * step), slope.uv[5, 1], rtol=1e-4)


def test_broken_contacts_lay_nothing():
    broken = jax.tree.map(lambda x: x.at[0].set(jnp.nan), contacts(1))
    assert float(film_at(Brush(), broken, jnp.zeros((3, 2))).max()) == 0.0
