"""What velocity servos say of their joints, against MuJoCo's own simulation of them."""

import mujoco
import numpy as np
import pytest

from sims.robots.servos import damping_of, speed_of, velocity_servo

ONE = """<mujoco><option timestep="0.002" gravity="0 0 0" integrator="implicitfast"/><worldbody><body>
<joint name="j" armature="1"/><geom size="0.1" mass="1"/></body></worldbody>
<actuator>{servo}</actuator></mujoco>"""
SERVOS = {
    "plain": '<velocity joint="j" kv="2" ctrlrange="-3 3"/>',
    "geared": '<velocity joint="j" kv="2" gear="10" ctrlrange="-30 30"/>',
    "reversed": '<velocity joint="j" kv="2" gear="-10" ctrlrange="-30 30"/>',
    "general": '<general joint="j" gainprm="6" biastype="affine" biasprm="0 0 -2" ctrlrange="-1 1"/>',
}


@pytest.mark.parametrize("servo", SERVOS)
def test_the_speed_told_is_reached_and_the_gain_is_felt(servo):
    model = mujoco.MjModel.from_xml_string(ONE.format(servo=SERVOS[servo]))
    data = mujoco.MjData(model)
    data.ctrl[:] = model.actuator_ctrlrange[0, 1]
    for _ in range(5000):
        mujoco.mj_step(model, data)
    assert abs(data.qvel[0]) == pytest.approx(speed_of(model, 0, 0.0), rel=1e-4)
    data.ctrl[:], data.qvel[:] = 0, 1
    mujoco.mj_forward(model, data)
    assert -data.qfrc_actuator[0] == pytest.approx(damping_of(model, velocity_servo(model, 0)), rel=1e-9)


def test_a_servo_geared_by_nothing_drives_nothing():
    model = mujoco.MjModel.from_xml_string(ONE.format(servo='<velocity joint="j" kv="2" gear="0"/>'))
    assert velocity_servo(model, 0) is None
    np.testing.assert_allclose(speed_of(model, 0, 1.5), 1.5)
