"""Places to paint: what rays meet, the wall's own coordinates, and captured walls."""

from sims.scenes.arc_length import ArcLengthChart, ArcScale
from sims.scenes.canvases import canvas_for, default_canvas, make_canvas
from sims.scenes.captured import CapturedWall, CaptureReport, captured
from sims.scenes.charts import AbstractChart, CylinderChart, FoldChart, HeightChart, PlaneChart
from sims.scenes.furnished import Objects, Room, objects, room
from sims.scenes.heightfield import HeightField
from sims.scenes.heightmap import HeightMap
from sims.scenes.hits import Hit
from sims.scenes.mesh_files import TriangleMesh, is_mesh, read_mesh
from sims.scenes.mesh_report import MeshReport
from sims.scenes.mesh_walls import MeshWall, mesh_wall, read_wall
from sims.scenes.mjcf import scene_mjcf
from sims.scenes.primitives import AbstractPrimitive, Box, CylinderPatch, Floor, Post, Rectangle, Sphere
from sims.scenes.scene import Scene
from sims.scenes.textures import AbstractTexture, Bricks, Checker, Photograph, Plain, Plaster, Wood
from sims.scenes.walls import WALLS, Column, Corner, FlatWall, corner, cylinder, flat, make_wall

__all__ = [
    "WALLS",
    "AbstractChart",
    "AbstractPrimitive",
    "AbstractTexture",
    "ArcLengthChart",
    "ArcScale",
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
    "MeshReport",
    "MeshWall",
    "Objects",
    "Photograph",
    "Plain",
    "PlaneChart",
    "Plaster",
    "Post",
    "Rectangle",
    "Room",
    "Scene",
    "Sphere",
    "TriangleMesh",
    "Wood",
    "canvas_for",
    "captured",
    "corner",
    "cylinder",
    "default_canvas",
    "flat",
    "is_mesh",
    "make_canvas",
    "make_wall",
    "mesh_wall",
    "objects",
    "read_mesh",
    "read_wall",
    "room",
    "scene_mjcf",
]
