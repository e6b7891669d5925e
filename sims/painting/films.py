"""The paint of many worlds, which together may be more than memory holds."""

from collections.abc import Callable, Iterator
from typing import Any

import jax
import numpy as np
from jaxtyping import Float, Int

HELD = 800e6  # bytes of films that are kept: a fraction of a small machine's memory

Group = Int[np.ndarray, " group"]


class Films:
    """Film thickness [worlds, colours, rows, columns] in metres.

    Where all worlds fit into `HELD` bytes they are kept. Else they are laid again, group by group, whenever
    somebody asks: laying gives the same bits each time. One world is had by its index from 0 (IndexError
    beyond the last, and below 0), all of them by `np.asarray`, and as many as lie in memory at once by
    `groups`.
    """

    def __init__(self, shape: tuple[int, ...], groups: tuple[Group, ...], lay: Callable, first: Any = None):
        """groups: as from `split`. lay: from worlds to their films. first: of the only group, if known."""
        self.shape, self._groups, self._lay = shape, groups, lay
        self._at, self._parts = -1, []
        if first is not None:
            self._at, self._parts = 0, [first]

    def groups(self) -> Iterator[tuple[Group, Float[np.ndarray, "group colours rows columns"]]]:
        """Worlds and their films, every world once and in order."""
        seen = 0
        for number, worlds in enumerate(self._groups):
            start = int(worlds[0])
            for films in self._films(number):
                stop = start + len(films)
                if stop > seen:
                    first = max(seen, start)
                    yield np.arange(first, stop), films[first - start :]
                    seen = stop
                start = stop

    def __len__(self) -> int:
        return self.shape[0]

    def __getitem__(self, world: int) -> Float[np.ndarray, "colours rows columns"]:
        if not 0 <= world < len(self):
            raise IndexError(f"world: found {world}, allowed: 0 to {len(self) - 1}")
        number = next(k for k, worlds in enumerate(self._groups) if world <= worlds[-1])
        pieces, place = iter(self._films(number)), world - int(self._groups[number][0])
        films = next(pieces)
        while place >= len(films):
            place -= len(films)
            films = next(pieces)
        return films[place]

    def __array__(self, dtype=None, copy=None) -> np.ndarray:
        whole = np.concatenate([films for _, films in self.groups()])
        return whole if dtype is None else whole.astype(dtype)

    def _films(self, number: int) -> list[np.ndarray]:
        """A group's films, in the pieces in which they lie in memory."""
        if self._at != number:
            self._at, self._parts = number, []  # freed before the next ones come
            self._parts = [self._lay(self._groups[number])]
        self._parts = [piece for part in self._parts for piece in _pieces(part)]
        return self._parts


def _pieces(films: jax.Array | np.ndarray) -> list[np.ndarray]:
    """Per device, so that nothing is copied."""
    if isinstance(films, np.ndarray):
        return [films]
    shards = sorted(films.addressable_shards, key=lambda shard: shard.index[0].start or 0)
    return [np.asarray(shard.data) for shard in shards]


def split(worlds: int, size: int) -> tuple[Group, ...]:
    """Groups of one length, so that they share a compilation, for films of `size` bytes a world.

    The last group reaches back into the one before.
    """
    count = min(worlds, max(2, int(HELD // size) // 2 * 2))
    starts = [*range(0, worlds - count, count), worlds - count]
    return tuple(np.arange(start, start + count) for start in starts)
