"""Steering and rolling angles of wheels that follow the base: runs do not record them."""

import mujoco
import numpy as np
from jaxtyping import Float

from jaxpaint.steering import SteeredWheels
from sims.robots.wheels import STEER, WHEEL, drive_from_model

# A wheel whose contact is slower keeps its direction [m/s]; velocities are means over so many samples.
_HARDLY, _WINDOW = 2e-3, 9


def wheel_angles(
    model: mujoco.MjModel, time: Float[np.ndarray, " t"], base: Float[np.ndarray, "t 3"]
) -> dict[str, Float[np.ndarray, " t"]]:
    """Angles [rad] by joint of steered wheels whose contacts do not slip; nothing for other bases.

    base: poses x, y [m], yaw [rad]. A wheel turns to where its contact goes by the shorter way, forwards or
    backwards.
    """
    joints = [model.joint(k).name for k in range(model.njnt)]
    names = [name.removeprefix(WHEEL) for name in joints if name.startswith(WHEEL)]
    if len(time) < 2 or not names or not isinstance(drive := drive_from_model(model), SteeredWheels):
        return {}
    twist, found = _twist(time, base), {}
    for name, place in zip(names, np.asarray(drive.position, float), strict=True):
        velocity = twist[:, :2] + twist[:, 2:] * np.array([-place[1], place[0]])
        angle = _steering(velocity)
        along = velocity[:, 0] * np.cos(angle) + velocity[:, 1] * np.sin(angle)
        way = np.concatenate([[0.0], np.cumsum(along[:-1] * np.diff(time))])
        found[STEER + name] = angle * (np.sign(model.joint(STEER + name).axis[2]) or 1.0)
        found[WHEEL + name] = way / _radius(model, WHEEL + name)
    return found


def _twist(time, base) -> Float[np.ndarray, "t 3"]:
    """In the base frame; smoothed, as slip trembles."""
    rate = np.gradient(base, time, axis=0)
    window = min(_WINDOW, len(rate))
    padded = np.pad(rate, (((window - 1) // 2, window // 2), (0, 0)), mode="edge")
    x, y, turn = (np.convolve(column, np.full(window, 1 / window), mode="valid") for column in padded.T)
    c, s = np.cos(base[:, 2]), np.sin(base[:, 2])
    return np.stack([c * x + s * y, c * y - s * x, turn], axis=1)


def _steering(velocity: Float[np.ndarray, "t 2"]) -> Float[np.ndarray, " t"]:
    """The direction of the velocity or the opposite one, whichever is nearer to the direction before."""
    angle, found = 0.0, np.zeros(len(velocity))
    for k, (x, y) in enumerate(velocity):
        if np.hypot(x, y) > _HARDLY:
            angle += (np.arctan2(y, x) - angle + np.pi / 2) % np.pi - np.pi / 2
        found[k] = angle
    return found


def _radius(model: mujoco.MjModel, joint: str) -> float:
    """Of the largest geom on the wheel's body [m], below 0 where the wheel's axle points to the right."""
    body = model.body(model.joint(joint).bodyid[0])
    first = body.geomadr[0]
    largest = model.geom_aabb[first : first + body.geomnum[0], 3:].max()
    return float(largest * np.sign(model.joint(joint).axis[1] or 1.0))
