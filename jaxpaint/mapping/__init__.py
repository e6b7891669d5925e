"""From a picture on a canvas to a brush path on the surface."""

from jaxpaint.mapping.canvas import Canvas
from jaxpaint.mapping.mapped import Cause, Mapped, count_by_cause
from jaxpaint.mapping.moves import Move, MoveSettings
from jaxpaint.mapping.raycast import MappingSettings, cast
from jaxpaint.mapping.runs import Runs
from jaxpaint.mapping.timeline import (
    BrushPath,
    PathSettings,
    TimedPath,
    colour_at,
    duration,
    plan_path,
    sample,
)

__all__ = [
    "BrushPath",
    "Canvas",
    "Cause",
    "Mapped",
    "MappingSettings",
    "Move",
    "MoveSettings",
    "PathSettings",
    "Runs",
    "TimedPath",
    "cast",
    "colour_at",
    "count_by_cause",
    "duration",
    "plan_path",
    "sample",
]
