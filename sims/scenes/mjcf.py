"""The same scene as a MuJoCo model: static geoms and their materials."""

from functools import singledispatch
from xml.etree import ElementTree as xml

import jax
import jax.numpy as jnp
import numpy as np
from scipy import ndimage

from sims.scenes.heightfield import HeightField
from sims.scenes.primitives import AbstractPrimitive, Box, CylinderPatch, Floor, Post, Rectangle, Sphere
from sims.scenes.scene import Scene
from sims.scenes.textures import AbstractTexture

# Plates and height fields need a body behind their face.
_THICKNESS = 0.04


def scene_mjcf(scene: Scene) -> str:
    """A whole MJCF document, to be compiled alone, attached to a robot's, or included.

    Every primitive becomes one static geom named `scene_<number>`, with a material of its mean colour. A
    cylinder patch becomes the whole cylinder, a height field closes its holes: MuJoCo's rays agree wherever
    the scene's hit something.
    """
    root = xml.Element("mujoco", model=f"scene {scene.name}")
    asset, world = xml.SubElement(root, "asset"), xml.SubElement(root, "worldbody")
    for number, primitive in enumerate(scene.primitives):
        name = f"scene_{number}"
        xml.SubElement(asset, "material", name=name, rgba=f"{_text(_mean_colour(primitive.texture))} 1")
        geom = xml.SubElement(world, "geom", name=name, material=name)
        _describe(primitive, geom, asset)
    xml.indent(root)
    return xml.tostring(root, encoding="unicode")


@singledispatch
def _describe(primitive: AbstractPrimitive, geom: xml.Element, asset: xml.Element) -> None:
    """Fills in the geom's shape, and adds the assets it needs."""
    raise NotImplementedError(f"no MJCF for {type(primitive).__name__}")


@_describe.register
def _(primitive: Rectangle, geom: xml.Element, asset: xml.Element) -> None:
    rotation = np.asarray(primitive.R_map_plate, dtype=float)
    center = np.asarray(primitive.center, dtype=float) - 0.5 * _THICKNESS * rotation[:, 2]
    half = [*np.asarray(primitive.half, dtype=float), 0.5 * _THICKNESS]
    geom.attrib |= {"type": "box", "pos": _text(center), "size": _text(half), "xyaxes": _axes(rotation)}


@_describe.register
def _(primitive: Box, geom: xml.Element, asset: xml.Element) -> None:
    axes = _axes(np.asarray(primitive.R_map_box, dtype=float))
    geom.attrib |= {
        "type": "box",
        "pos": _text(primitive.center),
        "size": _text(primitive.half),
        "xyaxes": axes,
    }


@_describe.register
def _(primitive: Sphere, geom: xml.Element, asset: xml.Element) -> None:
    geom.attrib |= {"type": "sphere", "pos": _text(primitive.center), "size": _text(primitive.radius)}


@_describe.register
def _(primitive: Floor, geom: xml.Element, asset: xml.Element) -> None:
    geom.attrib |= {"type": "plane", "pos": _text([0, 0, float(primitive.height)]), "size": "0 0 0.05"}


@_describe.register
def _(primitive: CylinderPatch | Post, geom: xml.Element, asset: xml.Element) -> None:
    half = 0.5 * float(primitive.height)
    middle = np.asarray(primitive.foot, dtype=float) + np.array([0, 0, half])
    geom.attrib |= {"type": "cylinder", "pos": _text(middle), "size": _text([float(primitive.radius), half])}


@_describe.register
def _(primitive: HeightField, geom: xml.Element, asset: xml.Element) -> None:
    """A height field whose z axis points to the robot; its rows are v, its columns u."""
    surface = primitive.surface
    # The map's numbers are coefficients: what MuJoCo joins are the spline's own depths at the cells.
    depth = np.asarray(surface.depth, dtype=float)
    for axis in (0, 1):
        depth = ndimage.correlate1d(depth, [0.125, 0.75, 0.125], axis=axis, mode="nearest")
    rows, columns = depth.shape
    half_u, half_v = 0.5 * float(surface.cell) * (columns - 1), 0.5 * float(surface.cell) * (rows - 1)
    back = float(depth.max())
    size = [half_u, half_v, max(back - float(depth.min()), 1e-6), _THICKNESS]
    xml.SubElement(
        asset,
        "hfield",
        name=geom.attrib["name"],
        nrow=str(rows),
        ncol=str(columns),
        size=_text(size),
        elevation=" ".join(f"{value:.5f}" for value in (back - depth)[::-1].ravel()),
    )
    center = [back, -(float(surface.left) + half_u), float(surface.low) + half_v]
    geom.attrib |= {"type": "hfield", "hfield": geom.attrib["name"], "pos": _text(center)}
    geom.attrib["xyaxes"] = "0 -1 0 0 0 1"


def _mean_colour(texture: AbstractTexture) -> np.ndarray:
    """Mean over a square metre."""
    steps = np.stack(np.meshgrid(np.linspace(0, 1, 12), np.linspace(0, 1, 12)), axis=-1).reshape(-1, 2)
    return np.asarray(jax.vmap(texture.colour)(jnp.asarray(steps, dtype=float)).mean(axis=0))


def _axes(rotation: np.ndarray) -> str:
    return _text([*rotation[:, 0], *rotation[:, 1]])


def _text(values: object) -> str:
    return " ".join(f"{value:.9g}" for value in np.atleast_1d(np.asarray(values, dtype=float)))
