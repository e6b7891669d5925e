"""A one-world function over many worlds: padded chunks, all local devices, one compilation."""

import time
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax.extend import core
from jax.sharding import Mesh, NamedSharding, PartitionSpec

from jaxpaint.compiling.batch_last import batch_last
from jaxpaint.compiling.per_world import is_marked, without_marks
from jaxpaint.compiling.rules import Value, spread

# XLA deletes barriers before it fuses (`cse_barrier_expander`), and splits large operations over a thread
# pool in a way that can hang for good (`cpu-parallel-task-assigner`); devices are our parallelism. Small
# loops it moves into code that knows no barriers (`small-while-loop-hoisting`) and refuses to compile.
# Kernels with the worlds last are plain loops over them, which LLVM vectorises on its first level already:
# they run as fast as on the third, and large programs compile in three quarters of the time.
CPU_OPTIONS = {
    "xla_disable_hlo_passes": "cse_barrier_expander,cpu-parallel-task-assigner,small-while-loop-hoisting",
    "xla_backend_optimization_level": 1,
}
# Worlds that a device computes side by side, where nothing else is asked for.
CHUNK = 32
# Work on big arrays, one world at a time, needs no barriers; it only must not reach for the thread pool.
_DENSE_OPTIONS = {"xla_disable_hlo_passes": "cpu-parallel-task-assigner"}


