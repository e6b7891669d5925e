"""Bodies and rays: where they meet, from which side, and that gradients survive a miss."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from sims.scenes import (
    Box,
    Bricks,
    Checker,
    CylinderPatch,
    Floor,
    HeightField,
    HeightMap,
    Plain,
    Plaster,
    Post,
    Rectangle,
    Sphere,
    Wood,
)


def _numbers(*values):
    return jnp.asarray(values, dtype=float)


def _grey():
    return Plain(_numbers(0.5, 0.6, 0.7))


def _tilt():
    """A rotation whose third axis points to -x and up."""
    normal = np.array([-0.8, 0.36, 0.48])
    right = np.cross([0, 0, 1.0], normal)
    right /= np.linalg.norm(right)
    return jnp.asarray(np.stack([right, np.cross(normal, right), normal], axis=1))


def _field(steps=64):
    """A wavy sheet, captured all over."""
    v, u = np.indices((60, 80))
    depth = 0.05 * np.sin(0.15 * u) * np.cos(0.12 * v)
    surface = HeightMap(
        jnp.asarray(depth),
        jnp.ones(depth.shape, dtype=bool),
        jnp.asarray(-0.8),
        jnp.asarray(0.4),
        jnp.asarray(0.02),
    )
    nowhere = jnp.zeros(depth.shape, dtype=bool)
    return HeightField(surface, jnp.asarray(-0.06), jnp.asarray(0.06), _grey(), nowhere, steps)


BODIES = {
    "rectangle": lambda: Rectangle(_numbers(0, 0, 1), _tilt(), _numbers(0.6, 0.4), _grey()),
    "box": lambda: Box(_numbers(0.3, 0, 1), _tilt(), _numbers(0.3, 0.2, 0.25), _grey()),
    "sphere": lambda: Sphere(_numbers(0.4, 0.1, 1.0), jnp.asarray(0.4), _grey()),
    "cylinder": lambda: CylinderPatch(
        _numbers(0.5, 0, 0.2), jnp.asarray(0.1), jnp.asarray(0.5), jnp.asarray(1.2), jnp.asarray(1.6), _grey()
    ),
    "post": lambda: Post(_numbers(0.3, 0, 0.4), jnp.asarray(0.35), jnp.asarray(0.7), _grey()),
    "floor": lambda: Floor(jnp.asarray(0.1), _grey()),
    "field": _field,
}


@jax.jit
def _cast(body, origins, directions):
    return jax.vmap(body.intersect)(origins, directions)


def _rays(count=100):
    generator = np.random.default_rng(8)
    origins = generator.uniform([-1.6, -0.5, 0.5], [-1.0, 0.5, 1.6], (count, 3))
    targets = generator.uniform([0, -0.7, 0.0], [0.4, 0.7, 1.8], (count, 3))
    directions = targets - origins
    return jnp.asarray(origins), jnp.asarray(directions / np.linalg.norm(directions, axis=1, keepdims=True))


@jax.jit
def _depths(surface, uv):
    return jax.vmap(lambda at: surface.evaluate(at)[0])(uv)


def _signed_distance(kind, body, points):
    """How far points are outside the body's surface, written down afresh [m]."""
    if kind in ("rectangle", "box"):
        local = (points - np.asarray(body.center)) @ np.asarray(
            body.R_map_plate if kind == "rectangle" else body.R_map_box
        )
        return local[:, 2] if kind == "rectangle" else np.max(np.abs(local) - np.asarray(body.half), axis=1)
    if kind == "sphere":
        return np.linalg.norm(points - np.asarray(body.center), axis=1) - float(body.radius)
    if kind == "cylinder":
        return np.linalg.norm((points - np.asarray(body.foot))[:, :2], axis=1) - float(body.radius)
    if kind == "post":
        local = points - np.asarray(body.foot)
        half = 0.5 * float(body.height)
        return np.maximum(np.hypot(*local[:, :2].T) - float(body.radius), np.abs(local[:, 2] - half) - half)
    if kind == "floor":
        return points[:, 2] - float(body.height)
    uv = jnp.asarray(np.stack([-points[:, 1], points[:, 2]], axis=1))
    return np.asarray(_depths(body.surface, uv)) - points[:, 0]


