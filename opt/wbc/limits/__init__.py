"""What the whole body must not do: each limit gives bounds, hard rows or inequality rows."""

from opt.wbc.limits.acceleration import braked, within_acceleration
from opt.wbc.limits.clearance import Clearance, as_bounds_allow, clearance
from opt.wbc.limits.dampers import damper_bounds
from opt.wbc.limits.low_speed import is_signed, low_speed_bounds
from opt.wbc.limits.nonholonomic import nonholonomic, nonholonomic_rows, possible_part, with_braking
from opt.wbc.limits.speed import speed_bounds

__all__ = [
    "Clearance",
    "as_bounds_allow",
    "braked",
    "clearance",
    "damper_bounds",
    "is_signed",
    "low_speed_bounds",
    "nonholonomic",
    "nonholonomic_rows",
    "possible_part",
    "speed_bounds",
    "with_braking",
    "within_acceleration",
]
