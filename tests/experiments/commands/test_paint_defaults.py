"""What an option defaults to is what the library defaults to.

The command line writes some of these down again, so that it starts without the library: they may not part.
"""

import math

import pytest

from experiments import exports
from experiments.commands.paint_options import AXES, PICTURES, WALLS, PaintOptions
from experiments.options import values_of
from jaxpaint.decisions.thresholds import default_thresholds
from jaxpaint.pictures import FillSettings, RasterSettings
from jaxpaint.pictures.read import RASTER as PIXELS
from sims.painting.job import Job
from sims.scenes import walls
from sims.scenes.orientation import parse_axis

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


def spec_of(option: str):
    values = values_of(PaintOptions)[option]
    assert values is not None
    return values


def test_the_names_offered_are_those_that_there_are():
    assert tuple(walls.WALLS) == WALLS
    assert spec_of("export").holds(tuple(exports.KINDS))
    assert spec_of("export").metavar == "{" + ",".join([*exports.KINDS, "none"]) + "}"
    assert (".svg", *PIXELS) == PICTURES
    assert {parse_axis(axis) for axis in AXES} == {f"{sign}{axis}" for sign in "+-" for axis in "xyz"}


def test_the_help_of_the_band_says_what_it_is():
    limits = default_thresholds()
    band = f"{float(limits.variance_lower):.1g} {float(limits.variance_upper):.1g}"
    assert spec_of("variance_bounds").str_from_instance(None) == band.split()
