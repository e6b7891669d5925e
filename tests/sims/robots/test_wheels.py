"""The base's drive by the names of its joints."""

import numpy as np
import pytest

from jaxpaint.errors import InputError
from jaxpaint.steering import CasterWheels, DifferentialWheels, RollerWheels, SteeredWheels
from sims.robots import check_can_paint, load_robot

BODY = """
<mujoco><custom>{numeric}</custom><worldbody><body name="base">
  <joint name="base_x" type="slide" axis="1 0 0"/><joint name="base_y" type="slide" axis="0 1 0"/>
  <joint name="base_yaw" axis="0 0 1"/><geom type="box" size="0.3 0.2 0.1" mass="1"/>{wheels}
  <body pos="0 0 0.5"><joint name="arm" axis="0 1 0"/><geom size="0.05" mass="1"/>
    <site name="brush" pos="0.5 0 0"/><site name="camera"/></body></body></worldbody>
  <keyframe><key name="home"/></keyframe></mujoco>"""
CORNERS = {"fl": (0.3, 0.2), "fr": (0.3, -0.2), "rl": (-0.3, 0.2), "rr": (-0.3, -0.2)}


BALL = '<body pos="-0.2 0 0.03"><joint name="ball" type="ball"/><geom size="0.03" mass="1"/></body>'
SWIVEL = (
    '<body pos="0.3 0 0.1"><joint name="caster_swivel" axis="0 0 1"/><geom size="0.03" mass="1"/>'
    '<body pos="-0.03 0 -0.05"><joint name="caster_roll" axis="0 1 0"/><geom size="0.05" mass="1"/></body>'
    "</body>"
)


def wheel(kind, name, place, axis="0 1 0"):
    return (
        f'<body pos="{place[0]} {place[1]} 0.1"><joint name="{kind}_{name}" axis="{axis}"/>'
        '<geom type="cylinder" size="0.08 0.02" mass="1"/></body>'
    )


def steered(name, place, offset="0 0 0", axis="0 1 0"):
    x, y = place
    return (
        f'<body pos="{x} {y} 0.1"><joint name="steer_{name}" axis="0 0 1"/><geom size="0.03" mass="1"/>'
        f'<body pos="{offset}"><joint name="wheel_{name}" axis="{axis}"/>'
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


def test_two_wheels_on_an_axle_are_differential_whatever_casters_there_are(tmp_path):
    two = wheel("wheel", "left", (-0.1, 0.2)) + wheel("wheel", "right", (-0.1, -0.2), "0 -1 0")
    drive = robot(tmp_path, BALL + two + SWIVEL).drive
    assert isinstance(drive, DifferentialWheels)
    assert float(drive.axle) == pytest.approx(-0.1)
    np.testing.assert_allclose(drive.lateral, [0.2, -0.2], rtol=1e-6)
    assert float(drive.speed_limit) == pytest.approx(12 * 0.08)
    np.testing.assert_allclose(drive.nonholonomic_rows, [[0, 1, -0.1]], rtol=1e-6)


@pytest.mark.parametrize("offset", [0.05, -0.05])
@pytest.mark.parametrize("axis", ["0 1 0", "0 -1 0"])
def test_wheels_ahead_of_their_steering_axes_or_behind_are_casters(tmp_path, offset, axis):
    wheels = "".join(steered(*item, f"{offset} 0.002 0", axis) for item in CORNERS.items())
    drive = robot(tmp_path, wheels).drive
    assert isinstance(drive, CasterWheels)
    assert float(drive.offset) == pytest.approx(offset)
    np.testing.assert_allclose(drive.position, list(CORNERS.values()), atol=1e-6)
    assert float(drive.rate_limit) == 3.0


def test_an_offset_is_along_the_way_that_the_wheel_rolls(tmp_path):
    """Wheels that roll to the left at angle 0; and the joint's own place, not its body's, is the axis."""
    wheels = "".join(steered(*item, "0 0.05 0", "1 0 0") for item in CORNERS.items())
    assert float(robot(tmp_path, wheels).drive.offset) == pytest.approx(0.05)
    moved = "".join(steered(*item) for item in CORNERS.items()).replace(
        'axis="0 0 1"', 'axis="0 0 1" pos="0.04 0 0"'
    )
    drive = robot(tmp_path, moved).drive
    assert float(drive.offset) == pytest.approx(-0.04)
    np.testing.assert_allclose(drive.position, [(x + 0.04, y) for x, y in CORNERS.values()], atol=1e-6)


def test_a_few_millimetres_are_no_offset(tmp_path):
    drive = robot(tmp_path, "".join(steered(*item, "0.003 0.003 0") for item in CORNERS.items())).drive
    assert isinstance(drive, SteeredWheels)


def test_a_differential_base_cannot_paint(tmp_path):
    """Its base would have to go sideways: in one line, before any work."""
    two = wheel("wheel", "left", (0, 0.2)) + wheel("wheel", "right", (0, -0.2))
    with pytest.raises(InputError, match=r"differential base.*allowed: steered.*mecanum") as caught:
        check_can_paint(robot(tmp_path, two))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("wheels", "numeric", "message"),
    [
        (
            wheel("wheel", "left", (0, 0.2), "1 0 0") + wheel("wheel", "right", (0, -0.2), "1 0 0"),
            "",
            "'wheel_left' of a differential base.*along the base's x axis",
        ),
        (
            wheel("wheel", "left", (0, 0.2), "0 0 1") + wheel("wheel", "right", (0, -0.2)),
            "",
            "'wheel_left' is not level",
        ),
        (wheel("wheel", "one", (0, 0.2)), "", "two or more on one axle"),
        (
            wheel("wheel", "left", (0, 0.2))
            + wheel("wheel", "right", (0, -0.2))
            + wheel("wheel", "c", (0.3, 0)),
            "",
            "off both axes.*other names than wheel_NAME for casters",
        ),
        (
            "".join(steered(*item, "0 0.05 0") for item in CORNERS.items()),
            "",
            "0.050 m beside its steering axis",
        ),
        (
            "".join(steered(n, p, f"{p[0] / 6} 0 0") for n, p in CORNERS.items()),
            "",
            "0.05, 0.05, -0.05, -0.05.*one offset for all",
        ),
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
