"""Planes in a cloud, one after the other, by random samples.

Sequential RANSAC: the plane with most support is found, its points are taken away, and so on (Fischler and
Bolles, 1981), scored as MSAC (Torr and Zisserman, 2000), from samples of all extents, so that a small face is
found beside a large wall (after Schnabel, Wahl and Klein, 2007).
"""

import numpy as np
from jaxtyping import Bool, Float, Int

_DRAWN = 1_024
"""Points among which samples are drawn."""
_SCORED = 4_096
"""Points on which every sample is scored; only the best one meets the whole cloud."""
_AT_ONCE = 64
_REFITS = 4


def find_planes(
    cloud: Float[np.ndarray, "3 N"],
    limit: Float[np.ndarray, "N"],
    *,
    least: int,
    most: int,
    samples: int,
    seed: int,
) -> Float[np.ndarray, "P 4"]:
    """At most `most` planes of at least `least` points each: unit normal n and offset d, n . p = d [m].

    A point supports a plane within its own `limit` [m], above zero, and only the first that it supports.
    """
    generator = np.random.default_rng(seed)
    left = np.arange(cloud.shape[1])
    found: list[np.ndarray] = []
    while len(found) < most and len(left) >= least:
        sampled = _sampled(cloud[:, left], samples, generator)
        if len(sampled) == 0:
            break
        plane = _best(sampled, cloud[:, left], limit[left], generator)
        for _ in range(_REFITS):
            plane = fit_plane(cloud, limit, left[_within(plane, cloud[:, left], limit[left])], plane)
        supporting = _within(plane, cloud[:, left], limit[left])
        if supporting.sum() < least:
            break
        found.append(plane)
        left = left[~supporting]
    return np.array(found).reshape(-1, 4)


def fit_plane(
    cloud: Float[np.ndarray, "3 N"],
    limit: Float[np.ndarray, "N"],
    members: Int[np.ndarray, "m"] | Bool[np.ndarray, "N"],
    otherwise: Float[np.ndarray, "4"],
) -> Float[np.ndarray, "4"]:
    """Total least squares on some points with weights 1 / limit^2; `otherwise` for fewer than three."""
    points, scale = cloud[:, members], limit[members]
    if len(scale) < 3:
        return otherwise
    weight = (scale.min() / scale) ** 2
    share = weight / weight.sum()
    centre = points @ share
    about = points - centre[:, None]
    normal = np.linalg.eigh((about * share) @ about.T)[1][:, 0]
    return np.append(normal, normal @ centre)


def offsets(planes: Float[np.ndarray, "P 4"], cloud: Float[np.ndarray, "3 n"]) -> Float[np.ndarray, "P n"]:
    """Signed distances of points from planes [m]."""
    return planes[:, :3] @ cloud - planes[:, 3:]


def _within(plane, cloud, limit):
    return np.abs(offsets(plane[None], cloud)[0]) <= limit


def _sampled(
    cloud: Float[np.ndarray, "3 n"], samples: int, generator: np.random.Generator
) -> Float[np.ndarray, "s 4"]:
    """Planes through triples: a random point and two of its nearest, how near is drawn log-uniformly.

    Triples in a line are left out.
    """
    some = cloud[:, generator.choice(cloud.shape[1], min(_DRAWN, cloud.shape[1]), replace=False)]
    count = some.shape[1]
    corner = generator.integers(count, size=samples)
    square = ((some[:, corner, None] - some[:, None, :]) ** 2).sum(axis=0)
    order = np.argsort(square, axis=1, kind="stable")
    reach = np.exp(generator.uniform(np.log(3), np.log(max(count, 4)), (samples, 1)))
    rank = np.minimum(1 + (generator.uniform(size=(samples, 2)) * reach).astype(np.int64), count - 1)
    first, second = (some[:, index].T for index in np.take_along_axis(order, rank, axis=1).T)
    origin = some[:, corner].T
    normal = np.cross(first - origin, second - origin)
    length = np.linalg.norm(normal, axis=1)
    sides = np.linalg.norm(first - origin, axis=1) * np.linalg.norm(second - origin, axis=1)
    fine = length > 1e-6 * sides
    normal = normal[fine] / length[fine, None]
    return np.column_stack([normal, (normal * origin[fine]).sum(axis=1)])


def _best(
    planes: Float[np.ndarray, "s 4"],
    cloud: Float[np.ndarray, "3 n"],
    limit: Float[np.ndarray, "n"],
    generator: np.random.Generator,
) -> Float[np.ndarray, "4"]:
    """The plane of the highest score sum(max(0, 1 - (distance / limit)^2)) over some of the points."""
    some = generator.choice(len(limit), min(_SCORED, len(limit)), replace=False)
    points, scale = cloud[:, some], limit[some]
    pieces = np.array_split(planes, -(-len(planes) // _AT_ONCE))
    scores = [np.maximum(1 - (offsets(piece, points) / scale) ** 2, 0).sum(axis=1) for piece in pieces]
    return planes[np.argmax(np.concatenate(scores))]
