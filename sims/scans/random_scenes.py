"""Random scenes of three types, each with a camera that looks at it."""

import itertools
import math
from dataclasses import replace
from typing import TypeVar

import equinox as eqx
import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int, PRNGKeyArray

from jaxpaint.kinematics.pose import Pose
from jaxpaint.kinematics.rotations import compose, rotate, transpose
from sims.scans.colours import AnyTexture, random_textures
from sims.scans.random_objects import COUNT, places_in_picture, random_objects, random_sizes
from sims.scans.random_walls import Fold, bent_face, corner_faces, flat_face, random_fold, random_frame
from sims.scans.settings import KINDS, ScanSettings
from sims.scans.turns import frame_about
from sims.scans.window import ray_at
from sims.scenes.charts import PlaneChart
from sims.scenes.primitives import AbstractPrimitive, Box, CylinderPatch, Post, Sphere
from sims.scenes.scene import Scene
from sims.sensors.camera import Camera

_Body = TypeVar("_Body", bound=AbstractPrimitive)
# Where what a scene lacks is put [m]: out of every sensor's range, and never the nearest.
_AWAY = 1000.0
# The camera stands aside of a corner's bisector, and leans along its edge, at most so far [rad].
_ASIDE, _LEAN = 0.8, 0.6
# Its line of sight meets either face at no less than this angle in the plane across the edge [rad].
_LEAST_SLANT = 0.35
# Objects are scaled by the camera's distance from the wall's plane, which is no less where there are any [m].
_LEAST_HEIGHT = 0.1
# A corner's edge goes through this inner share of the picture.
_EDGE_WITHIN = 0.6
# What is drawn for a scene, even over 0..1: all at once, as each generator in a program takes 0.15 s to
# compile. Only one of the faces is of a kind, so they share theirs.
_DRAWS = {
    "bend": (),
    "fold": (2,),
    "frame": (6,),
    "view": (8,),
    "face": (4,),
    "looks": (3 + COUNT, 14),
    "sizes": (COUNT, 4),
    "places": (COUNT, 3),
    "turns": (2, 4),
    "there": (COUNT,),
}


class _View(eqx.Module):
    """How the camera looks at W's origin: from where (unit, in W), through which of its rays, from what
    depth [m], and turned by how much about that ray [rad].
    """

    towards: Float[Array, "3"]
    ray: Float[Array, "3"]
    depth: Float[Array, ""]
    roll: Float[Array, ""]


def random_scene(
    kind: Int[Array, ""], camera: Camera, settings: ScanSettings, *, key: PRNGKeyArray
) -> tuple[Scene, Pose]:
    """A scene and T_map_camera, in a map frame of any attitude within some metres of both.

    kind: number in `KINDS`. camera: what it sees is what is wanted: a corner's edge goes through its picture,
    objects have their middles in it. The depth along the optical axis, of the wall in the middle of the
    picture or of the point of a corner's edge that is looked at, is uniform in `settings.distance`.

    All kinds have the same tree: what a kind lacks is 1 km away. The chart is that of a wall through W's
    origin and only fills the field: nothing is painted here.
    """
    draws = _draws(key)
    is_corner, has_objects = kind == KINDS.index("corner"), kind == KINDS.index("objects")
    bent = (kind == KINDS.index("flat")) & (draws["bend"] < settings.bend)
    fold = random_fold(settings, draws["fold"])
    T_map_W = random_frame(bent, draws["frame"])
    view = _random_view(is_corner, fold, camera, settings, draws["view"])
    T_map_camera = _camera_pose(T_map_W, view)
    looks = random_textures(view.depth, draws["looks"])
    flat = flat_face(T_map_W, view.depth, looks[0], draws["face"])
    left, right = corner_faces(T_map_W, fold, view.depth, (looks[0], looks[1]), draws["face"])
    first = jax.tree.map(lambda a, b: jnp.where(is_corner, a, b), left, flat)
    things = _things(T_map_W, T_map_camera, camera, settings, looks[3:], draws)
    there = _there(settings, draws["there"]) & has_objects
    primitives = (
        _or_away(~bent, first),
        _or_away(is_corner, right),
        _or_away(bent, bent_face(T_map_W, settings, view.depth, looks[2], draws["face"])),
        *(_or_away(there[number], thing) for number, thing in enumerate(things)),
    )
    return Scene(primitives, _chart(T_map_W, view.depth), "random"), T_map_camera


