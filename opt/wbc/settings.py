"""The numbers of the whole-body controller."""

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float


class ControllerSettings(eqx.Module):
    """Gains, weights and limits; every leaf is traced, and each term can be left out by its own: weights by
    0, limits by infinity where nothing else is said.

    Tasks. position_gain, orientation_gain: pose feedback on odometry [1/s]. slack_cost: of the task rows in
    the brush frame, three linear [s^2/m^2] and three angular [s^2/rad^2]; the last is the spin about the
    brush, which paint does not see; 0 leaves a row out. arm_effort [s^2/rad^2], base_effort (x, y: [s^2/m^2];
    yaw: [s^2/rad^2]): diagonal of M in S1-(10); S1's reference [26] too makes base motion far dearer than the
    arm's. manipulability: weight of its gradient in C. base_follow: weight that draws the base to the
    demanded velocity while the low-speed rule is on; without the rule effort and manipulability alone decide
    how base and arm share the motion, as in S1's reference [26].

    Limits. arm_speed, base_speed, arm_acceleration, base_acceleration: share of the robot's limits in use.
    damper_start, damper_stop: distances from a joint limit at which the velocity damper of S1's reference
    [26] begins and at which no approach is left [rad]; start 0 leaves dampers out. nonholonomic: 0 leaves out
    the rows of a base that cannot go everywhere.

    Base. base_arrived: a base nearer to its station than this is there [m]. base_worthwhile: a halted base
    does not start for less than this way [m], since every start costs time and scrub. base_approach: speed
    per metre that is left [1/s]. base_least_speed: least demand, six times the dead band [m/s].

    Clock. hold_error: error at which the path's clock has stopped [m]; it slows from half of that. patience:
    the robot gives a target up whose error has not fallen for so long while the clock waits [s]; infinity
    waits for ever. yaw_lever: metres that count like one radian in base travel. qp_smoothing: see `solve_qp`.
    """

    position_gain: Float[Array, ""]
    orientation_gain: Float[Array, ""]
    slack_cost: Float[Array, "6"]
    arm_effort: Float[Array, "a"]
    base_effort: Float[Array, "3"]
    manipulability: Float[Array, ""]
    base_follow: Float[Array, ""]
    arm_speed: Float[Array, ""]
    base_speed: Float[Array, ""]
    arm_acceleration: Float[Array, ""]
    base_acceleration: Float[Array, ""]
    damper_start: Float[Array, ""]
    damper_stop: Float[Array, ""]
    nonholonomic: Float[Array, ""]
    own_approach: Float[Array, ""]
    own_start: Float[Array, ""]
    own_stop: Float[Array, ""]
    wall_approach: Float[Array, ""]
    wall_start: Float[Array, ""]
    wall_stop: Float[Array, ""]
    wall_reach: Float[Array, ""]
    gap_blend: Float[Array, ""]
    base_arrived: Float[Array, ""]
    base_worthwhile: Float[Array, ""]
    base_approach: Float[Array, ""]
    base_least_speed: Float[Array, ""]
    hold_error: Float[Array, ""]
    patience: Float[Array, ""]
    yaw_lever: Float[Array, ""]
    qp_smoothing: Float[Array, ""]


def default_settings(arm_joints: int = 6) -> ControllerSettings:
    """The settings that every published figure of this project uses, for an arm of that many joints."""
    numbers = {
        "position_gain": 4.0,
        "orientation_gain": 4.0,
        "slack_cost": [1e4, 1e4, 1e4, 1e3, 1e3, 1e-1],
        "arm_effort": [0.01] * arm_joints,
        "base_effort": [0.3, 0.3, 0.3],
        "manipulability": 0.01,
        "base_follow": 1.0,
        "arm_speed": 0.5,
        "base_speed": 1.0,
        "arm_acceleration": 1.0,
        "base_acceleration": 1.0,
        "damper_start": 0.5,
        "damper_stop": 0.05,
        "nonholonomic": 1.0,
        "own_approach": 0.05,
        "own_start": 0.016,
        "own_stop": 0.008,
        "wall_approach": 0.1,
        "wall_start": 0.05,
        "wall_stop": 0.01,
        "wall_reach": 0.6,
        "gap_blend": 0.004,
        "base_arrived": 0.01,
        "base_worthwhile": 0.12,
        "base_approach": 1.5,
        "base_least_speed": 0.03,
        "hold_error": 0.02,
        "patience": 10.0,
        "yaw_lever": 0.3,
        "qp_smoothing": 0.0,
    }
    return ControllerSettings(**{name: jnp.asarray(value) for name, value in numbers.items()})
