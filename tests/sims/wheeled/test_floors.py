"""Floors and wheels that are refused, in one line."""

import dataclasses

import mujoco
import numpy as np
import pytest

from jaxpaint.errors import InputError
from sims.robots import load_robot, robot_model
from sims.wheeled import Bump, Flat, Ramp, at_rest, wheeled_model


@pytest.mark.parametrize(
    "make",
    [
        lambda: Ramp(slope=0.0),
        lambda: Ramp(slope=0.5),
        lambda: Bump(height=-0.05),
        lambda: Bump(width=float("inf")),
        lambda: Bump(height=0.2),
    ],
)
def test_floors_that_no_robot_stands_on(make):
    with pytest.raises(InputError, match="allowed"):
        make()


def test_a_bump_is_s2s_prism():
    bump = Bump()
    assert (bump.length, bump.width, bump.height) == (1.0, 0.35, 0.05)
    model = wheeled_model(robot_model(), dataclasses.replace(bump, center=(2.0, 1.0)))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    lowest = model.geom("floor").pos[2]
    for y, height in ((1.0, 0.05), (1.0 + 0.0875, 0.025)):
        hit = mujoco.mj_ray(
            model,
            data,
            np.array([2.0, y, 1.0]),
            np.array([0.0, 0.0, -1.0]),
            None,
            1,
            -1,
            np.zeros(1, np.int32),
        )
        assert 1.0 - hit - lowest == pytest.approx(height, abs=1e-6)


def test_wheels_touch_in_pairs_with_every_part_of_the_floor():
    assert wheeled_model(robot_model(), Flat()).npair == 4
    assert wheeled_model(robot_model(), Ramp()).npair == 8


def test_a_loaded_tyre_is_a_little_flat():
    home = np.asarray(load_robot().home, float)
    rest = at_rest(wheeled_model(robot_model()), home)
    assert 0.099 < rest.rolling_radius < 0.1 and -1e-3 < rest.tilt[0] < -3e-4
    lifted = at_rest(wheeled_model(robot_model(), height=-rest.tilt[0]), home)
    assert abs(lifted.tilt[0]) < 1e-9


def test_robots_without_steered_wheels_are_refused():
    spec = mujoco.MjSpec()
    body = spec.worldbody.add_body(name="base")
    for name, kind, axis in (("base_x", 2, [1, 0, 0]), ("base_y", 2, [0, 1, 0]), ("base_yaw", 3, [0, 0, 1])):
        body.add_joint(name=name, type=mujoco.mjtJoint(kind), axis=axis)
    body.add_geom(size=[0.1, 0, 0])
    body.add_site(name="brush")
    with pytest.raises(InputError, match="wheels none"):
        wheeled_model(spec.compile())
