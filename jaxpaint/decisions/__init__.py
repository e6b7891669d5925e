"""What the adaptive control policy decides: modes, halting, thresholds."""

from jaxpaint.decisions.halting import HaltState, initial_halt, update_halt
from jaxpaint.decisions.relax import exceeds
from jaxpaint.decisions.thresholds import Thresholds, default_thresholds

__all__ = ["HaltState", "Thresholds", "default_thresholds", "exceeds", "initial_halt", "update_halt"]
