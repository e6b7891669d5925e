"""Pictures: from a file to lines and areas of ink, and from these to ordered strokes (S1 section III-B)."""

from jaxpaint.pictures.drawing import Area, Drawing, fit
from jaxpaint.pictures.fills import FillSettings, outlined
from jaxpaint.pictures.ink_settings import RasterSettings
from jaxpaint.pictures.notes import reading_notes
from jaxpaint.pictures.read import read_drawing
from jaxpaint.pictures.reading import Reading
from jaxpaint.pictures.strokes import Strokes, plan_strokes

__all__ = [
    "Area",
    "Drawing",
    "FillSettings",
    "RasterSettings",
    "Reading",
    "Strokes",
    "fit",
    "outlined",
    "plan_strokes",
    "read_drawing",
    "reading_notes",
]
