"""Trajectories of chosen worlds, whatever group they ran in."""

import types

import jax
import numpy as np
import pytest

from experiments.commands.paint_outcome import TRAJECTORIES
from experiments.paint import _unrecorded
from experiments.recording import chosen, joined, recorded, shown
from sims.painting.drive import Driven
from sims.painting.lay import Laid, Truth
from sims.painting.mission import Mission, Modes
from sims.rollout import RECORD_EVERY, Record
from sims.scenes import make_wall

ROWS = [types.SimpleNamespace(status="ok", rmse_total=x) for x in (0.003, 0.001, 0.002)]


@pytest.fixture(scope="module")
def task():
    chain = types.SimpleNamespace(names=("base_x", "base_y", "base_yaw", "elbow"))
    robot = types.SimpleNamespace(chain=chain)
    job = types.SimpleNamespace(robot=robot, scene=make_wall("flat"), dt=0.02)
    return types.SimpleNamespace(job=job, drawing=types.SimpleNamespace(colours=((0.0, 0.0, 0.0), (1, 0, 0))))


def mission(worlds: int, samples: int, first: int = 0, colour=None) -> Mission:
    """Worlds that only differ in numbers: `base` x is 100 world + sample; the last sample is not live."""
    number = 100.0 * (first + np.arange(worlds)[:, None]) + np.arange(samples)
    three = np.repeat(number[..., None], 3, axis=-1)
    pen = np.broadcast_to(np.arange(samples) % 4 < 2, (worlds, samples)).astype(float)
    live = np.broadcast_to(np.arange(samples) < samples - 1, (worlds, samples))
    record = Record(three, three, three[..., :1], three, three, three, pen, pen, number, live)
    whole_body = np.arange(worlds) % 2 == 1
    return Mission(
        status=np.zeros(worlds, int),
        modes=Modes(whole_body, whole_body),
        clouds=(np.zeros((worlds, 5, 3)), np.ones((worlds, 5))),
        painting=None,
        driven=Driven(None, record, np.ones(worlds, bool), np.zeros(worlds, bool)),
        truth=Truth(three, three),
        laid=Laid(None, np.zeros(worlds), np.zeros((worlds, samples, 2)), None, colour),
        surface=None,
        executed_s=1.0,
    )  # fmt: skip


def test_every_array_is_described(task):
    found = recorded(task, mission(3, 9), [2, 0])
    assert list(found) == [name for name in found if name in TRAJECTORIES]
    assert found["joint_names"].tolist() == ["base_x", "base_y", "base_yaw", "elbow"]
    assert found["palette"].shape == (2, 3)
    assert found["world"].tolist() == [2, 0]
    assert found["base"][:, 0, 0].tolist() == [200, 0]
    np.testing.assert_allclose(np.diff(found["time"][0, :-1]), 0.02 * RECORD_EVERY)
    assert np.isnan(found["time"][:, -1]).all()


def test_strokes_are_numbered_as_they_are_drawn(task):
    found = recorded(task, mission(1, 10), [0])
    assert found["stroke"][0].tolist() == [0, 0, -1, -1, 1, 1, -1, -1, 2, -1], "the last is not live"
    assert not found["colour"].any()
    hand = np.tile(np.arange(10) // 5, (1, 1))
    assert recorded(task, mission(1, 10, colour=hand), [0])["colour"][0].tolist() == [0] * 5 + [1] * 5


def test_worlds_of_any_group_in_the_order_that_was_asked_for(task):
    worlds = (6, 0, 5)
    groups = [(np.arange(0, 3), 9), (np.arange(3, 5), 7), (np.arange(5, 8), 12)]
    parts = []
    for index, samples in groups:
        parts += chosen(task, mission(len(index), samples, index[0]), index, worlds)
    assert len(parts) == 2, "nothing is kept of a group without any of them"
    found = joined(parts, worlds)
    assert found["world"].tolist() == [6, 0, 5]
    assert found["base"][:, 0, 0].tolist() == [600, 0, 500]
    assert found["time"].shape == (3, 12)
    assert np.isfinite(found["time"]).sum(axis=1).tolist() == [11, 8, 11]
    assert found["mode"][:, 0].tolist() == [1, 0, 0]
    over = ~np.isfinite(found["time"])
    assert not found["pen"][1, 9:].any()
    assert (found["stroke"][over] == -1).all()
    assert np.isfinite(found["brush"]).all()
    assert found["palette"].shape == (2, 3)


def test_what_is_kept_holds_no_other_worlds(task):
    group = mission(3, 9)
    arrays = [x for x in jax.tree.leaves(group) if isinstance(x, np.ndarray)]
    for name, found in recorded(task, group, [1]).items():
        assert not any(np.shares_memory(found, x) for x in arrays), f"{name} would keep the whole group"


def test_by_default_the_median_the_worst_and_the_first(task):
    assert shown(ROWS) == [2, 0, 1]
    found = recorded(task, mission(3, 9), shown(ROWS))
    assert found["world"].tolist() == [2, 0, 1]


def test_worlds_that_were_not_finished_are_told(task):
    part = chosen(task, mission(3, 9), np.arange(3), (70, 1))
    found = joined(part, (70, 1))
    assert found["world"].tolist() == [1]
    assert _unrecorded((70, 1), [{"world": np.array([1])}]) == ["not recorded, as not finished: world 70"]
    assert _unrecorded((), []) == []
