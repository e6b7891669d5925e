"""Deposition in windows against the definition on the whole grid."""

from dataclasses import replace
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from sims.paint import Brush, Contact, Paint, PaintGrid, deposit, window_cells

CELL = 0.002
STEPS = 60
WINDOW = 17  # what `window_cells` gives for the default brush
DEPOSIT = jax.jit(partial(deposit, window=WINDOW))


def wiggle(steps, seed=0):
    """A brush that wanders over, and past the border of, the grid below."""
    rng = np.random.default_rng(seed)
    t = np.linspace(0, 1, steps)
    return Contact(
        uv=jnp.asarray(np.stack([0.14 * t - 0.01, 0.05 + 0.06 * np.sin(7 * t)], axis=-1)),
        height=jnp.asarray(rng.uniform(-0.003, 0.007, steps)),
        lean=jnp.asarray(rng.uniform(-0.2, 0.2, (steps, 2))),
        speed=jnp.asarray(rng.uniform(0.02, 0.04, steps)),
        duration=jnp.asarray(rng.uniform(0.05, 0.1, steps)),
        pen=jnp.ones(steps),
    )


def small_grid():
    return PaintGrid.covering(np.asarray([0.0, 0.0]), np.asarray([0.12, 0.1]), CELL)


def lay(contacts, brush, grid, *, paint=None):
    """`deposit`, compiled once for all tests: contacts are padded with ones that last no time."""
    missing = STEPS - len(contacts.pen)
    padded = jax.tree.map(lambda x: jnp.pad(x, [(0, missing)] + [(0, 0)] * (x.ndim - 1)), contacts)
    return DEPOSIT(Paint.bare(grid) if paint is None else paint, brush, grid, padded)


@jax.jit
def by_definition(contacts, brush, grid):
    """Every contact on every cell."""
    offset = grid.centres() - contacts.uv[:, None, None, :]
    rate = jax.vmap(lambda d, c: brush.rate(d[..., 0], d[..., 1], c))(offset, contacts)
    return (rate * contacts.duration[:, None, None]).sum(0)


def test_windows_lose_nothing_not_even_at_the_border():
    assert window_cells(Brush(), CELL) == WINDOW
    grid, contacts = small_grid(), wiggle(60)
    thickness = np.asarray(lay(contacts, Brush(), grid).thickness)
    expected = np.asarray(by_definition(contacts, Brush(), grid))
    assert expected.max() > 10e-6
    assert (expected[0] > 0).any(), "the path crosses the border"
    np.testing.assert_allclose(thickness, expected, atol=1e-5 * expected.max())


def test_grid_smaller_than_the_window():
    grid = PaintGrid.covering(np.asarray([0.05, 0.04]), np.asarray([0.056, 0.08]), CELL)
    contacts = wiggle(60)
    expected = by_definition(contacts, Brush(), grid)
    np.testing.assert_allclose(lay(contacts, Brush(), grid).thickness, expected, atol=1e-10)


def test_run_in_parts_is_the_run():
    grid, contacts = small_grid(), wiggle(40)
    first, second = (
        jax.tree.map(lambda x, part=part: x[part], contacts) for part in (np.s_[:15], np.s_[15:])
    )
    parts = lay(second, Brush(), grid, paint=lay(first, Brush(), grid))
    whole = lay(contacts, Brush(), grid)
    np.testing.assert_allclose(parts.thickness, whole.thickness, rtol=1e-4, atol=1e-12)
    np.testing.assert_allclose(parts.stray, whole.stray, rtol=1e-4)


