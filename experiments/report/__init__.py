"""report.html: one self-contained page with the pictures and tables that a person looks at first."""

from experiments.report.page import Figure, Page, Section, Tile, render
from experiments.report.painted_wall import PaintedWall, painted_wall
from experiments.report.spread import Spread, spread
from experiments.report.surface_path import SurfacePath, surface_path
from experiments.report.tracking_error import TrackingError, tracking_error

__all__ = [
    "Figure", "Page", "PaintedWall", "Section", "Spread", "SurfacePath", "Tile", "TrackingError",
    "painted_wall", "render", "spread", "surface_path", "tracking_error",
]  # fmt: skip
