"""Point clouds: the files that people have, and how far a cloud is from the truth."""

from jaxpaint.clouds.chamfer import Chamfer, chamfer, chamfer_by_tree
from jaxpaint.clouds.edge_sharpness import Edge, EdgeSharpness, edge_sharpness
from jaxpaint.clouds.files import Cloud, read_cloud, write_ply
from jaxpaint.clouds.surface_errors import (
    AngleStatistics,
    DistanceStatistics,
    normal_error,
    point_to_surface,
)

__all__ = [
    "AngleStatistics",
    "Chamfer",
    "Cloud",
    "DistanceStatistics",
    "Edge",
    "EdgeSharpness",
    "chamfer",
    "chamfer_by_tree",
    "edge_sharpness",
    "normal_error",
    "point_to_surface",
    "read_cloud",
    "write_ply",
]
