"""Worlds in groups, and what is kept of them."""

import dataclasses

import numpy as np
import pytest

from experiments.finished import Finished, together
from experiments.paint import groups_of
from sims.scoring import WorldScore


@pytest.mark.parametrize("worlds", [1, 64, 65, 200, 600])
def test_groups_are_no_more_than_it_takes(worlds):
    groups = groups_of(np.arange(7, 7 + worlds), 64)
    np.testing.assert_array_equal(np.concatenate(groups), np.arange(7, 7 + worlds))
    assert max(len(group) for group in groups) <= 64
    assert len(groups) == -(-worlds // 64)


def finished(worlds: np.ndarray) -> Finished:
    """Made up: figures that differ from world to world, one of them missing."""
    count, random = len(worlds), np.random.default_rng(int(worlds[0]))
    scores = {field.name: random.normal(size=count) for field in dataclasses.fields(WorldScore)}
    scores |= {"status": np.where(worlds == 1, "unreachable", "ok"), "halts": worlds + 3}
    scores["gap_length"][0] = np.nan
    return Finished(
        world=worlds,
        scores=scores,
        steps=worlds + 100,
        diverged_at=np.full(count, -1),
        down=random.normal(size=count).astype(np.float32),
        travel=random.normal(size=count).astype(np.float32),
        whole_body=random.normal(size=(count, 2)) > 0,
        met=random.integers(0, 9, (8, 500)),
        executed_s=1.25,
    )


def test_what_is_handed_to_another_process_arrives_bit_for_bit():
    sent = finished(np.arange(5))
    back = Finished.from_bytes(sent.to_bytes())
    for name, value in vars(sent).items():
        if name != "scores":
            np.testing.assert_array_equal(value, getattr(back, name))
            assert np.asarray(value).dtype == np.asarray(getattr(back, name)).dtype
    for name, column in sent.scores.items():
        np.testing.assert_array_equal(column, back.scores[name])
    assert [row.status for row in back.rows] == ["ok", "unreachable", "ok", "ok", "ok"]
    assert back.rows[4].halts == 7 and isinstance(back.rows[4].halts, int)


def test_groups_together_are_the_run():
    parts = [finished(np.arange(3)), finished(np.arange(3, 5))]
    whole = together(parts)
    np.testing.assert_array_equal(whole.world, np.arange(5))
    np.testing.assert_array_equal(whole.met, parts[0].met + parts[1].met)
    assert len(whole.rows) == 5
    assert whole.executed_s == 2.5


def test_a_finished_world_keeps_little():
    """The contract of 4,096 worlds in 8 GB: some hundred bytes, and nothing for each point of the picture."""
    many = together([finished(np.arange(64 * k, 64 * k + 64)) for k in range(8)])
    columns = [*many.scores.values(), many.steps, many.diverged_at, many.down, many.travel, many.whole_body]
    assert sum(column.nbytes for column in columns) < 400 * len(many.world)
    assert many.met.shape == (8, 500)
