"""One command in several processes: the split, what they hand in, and that they end together."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from experiments.commands.paint_options import PaintOptions
from experiments.interrupts import Interrupts, Stop
from experiments.processes import Peers, PeersLost
from experiments.processes import peers as of_peers
from experiments.processes.launch import _Local, _watch
from jaxpaint.errors import InputError

ROOT = Path(__file__).resolve().parents[3]
# How long a program may take to end where much else runs [s].
SLOW_MACHINE = 300

# The command with work that only waits: its arguments say what each process does, by number.
WAITING = """
import dataclasses, json, os, signal, sys, time
from experiments.cli import main
from experiments.commands import command, paint
from experiments.interrupts import Stop, held
from experiments.processes import launch, peers
from jaxpaint.errors import InputError
CODE, WORK = {code!r}, {work!r}
def share(options):
    what, found = WORK[peers().number], 0
    print(f"process {{peers().number}} {{os.getpid()}}", file=sys.stderr, flush=True)
    if what == "die":
        time.sleep(2)  # until the others are at work
        os.kill(os.getpid(), signal.SIGKILL)
    if what == "fail":
        raise RuntimeError("no paint left")
    if what == "refuse":
        raise InputError("--image: found nothing, allowed: something")
    with held() as interrupts:
        for index in peers().share(options.worlds):
            try:
                for _ in range(int(what)):
                    time.sleep(0.05)
                    interrupts.checked(peers().checked(lambda share: None))(0.1)
            except Stop:
                break
            found += 1 + int(index)
            interrupts.keep()
        return peers().gather(str(found).encode(), interrupts)
def execute(options, folder):
    parts = share(options)
    folder.path("parts.txt").write_text(b" ".join(parts).decode())
    return command.Outcome({{"worlds": len(parts)}}, ())
paint.COMMAND = dataclasses.replace(paint.COMMAND, execute=execute, share=share)
launch.__globals__["_START"] = CODE.format(code=CODE, work=WORK)
if sys.argv[0] == "-c" and len(sys.argv) > 1:
    sys.exit(main())
