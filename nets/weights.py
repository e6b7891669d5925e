"""Networks in files: plain arrays and a line of JSON, nothing that is run when it is read."""

import json
import os
from pathlib import Path
from typing import TypeVar

import equinox as eqx
import jax
import numpy as np

from jaxpaint.errors import InputError

_ABOUT = "about"
Tree = TypeVar("Tree")


def save(path: Path, tree: eqx.Module, about: dict) -> None:
    """Writes the array leaves of `tree`, and `about` (settings, command, seed, scores) as JSON, as one .npz.

    Written beside and renamed: the file is whole, or not there.
    """
    leaves = jax.tree.leaves(eqx.filter(tree, eqx.is_array))
    arrays = {_name(k): np.asarray(leaf) for k, leaf in enumerate(leaves)}
    arrays[_ABOUT] = np.asarray(json.dumps(about))
    beside = path.with_name(f"{path.name}.{os.getpid()}.part")
    try:
        with beside.open("wb") as file:
            np.savez_compressed(file, allow_pickle=False, **arrays)
        beside.replace(path)
    finally:
        beside.unlink(missing_ok=True)


def about(path: Path) -> dict:
    """What was written beside the weights. Raises InputError."""
    return json.loads(str(_arrays(path)[_ABOUT]))


def load(path: Path, like: Tree) -> Tree:
    """The file's arrays in the place of those of `like`, which has their shapes. Raises InputError."""
    arrays = _arrays(path)
    dynamic, static = eqx.partition(like, eqx.is_array)
    leaves, structure = jax.tree.flatten(dynamic)
    found = [arrays.get(_name(k)) for k in range(len(leaves))]
    if len(arrays) - 1 != len(leaves) or any(
        new is None or new.shape != old.shape or new.dtype != old.dtype
        for new, old in zip(found, leaves, strict=True)
    ):
        raise InputError(f"{path}: weights of another network, allowed: those of its own settings")
    return eqx.combine(jax.tree.unflatten(structure, [jax.numpy.asarray(x) for x in found]), static)


def _arrays(path: Path) -> dict[str, np.ndarray]:
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as held:
            arrays = {name: held[name] for name in held.files}
    except FileNotFoundError as error:
        raise InputError(f"{path}: no such file") from error
    except Exception as error:
        raise InputError(f"{path}: no readable file of weights") from error
    if _ABOUT not in arrays:
        raise InputError(f"{path}: no file of weights ('{_ABOUT}' is missing)")
    return arrays


def _name(number: int) -> str:
    return f"leaf-{number:03d}"
