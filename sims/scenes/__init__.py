"""Places to paint: what rays meet, the wall's own coordinates, and captured walls."""

from sims.scenes.canvases import canvas_for, default_canvas, make_canvas
from sims.scenes.captured import CapturedWall, CaptureReport, captured
from sims.scenes.charts import AbstractChart, CylinderChart, FoldChart, HeightChart, PlaneChart
from sims.scenes.heightfield import HeightField
from sims.scenes.heightmap import HeightMap
from sims.scenes.hits import Hit
from sims.scenes.mjcf import scene_mjcf
from sims.scenes.primitives import AbstractPrimitive, Box, CylinderPatch, Floor, Rectangle, Sphere
from sims.scenes.scene import Scene
from sims.scenes.textures import AbstractTexture, Bricks, Checker, Photograph, Plain, Plaster, Wood
from sims.scenes.walls import WALLS, Column, Corner, FlatWall, corner, cylinder, flat, make_wall

__all__ = [
    "WALLS",
    "AbstractChart",
    "AbstractPrimitive",
    "AbstractTexture",
    "Box",
    "Bricks",
    "CaptureReport",
    "CapturedWall",
    "Checker",
    "Column",
    "Corner",
    "CylinderChart",
    "CylinderPatch",
    "FlatWall",
    "Floor",
    "FoldChart",
    "HeightChart",
    "HeightField",
    "HeightMap",
    "Hit",
    "Photograph",
    "Plain",
    "PlaneChart",
    "Plaster",
    "Rectangle",
    "Scene",
    "Sphere",
    "Wood",
    "canvas_for",
    "captured",
    "corner",
    "cylinder",
    "default_canvas",
    "flat",
    "make_canvas",
    "make_wall",
    "scene_mjcf",
]
