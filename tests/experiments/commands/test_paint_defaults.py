"""What an option defaults to is what the library defaults to.

The command line writes some of these down again, so that it starts without the library: they may not part.
"""

import math

import pytest

from experiments.commands.paint_options import PaintOptions
from jaxpaint.pictures import FillSettings, RasterSettings
from sims.painting.job import Job

FILL, RASTER = FillSettings(), RasterSettings()


@pytest.mark.parametrize(
    ("option", "default"),
    [
        ("fill", FILL.style),
        ("fill_overlap", FILL.overlap),
        ("fill_angle_deg", math.degrees(FILL.angle)),
        ("bleed", FILL.bleed),
        ("line_art", RASTER.style),
        ("threshold", RASTER.threshold),
        ("ink", RASTER.ink),
        ("colours", RASTER.colours),
        ("tool_change_time", Job.__dataclass_fields__["tool_change"].default),
    ],
)
def test_an_option_defaults_to_what_the_library_does(option, default):
    assert getattr(PaintOptions(), option) == default