@pytest.mark.parametrize("kind", BODIES)
def test_hits_lie_on_the_surface_and_nothing_is_crossed_before(x64, strict_ranks, kind):
    body = BODIES[kind]()
    origins, directions = _rays()
    hits = _cast(body, origins, directions)
    met = np.asarray(hits.valid)
    assert 0.1 < met.mean() < 1.0 or kind == "field"
    assert met.any()
    points = np.asarray(origins + hits.distance[:, None] * directions)[met]
    np.testing.assert_allclose(_signed_distance(kind, body, points), 0.0, atol=1e-9)
    assert np.all(np.sum(np.asarray(hits.normal * directions)[met], axis=1) < 0)
    for share in np.linspace(0.0, 0.98, 50):
        before = np.asarray(origins)[met] + share * (points - np.asarray(origins)[met])
        assert np.all(_signed_distance(kind, body, before) > 0)
    assert np.all(np.isinf(np.asarray(hits.distance)[~met]))
    np.testing.assert_allclose(np.asarray(hits.colour)[met], np.tile([0.5, 0.6, 0.7], (met.sum(), 1)))


@pytest.mark.parametrize("kind", BODIES)
def test_normals_are_gradients_of_distance_to_the_surface(x64, strict_ranks, kind):
    body = BODIES[kind]()
    origins, directions = _rays()
    hits = _cast(body, origins, directions)
    met = np.asarray(hits.valid)
    points = np.asarray(origins + hits.distance[:, None] * directions)[met]
    slope = np.stack(
        [
            _signed_distance(kind, body, points + step) - _signed_distance(kind, body, points - step)
            for step in 1e-6 * np.eye(3)
        ],
        axis=1,
    )
    slope /= np.linalg.norm(slope, axis=1, keepdims=True)
    np.testing.assert_allclose(np.asarray(hits.normal)[met], slope, atol=1e-4)


@pytest.mark.parametrize("kind", BODIES)
def test_rays_from_behind_pass_through(x64, strict_ranks, kind):
    body = BODIES[kind]()
    inside = {"rectangle": (0.4, 0, 0.9), "box": (0.3, 0, 1.0), "sphere": (0.4, 0.1, 1.0)}
    inside |= {
        "cylinder": (0.5, 0, 1.0),
        "floor": (0, 0, -0.5),
        "post": (0.3, 0, 0.8),
        "field": (0.5, 0, 1.0),
    }
    towards = (0.0, 0.0, 1.0) if kind == "floor" else (-1.0, 0.0, 0.0)
    hits = _cast(body, jnp.tile(_numbers(*inside[kind]), (100, 1)), jnp.tile(_numbers(*towards), (100, 1)))
    assert not np.any(hits.valid) and np.all(np.isinf(hits.distance))


@pytest.mark.parametrize("kind", BODIES)
def test_gradients_of_hits_are_right_and_those_of_misses_are_zero(x64, strict_ranks, kind):
    body = BODIES[kind]()
    origins, directions = _rays()

    def reach(origin, direction):
        hit = body.intersect(origin, direction)
        return jnp.where(hit.valid, hit.distance, 0.0) + jnp.sum(hit.colour)

    slopes = jax.jit(jax.vmap(jax.grad(reach)))(origins, directions)
    hits = _cast(body, origins, directions)
    met = np.asarray(hits.valid)
    assert np.all(np.isfinite(slopes)) and np.all(np.asarray(slopes)[~met] == 0)
    # The distance to a surface with normal n falls by n / (n . d) for every metre that the origin moves.
    towards = np.sum(np.asarray(hits.normal * directions), axis=1, keepdims=True)
    np.testing.assert_allclose(
        np.asarray(slopes)[met],
        -(np.asarray(hits.normal) / np.where(met[:, None], towards, 1))[met],
        atol=1e-6,
    )


@pytest.mark.parametrize("kind", BODIES)
def test_rays_along_the_axes_are_finite(kind):
    body = BODIES[kind]()
    directions = jnp.asarray(np.concatenate([np.eye(3), -np.eye(3)]), dtype=float)
    origins = jnp.broadcast_to(_numbers(-1.0, 0.05, 1.0), (6, 3))

    def total(origin, direction):
        hit = body.intersect(origin, direction)
        return jnp.sum(hit.normal), hit

    slopes, hits = jax.jit(jax.vmap(jax.grad(total, has_aux=True)))(origins, directions)
    assert not np.any(np.isnan(hits.distance)) and np.all(np.isfinite(hits.normal))
    assert np.all(np.isfinite(slopes))


