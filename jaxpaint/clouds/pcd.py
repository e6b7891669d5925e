"""Reader of .pcd files: ascii, binary and compressed, with packed colours."""

import re
from pathlib import Path

import numpy as np
from pypcd4 import PointCloud

from jaxpaint.clouds.records import Records
from jaxpaint.errors import InputError

_HEADER_BYTES = 4096


def read_pcd(path: Path) -> Records:
    """The rows of a .pcd file. Raises InputError where the file is not one, or is cut short."""
    with path.open("rb") as file:
        head = file.read(_HEADER_BYTES)
    if not (re.search(rb"^FIELDS\s", head, re.M) and re.search(rb"^DATA\s", head, re.M)):
        raise InputError(f"{path}: no .pcd header (FIELDS, DATA) found")
    cloud = _parse(path)
    rows, promised = cloud.pc_data, cloud.metadata.points
    if len(rows) != promised:
        raise InputError(f"{path}: cut short, {len(rows)} points found where the header says {promised}")
    if not {"x", "y", "z"} <= set(rows.dtype.names or ()):
        raise InputError(f"{path}: fields {', '.join(cloud.fields)} found, x, y and z are needed")
    organised = cloud.metadata.height > 1
    return Records.of(
        np.stack([rows[axis] for axis in "xyz"], axis=-1),
        colours=_colours(rows),
        shape=(cloud.metadata.height, cloud.metadata.width) if organised else None,
        viewpoint=np.array(cloud.metadata.viewpoint[:3]),
    )


def _parse(path: Path) -> PointCloud:
    try:
        return PointCloud.from_path(path)
    # The package signals a short or damaged body with whatever its parts raise.
    except Exception as error:
        raise InputError(f"{path}: the body does not fit the .pcd header, cut short or damaged") from error


def _colours(rows: np.ndarray) -> np.ndarray | None:
    """Colours packed in one 32-bit field, whichever type the field is declared with."""
    name = next((name for name in ("rgb", "rgba") if name in (rows.dtype.names or ())), None)
    if name is None or rows.dtype[name].itemsize != 4:
        return None
    packed = np.ascontiguousarray(rows[name]).view(np.uint32)
    return np.stack([(packed >> shift) & 255 for shift in (16, 8, 0)], axis=-1).astype(np.uint8)
