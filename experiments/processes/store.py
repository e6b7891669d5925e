"""Keys and values that all processes of a run see: the coordination service of jax.distributed."""

import contextlib
import threading
import time

from jaxpaint.errors import InputError

_ROOT, _SIGNS = "jaxpaint/", "jaxpaint/signs/"
# Longest value of one key: messages of the service have an end.
_PIECE = 1 << 20
# How long a process waits for the others to start [s]: they may be queued, or slow to load.
START = 300
_WAIT = 0.2
# And how long for them to leave, when all is done [s].
_LEAVE = 30
# A service that is torn down under those who use it ends the process with a dump: it lives as long.
_OPEN: list = []
_LOOPBACK = ("localhost", "127.0.0.1", "::1", "[::1]")


def left_open() -> bool:
    """Whether this process has a service that it did not leave together with the others."""
    return bool(_OPEN)


class Store:
    """Signs are short texts that all look at; contents are bytes that one reads."""

    def __init__(self, state) -> None:
        self._state = state

    def sign(self, name: str, text: str) -> None:
        """Sets a sign; does nothing where the service is gone."""
        with contextlib.suppress(RuntimeError):
            self._state.client.key_value_set(_SIGNS + name, text or "-", allow_overwrite=True)

    def signs(self) -> dict[str, str]:
        """All signs. Raises RuntimeError where the service is gone."""
        found = self._state.client.key_value_dir_get(_SIGNS)
        return {key.removeprefix(_SIGNS): text for key, text in found}

    def put(self, name: str, content: bytes) -> None:
        """Bytes of any length, before a sign says that they are there."""
        pieces = [content[at : at + _PIECE] for at in range(0, len(content), _PIECE)]
        for number, piece in enumerate(pieces):
            self._state.client.key_value_set_bytes(f"{_ROOT}{name}/{number}", piece)
        self._state.client.key_value_set(f"{_ROOT}{name}/pieces", str(len(pieces)))

    def get(self, name: str) -> bytes:
        """What was put there."""
        client = self._state.client
        count = int(client.blocking_key_value_get(f"{_ROOT}{name}/pieces", 1000 * _LEAVE))
        keys = [f"{_ROOT}{name}/{number}" for number in range(count)]
        return b"".join(client.blocking_key_value_get_bytes(key, 1000 * _LEAVE) for key in keys)

    def close(self) -> None:
        """Leaves together with the others."""
        with contextlib.suppress(RuntimeError):
            self._state.shutdown()
        _OPEN.remove(self._state)


def open_store(coordinator: str, count: int, number: int) -> Store:
    """Meets the others at `coordinator` (host:port). Raises InputError where they do not come.

    A process that then ends without `close` has to do so by `os._exit`, see `left_open`.
    """
    import jax
    from jax._src.distributed import State  # the public functions would make all devices global

    jax.config.update("jax_enable_preemption_service", False)  # it would take SIGTERM for itself
    state, failures = State(), []
    _OPEN.append(state)
    # Beside the main thread, which so hears of signals and is less patient than the service, that ends in a
    # dump.
    meeting = threading.Thread(target=_meet, args=(state, coordinator, count, number, failures), daemon=True)
    meeting.start()
    until = time.monotonic() + START
    while meeting.is_alive() and time.monotonic() < until:
        meeting.join(_WAIT)
    if meeting.is_alive():
        failures.append(f"not all came in {START} s")
    if failures:
        allowed = f"an address of process 0 that all {count} processes reach"
        raise InputError(f"--coordinator: found {coordinator!r} ({failures[0]}), allowed: {allowed}")
    return Store(state)


def _meet(state, coordinator: str, count: int, number: int, failures: list[str]) -> None:
    host = coordinator.rpartition(":")[0]
    try:
        state.initialize(
            coordinator,
            count,
            number,
            cluster_detection_method="deactivate",
            initialization_timeout=2 * START,
            coordinator_bind_address=coordinator if host in _LOOPBACK else None,
            shutdown_timeout_seconds=_LEAVE,
        )
    except Exception as error:
        failures.append(str(error).partition("\n")[0])
