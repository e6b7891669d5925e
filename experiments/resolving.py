"""What a user left open, as the program chose it: into the summary's config, so that a repeat has it."""

from collections.abc import Mapping
from typing import Any

from experiments.commands.paint_options import PaintOptions
from experiments.options import is_allowed
from experiments.placing import decimals
from jaxpaint.decisions.thresholds import default_thresholds
from jaxpaint.pictures import FillSettings


def resolved(options: PaintOptions, on_wall: Mapping[str, Any]) -> dict[str, Any]:
    """Values by the names of options; those of the wall are `on_wall` (`experiments.placing.Placed.found`).

    What a switch turns off is not chosen. What a user could not have asked for, such as a wall below the
    floor, is left open: the run that repeats this one chooses it again.
    """
    limits = default_thresholds(**options.threshold_changes())
    halting = {
        "theta": decimals(limits.halt_travel)[0],
        "dwell": decimals(limits.dwell)[0],
        "release_margin": decimals(limits.release_margin)[0],
    }
    low_speed = {"low_speed_scale": decimals(limits.low_speed_scale)[0]}
    found = {
        **on_wall,
        **(halting if options.halting else {}),
        **(low_speed if options.low_speed else {}),
        "variance_bounds": (*decimals(limits.variance_lower), *decimals(limits.variance_upper)),
    }
    chosen = {
        name: value
        for name, value in found.items()
        if getattr(options, name) is None and is_allowed(options, name, value)
    }
    bleed = FillSettings(bleed=options.bleed).bleed_of(options.brush_radius)
    return chosen if bleed == options.bleed else chosen | {"bleed": bleed}
