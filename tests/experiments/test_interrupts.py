"""Ctrl-C and termination: what is finished is kept, what is not leaves nothing."""

import contextlib
import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from experiments.interrupts import Interrupted, Stop, held, shielded

ROOT = Path(__file__).resolve().parents[2]
# How long a program may take to end where much else runs [s].
SLOW_MACHINE = 300

# The command with groups that only wait: "group" is said as one begins, results are counted.
WAITING = """
import dataclasses, sys, time
from experiments.cli import main
from experiments.commands import command, paint
from experiments.interrupts import Stop, held
out, first, later, writing = sys.argv[1:]
def execute(options, folder):
    done = 0
    with held() as interrupts:
        for group in range(3):
            print("group", flush=True)
            try:
                for _ in range(int(later if group else first)):
                    time.sleep(0.05)
                    interrupts.checked(lambda share: None)(0.1)
            except Stop:
                break
            done += 1
            interrupts.keep()
    folder.path("runs.txt").write_text(f"{done} groups")
    print("writing", flush=True)
    time.sleep(float(writing))
    return command.Outcome({"worlds": done}, (), interrupted=done < 3)
paint.COMMAND = dataclasses.replace(paint.COMMAND, execute=execute)
sys.argv = ["jaxpaint", "paint", "--out", out]
sys.exit(main())
"""

# The command whose table takes long to print.
SHOWING = """
import dataclasses, sys, time
from experiments import tables
from experiments.cli import main
from experiments.commands import command, paint
def show(shown):
    print("shown", flush=True)
    time.sleep(60)
tables.show = show
execute = lambda options, folder: command.Outcome({"worlds": 1}, ())
paint.COMMAND = dataclasses.replace(paint.COMMAND, execute=execute)
sys.argv = ["jaxpaint", "paint", "--out", sys.argv[1]]
sys.exit(main())
"""

PAINTING = """
import sys
from experiments import paint
from experiments.cli import main
score = paint.score
def and_say(*given):
    found = score(*given)
    print("scored", flush=True)
    return found
paint.score = and_say
sys.argv = ["jaxpaint", "paint", *sys.argv[1:]]
sys.exit(main())
"""

PICTURE = """<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 60 60" fill="none" stroke="black">
<path d="M5 10 H40"/><path d="M5 30 Q25 50 50 30"/></svg>"""


