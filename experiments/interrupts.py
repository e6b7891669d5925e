"""Ctrl-C and termination: the first ends the work with what is finished, the second ends it at once."""

import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager

SIGNALS = (signal.SIGINT, signal.SIGTERM)
INTERRUPTED = 130
"""Exit status after Ctrl-C, by the shells' convention of 128 plus the signal's number."""


class Interrupted(KeyboardInterrupt):
    """A signal ended the work at once; `status` is the exit status that a shell expects."""

    def __init__(self, number: int) -> None:
        super().__init__()
        self.status = 128 + number


class Stop(Exception):
    """The work was asked to stop and there is something finished to keep; raised by `Interrupts.check`."""


class Interrupts:
    """What signals asked of the work; made by `held`.

    received: the signal that asked to stop, None while none did. Before `keep` a signal ends the work at
    once, since there is nothing to lose; after it the first signal only waits for the next `check`.
    """

    def __init__(self) -> None:
        self.received: int | None = None
        self._keeping = False
        self._shields = 0

    def keep(self) -> None:
        """Something is finished from now on: a signal must not lose it."""
        self._keeping = True

    def check(self) -> None:
        """Raise Stop where a signal asked for it: called between pieces of work. With nothing to keep it ends
        the work, whose handler's exception something has swallowed (Python drops one in a callback of its
        garbage collector).
        """
        if self.received is not None:
            raise Stop if self._keeping else Interrupted(self.received)

    def checked(self, advance):
        """The progress callback `advance` with a check behind it: long work calls it between its pieces."""

        def advance_and_check(amount: float = 1.0) -> None:
            advance(amount)
            self.check()

        return advance_and_check

    @property
    def status(self) -> int | None:
        """The exit status of a work that was asked to stop."""
        return None if self.received is None else 128 + self.received

    def handle(self, number: int, _: object) -> None:
        """The signal handler."""
        again, self.received = self.received is not None, number
        if not self._shields and (again or not self._keeping):
            raise Interrupted(number)
        if sys.stderr.isatty():
            print("\nstopping; what is finished is kept (again: ends at once)", file=sys.stderr, flush=True)

    @contextmanager
    def _shielded(self) -> Iterator[None]:
        self._shields += 1
        try:
            yield
        finally:
            self._shields -= 1


_active: list[Interrupts] = []


@contextmanager
def shielded() -> Iterator[None]:
    """No signal breaks off what happens inside: short work on files that must be done as a whole."""
    if not _active:
        yield
        return
    with _active[0]._shielded():
        yield


@contextmanager
def held() -> Iterator[Interrupts]:
    """Signals go to the one Interrupts of this process; inside another `held` it is that one's.

    with held() as interrupts:
        for group in groups:
            try:
                results.append(work(group, advance=interrupts.checked(bar.advance)))
            except Stop:
                break
            interrupts.keep()
    Outside of the main thread, where Python allows no handlers, signals do what they did.
    """
    if _active:
        yield _active[0]
        return
    own = Interrupts()
    _active.append(own)
    before = {}
    try:
        if threading.current_thread() is threading.main_thread():
            before = {number: signal.signal(number, own.handle) for number in SIGNALS}
        yield own
    finally:
        _active.remove(own)
        for number, handler in before.items():
            signal.signal(number, handler if handler is not None else signal.SIG_DFL)
