"""What refinement without learning gives back."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from jaxpaint.refinement.neighbourhoods import Neighbourhoods


@dataclass(frozen=True)
class Displacement:
    """How far the points of a cloud were moved: mean, 95th percentile and largest [m]."""

    mean: float
    p95: float
    largest: float

    @classmethod
    def between(cls, before: Float[np.ndarray, "3 N"], after: Float[np.ndarray, "3 N"]) -> "Displacement":
        """From two clouds of the same points."""
        moved = np.linalg.norm(after.astype(np.float64) - before, axis=0)
        return cls(float(moved.mean()), float(np.percentile(moved, 95)), float(moved.max()))


@dataclass(frozen=True)
class Refined:
    """A refined cloud, in the order and the type of the one that came.

    points: [m]. normals: unit, of the surface that the last step fitted; to the side of the viewpoint where
    one was given, else of either sign.
    """

    points: Float[np.ndarray, "N 3"]
    normals: Float[np.ndarray, "N 3"]
    statistics: Displacement


def refined(
    near: Neighbourhoods,
    points: Float[np.ndarray, "3 N"],
    normals: Float[np.ndarray, "3 N"],
    viewpoint: Float[np.ndarray, "3"] | None,
) -> Refined:
    """The result from points about the cloud's mean and normals of any sign."""
    if viewpoint is not None:
        eye = np.asarray(viewpoint, np.float64) - near.mean
        facing = np.einsum("an,an->n", eye[:, None] - points, normals) >= 0
        normals = np.where(facing, normals, -normals)
    turned = np.ascontiguousarray(normals.T, dtype=near.points.dtype)
    return Refined(near.placed(points), turned, Displacement.between(near.points, points))
