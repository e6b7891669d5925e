"""Outlines lie on what was seen, in as few pieces as it has."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jaxpaint.localisation import outline_of

seeds = st.integers(0, 10_000)


def surface(outline):
    """Points of each live piece, ends left out. [pieces, 9, 2]"""
    live = np.asarray(outline.live) > 0
    start, end, normal = (np.asarray(x, float)[live] for x in (outline.start, outline.end, outline.normal))
    curvature = np.asarray(outline.curvature, float)[live, None]
    share = np.linspace(-0.45, 0.45, 9)
    chord = end - start
    length = np.linalg.norm(chord, axis=1)[:, None]
    on_chord = (start + end)[:, None] / 2 + share[None, :, None] * chord[:, None]
    depth = curvature * length**2 * (1 / 4 - share**2) / 2  # a parabola: 0.2 mm off a circle here
    return on_chord + depth[..., None] * normal[:, None]


@pytest.mark.parametrize(("name", "pieces"), [("flat", 1), ("corner", 2), ("room", 4)])
@given(seed=seeds)
def test_straight_walls_are_one_piece_each(places, name, pieces, seed):
    outline = places[name].outline(np.random.default_rng(seed))
    assert int(outline.live.sum()) == pieces
    assert places[name].gap(surface(outline)).max() < 0.006
    assert np.asarray(outline.curvature).max() == 0


@given(seed=seeds)
def test_a_column_is_pieces_of_one_circle(places, seed):
    outline = places["column"].outline(np.random.default_rng(seed))
    live = np.asarray(outline.live) > 0
    assert 4 <= live.sum() <= 8
    assert places["column"].gap(surface(outline)).max() < 0.006
    np.testing.assert_allclose(np.asarray(outline.curvature)[live], 0.5, atol=0.05)


@pytest.mark.parametrize("name", ["flat", "corner", "room", "column"])
def test_pieces_have_no_bias_and_their_sigma_is_right(places, name):
    """Over 40 surveys: the mean of the signed distance is below 1 mm, and its square what `sigma` says."""
    off, sigma = [], []
    for seed in range(40):
        outline = places[name].outline(np.random.default_rng(seed))
        live = np.asarray(outline.live) > 0
        points, normal = surface(outline), np.asarray(outline.normal, float)[live][:, None]
        step = 1e-3 * normal
        side = np.sign(places[name].gap(points + step) - places[name].gap(points - step))
        off.append((places[name].gap(points) * side).ravel())
        count = live.sum() if name == "column" else 1  # pieces of one circle share what it is wrong by
        sigma.append(np.asarray(outline.sigma, float)[live] / np.sqrt(count))
    off, sigma = np.concatenate(off), np.concatenate(sigma)
    assert abs(off.mean()) < 3e-4
    assert 0.7 < np.sqrt((off**2).mean() / (sigma**2).mean()) < 1.4


def test_without_noise_it_is_exact(places):
    for place in places.values():
        outline = place.outline()
        assert place.gap(surface(outline)).max() < 4e-4
        normal, live = np.asarray(outline.normal, float), np.asarray(outline.live) > 0
        np.testing.assert_allclose(np.linalg.norm(normal, axis=1), 1, rtol=1e-5)
        towards = (np.array(place.stand[:2]) - np.asarray(outline.start))[live]
        assert ((towards * normal[live]).sum(1) > 0).all()


def test_steps_gaps_and_clutter_part_walls(places):
    """A wall that steps back by 0.1 m, with a doorway, and a pole before it."""
    step = dataclasses.replace(
        places["flat"],
        segments=((3, -6, 3, 0), (3.1, 0, 3.1, 1.5), (3.1, 2.4, 3.1, 4)),
        discs=((2.3, -0.6, 0.06),),
    )
    outline = step.outline(np.random.default_rng(0))
    live = np.asarray(outline.live) > 0
    assert step.gap(surface(outline)).max() < 0.01
    ends = np.sort(np.concatenate([np.asarray(outline.start)[live], np.asarray(outline.end)[live]])[:, 1])
    doorway = (ends > 1.55) & (ends < 2.35)
    assert not doorway.any()
    straight = live & (np.asarray(outline.curvature) == 0)
    lengths = np.linalg.norm(np.asarray(outline.end - outline.start), axis=1)[straight]
    assert (
        lengths > 0.5
    ).sum() == 4  # the wall beside the pole on both sides, behind the step, the doorway's


def test_the_longest_are_kept(places):
    whole, two = places["room"].outline(), places["room"].outline(count=2)
    lengths = np.linalg.norm(np.asarray(whole.end - whole.start), axis=1)
    kept = np.linalg.norm(np.asarray(two.end - two.start), axis=1)
    np.testing.assert_allclose(np.sort(kept), np.sort(lengths)[-2:], rtol=1e-6)
    assert two.start.shape == (2, 2) and whole.start.shape == (32, 2)


@given(
    seed=seeds,
    shape=st.sampled_from(["nothing", "dust", "point", "few", "here"]),
)
def test_what_is_no_wall_gives_no_piece_and_no_error(seed, shape):
    rng = np.random.default_rng(seed)
    echoes = {
        "nothing": np.full((541, 2), np.nan),
        "dust": rng.uniform(-5, 5, (60, 2)),
        "point": np.ones((50, 2)),
        "few": np.array([[1.0, 0.0], [1.0, 0.1], [np.nan, 0.2]]),
        "here": np.zeros((20, 2)),
    }[shape]
    outline = outline_of(echoes, np.zeros(2))
    for leaf in (outline.start, outline.end, outline.normal, outline.sigma, outline.curvature):
        assert np.isfinite(leaf).all()
    assert float(outline.live.sum()) == 0 or shape == "dust"
    assert float(outline.sigma.min()) > 0


@pytest.mark.parametrize(
    ("change", "message"),
    [({"count": 0}, "count: 0"), ({"range_sigma": 0.0}, "range_sigma"), ({"echoes": np.zeros(4)}, "echoes")],
)
def test_wrong_input_is_named(change, message):
    given = {"echoes": np.zeros((9, 2)), "seen_from": np.zeros(2)} | change
    with pytest.raises(ValueError, match=message):
        outline_of(given.pop("echoes"), given.pop("seen_from"), **given)
