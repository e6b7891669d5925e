"""Triangle meshes from .stl, .obj and .ply files, checked once here so that nothing after has to.

What a file holds is counted before it is loaded: a header, a size or a scan of its lines tells.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import trimesh
from jaxtyping import Float, Int

from jaxpaint.errors import InputError
from sims.scenes.obj_files import count_obj, read_obj
from sims.scenes.ply_files import read_ply
from sims.scenes.polygons import cut

MAX_FACES = 2_000_000
MIN_EXTENT, MAX_EXTENT = 0.1, 30.0
_KINDS = (".stl", ".obj", ".ply")
_UNITS = ((0.001, "millimetres"), (0.01, "centimetres"), (0.0254, "inches"), (0.3048, "feet"), (1000.0, "km"))
_BLOCK = 1 << 20
_STL_HEAD, _STL_FACE = 84, 50


@dataclass(frozen=True)
class TriangleMesh:
    """Triangles in the file's own axes, in metres; every vertex is finite and belongs to a face.

    scale: the factor that turned the file's units into metres.
    """

    vertices: Float[np.ndarray, "V 3"]
    faces: Int[np.ndarray, "F 3"]
    name: str
    scale: float = 1.0

    @property
    def corners(self) -> Float[np.ndarray, "F 3 3"]:
        """The three corners of every face [m]."""
        return self.vertices[self.faces]


def is_mesh(path: str | Path) -> bool:
    """Whether a file is to be read as a mesh: .stl and .obj always, a .ply where it says it has faces.

    What is no readable .ply is left to the cloud's reader, which says what is wrong with it.
    """
    path = Path(path)
    kind = path.suffix.lower()
    if kind != ".ply" or not path.is_file():
        return kind in (".stl", ".obj")
    return _ply_counts(path).get("face", 0) > 0


def read_mesh(path: str | Path, *, scale: float = 1.0) -> TriangleMesh:
    """Reads a mesh of at most 2 million faces; `scale` turns its units into metres.

    Bodies of a file are joined, colours and materials left aside. Raises InputError, in one line, for
    whatever is no such mesh, and where its size is none of a wall: below 0.1 m or above 30 m.
    """
    path = Path(path)
    if not (np.isfinite(scale) and scale > 0):
        raise InputError(f"--wall-scale: {scale} found, a factor above 0 is allowed")
    _check_file(path)
    _check_counts(path)
    try:
        vertices, faces = _READERS[path.suffix.lower()](path)
    except InputError:
        raise
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or 'damaged file'})") from error
    # A damaged file may fail anywhere inside a parser, in any way: whatever it is, it is the file.
    except Exception as error:
        raise InputError(f"{path}: not a readable {path.suffix.lower()} mesh") from error
    return _checked(path, vertices, faces, scale)


def _check_file(path: Path) -> None:
    if path.suffix.lower() not in _KINDS:
        raise InputError(f"{path}: unknown kind of mesh '{path.suffix}', allowed: {', '.join(_KINDS)}")
    if path.is_dir():
        raise InputError(f"{path}: is a folder, a mesh file is needed ({', '.join(_KINDS)})")
    if not path.exists():
        raise InputError(f"{path}: no such file")
    if path.stat().st_size == 0:
        raise InputError(f"{path}: the file is empty")


def _check_counts(path: Path) -> None:
    """Refuses what is too much before any of it is loaded."""
    try:
        count = _COUNTERS[path.suffix.lower()](path)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or 'damaged file'})") from error
    _check_count(path, count)


def _check_count(path: Path, count: int) -> None:
    if count > MAX_FACES:
        raise InputError(
            f"{path}: {count} faces or more found, at most {MAX_FACES} are allowed; simplify the mesh"
        )


def _stl_count(path: Path) -> int:
    size = path.stat().st_size
    with path.open("rb") as file:
        head = file.read(_STL_HEAD)
    if len(head) == _STL_HEAD:
        faces = int.from_bytes(head[80:], "little")
        if size == _STL_HEAD + _STL_FACE * faces:
            return faces
    if not head.lstrip().lower().startswith(b"solid"):
        raise InputError(
            f"{path}: no .stl: neither as long as its header says, nor text that begins with solid"
        )
    return _count_marks(path, b"endfacet")


def _ply_counts(path: Path) -> dict[str, int]:
    """Elements of a .ply by name, from its header."""
    with path.open("rb") as file:
        head = file.read(1 << 16)
    end = head.find(b"end_header")
    lines = [line.split() for line in head[: max(end, 0)].decode("ascii", errors="replace").splitlines()]
    found = [line for line in lines if line[:1] == ["element"] and len(line) == 3 and line[2].isdigit()]
    return {line[1]: int(line[2]) for line in found} if head.startswith(b"ply") else {}


def _ply_count(path: Path) -> int:
    counts = _ply_counts(path)
    if not counts:
        raise InputError(f"{path}: no .ply header (ply ... end_header) found")
    if counts.get("face", 0) == 0:
        raise InputError(f"{path}: no faces found, a mesh needs some; a .ply of points alone is a cloud")
    # No face needs more than its three corners.
    return max(counts["face"], counts.get("vertex", 0) // 3)


def _obj_count(path: Path) -> int:
    return count_obj(path, MAX_FACES)


def _count_marks(path: Path, mark: bytes) -> int:
    """How often a file holds some letters, large or small, at most about the limit; only a block of it is
    held at a time.
    """
    count, rest = 0, b"\n"
    with path.open("rb") as file:
        while count <= MAX_FACES and (block := file.read(_BLOCK)):
            block = rest + block.lower()
            count += block.count(mark)
            rest = block[-(len(mark) - 1) :]
    return count


def _read_ply(path: Path) -> tuple[np.ndarray, np.ndarray]:
    points, corners, counts = read_ply(path)
    _check_count(path, int(np.maximum(counts - 2, 0).sum()))
    if len(corners) and not 0 <= corners.min() <= corners.max() < len(points):
        raise InputError(f"{path}: faces name vertices that are not there ({len(points)} vertices found)")
    return points, cut(points, corners, counts)


def _load(path: Path) -> tuple[np.ndarray, np.ndarray]:
    with path.open("rb") as file:
        # From the open file alone: a path would let it look for textures and materials beside.
        loaded = trimesh.load_scene(file, file_type=path.suffix.lower()[1:], process=False)
    held = loaded.to_mesh()
    return np.asarray(held.vertices, dtype=float), np.asarray(held.faces, dtype=np.int64)


def _checked(path: Path, vertices: np.ndarray, faces: np.ndarray, scale: float) -> TriangleMesh:
    if not len(faces):
        raise InputError(f"{path}: no faces found, a mesh needs some")
    if faces.min() < 0 or faces.max() >= len(vertices):
        raise InputError(f"{path}: faces name vertices that are not there ({len(vertices)} vertices found)")
    used, faces = np.unique(faces, return_inverse=True)
    vertices = vertices[used]
    broken = int((~np.isfinite(vertices)).any(axis=1).sum())
    if broken:
        raise InputError(f"{path}: {broken} vertices are not finite numbers, every one must be")
    _check_extent(path, vertices, scale)
    mesh = TriangleMesh(vertices * scale, faces.reshape(-1, 3), path.name, scale)
    sides = mesh.corners[:, 1:] - mesh.corners[:, :1]
    if not np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1).sum() > 0:
        raise InputError(f"{path}: the {len(faces) // 3 or 1} faces have no area")
    return mesh


def _check_extent(path: Path, vertices: np.ndarray, scale: float) -> None:
    """The size must be that of a wall; else the units that would make it one are named."""
    extent = float(np.ptp(vertices, axis=0).max()) * scale
    if MIN_EXTENT <= extent <= MAX_EXTENT:
        return
    fits = [(unit, name) for unit, name in _UNITS if 0.3 <= extent / scale * unit <= 15.0]
    hint = " or ".join(f"--wall-scale {unit:g} ({name})" for unit, name in fits)
    raise InputError(
        f"{path}: {extent:.3g} m across with --wall-scale {scale:g}, {MIN_EXTENT:g} to {MAX_EXTENT:g} m is "
        f"allowed; try {hint or f'--wall-scale {3 * scale / max(extent, 1e-300):.1g}'}"
    )


_READERS: dict[str, Callable[[Path], tuple[np.ndarray, np.ndarray]]] = {
    ".stl": _load,
    ".obj": read_obj,
    ".ply": _read_ply,
}
_COUNTERS: dict[str, Callable[[Path], int]] = {".stl": _stl_count, ".obj": _obj_count, ".ply": _ply_count}
