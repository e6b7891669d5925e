"""What is wrong with a mesh, told to its owner: holes, non-manifold edges, faces without area."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from jaxpaint.errors import InputError
from sims.scenes.mesh_files import TriangleMesh

# Corners closer than this share of the mesh's size are one vertex: files split them at seams.
_WELD = 1e-6
_FLAT = 1e-12


@dataclass(frozen=True)
class MeshChecks:
    """Defects of a mesh after vertices at one place were joined.

    bodies: parts that share no vertex. holes: extent of every closed run of open edges [m], falling, but for
    the widest of each body, which is its outer rim. rims: how many bodies have such a rim; the others are
    closed. crowded: edges of more than two faces. flipped: edges whose two faces look to opposite sides.
    degenerate: faces without area, which nothing else counts. sound: faces that have one.
    """

    faces: int
    bodies: int
    rims: int
    holes: tuple[float, ...]
    crowded: int
    flipped: int
    degenerate: int
    sound: Bool[np.ndarray, "F"]


def check_mesh(mesh: TriangleMesh) -> MeshChecks:
    """Counts the defects of a mesh. Raises InputError where no face is sound."""
    faces, places = _welded(mesh)
    corners = mesh.corners
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    distinct = (faces != np.roll(faces, 1, axis=1)).all(axis=1)
    sound = distinct & (area > _FLAT * float(np.ptp(mesh.vertices, axis=0).max()) ** 2)
    if not sound.any():
        raise InputError(f"{mesh.name}: none of the {len(faces)} faces has an area to speak of")
    faces = faces[sound]
    directed = np.concatenate([faces, np.roll(faces, -1, axis=1)]).reshape(2, -1).T
    edges, place, count = np.unique(
        np.sort(directed, axis=1), axis=0, return_inverse=True, return_counts=True
    )
    forward = np.bincount(place.ravel(), directed[:, 0] < directed[:, 1], len(edges))
    bodies, body = _components(directed, len(places))
    rims, holes = _loops(edges[count == 1], places, body)
    return MeshChecks(
        faces=len(mesh.faces),
        bodies=len(np.unique(body[faces])) if len(faces) else bodies,
        rims=rims,
        holes=holes,
        crowded=int((count > 2).sum()),
        flipped=int(((count == 2) & (forward != 1)).sum()),
        degenerate=int((~sound).sum()),
        sound=sound,
    )


def _welded(mesh: TriangleMesh) -> tuple[Int[np.ndarray, "F 3"], Float[np.ndarray, "W 3"]]:
    """Faces over vertices of which no two are at one place, and those vertices."""
    size = float(np.ptp(mesh.vertices, axis=0).max())
    keys = np.round((mesh.vertices - mesh.vertices.min(axis=0)) / (_WELD * size)).astype(np.int64)
    # One number for each place is several times faster to sort than rows of three; 21 bits hold a million.
    packed = keys[:, 0] << 42 | keys[:, 1] << 21 | keys[:, 2]
    _, first, inverse = np.unique(packed, return_index=True, return_inverse=True)
    return inverse.ravel()[mesh.faces], mesh.vertices[first]


def _components(edges: Int[np.ndarray, "E 2"], count: int) -> tuple[int, Int[np.ndarray, "count"]]:
    graph = coo_array((np.ones(len(edges), dtype=bool), (edges[:, 0], edges[:, 1])), shape=(count, count))
    return connected_components(graph, directed=False)


def _loops(
    open_edges: Int[np.ndarray, "E 2"], places: Float[np.ndarray, "W 3"], body: Int[np.ndarray, "W"]
) -> tuple[int, tuple[float, ...]]:
    """Number of bodies with a rim, and extents of the other loops of open edges [m]."""
    if not len(open_edges):
        return 0, ()
    ends, inverse = np.unique(open_edges, return_inverse=True)
    loops, label = _components(inverse.reshape(-1, 2), len(ends))
    low, high = np.full((loops, 3), np.inf), np.full((loops, 3), -np.inf)
    np.minimum.at(low, label, places[ends])
    np.maximum.at(high, label, places[ends])
    extent = (high - low).max(axis=1)
    owner = np.zeros(loops, dtype=int)
    owner[label] = body[ends]
    order = np.argsort(-extent, kind="stable")
    _, first = np.unique(owner[order], return_index=True)
    holes = np.delete(extent[order], first)
    return len(first), tuple(float(width) for width in holes)
