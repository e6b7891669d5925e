import numpy as np
import pytest

pytest.importorskip("daqp", reason="needs the extra `bench`")

from experiments.benchmarks.serial_loop_peer import (
    SerialLoop,
    SerialLoops,
    circle_twist,
    control_steps_per_second,
)


def test_the_brush_follows_its_circle():
    loop = SerialLoop()
    start = loop.data.site_xpos[loop.site].copy()
    demanded, reached = [start], [start]
    for step in range(400):
        twist = circle_twist(step)
        loop.step(twist)
        demanded.append(demanded[-1] + twist[:3] * loop.model.opt.timestep)
        reached.append(loop.data.site_xpos[loop.site].copy())
    assert np.ptp(demanded, axis=0)[0] > 0.15  # the demand goes somewhere
    assert np.abs(np.subtract(demanded, reached)).max() < 0.005


def test_it_has_a_rate():
    assert control_steps_per_second(steps=20) > 0


def test_two_loops_at_once():
    with SerialLoops(2) as loops:
        assert loops.rate(steps=20) > 0
