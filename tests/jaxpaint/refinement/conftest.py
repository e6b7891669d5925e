"""Small clouds that all methods of refinement meet."""

import numpy as np
import pytest


@pytest.fixture(scope="session")
def flat() -> np.ndarray:
    """2,000 points of a tilted plane of 1 m x 1 m with noise of 10 mm; its normal is (0, 0.6, 0.8)."""
    rng = np.random.default_rng(0)
    u, v, noise = rng.uniform(0, 1, 2_000), rng.uniform(0, 1, 2_000), rng.normal(0, 0.01, 2_000)
    return np.stack([u, 0.8 * v + 0.6 * noise, -0.6 * v + 0.8 * noise], axis=1)


@pytest.fixture(scope="session")
def folded() -> np.ndarray:
    """3,000 points of the outside edge x = z = 0 of a box, faces x = 0 and z = 0, with noise of 4 mm."""
    rng = np.random.default_rng(1)
    place, y = rng.uniform(0, 0.5, (2, 1_500)), rng.uniform(0, 1, (2, 1_500))
    none = np.zeros(1_500)
    top, side = np.stack([place[0], y[0], none], axis=1), np.stack([none, y[1], place[1]], axis=1)
    return np.concatenate([top, side]) + rng.normal(0, 0.004, (3_000, 3))


@pytest.fixture(
    params=[
        lambda: np.repeat(np.random.default_rng(3).uniform(size=(3, 3)), 60, axis=0),
        lambda: np.zeros((50, 3)) + 7,
        lambda: np.linspace(0, 1, 100)[:, None] * np.asarray([1.0, 2, 3]),
        lambda: np.random.default_rng(3).uniform(size=(10, 3)),
        lambda: np.concatenate([np.random.default_rng(3).uniform(size=(200, 3)), np.full((90, 3), 0.5)]),
        lambda: np.stack(np.meshgrid(*[np.linspace(0, 1, 12)] * 2, [1e3]), -1).reshape(-1, 3),
    ],
    ids=["three-places", "one-place", "line", "ten-points", "duplicates", "grid-far-away"],
)
def awkward(request) -> np.ndarray:
    """Clouds whose neighbourhoods determine no plane, no scale, or too much of either."""
    return request.param()


@pytest.fixture(params=[np.float32, np.float64], ids=["float32", "float64"])
def dtype(request) -> type:
    """Both types that clouds come in."""
    return request.param
