"""Laying paint on the wall's own (u, v) grid."""

from sims.paint.applicator import Applicator, window_cells
from sims.paint.brush import Brush
from sims.paint.contact import Contact, contact, wall_axes
from sims.paint.deposit import Paint, deposit
from sims.paint.film import film_at
from sims.paint.grid import PaintGrid, canvas_extent, pose_all_on_wall, pose_on_wall
from sims.paint.spray import Spray

__all__ = [
    "Applicator",
    "Brush",
    "Contact",
    "Paint",
    "PaintGrid",
    "Spray",
    "canvas_extent",
    "contact",
    "deposit",
    "film_at",
    "pose_all_on_wall",
    "pose_on_wall",
    "wall_axes",
    "window_cells",
]
