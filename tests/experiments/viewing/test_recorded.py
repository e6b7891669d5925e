"""What can be looked at in a run's folder, and one line for what cannot."""

import json
from shutil import copytree

import numpy as np
import pytest

from experiments.viewing import read_recorded
from jaxpaint.errors import InputError


@pytest.fixture
def copied(recorded_run, tmp_path):
    return copytree(recorded_run, tmp_path / "run")


def changed(folder, **arrays):
    """The same run with other arrays; None leaves one out."""
    with np.load(folder / "trajectories.npz") as held:
        kept = {**held, **arrays}
    np.savez(folder / "trajectories.npz", **{name: x for name, x in kept.items() if x is not None})
    return folder


def test_the_motion_of_a_world(recorded_run):
    recorded = read_recorded(recorded_run, "RUN")
    assert recorded.worlds == [3, 1]
    motion = recorded.motion(3)
    assert motion.names[:3] == ("base_x", "base_y", "base_yaw")
    assert motion.joints.shape == (60, 9)
    assert set(motion.stroke.tolist()) == {0, -1, 1}
    assert read_recorded(recorded_run / "summary.json", "RUN").folder == recorded.folder


@pytest.mark.parametrize(("world", "said"), [(0, "not recorded"), (1, "did not paint")])
def test_the_recorded_worlds_are_listed(recorded_run, world, said):
    with pytest.raises(InputError, match=rf"--world: found {world} .*{said}.* allowed: .*3 1"):
        read_recorded(recorded_run, "RUN").motion(world)


def test_samples_after_the_end_are_left_out(copied):
    time = np.where(np.arange(60) < 25, np.arange(60) * 0.08, np.nan)
    motion = read_recorded(changed(copied, time=np.stack([time, time])), "RUN").motion(1)
    assert len(motion.time) == len(motion.joints) == len(motion.brush) == 25


@pytest.mark.parametrize(
    ("arrays", "said"),
    [
        ({"joint_names": None}, "without joint_names"),
        ({"time": np.zeros(3)}, "time with 1 axes"),
        ({"base": np.zeros((2, 59, 3))}, "base of another size"),
        ({"joints": np.zeros((2, 60, 5))}, "joint_names of another size"),
        ({"colour": np.full((2, 60), 2)}, "colour of another size"),
        ({"palette": np.zeros((0, 3))}, "colour of another size"),
        ({"world": np.array([3])}, "world"),
        (
            {name: np.zeros((0, 60, 3)[:k]) for name, k in (("world", 1), ("time", 2))},
            "stroke of another size",
        ),
        ({"stroke": np.array([object()])}, "not a file of arrays"),
        ({"time": np.full((2, 60), "now")}, "time of another kind"),
        ({"colour": np.zeros((2, 60))}, "colour of another kind"),
        ({"palette": np.full((2, 3), "red")}, "palette of another kind"),
        ({"brush": np.full((2, 60, 3), np.nan)}, "brush that is not finite"),
        ({"base": np.full((2, 60, 3), np.inf)}, "base that is not finite"),
        ({"time": np.zeros((2, 60))}, "time that does not rise"),
        ({"world": np.array([3, 3])}, "world more than once"),
        ({"stroke": np.full((2, 60), 2**31 - 1)}, "stroke beyond"),
    ],
)
def test_other_arrays_are_refused(copied, arrays, said):
    with pytest.raises(InputError, match=rf"RUN: found .*trajectories.npz \({said}|{said}\), allowed"):
        read_recorded(changed(copied, **arrays), "RUN")


@pytest.mark.parametrize(("content", "said"), [(None, "No such file"), (b"PK", "not a file"), (b"", "not a")])
def test_no_arrays_at_all(copied, content, said):
    (copied / "trajectories.npz").unlink()
    if content is not None:
        (copied / "trajectories.npz").write_bytes(content)
    with pytest.raises(InputError, match=said):
        read_recorded(copied, "RUN")


def test_a_wall_that_is_gone_is_named_and_a_picture_is_not_asked_for(copied):
    summary = json.loads((copied / "summary.json").read_text())
    summary["config"] |= {"image": "gone.svg"}
    (copied / "summary.json").write_text(json.dumps(summary))
    assert read_recorded(copied, "RUN").options.image is None
    summary["config"] |= {"wall": "gone.ply"}
    (copied / "summary.json").write_text(json.dumps(summary))
    with pytest.raises(InputError, match=r"summary.json: config: --wall: .*gone.ply.*allowed"):
        read_recorded(copied, "RUN")