def test_colours_lie_on_sheets_of_their_own():
    grid, contacts = small_grid(), wiggle(STEPS)
    colour = jnp.asarray(np.arange(STEPS) * 3 // STEPS)
    sheets = jax.jit(partial(deposit, window=WINDOW))(
        Paint.bare(grid, 3), Brush(), grid, contacts, colour=colour
    )
    assert sheets.thickness.shape == (3, *grid.shape)
    for number, sheet in enumerate(sheets.thickness):
        own = replace(contacts, duration=jnp.where(colour == number, contacts.duration, 0))
        np.testing.assert_allclose(sheet, lay(own, Brush(), grid).thickness, rtol=1e-5, atol=1e-12)
    np.testing.assert_allclose(sheets.stray, lay(contacts, Brush(), grid).stray, rtol=1e-5)


def test_broken_contacts_lay_nothing():
    grid, contacts = small_grid(), wiggle(6)
    broken = replace(contacts, uv=contacts.uv.at[1].set(jnp.nan), height=contacts.height.at[2].set(jnp.inf))
    kept = jax.tree.map(lambda x: x[np.asarray([0, 3, 4, 5])], contacts)
    np.testing.assert_allclose(
        lay(broken, Brush(), grid).thickness, lay(kept, Brush(), grid).thickness, atol=1e-12
    )


def test_paint_past_the_grid_is_counted():
    grid = small_grid()
    outside = replace(
        jax.tree.map(lambda x: x[:3], wiggle(3)),
        uv=jnp.asarray([[0.3, 0.05], [0.05, -1.0], [0.05, 0.05]]),
        height=jnp.zeros(3),
        lean=jnp.zeros((3, 2)),
        duration=jnp.full(3, 0.5),
    )
    laid = lay(outside, Brush(), grid)
    one_contact = float(laid.thickness.sum()) * CELL**2
    assert one_contact > 0
    assert float(laid.stray) == pytest.approx(2 * one_contact, rel=0.02)
    assert float(lay(jax.tree.map(lambda x: x[2:], outside), Brush(), grid).stray) == 0


def test_paint_far_outside_is_harmless():
    far = jax.tree.map(lambda x: x[:1], replace(wiggle(1), uv=jnp.full((1, 2), 1e30)))
    laid = lay(far, Brush(), small_grid())
    assert (np.asarray(laid.thickness) == 0).all()
    assert np.isfinite(laid.stray)


def test_gradients_agree_with_central_differences(x64):
    grid, contacts, brush = small_grid(), wiggle(8, seed=3), Brush(shear=0.3, valve=0.4)
    weights = jnp.asarray(np.random.default_rng(1).normal(size=grid.shape)) * 1e6

    @jax.jit
    def objective(contacts, brush):
        laid = deposit(Paint.bare(grid), brush, grid, contacts, window=WINDOW).thickness
        return (weights * laid).sum() + (laid * 1e6 * laid * 1e6).sum()

    gradient = jax.jit(jax.grad(objective, argnums=(0, 1)))(contacts, brush)
    assert all(np.isfinite(leaf).all() for leaf in jax.tree.leaves(gradient))
    rng = np.random.default_rng(2)
    for _ in range(5):
        way = jax.tree.map(lambda x: jnp.asarray(rng.normal(size=x.shape)) * _size(x), (contacts, brush))
        ahead, behind = (
            objective(*jax.tree.map(lambda x, w, h=h: x + h * w, (contacts, brush), way))
            for h in (1e-7, -1e-7)
        )
        slope = sum(
            (g * w).sum() for g, w in zip(jax.tree.leaves(gradient), jax.tree.leaves(way), strict=True)
        )
        assert float(slope) == pytest.approx(float((ahead - behind) / 2e-7), rel=1e-4)


def _size(x):
    """Steps in proportion to what they change."""
    return jnp.maximum(jnp.abs(x).max(), 1e-3)


def test_brush_radius_reaches_the_paint_by_its_gradient(x64):
    grid, contacts = small_grid(), wiggle(20)

    @jax.jit
    def area(radius):
        laid = deposit(Paint.bare(grid), Brush(radius=radius), grid, contacts, window=WINDOW)
        return laid.thickness.sum()

    radius = jnp.asarray(0.010)
    slope = (area(radius + 1e-7) - area(radius - 1e-7)) / 2e-7
    assert float(jax.jit(jax.grad(area))(radius)) == pytest.approx(float(slope), rel=1e-5)
    assert slope > 0
