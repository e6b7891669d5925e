"""Footprints of brush and spray."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from sims.paint import Brush, Contact, Spray, window_cells

RATE = jax.jit(lambda tool, du, dv, held: tool.rate(du, dv, held))


def pressed(height=0.0, lean=(0.0, 0.0), speed=0.03, pen=1.0):
    parts = (jnp.zeros(2), height, lean, speed, 1.0, pen)
    return Contact(*(jnp.asarray(part) for part in parts))


def across(tool, held, offsets):
    """Growth of the film along u."""
    u = jnp.asarray(offsets)
    return np.asarray(RATE(tool, u, jnp.zeros_like(u), held))


def stroke(tool, held, y, speed, steps=4001):
    """Film [m] that a pass along u at this speed leaves at distance y from the centre-line."""
    reach = tool.reach()
    u = jnp.linspace(-reach, reach, steps)
    rates = np.asarray(RATE(tool, u, jnp.full_like(u, y), held))
    return float(np.trapezoid(rates, np.asarray(u)) / speed)


@pytest.mark.parametrize("radius", [0.005, 0.010, 0.02])
def test_brush_lays_its_film_in_one_pass(radius):
    brush = Brush(radius=radius)
    assert stroke(brush, pressed(), 0.0, 0.03) == pytest.approx(60e-6, rel=0.01)


def test_brush_wets_a_narrow_rim_beyond_its_radius():
    brush = Brush()
    widths = np.linspace(0.009, 0.014, 101)
    films = np.asarray([stroke(brush, pressed(), y, 0.03) for y in widths])
    painted = widths[films >= 0.2 * 60e-6].max()
    assert 0.011 < painted < 0.012


def test_brush_is_flat_inside_and_ends_at_its_reach():
    brush = Brush()
    rates = across(brush, pressed(), [0.0, 0.005, 0.0099, 0.0115, 0.0131])
    np.testing.assert_allclose(rates[:3], rates[0], rtol=1e-3)
    assert 0 < rates[3] < rates[0]
    assert rates[4] == 0
    squeezed = pressed(height=-0.02)
    assert (across(brush, squeezed, [brush.reach(), -brush.reach()]) == 0).all()


def test_brush_loses_contact_when_lifted_by_its_compression():
    brush = Brush(compression=0.006)
    middle = [float(across(brush, pressed(h), [0.0])[0]) for h in (-0.004, 0.0, 0.0045, 0.0055, 0.0061)]
    assert middle[0] == middle[1] > middle[2] > middle[3] > middle[4] == 0


def test_contact_grows_with_pressure_within_the_ferrule():
    radii = [float(Brush().contact_radius(jnp.asarray(h))) for h in (0.005, 0.0, -0.003, -0.1)]
    assert radii == sorted(radii)
    assert radii[1] == pytest.approx(0.010)
    assert radii[2] == pytest.approx(0.010 + 0.5 * 0.003, rel=0.05)
    assert radii[3] == pytest.approx(0.012, rel=1e-3)


def test_leaning_brush_lifts_the_side_it_leans_to():
    brush = Brush(compression=0.006)
    far, near = across(brush, pressed(lean=(0.6, 0.0)), [0.0085, -0.0085])
    assert far < 0.9 * near
    upright = across(brush, pressed(), [0.0105])
    assert across(brush, pressed(lean=(0.6, 0.0)), [-0.0105])[0] < upright[0], "shortened along the lean"


def test_valve_and_shear():
    dipped, fed = Brush(), Brush(valve=1.0)
    assert across(dipped, pressed(pen=0.0), [0.0])[0] > 0
    assert across(fed, pressed(pen=0.0), [0.0])[0] == 0
    sheared = Brush(shear=1.0)
    slow, fast = (across(sheared, pressed(speed=v), [0.0])[0] for v in (0.03, 0.06))
    assert fast == pytest.approx(2 * slow)
    assert slow == pytest.approx(across(dipped, pressed(), [0.0])[0])


def volume(spray, held):
    u = jnp.linspace(-spray.reach(), spray.reach(), 601)
    rates = np.asarray(RATE(spray, u[None, :], u[:, None], held))
    return rates.sum() * float(u[1] - u[0]) ** 2, np.asarray(u), rates


@pytest.mark.parametrize("height", [-0.05, 0.0, 0.05])
def test_spray_keeps_its_volume_at_any_stand_off(height):
    spray = Spray()
    total, _, rates = volume(spray, pressed(height))
    assert total == pytest.approx(float(spray.flow), rel=0.02)
    assert float(spray.area(pressed(height))) == pytest.approx(float(spray.flow) / rates.max(), rel=0.01)


def test_spray_lays_its_film_and_widens_with_distance():
    spray = Spray()
    assert stroke(spray, pressed(), 0.0, 0.03) == pytest.approx(60e-6, rel=0.1)
    spreads = []
    for height in (0.0, 0.05):
        _, u, rates = volume(spray, pressed(height))
        spreads.append(np.sqrt((rates.sum(0) * u**2).sum() / rates.sum()))
    assert spreads[1] / spreads[0] == pytest.approx(1.25, rel=0.01)


def test_spray_wanders_with_the_lean_and_obeys_the_pen():
    spray = Spray()
    _, u, rates = volume(spray, pressed(lean=(0.2, 0.0)))
    assert (rates.sum(0) * u).sum() / rates.sum() == pytest.approx(0.04, rel=0.02)
    assert volume(spray, pressed(pen=0.0))[0] == 0


def test_window_holds_the_reach():
    for radius in (0.004, 0.01, 0.025):
        brush = replace(Brush(), radius=jnp.asarray(radius))
        cell = radius / 5
        cells = window_cells(brush, cell)
        assert cells % 2 == 1
        assert (cells // 2 - 0.5 + 1e-4) * cell >= brush.reach()
        assert (cells // 2 - 1.5 - 1e-4) * cell < brush.reach()
