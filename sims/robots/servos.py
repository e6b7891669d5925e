"""What the actuators of a model say of its joints: how fast they may be told to go."""

import mujoco
import numpy as np

from jaxpaint.errors import InputError

# A joint may be this fast [rad/s or m/s]; more is a slip of the pen, in degrees a second most likely.
_ABSURD = 100.0


def velocity_servo(model: mujoco.MjModel, joint: int) -> int | None:
    """The velocity servo of a joint: a servo's bias is -gain times (offset, position, velocity)."""
    for a in range(model.nu):
        geared = model.actuator_gear[a, 0] != 0
        drives_joint = model.actuator_trntype[a] == int(mujoco.mjtTrn.mjTRN_JOINT) and geared
        follows_speed = model.actuator_biasprm[a, 1] == 0 and model.actuator_biasprm[a, 2] < 0
        if drives_joint and model.actuator_trnid[a, 0] == joint and follows_speed:
            return a
    return None


def damping_of(model: mujoco.MjModel, servo: int) -> float:
    """kv of a velocity servo as its joint feels it [N m s/rad or N s/m]: the gear acts on speed and force."""
    return -float(model.actuator_biasprm[servo, 2]) * float(model.actuator_gear[servo, 0]) ** 2


def speed_of(model: mujoco.MjModel, joint: int, default: float) -> float:
    """The speed that the velocity servo of a joint can be told [rad/s or m/s].

    Its control range, behind the gear: the servo rests where gain ctrl = kv gear v.
    """
    servo = velocity_servo(model, joint)
    if servo is None or not model.actuator_ctrllimited[servo]:
        return default
    told = float(np.abs(model.actuator_ctrlrange[servo]).min() * np.abs(model.actuator_gainprm[servo, 0]))
    kv, gear = -float(model.actuator_biasprm[servo, 2]), abs(float(model.actuator_gear[servo, 0]))
    speed = told / (kv * gear)
    if not 0 < speed <= _ABSURD:
        raise InputError(
            f"joint '{model.joint(joint).name}' has a speed limit of {speed:g}; "
            f"allowed: above 0, up to {_ABSURD:g} rad/s or m/s"
        )
    return speed
