"""Arrays of a run: one Parquet row a world, and the trajectories of a few worlds."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np


def write_parquet(path: Path, columns: Mapping[str, Any]) -> None:
    """Columns [rows] or [rows, k] (a list a row) as Parquet; a number that is not finite becomes null."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    arrays = {name: np.asarray(column) for name, column in columns.items()}
    lengths = {name: array.shape[:1] for name, array in arrays.items()}
    if len(set(lengths.values())) > 1:
        raise ValueError(f"columns: found lengths {lengths}, allowed: one length for all")
    table = pa.table({name: _column(array) for name, array in arrays.items()})
    pq.write_table(table, path)


def write_trajectories(path: Path, arrays: Mapping[str, Any], about: Mapping[str, str]) -> None:
    """Arrays as compressed .npz with the array `about`: rows (name, shape, units and frame in words)."""
    undocumented = sorted(set(arrays) - set(about))
    if undocumented:
        raise ValueError(
            f"about: found nothing on {', '.join(undocumented)}, allowed: a line for every array"
        )
    described = np.array([(name, about[name]) for name in arrays], dtype=str).reshape(-1, 2)
    held: dict[str, Any] = {name: np.asarray(array) for name, array in arrays.items()}
    np.savez_compressed(path, about=described, **held)


def _column(array: np.ndarray):
    import pyarrow as pa

    if array.ndim == 2:
        flat = _column(array.reshape(-1))
        return pa.FixedSizeListArray.from_arrays(flat, array.shape[1])
    if array.ndim != 1:
        raise ValueError(f"columns: found an array of {array.ndim} axes, allowed: 1 or 2")
    if not np.issubdtype(array.dtype, np.floating):
        return pa.array(array.tolist() if array.dtype.kind in "US" else array)
    return pa.array(array, mask=~np.isfinite(array))