def _draws(key: PRNGKeyArray) -> dict[str, Array]:
    sizes = [math.prod(shape) for shape in _DRAWS.values()]
    drawn = jax.random.uniform(key, (sum(sizes),))
    ends = itertools.accumulate(sizes)
    return {
        name: drawn[end - size : end].reshape(shape)
        for (name, shape), size, end in zip(_DRAWS.items(), sizes, ends, strict=True)
    }


def _random_view(
    is_corner: Bool[Array, ""], fold: Fold, camera: Camera, settings: ScanSettings, draws: Float[Array, "8"]
) -> _View:
    low, high = settings.distance
    # The root spreads lines of sight evenly over the cone, not around its axis.
    incidence, azimuth = settings.incidence * jnp.sqrt(draws[0]), 2 * jnp.pi * draws[1]
    flat = jnp.stack(
        [
            jnp.sin(incidence) * jnp.cos(azimuth),
            jnp.sin(incidence) * jnp.sin(azimuth),
            jnp.cos(incidence),
        ]
    )
    aside = (2 * draws[2] - 1) * jnp.minimum(fold.half - _LEAST_SLANT, _ASIDE)
    lean = (2 * draws[3] - 1) * _LEAN
    corner = jnp.stack([jnp.sin(aside) * jnp.cos(lean), jnp.sin(lean), jnp.cos(aside) * jnp.cos(lean)])
    place = jnp.where(is_corner, _EDGE_WITHIN * (2 * draws[4:6] - 1), 0.0)
    return _View(
        towards=jnp.where(is_corner, corner, flat),
        ray=ray_at(camera, place),
        depth=low + draws[6] * (high - low),
        roll=2 * jnp.pi * draws[7],
    )


def _camera_pose(T_map_W: Pose, view: _View) -> Pose:
    """T_map_camera, with W's origin on the view's ray at its depth along the optical axis."""
    ray = view.ray / jnp.sqrt((view.ray * view.ray).sum())
    look = -rotate(T_map_W.R, view.towards)
    R_map_sight, R_camera_sight = frame_about(look, view.roll), frame_about(ray, jnp.zeros_like(view.roll))
    R = compose(R_map_sight, transpose(R_camera_sight))
    return Pose(T_map_W.p - view.depth * rotate(R, view.ray), R)


def _things(
    T_map_W: Pose,
    T_map_camera: Pose,
    camera: Camera,
    settings: ScanSettings,
    looks: tuple[AnyTexture, ...],
    draws: dict[str, Array],
) -> tuple[Box, Box, Sphere, Post]:
    offset, normal = T_map_camera.p - T_map_W.p, T_map_W.R[:, 2]
    height = jnp.maximum((offset * normal).sum(), _LEAST_HEIGHT)
    incidence = jnp.arccos(jnp.clip(height / jnp.sqrt((offset * offset).sum()), 0.0, 1.0))
    sizes, gaps = random_sizes(settings, height, draws["sizes"])
    rays = jax.vmap(ray_at, in_axes=(None, 0))(camera, places_in_picture(incidence, draws["places"]))
    turned = jax.vmap(rotate, in_axes=(None, 0))(T_map_camera.R, rays)
    return random_objects(T_map_W, sizes, gaps, T_map_camera.p, turned, looks, draws["turns"])


def _there(settings: ScanSettings, draws: Float[Array, "4"]) -> Bool[Array, "4"]:
    """Which objects there are: at least one."""
    return (draws < settings.present) | (jnp.arange(COUNT) == jnp.argmin(draws))


def _or_away(there: Bool[Array, ""], primitive: _Body) -> _Body:
    """The body where it is there, else 1 km off."""
    place = "foot" if isinstance(primitive, CylinderPatch | Post) else "center"
    point = getattr(primitive, place)
    return replace(primitive, **{place: jnp.where(there, point, point + _AWAY)})


def _chart(T_map_W: Pose, distance: Float[Array, ""]) -> PlaneChart:
    normal = T_map_W.R[:, 2]
    limit = jnp.stack([distance, distance])
    return PlaneChart(T_map_W.p, jnp.arctan2(-normal[1], -normal[0]), -limit, limit)