"""


def start(out: Path, work: list[str], *words: str) -> subprocess.Popen:
    """`jaxpaint paint` in as many processes as `work` has entries."""
    kept = {key: value for key, value in os.environ.items() if not key.startswith(("XLA", "JAX"))}
    where = ["paint", "--out", str(out), "--processes", str(len(work)), *words]
    return subprocess.Popen(
        [sys.executable, "-c", WAITING.format(code=WAITING, work=work), *where],
        env=kept | {"PYTHONPATH": str(ROOT), "JAX_PLATFORMS": "cpu"},
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip


def ended(run: subprocess.Popen) -> tuple[int, list[str]]:
    """Exit status, and the lines on standard error without those of the work itself."""
    _, said = run.communicate(timeout=SLOW_MACHINE)
    return run.returncode, [line for line in said.splitlines() if not line.startswith("process ")]


def first_pid(run: subprocess.Popen) -> int:
    """Of process 0, once it works."""
    assert run.stderr is not None
    return int(run.stderr.readline().split()[2])


def is_alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return "\nState:\tZ" not in Path(f"/proc/{pid}/status").read_text()


@pytest.mark.parametrize(("worlds", "count"), [(7, 2), (7, 3), (4096, 6), (2, 2), (5, 1)])
def test_every_world_has_one_process(worlds, count):
    shares = [Peers(count, number).share(worlds) for number in range(count)]
    np.testing.assert_array_equal(np.concatenate(shares), np.arange(worlds))
    assert len(shares[0]) == -(-worlds // count) == max(map(len, shares))
    assert min(map(len, shares)) >= len(shares[0]) - 1


def test_a_process_alone_gathers_what_it_has():
    alone = of_peers()
    assert (alone.count, alone.number) == (1, 0)
    assert alone.gather(b"mine", Interrupts()) == [b"mine"]
    alone.check()


class Memory:
    """A store that only this process sees."""

    def __init__(self):
        self.texts, self.contents = {}, {}

    def sign(self, name, text):
        self.texts[name] = text

    def signs(self):
        return dict(self.texts)

    def put(self, name, content):
        self.contents[name] = content

    def get(self, name):
        return self.contents[name]


def test_the_first_one_gathers_in_order():
    store = Memory()
    for number in (2, 1):
        assert Peers(3, number, store).gather(f"of {number}".encode(), Interrupts()) == []
    assert Peers(3, 0, store).gather(b"of 0", Interrupts()) == [b"of 0", b"of 1", b"of 2"]


def test_a_failure_is_told_and_silence_is_noticed(monkeypatch):
    store = Memory()
    first = Peers(2, 0, store)
    store.sign("alive-1", "1")
    first.check()
    now = time.monotonic()
    monkeypatch.setattr(time, "monotonic", lambda: now + 100)
    store.sign("alive-0", "7")
    store.sign("alive-1", "2")
    first.check()
    monkeypatch.setattr(time, "monotonic", lambda: now + 200)
    store.sign("alive-0", "8")
    with pytest.raises(PeersLost, match="process 1 of 2 gave no sign of life"):
        first.check()
    store.sign("failed-1", "process 1 of 2 failed: why")
    with pytest.raises(PeersLost, match="failed: why"):
        first.check()


def test_the_first_one_asks_the_others_to_stop():
    store, stopped = Memory(), Interrupts()
    stopped.received = signal.SIGINT
    second = Peers(2, 1, store)
    store.sign("handed-in-1", "-")
    store.put("part-1", b"late")
    Peers(2, 0, store).gather(b"", Interrupts())
    second.check()
    store.sign("stop", "-")
    with pytest.raises(Stop):
        second.check()


@pytest.mark.parametrize(
    ("change", "name"),
    [
        ({"processes": 0}, "--processes"),
        ({"processes": 9, "worlds": 8}, "--processes: found '9', allowed: at most --worlds"),
        ({"process": 0}, "--process: found '0' .no effect."),
        ({"processes": 2, "coordinator": "here:1"}, "--coordinator: .* allowed: only beside --process"),
        ({"processes": 2, "coordinator": "here:1", "process": 2}, "--process: found '2', allowed: 0 to 1"),
        ({"processes": 2, "coordinator": "here", "process": 0}, "--coordinator: found 'here'"),
        ({"processes": 2, "coordinator": "here:0", "process": 0}, "--coordinator"),
        ({"processes": 2, "coordinator": "here:1", "process": -1}, "--process"),
        ({"processes": 2, "worlds": 4, "export": ("csv",), "export_world": 2}, "--export-world: .* below 2"),
        ({"memory_gb": 0.0}, "--memory-gb"),
    ],
)
def test_bad_options_are_refused(change, name):
    with pytest.raises(InputError, match=name):
        PaintOptions(**change).check()


def test_all_hand_in_and_the_first_one_writes(tmp_path):
    status, said = ended(start(tmp_path / "out", ["1", "3", "2"], "--worlds", "5"))
    assert (status, said) == (0, [])
    assert (tmp_path / "out" / "parts.txt").read_text() == "3 7 5"


@pytest.mark.parametrize(
    ("work", "words"),
    [("die", "process 1 of 2 was killed by signal 9"), ("fail", "process 1 of 2 failed: no paint left")],
)
def test_a_process_that_fails_ends_all(work, words, tmp_path):
    run = start(tmp_path / "out", ["1000", work])
    pid = first_pid(run)
    status, said = ended(run)
    assert status == 1
    assert words in said[-1]
    assert not is_alive(pid)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
@pytest.mark.parametrize(
    ("work", "words"),
    [("fail", "RuntimeError: no paint left"), ("die", "process 0 of 2 was killed by signal 9")],
)
def test_the_first_one_may_fail_too(work, words, tmp_path):
    status, said = ended(start(tmp_path / "out", [work, "1000"]))
    assert (status, len(said)) == (1, 1)
    assert words in said[0]
    assert list(tmp_path.iterdir()) == []


def test_bad_input_is_one_line(tmp_path):
    status, said = ended(start(tmp_path / "out", ["refuse", "refuse"]))
    assert (status, said) == (2, ["jaxpaint: --image: found nothing, allowed: something"])
    assert list(tmp_path.iterdir()) == []


def test_ctrl_c_ends_all_and_leaves_nothing(tmp_path):
    run = start(tmp_path / "out", ["1000", "1000"])
    pid = first_pid(run)
    run.send_signal(signal.SIGINT)
    assert ended(run) == (130, ["jaxpaint: interrupted; nothing was written"])
    assert not is_alive(pid)
    assert list(tmp_path.iterdir()) == []


def test_what_the_end_of_the_first_one_kills_is_no_failure():
    """Its end takes the service away, which others may die of, and be seen to be dead before it is."""
    words = [
        "import sys, time; time.sleep(0.5); sys.exit(130)",
        "import os, signal; os.kill(os.getpid(), signal.SIGABRT)",
    ]
    local = [_Local(k, subprocess.Popen([sys.executable, "-c", x]), None) for k, x in enumerate(words)]
    assert _watch(local) is None
    assert local[0].run.returncode == 130


@pytest.mark.slow
def test_ctrl_c_keeps_what_is_finished(tmp_path):
    run = start(tmp_path / "out", ["1", "1000"], "--worlds", "4")
    first_pid(run)
    time.sleep(3)
    run.send_signal(signal.SIGINT)
    status, said = ended(run)
    assert status == 130, said
    assert (tmp_path / "out" / "parts.txt").read_text() == "3 0"


@pytest.mark.slow
def test_processes_whose_starter_is_killed_end(tmp_path):
    run = start(tmp_path / "out", ["1000", "1000"])
    pid = first_pid(run)
    run.kill()
    run.communicate(timeout=SLOW_MACHINE)
    until = time.monotonic() + SLOW_MACHINE
    while is_alive(pid) and time.monotonic() < until:
        time.sleep(0.1)
    assert not is_alive(pid)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_processes_started_one_by_one_meet(tmp_path):
    """As a cluster's launcher does it; the first one notices that the other one dies."""
    words = ["--worlds", "4", "--coordinator", f"127.0.0.1:{free_port()}"]
    runs = [start(tmp_path / "out", ["1", "2"], *words, "--process", str(number)) for number in (1, 0)]
    assert [ended(run) for run in runs] == [(0, []), (0, [])]
    assert (tmp_path / "out" / "parts.txt").read_text() == "3 7"


def free_port() -> int:
    import socket

    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]
