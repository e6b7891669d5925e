"""Pictures: from a file to line art, and from line art to ordered strokes (S1 section III-B)."""

from jaxpaint.pictures.drawing import Drawing, fit
from jaxpaint.pictures.read import read_drawing
from jaxpaint.pictures.strokes import Strokes, plan_strokes

__all__ = ["Drawing", "Strokes", "fit", "plan_strokes", "read_drawing"]
