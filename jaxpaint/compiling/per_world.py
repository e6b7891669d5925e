"""Leaves that differ from world to world inside of an argument that all worlds share."""

from typing import Any, NamedTuple

import equinox as eqx
import jax


class PerWorld(eqx.Module):
    """Marks `value`, an array or a tree of arrays with a leading worlds axis, inside of a shared argument.

    A `Batched` program gives each world its own row and copies nothing else: of a model of which only the
    masses change, one model and the masses of all worlds are kept.
    """

    value: Any


class Batch(NamedTuple):
    """A tree without marks, and the axis of each of its leaves as `jax.vmap` wants it: 0, or None."""

    tree: Any
    in_axes: Any


def per_world(tree: Any, in_axes: Any) -> Any:
    """The tree with marks on the leaves whose axis is 0; in_axes: a tree of 0 and None like it."""
    axes = jax.tree.leaves(in_axes, is_leaf=lambda x: x is None)
    leaves, structure = jax.tree.flatten(tree)
    if len(axes) != len(leaves) or set(axes) - {0, None}:
        raise ValueError(
            f"in_axes: found {len(axes)} entries for {len(leaves)} leaves; allowed: 0 or None for each"
        )
    marked = [x if a is None else PerWorld(x) for x, a in zip(leaves, axes, strict=True)]
    return jax.tree.unflatten(structure, marked)


def without_marks(tree: Any) -> Batch:
    """The inverse."""
    leaves, structure = jax.tree.flatten(tree, is_leaf=is_marked)
    trees = jax.tree.unflatten(structure, [x.value if is_marked(x) else x for x in leaves])
    axes = [jax.tree.map(lambda _: 0, x.value) if is_marked(x) else None for x in leaves]
    return Batch(trees, jax.tree.unflatten(structure, axes))


def repeated(tree: Any, times: int) -> Any:
    """The tree with each row of what is marked so many times in a row: for rows of worlds and times."""

    def again(x: Any) -> Any:
        return PerWorld(jax.tree.map(lambda y: y.repeat(times, axis=0), x.value)) if is_marked(x) else x

    return jax.tree.map(again, tree, is_leaf=is_marked)


def is_marked(x: Any) -> bool:
    """Whether this is a `PerWorld`."""
    return isinstance(x, PerWorld)
