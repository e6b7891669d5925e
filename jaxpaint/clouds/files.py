"""Point clouds from files, checked once here so that nothing after has to.

Everything is host numpy: a file is read once, before any world exists.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

import numpy as np
from jaxtyping import Float

from jaxpaint.clouds.pcd import read_pcd
from jaxpaint.clouds.ply import read_ply
from jaxpaint.clouds.records import Records
from jaxpaint.errors import InputError

MIN_POINTS = 100
MAX_EXTENT = 100.0


@dataclass(frozen=True)
class Cloud:
    """A cloud as captured: finite points only, in the file's own axes.

    points: [m]. colours: 0..1 or None. missing: rows of the file without a finite position, dropped.
    shape: (height, width) of an organised file, before the missing rows were dropped; None otherwise.
    viewpoint: where the sensor stood, in the same axes [m]; the origin where the file does not say.
    scale: the factor that turned the file's units into metres.
    """

    points: Float[np.ndarray, "N 3"]
    colours: Float[np.ndarray, "N 3"] | None
    missing: int
    shape: tuple[int, int] | None
    name: str
    viewpoint: Float[np.ndarray, "3"]
    scale: float = 1.0


def read_cloud(path: str | Path, *, scale: float = 1.0) -> Cloud:
    """Reads a .ply, .pcd, .xyz or .npz file; `scale` turns its units into metres.

    Raises InputError, in one line, for whatever is not a usable cloud of at least 100 finite points.
    """
    path = Path(path)
    _check_scale(scale)
    records = _records(path)
    finite = np.isfinite(records.points).all(axis=1)
    points = records.points[finite] * scale
    _check_points(path, points, missing=int((~finite).sum()))
    return Cloud(
        points=points,
        colours=None if records.colours is None else records.colours[finite],
        missing=int((~finite).sum()),
        shape=records.shape,
        name=path.name,
        viewpoint=records.viewpoint * scale,
        scale=scale,
    )


def write_ply(
    path: str | Path, points: Float[np.ndarray, "N 3"], colours: Float[np.ndarray, "N 3"] | None = None
) -> None:
    """Writes points [m], and colours in 0..1 where given, as a binary .ply."""
    layout = [("x", "<f4"), ("y", "<f4"), ("z", "<f4")]
    if colours is not None:
        layout += [("red", "u1"), ("green", "u1"), ("blue", "u1")]
    rows = np.zeros(len(points), dtype=layout)
    for axis, name in enumerate("xyz"):
        rows[name] = np.asarray(points)[:, axis]
    if colours is not None:
        for channel, name in enumerate(("red", "green", "blue")):
            rows[name] = np.clip(np.round(np.asarray(colours)[:, channel] * 255), 0, 255)
    kinds = {"<f4": "float", "u1": "uchar"}
    properties = "".join(f"property {kinds[kind]} {name}\n" for name, kind in layout)
    header = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n{properties}end_header\n"
    Path(path).write_bytes(header.encode("ascii") + rows.tobytes())


def _records(path: Path) -> Records:
    if path.suffix.lower() not in _READERS:
        raise InputError(f"{path}: unknown kind of cloud '{path.suffix}', allowed: {', '.join(_READERS)}")
    if not path.exists():
        raise InputError(f"{path}: no such file")
    if path.is_dir():
        raise InputError(f"{path}: is a folder, a cloud file is needed ({', '.join(_READERS)})")
    if path.stat().st_size == 0:
        raise InputError(f"{path}: the file is empty")
    try:
        return _READERS[path.suffix.lower()](path)
    except InputError:
        raise
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or 'damaged file'})") from error
    # A damaged file may fail anywhere inside a parser, in any way: whatever it is, it is the file.
    except Exception as error:
        raise InputError(f"{path}: not a readable {path.suffix.lower()} cloud") from error


def _read_xyz(path: Path) -> Records:
    """Text of 3 columns (x y z) or 6 (x y z r g b), colours in 0..255 or 0..1."""
    try:
        lines = [
            line for line in path.read_text(encoding="utf-8").replace(",", " ").splitlines() if line.strip()
        ]
        table = np.loadtxt(lines, ndmin=2) if lines else np.zeros((0, 3))
    except ValueError as error:
        raise InputError(f"{path}: not a table of numbers, 3 or 6 columns are needed") from error
    if table.shape[1] not in (3, 6):
        raise InputError(f"{path}: {table.shape[1]} columns found, 3 (x y z) or 6 (x y z r g b) are allowed")
    return Records.of(table[:, :3], colours=table[:, 3:] if table.shape[1] == 6 else None)


def _read_npz(path: Path) -> Records:
    """The array `points`, or the only N x 3 array; `colours` beside it where there is one."""
    # Opened here: numpy leaves a file open that turns out to be no archive.
    with path.open("rb") as file:
        held = _load_arrays(path, file)
    triples = [name for name, array in held.items() if array.ndim >= 2 and array.shape[-1] == 3]
    name = "points" if "points" in held else triples[0] if len(triples) == 1 else None
    if name is None or name not in triples:
        found = ", ".join(f"{name} {array.shape}" for name, array in held.items()) or "nothing"
        raise InputError(f"{path}: holds {found}; an array 'points' or one N x 3 array is needed")
    array = held[name]
    shape = (array.shape[0], array.shape[1]) if array.ndim == 3 else None
    colours = held.get("colours")
    return Records.of(array.reshape(-1, 3), colours=colours, shape=shape)


def _load_arrays(path: Path, file: BinaryIO) -> dict[str, np.ndarray]:
    try:
        with np.load(file, allow_pickle=False) as arrays:
            held = {name: arrays[name] for name in arrays.files}
    except (ValueError, AttributeError) as error:
        raise InputError(
            f"{path}: no .npz archive of plain numbers (pickled objects are not read)"
        ) from error
    return {name: array for name, array in held.items() if np.issubdtype(array.dtype, np.number)}


def _check_scale(scale: float) -> None:
    if not (np.isfinite(scale) and scale > 0):
        raise InputError(f"--wall-scale: {scale} found, a factor above 0 is allowed")


def _check_points(path: Path, points: Float[np.ndarray, "N 3"], missing: int) -> None:
    if len(points) < MIN_POINTS:
        raise InputError(
            f"{path}: {len(points)} finite points and {missing} missing, at least {MIN_POINTS} are needed"
        )
    # Stray far points say nothing about the units: the middle 98 % does.
    low, high = np.percentile(points, [1, 99], axis=0)
    extent = float((high - low).max())
    if float(np.ptp(points, axis=0).max()) == 0.0:
        raise InputError(f"{path}: all {len(points)} points are equal")
    if extent > MAX_EXTENT:
        raise InputError(
            f"{path}: {extent:.0f} m wide, at most {MAX_EXTENT:.0f} m is allowed; "
            "if the file is in millimetres, use --wall-scale 0.001"
        )


_READERS: dict[str, Callable[[Path], Records]] = {
    ".ply": read_ply,
    ".pcd": read_pcd,
    ".xyz": _read_xyz,
    ".npz": _read_npz,
}