class Batched:
    """A compiled function of many worlds; made by `batched`.

    `traces` counts how often the one-world function was traced, `compile_s` the seconds that tracing and
    compilation took. Both stay as they are when only values change.
    """

    spent_s = 0.0
    """Seconds that all programs together took to trace and compile in this process."""

    def __init__(
        self,
        function: Callable,
        in_axes: tuple[int | None, ...],
        chunk: int,
        dense: bool,
        block: int | None = None,
    ):
        self._function, self._in_axes, self._chunk, self._dense = function, in_axes, chunk, dense
        self._block = block
        self._programs: dict[Any, Callable] = {}
        self.traces, self.compile_s = 0, 0.0

    def __call__(self, *args):
        """Runs all worlds; batched arguments and every result have a leading worlds axis, and so has what is
        marked by `PerWorld` in arguments that worlds share.
        """
        axes = self._leaf_axes(args)
        flat, tree = jax.tree.flatten(tuple(without_marks(arg).tree for arg in args))
        counts = {np.shape(x)[0] for x, batched in zip(flat, axes, strict=True) if batched}
        if len(counts) != 1:
            raise ValueError(
                f"in_axes: the batched arguments must share one leading size, found {sorted(counts)}"
            )
        worlds = counts.pop()
        mesh = Mesh(np.array(jax.local_devices()), ("worlds",))
        # A loop of one round is compiled to other code, whose last bits differ: never fewer than two.
        per_device = max(_round_up(-(-worlds // mesh.size), self._chunk), 2)
        padded = per_device * mesh.size
        placed = [_place(x, padded if split else None, mesh) for x, split in zip(flat, axes, strict=True)]
        out = self._program(placed, tree, axes, per_device, mesh)(*placed)
        return out if padded == worlds else jax.tree.map(lambda x: _first(x, worlds, mesh), out)

    def temporary_bytes(self) -> int:
        """Memory beside inputs and outputs that the largest of the compiled programs takes on all devices."""
        sizes = [p.memory_analysis().temp_size_in_bytes for p in self._programs.values()]  # type: ignore[attr-defined]
        return max(sizes, default=0) * jax.local_device_count()

    def _leaf_axes(self, args) -> tuple[bool, ...]:
        return tuple(
            axis is not None or is_marked(leaf)
            for arg, axis in zip(args, self._in_axes, strict=True)
            for leaf in jax.tree.leaves(arg, is_leaf=is_marked)
            for _ in jax.tree.leaves(leaf)
        )

    def forget(self) -> None:
        """Lets go of the compiled programs, and of the memory that they take; the next call compiles anew."""
        self._programs.clear()

    def _program(self, flat, tree, axes, per_device, mesh) -> Callable:
        key = (tree, axes, tuple((x.shape, x.dtype) for x in flat), jax.config.read("jax_enable_x64"))
        if key not in self._programs:
            start = time.perf_counter()
            self._programs[key] = self._compile(flat, tree, axes, per_device, mesh)
            seconds = time.perf_counter() - start
            self.compile_s += seconds
            Batched.spent_s += seconds
        return self._programs[key]

    def _compile(self, flat, tree, axes, per_device, mesh) -> Callable:
        specs = tuple(PartitionSpec("worlds") if batched else PartitionSpec() for batched in axes)

        def body(*leaves):
            return self._on_one_device(leaves, tree, axes, per_device)

        shards = jax.shard_map(
            body, mesh=mesh, in_specs=specs, out_specs=PartitionSpec("worlds"), check_vma=False
        )
        on_cpu = jax.default_backend() == "cpu"
        options: Any = (_DENSE_OPTIONS if self._dense else CPU_OPTIONS) if on_cpu else None
        return jax.jit(shards).lower(*flat).compile(compiler_options=options)

    def _on_one_device(self, leaves, tree, axes, per_device):
        """Maps one chunk after another, so that a chunk's working set stays in the cache."""
        chunk = min(self._chunk, per_device)
        shared = [x for x, batched in zip(leaves, axes, strict=True) if not batched]
        moving = [x for x, batched in zip(leaves, axes, strict=True) if batched]

        def run(part):
            own, common = iter(part), iter(shared)
            mixed = [next(own) if b else next(common) for b in axes]
            if self._dense:
                return self._traced(*jax.tree.unflatten(tree, mixed))
            if jax.default_backend() != "cpu":
                return _vectorised(self._traced, mixed, tree, axes)
            return _batch_last_chunk(self._traced, mixed, tree, axes, chunk, self._block)

        if self._dense:
            return jax.lax.map(run, moving)
        if jax.default_backend() != "cpu" and chunk == per_device:
            return run(moving)
        split = [x.reshape(per_device // chunk, chunk, *x.shape[1:]) for x in moving]
        rounds = jax.lax.map if jax.default_backend() != "cpu" else _rounds
        return jax.tree.map(lambda x: x.reshape(per_device, *x.shape[2:]), rounds(run, split))

    def _traced(self, *args):
        self.traces += 1
        return self._function(*args)


def batched(
    function: Callable,
    *,
    in_axes: tuple[int | None, ...] | int = 0,
    chunk: int = CHUNK,
    block: int | None = None,
) -> Batched:
    """Turns a function of one world into a compiled function of many.

    function: of positional pytrees of arrays. in_axes: 0 for an argument with a leading worlds axis, None for
    one that all worlds share, one entry an argument. chunk: how many worlds a device takes at a time; counts
    are padded to a multiple of it with copies of the last world, so a world's bits do not depend on how many
    others run. Worlds are split over all local devices.

    block: on CPUs, how many worlds of a chunk a loop inside of the function takes at a time. It is for
    functions that spend their time in loops which most worlds leave early: chunks may then be large, and
    the few worlds that take longest go on together, not in every chunk anew.
    """
    if block and chunk % block:
        raise ValueError(f"block: chunk is a multiple of it; found block {block} and chunk {chunk}")
    if isinstance(in_axes, int):
        count = function.__code__.co_argcount
        in_axes = (in_axes,) * count
    return Batched(function, tuple(in_axes), chunk, dense=False, block=block)


def one_by_one(function: Callable, *, in_axes: tuple[int | None, ...]) -> Batched:
    """The same for functions of big arrays (a cloud, an image): each device takes one world at a time."""
    return Batched(function, tuple(in_axes), 1, dense=True)


def on_devices(tree):
    """Leaves with a leading worlds axis, split over the local devices as batched programs want them: calls
    with what lies there move nothing. Their length is a multiple of chunk times devices.
    """
    mesh = Mesh(np.array(jax.local_devices()), ("worlds",))
    return jax.tree.map(lambda x: _place(x, np.shape(x)[0], mesh), tree)


def _round_up(count: int, multiple: int) -> int:
    return -(-count // multiple) * multiple


def _place(x, worlds: int | None, mesh: Mesh) -> jax.Array:
    """An argument where the program wants it: split over the devices after padding to `worlds`, or on all."""
    if worlds is None:
        return jax.device_put(jnp.asarray(x), NamedSharding(mesh, PartitionSpec()))
    missing = worlds - np.shape(x)[0]
    if missing:
        x = _on_one(x, mesh)
        x = (np if isinstance(x, np.ndarray) else jnp).concatenate([x, x[-1:].repeat(missing, axis=0)])
    return jax.device_put(x, NamedSharding(mesh, PartitionSpec("worlds")))


def _first(x: jax.Array, worlds: int, mesh: Mesh):
    return _on_one(x, mesh)[:worlds]


def _on_one(x, mesh: Mesh):
    """The array where slicing moves nothing between devices: such a collective hangs on busy CPUs (seen)."""
    return np.asarray(x) if mesh.size > 1 else jnp.asarray(x)


def _rounds(function, parts):
    """`jax.lax.map`, but XLA does not know how often it goes round, and there is room for two rounds: of one
    round it would make other code, and a world's last bits would depend on how many others there are.
    """
    count = parts[0].shape[0]
    parts = parts if count > 1 else [jnp.concatenate([x, x]) for x in parts]
    jaxpr, shape = jax.make_jaxpr(function, return_shape=True)([x[0] for x in parts])
    one = core.jaxpr_as_fun(jaxpr)
    out = [jnp.zeros((max(count, 2), *s.shape), s.dtype) for s in jax.tree.leaves(shape)]

    def go_on(state):
        number, out = state
        found = one(*(jax.lax.dynamic_index_in_dim(x, number, keepdims=False) for x in parts))
        put = jax.lax.dynamic_update_index_in_dim
        return number + 1, [put(all_, x, number, 0) for all_, x in zip(out, found, strict=True)]

    end = jax.lax.optimization_barrier(jnp.int32(count))
    _, out = jax.lax.while_loop(lambda state: state[0] < end, go_on, (jnp.int32(0), out))
    return jax.tree.unflatten(jax.tree.structure(shape), [x[:count] for x in out])


def _vectorised(function, leaves, tree, axes):
    """Plain vmap: on GPUs XLA does well as it is."""

    def flat_function(*flat):
        return function(*jax.tree.unflatten(tree, flat))

    return jax.vmap(flat_function, in_axes=tuple(0 if b else None for b in axes))(*leaves)


def _batch_last_chunk(function, leaves, tree, axes, chunk, block):
    """The same for CPUs, with barriers and the worlds as the last axis."""

    def flat_function(*flat):
        return function(*jax.tree.unflatten(tree, flat))

    one = [
        jax.ShapeDtypeStruct(x.shape[1:] if b else x.shape, x.dtype)
        for x, b in zip(leaves, axes, strict=True)
    ]
    jaxpr, shape = jax.make_jaxpr(flat_function, return_shape=True)(*one)
    # Behind a barrier, or every reader would transpose them anew.
    moved = [jnp.moveaxis(x, 0, -1) if b else x for x, b in zip(leaves, axes, strict=True)]
    values = [Value(x, b, effort=0) for x, b in zip(jax.lax.optimization_barrier(moved), axes, strict=True)]
    out = batch_last(jaxpr, values, chunk, block)
    arrays = [spread(v, s.shape, chunk) for v, s in zip(out, jax.tree.leaves(shape), strict=True)]
    return jax.tree.unflatten(jax.tree.structure(shape), [jnp.moveaxis(x, -1, 0) for x in arrays])