def start(code: str, *words: str) -> subprocess.Popen:
    kept = {key: value for key, value in os.environ.items() if not key.startswith("XLA")}
    return subprocess.Popen(
        [sys.executable, "-c", code, *words], env=kept | {"PYTHONPATH": str(ROOT), "JAX_PLATFORMS": "cpu"},
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip


def wait_for(run: subprocess.Popen, word: str, times: int = 1) -> None:
    assert run.stdout is not None
    for line in run.stdout:
        times -= line.strip() == word
        if not times:
            return
    pytest.fail(run.stderr.read() if run.stderr else "ended")


def ends_with_nothing(run: subprocess.Popen, folder: Path) -> None:
    """After a Ctrl-C."""
    _, said = run.communicate(timeout=SLOW_MACHINE)
    assert run.returncode == 130
    assert said == "jaxpaint: interrupted; nothing was written\n"
    assert list(folder.iterdir()) == []


def send(number: int = signal.SIGINT) -> None:
    """To this process; the handler has run when this returns."""
    signal.raise_signal(number)


def test_before_anything_is_finished_a_signal_ends_the_work_at_once():
    with pytest.raises(Interrupted) as caught, held():
        send(signal.SIGTERM)
    assert caught.value.status == 143
    assert isinstance(caught.value, KeyboardInterrupt)


def test_a_signal_whose_exception_something_swallowed_ends_the_work_at_the_next_check():
    with held() as interrupts:
        with contextlib.suppress(Interrupted):  # as Python does in a callback of its garbage collector
            send(signal.SIGTERM)
        with pytest.raises(Interrupted) as caught:
            interrupts.check()
    assert caught.value.status == 143


def test_afterwards_the_first_waits_for_a_check_and_the_second_does_not():
    told = []
    with held() as interrupts:
        interrupts.check()
        interrupts.keep()
        advance = interrupts.checked(told.append)
        advance(0.25)
        send()
        assert interrupts.status == 130
        with pytest.raises(Stop):
            advance(0.5)
        with pytest.raises(Stop):
            interrupts.check()
        with pytest.raises(Interrupted):
            send()
    assert told == [0.25, 0.5]


def test_files_are_put_in_their_place_as_a_whole():
    with held() as interrupts:
        with shielded():
            send()
            send()
        assert interrupts.received == signal.SIGINT
    with shielded(), pytest.raises(KeyboardInterrupt):
        send()


def test_inside_another_it_is_the_same_and_the_handlers_come_back():
    before = signal.getsignal(signal.SIGINT), signal.getsignal(signal.SIGTERM)
    with held() as outer:
        with held() as inner:
            assert inner is outer
        assert signal.getsignal(signal.SIGINT) == outer.handle
    assert (signal.getsignal(signal.SIGINT), signal.getsignal(signal.SIGTERM)) == before
    with held() as next_one:
        assert next_one is not outer


@pytest.mark.parametrize(("number", "status"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_finished_groups_are_written_and_said(number, status, tmp_path):
    run = start(WAITING, str(tmp_path / "out"), "1", "1000", "0")
    wait_for(run, "group", 2)
    run.send_signal(number)
    _, said = run.communicate(timeout=SLOW_MACHINE)
    assert run.returncode == status
    assert said == "jaxpaint paint: interrupted; what was finished is saved\n"
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["interrupted"] is True
    assert summary["worlds"] == 1
    assert sorted(entry.name for entry in (tmp_path / "out").iterdir()) == ["runs.txt", "summary.json"]


def test_nothing_finished_leaves_nothing(tmp_path):
    run = start(WAITING, str(tmp_path / "out"), "1000", "1", "0")
    wait_for(run, "group")
    run.send_signal(signal.SIGINT)
    ends_with_nothing(run, tmp_path)


def test_a_second_signal_ends_at_once_and_leaves_nothing(tmp_path):
    run = start(WAITING, str(tmp_path / "out"), "1", "1", "60")
    wait_for(run, "writing")
    run.send_signal(signal.SIGINT)
    with pytest.raises(subprocess.TimeoutExpired):
        run.communicate(timeout=0.5)
    run.send_signal(signal.SIGINT)
    ends_with_nothing(run, tmp_path)


def test_a_signal_after_the_work_loses_nothing(tmp_path):
    run = start(WAITING, str(tmp_path / "out"), "1", "1", "1")
    wait_for(run, "writing")
    run.send_signal(signal.SIGINT)
    _, said = run.communicate(timeout=SLOW_MACHINE)
    assert run.returncode == 130
    assert said == "jaxpaint paint: interrupted; all is saved\n"
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["worlds"] == 3
    assert "interrupted" not in summary


@pytest.mark.parametrize(("number", "status"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_signal_while_the_result_is_shown_says_that_all_is_written(number, status, tmp_path):
    run = start(SHOWING, str(tmp_path / "out"))
    wait_for(run, "shown")
    run.send_signal(number)
    _, said = run.communicate(timeout=SLOW_MACHINE)
    assert run.returncode == status
    assert said == "jaxpaint paint: interrupted; all is saved\n"
    assert (tmp_path / "out" / "summary.json").is_file()


@pytest.mark.slow
def test_a_painting_run_keeps_its_finished_groups(tmp_path):
    (tmp_path / "line.svg").write_text(PICTURE)
    words = f"--image {tmp_path / 'line.svg'} --canvas-size 0.5 0.5 --worlds 600 --out {tmp_path / 'out'}"
    run = start(PAINTING, *words.split())
    wait_for(run, "scored")
    run.send_signal(signal.SIGINT)
    _, said = run.communicate(timeout=120)
    assert run.returncode == 130, said
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["interrupted"] is True
    assert 30 <= summary["worlds"] <= 256, "a group, whatever the number of cores"
    assert summary["config"]["worlds"] == 600
    assert sum(summary["status"].values()) == summary["worlds"]
    assert (tmp_path / "out" / "report.html").is_file()