def test_the_rim_of_an_object_stops_a_ray_without_a_reading(x64, strict_ranks):
    field = _field()
    valid = np.ones(field.surface.depth.shape, dtype=bool)
    valid[:, 30:40] = False
    holed = HeightField(
        HeightMap(
            field.surface.depth, jnp.asarray(valid), field.surface.left, field.surface.low, field.surface.cell
        ),
        field.near,
        field.far,
        _grey(),
        field.empty,
    )
    start, along = _numbers(-1.0, 0.1, 1.0), _numbers(1.0, 0.0, 0.0)
    hits = _cast(holed, jnp.tile(start, (100, 1)), jnp.tile(along, (100, 1)))
    assert not np.any(hits.valid) and np.all(np.isfinite(hits.distance))


def test_a_ray_passes_where_there_is_nothing(x64, strict_ranks):
    field = _field()
    empty = np.zeros(field.surface.depth.shape, dtype=bool)
    empty[:, 30:40] = True
    holed = HeightField(field.surface, field.near, field.far, _grey(), empty=jnp.asarray(empty))
    start, along = jnp.tile(_numbers(-1.0, 0.1, 1.0), (100, 1)), jnp.tile(_numbers(1.0, 0.0, 0.0), (100, 1))
    hits = _cast(holed, start, along)
    assert not np.any(hits.valid) and np.all(np.isinf(hits.distance))
    assert np.all(_cast(holed, start.at[:, 1].add(0.3), along).valid)


def test_a_post_has_a_top_and_a_bottom(x64, strict_ranks):
    post = BODIES["post"]()
    starts = jnp.asarray([[0.4, 0.1, 2.0], [0.4, 0.1, -1.0], [0.7, 0.0, 2.0], [0.3, 0.6, 1.5]])
    downs = jnp.asarray([[0, 0, -1.0], [0, 0, 1.0], [0, 0, -1.0], [0, -0.6, -0.8]])
    hits = _cast(post, jnp.tile(starts, (25, 1)), jnp.tile(downs, (25, 1)))
    # Down to the top at 1.1, up to the bottom at 0.4, past the side, and aslant over the top's rim at y 0.3.
    np.testing.assert_allclose(hits.distance[:4], [0.9, 1.4, np.inf, 0.5])
    np.testing.assert_allclose(hits.normal[:2], [[0, 0, 1], [0, 0, -1]])


@pytest.mark.parametrize(
    "texture",
    [
        lambda: Plaster(_numbers(0.9, 0.8, 0.7), jnp.asarray(0.1), jnp.asarray(0.3)),
        lambda: Checker(_numbers(0, 0, 0), _numbers(1, 1, 1), jnp.asarray(0.25)),
        lambda: Bricks(
            _numbers(0.6, 0.3, 0.2), _numbers(0.8, 0.8, 0.8), _numbers(0.2, 0.07), jnp.asarray(0.01)
        ),
        lambda: Wood(_numbers(0.6, 0.5, 0.3), jnp.asarray(0.1), jnp.asarray(0.2)),
    ],
)
def test_textures_vary_and_stay_within_range(texture):
    steps = np.stack(np.meshgrid(np.linspace(-1, 1, 40), np.linspace(0, 2, 40)), axis=-1).reshape(-1, 2)
    colours = np.asarray(jax.vmap(texture().colour)(jnp.asarray(steps, dtype=float)))
    assert colours.min() >= 0 and colours.max() <= 1
    assert np.ptp(colours, axis=0).max() > 0.05


def test_patterns_go_on_at_negative_coordinates():
    uv = np.random.default_rng(3).uniform(-2, 2, (2000, 2)).astype(np.float32)
    checker = Checker(_numbers(0, 0, 0), _numbers(1, 1, 1), jnp.asarray(0.25))
    bricks = Bricks(_numbers(0, 0, 0), _numbers(1, 1, 1), _numbers(0.2, 0.07), jnp.asarray(0.01))
    odd = np.floor(uv / 0.25).sum(1) % 2 == 1
    course = np.floor(uv[:, 1] / 0.07)
    mortar = ((uv[:, 0] + 0.1 * (course % 2)) % 0.2 < 0.01) | (uv[:, 1] % 0.07 < 0.01)
    for texture, wanted in ((checker, odd), (bricks, mortar)):
        found = np.asarray(jax.vmap(texture.colour)(jnp.asarray(uv)))[:, 0] > 0.5
        assert (found == wanted).mean() > 0.998, "but for rounding at an edge"
