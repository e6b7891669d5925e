"""The processes that one run is split over, as one of them sees the others.

They find each other by the coordination service of jax.distributed, which process 0 runs, and talk through
its store of keys and values. Devices stay apart: each process computes on its own, as a run alone would, and
keeps compiled programs like one. (With jax's global devices all but the first would, on CPUs, compile anew
each time.)
"""

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np
from jaxtyping import Int

from experiments.interrupts import Interrupts, Stop
from experiments.processes.store import Store, open_store

BEAT = 2.0
"""Seconds between two signs of life."""
SILENT = 40.0
"""Seconds without one after which a process counts as dead: others may hold the interpreter for some."""
_WAIT = 0.2


class PeersLost(Exception):
    """Another process failed or died: the run has no result."""


class Peers:
    """All processes of a run; made by `joined`. count: how many. number: of this one, from 0."""

    def __init__(self, count: int = 1, number: int = 0, store: Store | None = None) -> None:
        self.count, self.number = count, number
        self._store = store
        self._beats: dict[int, tuple[str, float]] = {}

    def share(self, worlds: int) -> Int[np.ndarray, " share"]:
        """Indices of this process's worlds: neighbours, and as many as any other has, or one more."""
        return np.array_split(np.arange(worlds), self.count)[self.number]

    def check(self) -> dict[str, str]:
        """The signs that were set. Raises PeersLost where a process failed or is silent, and Stop where
        process 0 asks the others to end with what is finished.
        """
        if self._store is None:
            return {}
        signs = self._read()
        failed = [name for name in signs if name.startswith("failed-")]
        if failed:
            raise PeersLost(signs[failed[0]])
        for number in range(self.count):
            self._listen(number, signs.get(f"alive-{number}", ""))
        if self.number and "stop" in signs and "done" not in signs:
            raise Stop
        return signs

    def checked(self, advance: Callable[..., None]) -> Callable[..., None]:
        """The progress callback with `check` behind it."""

        def advance_and_check(amount: float = 1.0) -> None:
            advance(amount)
            self.check()

        return advance_and_check

    def gather(self, content: bytes, interrupts: Interrupts) -> list[bytes]:
        """What all processes found, in their order, for process 0; nothing for the others, which hand in
        theirs. Raises PeersLost.
        """
        if self._store is None:
            return [content]
        if self.number:
            self._store.put(f"part-{self.number}", content)
            self._store.sign(f"handed-in-{self.number}", "")
            return []
        return [content, *(self._part(number, interrupts) for number in range(1, self.count))]

    def wait_for_the_end(self) -> None:
        """Until process 0 has written everything. Raises PeersLost."""
        while self.number and not self._is_done():
            time.sleep(_WAIT)

    def tell(self, name: str, text: str = "") -> None:
        """Sets a sign for all; what cannot be said is not: they find out by the silence."""
        if self._store is not None:
            self._store.sign(name, text)

    def _is_done(self) -> bool:
        try:
            return "done" in self.check()
        except Stop:
            return False

    def _part(self, number: int, interrupts: Interrupts) -> bytes:
        assert self._store is not None
        while f"handed-in-{number}" not in self.check():
            if interrupts.received is not None:
                self.tell("stop")
            time.sleep(_WAIT)
        return self._store.get(f"part-{number}")

    def _read(self) -> dict[str, str]:
        assert self._store is not None
        try:
            return self._store.signs()
        except RuntimeError as error:
            raise PeersLost(f"process 0 of {self.count} does not answer") from error

    def _listen(self, number: int, beat: str) -> None:
        """Judged by what this process saw: it may not have looked for long."""
        now = time.monotonic()
        before, since = self._beats.get(number, ("", now))
        if beat != before or number not in self._beats:
            self._beats[number] = beat, now
        elif now - since > SILENT:
            raise PeersLost(f"process {number} of {self.count} gave no sign of life for {SILENT:.0f} s")


_joined: list[Peers] = []


def peers() -> Peers:
    """The processes of this run: this one alone outside of `joined`."""
    return _joined[-1] if _joined else Peers()


@contextmanager
def joined(coordinator: str | None, count: int, number: int) -> Iterator[Peers]:
    """This process as one of `count` that meet at `coordinator` (host:port); None: alone.

    Left by an exception, all others are told. Raises InputError where nobody is met.
    """
    if coordinator is None:
        yield Peers()
        return
    store = open_store(coordinator, count, number)
    mine, over = Peers(count, number, store), threading.Event()
    threading.Thread(target=_beat, args=(mine, over), daemon=True).start()
    _joined.append(mine)
    try:
        yield mine
        if not number:
            mine.tell("done")
        store.close()
    except BaseException as error:
        mine.tell(f"failed-{number}", _words(mine, error))
        raise
    finally:
        over.set()
        _joined.remove(mine)


def _beat(mine: Peers, over: threading.Event) -> None:
    count = 0
    while not over.wait(BEAT):
        count += 1
        mine.tell(f"alive-{mine.number}", str(count))


def _words(mine: Peers, error: BaseException) -> str:
    if isinstance(error, PeersLost):
        return str(error)
    what = "was interrupted" if isinstance(error, KeyboardInterrupt) else f"failed: {error}"
    return f"process {mine.number} of {mine.count} {what}"
