"""Progress on standard error: a bar for work that takes a while, nothing where nobody watches."""

import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Protocol

PATIENCE = 2.0
"""Seconds before a bar appears: shorter work needs none."""


class Bar(Protocol):
    """What the work tells about itself."""

    def advance(self, amount: float = 1.0) -> None:
        """So much more of the total is done."""
        ...

    def describe(self, text: str) -> None:
        """What is being done now."""
        ...


class _Silent:
    """No bar: standard error is not a terminal."""

    def advance(self, amount: float = 1.0) -> None:
        del amount

    def describe(self, text: str) -> None:
        del text


class _Shown:
    """A bar of rich, drawn from its own thread once the patience is over."""

    def __init__(self, text: str, total: float | None) -> None:
        from rich.console import Console
        from rich.progress import Progress, TimeElapsedColumn

        self._progress = Progress(
            *Progress.get_default_columns(), TimeElapsedColumn(), console=Console(stderr=True), transient=True
        )
        self._task = self._progress.add_task(text, total=total)
        self._timer = threading.Timer(PATIENCE, self._progress.start)
        self._timer.daemon = True
        self._timer.start()

    def advance(self, amount: float = 1.0) -> None:
        self._progress.advance(self._task, amount)

    def describe(self, text: str) -> None:
        self._progress.update(self._task, description=text)

    def close(self) -> None:
        self._timer.cancel()
        self._timer.join()  # a bar that was just starting is stopped too
        self._progress.stop()


@contextmanager
def silent(text: str, total: float | None = None) -> Iterator[Bar]:
    """No bar, for work beside other work that has one."""
    yield _Silent()


@contextmanager
def progress(text: str, total: float | None = None) -> Iterator[Bar]:
    """A bar for `total` units of work (None: unknown), gone at the end.

    with progress("paint", worlds) as bar:
        bar.advance(chunk)
    """
    if not sys.stderr.isatty():
        yield _Silent()
        return
    bar = _Shown(text, total)
    try:
        yield bar
    finally:
        bar.close()
