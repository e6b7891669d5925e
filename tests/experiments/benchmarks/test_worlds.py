"""What `bench worlds` measures does what its peers do."""

import numpy as np
import pytest

from experiments.benchmarks.worlds.painting_steps import PaintingSteps
from experiments.benchmarks.worlds.physics_rollouts import DynamicRollout, WheeledRollout
from experiments.benchmarks.worlds.scaling import Point, scaling, scaling_figure, scaling_table


@pytest.mark.parametrize(("kind", "close"), [(DynamicRollout, 1e-4), (WheeledRollout, 1e-4)])
def test_physics_are_those_of_mujoco(kind, close):
    rollout = kind(4, 20, 8)
    ours, theirs = np.asarray(rollout.positions(), float), rollout.c_positions()
    np.testing.assert_allclose(ours, theirs, atol=close)
    assert np.abs(theirs - rollout.start).max() > 1e-3


def test_painting_steps_paint():
    steps = PaintingSteps(4, clearance=False)
    bare = PaintingSteps(4, clearance=False)._score(steps._grid, _nothing(steps))
    found = steps.forward()
    assert found.shape == (4,) and np.isfinite(found).all()
    assert (found < 0.95 * float(bare)).all()  # a tenth of the circle is painted


def _nothing(steps):
    import jax

    part = tuple(x[:1] for x in steps._all)
    contacts = steps._moved(*part)
    return jax.tree.map(lambda x: 0 * x[0], contacts)


def test_every_number_of_worlds_is_a_point():
    class Fast:
        def rate(self, worlds=None):
            return 10.0 * (worlds or 1)

    points = scaling("fast", Fast(), worlds=(1, 8))
    assert [(p.worlds, p.rate, p.compile_s) for p in points] == [(1, 10.0, None), (8, 80.0, None)]
    assert len(scaling_table(points).rows) == 2
    figure = scaling_figure([*points, Point("slow", 8, 1.0, 2.0, 3.0)], {"fast": 5.0})
    assert len(figure.axes[0].lines) == 3
