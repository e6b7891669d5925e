"""The base's drive by the names of its joints."""

import numpy as np
import pytest

from jaxpaint.errors import InputError
from jaxpaint.steering import RollerWheels, SteeredWheels
from sims.robots import load_robot

BODY = """
<mujoco><custom>{numeric}</custom><worldbody><body name="base">
  <joint name="base_x" type="slide" axis="1 0 0"/><joint name="base_y" type="slide" axis="0 1 0"/>
  <joint name="base_yaw" axis="0 0 1"/><geom type="box" size="0.3 0.2 0.1" mass="1"/>{wheels}
  <body pos="0 0 0.5"><joint name="arm" axis="0 1 0"/><geom size="0.05" mass="1"/>
    <site name="brush" pos="0.5 0 0"/><site name="camera"/></body></body></worldbody>
  <keyframe><key name="home"/></keyframe></mujoco>"""
CORNERS = {"fl": (0.3, 0.2), "fr": (0.3, -0.2), "rl": (-0.3, 0.2), "rr": (-0.3, -0.2)}


def wheel(kind, name, place):
    return (
        f'<body pos="{place[0]} {place[1]} 0.1"><joint name="{kind}_{name}" axis="0 1 0"/>'
        '<geom type="cylinder" size="0.08 0.02" mass="1"/></body>'
    )


def steered(name, place):
    x, y = place
    return (
        f'<body pos="{x} {y} 0.1"><joint name="steer_{name}" axis="0 0 1"/><geom size="0.03" mass="1"/>'
        f'<body><joint name="wheel_{name}" axis="0 1 0"/>'
        '<geom type="cylinder" size="0.08 0.02" mass="1"/></body></body>'
    )


def robot(tmp_path, wheels, numeric=""):
    path = tmp_path / "base.xml"
    path.write_text(BODY.format(wheels=wheels, numeric=numeric))
    return load_robot(path)


def test_pairs_are_steered_and_need_not_be_four(tmp_path):
    three = {"a": (0.3, 0.0), "b": (-0.2, 0.2), "c": (-0.2, -0.2)}
    drive = robot(tmp_path, "".join(steered(*item) for item in three.items())).drive
    assert isinstance(drive, SteeredWheels)
    np.testing.assert_allclose(drive.position, list(three.values()), atol=1e-6)
    assert float(drive.speed_limit) == pytest.approx(12 * 0.08)


def test_wheels_alone_are_mecanum_with_the_files_roller_angle(tmp_path):
    wheels = "".join(wheel("wheel", *item) for item in CORNERS.items())
    for numeric, slope in (("", 1.0), ('<numeric name="roller_angle" data="0.5"/>', 1 / np.tan(0.5))):
        drive = robot(tmp_path, wheels, numeric).drive
        assert isinstance(drive, RollerWheels)
        np.testing.assert_allclose(drive.rows[:, 1], slope * np.array([-1, 1, 1, -1]), rtol=1e-6)


@pytest.mark.parametrize(
    ("wheels", "numeric", "message"),
    [
        (wheel("wheel", "left", (0, 0.2)) + wheel("wheel", "right", (0, -0.2)), "", "2 wheels.*differential"),
        (
            "".join(
                (steered if n[0] == "f" else lambda *x: wheel("wheel", *x))(n, p) for n, p in CORNERS.items()
            ),
            "",
            "wheels rl, rr have only one.*steered.*mecanum.*holonomic",
        ),
        ("".join(wheel("wheel", n, (p[0], 0)) for n, p in CORNERS.items()), "", "off both axes"),
        (
            "".join(wheel("wheel", *item) for item in CORNERS.items()),
            '<numeric name="roller_angle" data="2"/>',
            "rollers at 2 rad.*between 0 and pi/2",
        ),
        ("".join(steered(n, (0.1, 0.1)) for n in CORNERS), "", "one spot"),
    ],
)
def test_bases_that_cannot_be_are_refused(tmp_path, wheels, numeric, message):
    with pytest.raises(InputError, match=message) as caught:
        robot(tmp_path, wheels, numeric)
    assert "\n" not in str(caught.value)
