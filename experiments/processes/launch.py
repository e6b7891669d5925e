"""Several local processes of one command line: started, watched, and ended together."""

import os
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import IO, NamedTuple

from experiments.output import sweep
from experiments.process import PROCESSES_HERE

# What a process runs: the program itself, from where this one's code is.
_START = "import sys; from experiments.cli import main; sys.exit(main())"
_ROOT = Path(__file__).resolve().parents[2]
# A process that says itself why it failed leaves the first one time to hear of it, or to fail alike [s].
_HEARD = 30.0
# One that the end of the first one kills may be seen to end before it [s].
_SEEN = 1.0
# How long processes may take to end once they were told [s]: compiling cannot be broken off.
_LAST = 60.0
_WATCH = 0.1
_VISIBLE = "CUDA_VISIBLE_DEVICES"
# Names that the coordination service does not ask a proxy for.
_NO_PROXY = "no_grpc_proxy"


class _Local(NamedTuple):
    """One process of the run, and where its standard error goes; None: where that of this one goes."""

    number: int
    run: subprocess.Popen
    said: IO[bytes] | None


def launch(words: Sequence[str], count: int, out: Path | None) -> int:
    """Runs the command line `words`, which writes into `out`, in `count` processes on this machine; the first
    one's exit status.

    The first process shows and writes everything. Where another one fails or dies all end: status 1, and a
    line says which and how. Signals are handed on to all. Where this process is killed, the others end by
    themselves.
    """
    coordinator = f"127.0.0.1:{_free_port()}"
    local: list[_Local] = []
    try:
        for number in range(count):
            where = ["--coordinator", coordinator, "--process", str(number)]
            local.append(_start(number, [*words, *where], count))
        with _handing_on(local):
            lost = _watch(local)
            status = _ended(local[0])
            for other in local[1:]:
                _wait_for(other, _LAST if status == 0 else 0.0)
    finally:
        _end(local)
        if local and _ended(local[0]) < 0:
            sweep(out, local[0].run.pid)
    if lost is None and status >= 0:
        return status
    print(f"jaxpaint: failed: {_account(lost or local[0], count)}", file=sys.stderr, flush=True)
    return 1


def _start(number: int, words: list[str], count: int) -> _Local:
    """In a session of its own: Ctrl-C comes by way of the process that started it."""
    said = tempfile.TemporaryFile() if number else None  # noqa: SIM115
    path = os.pathsep.join([str(_ROOT), *filter(None, [os.environ.get("PYTHONPATH")])])
    direct = ",".join([*filter(None, [os.environ.get(_NO_PROXY)]), "127.0.0.1"])
    own = {"PYTHONPATH": path, _NO_PROXY: direct, PROCESSES_HERE: str(count), **_gpus(number, count)}
    run = subprocess.Popen(
        [sys.executable, "-c", _START, *words],
        env=os.environ | own,
        stdin=subprocess.PIPE,  # its end says that this process is gone
        stdout=subprocess.DEVNULL if number else None,
        stderr=said,
        start_new_session=True,
    )
    return _Local(number, run, said)


def _gpus(number: int, count: int) -> dict[str, str]:
    """Which of the machine's GPUs a process sees; nothing is said where there are fewer than processes."""
    chosen = os.environ.get(_VISIBLE)
    here = Path("/dev").glob("nvidia[0-9]*") if chosen is None else ()
    names = sorted(path.name.removeprefix("nvidia") for path in here) if chosen is None else chosen.split(",")
    return {_VISIBLE: ",".join(names[number::count])} if len(names) >= count else {}


def _watch(local: list[_Local]) -> _Local | None:
    """Until the first process has ended; which other one failed before, if the run ends for that."""
    lost, since = None, 0.0
    while local[0].run.poll() is None:
        time.sleep(_WATCH)
        if lost is None:
            lost = next((other for other in local[1:] if other.run.poll() not in (None, 0)), None)
            since = time.monotonic()
        patience = _SEEN if lost is not None and _ended(lost) < 0 else _HEARD
        if lost is not None and time.monotonic() - since > patience and local[0].run.poll() is None:
            _end(local)
            return lost
    return None


def _end(local: list[_Local]) -> None:
    """Told twice, since a run that has something finished only notes the first; then killed."""
    for number in (signal.SIGTERM, signal.SIGTERM):
        for one in local:
            _send(one, number)
        _wait_for_all(local, 1.0)
    _wait_for_all(local, _LAST)
    for one in local:
        _send(one, signal.SIGKILL)
        one.run.wait()


def _wait_for_all(local: list[_Local], seconds: float) -> None:
    until = time.monotonic() + seconds
    for one in local:
        _wait_for(one, max(0.0, until - time.monotonic()))


def _wait_for(one: _Local, seconds: float) -> None:
    try:
        one.run.wait(seconds)
    except subprocess.TimeoutExpired:
        return


def _send(one: _Local, number: int) -> None:
    if one.run.poll() is None:
        one.run.send_signal(number)


def _ended(one: _Local) -> int:
    """The exit status; minus a signal's number."""
    return one.run.poll() or 0


@contextmanager
def _handing_on(local: list[_Local]) -> Iterator[None]:
    """Ctrl-C and termination go to all: each process keeps what it has finished, and the first one writes."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def hand_on(number: int, _: object) -> None:
        for one in local:
            _send(one, number)

    before = {number: signal.signal(number, hand_on) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler if handler is not None else signal.SIG_DFL)


def _account(one: _Local, count: int) -> str:
    """Which process ended, and how: its own last words, where it had some."""
    name, status = f"process {one.number} of {count}", _ended(one)
    if status < 0:
        return f"{name} was killed by signal {-status} ({signal.Signals(-status).name})"
    words = b""
    if one.said is not None:
        one.said.seek(0)
        words = (one.said.read().strip().splitlines() or [b""])[-1]
    return f"{name} ended with status {status}: {words.decode(errors='replace').removeprefix('jaxpaint: ')}"


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]
