"""Where the base is: odometry corrected by what the robot sees of walls and of its own strokes."""

from jaxpaint.localisation.evidence import Evidence, no_evidence
from jaxpaint.localisation.filter import Belief, DriftModel, Trust, correct, predict, surprise
from jaxpaint.localisation.outline import Outline, outline_of
from jaxpaint.localisation.plane_view import PlaneSettings, match_plane
from jaxpaint.localisation.scan_matching import ScanSettings, match_scan
from jaxpaint.localisation.stroke_view import StrokeSettings, match_stroke

__all__ = [
    "Belief",
    "DriftModel",
    "Evidence",
    "Outline",
    "PlaneSettings",
    "ScanSettings",
    "StrokeSettings",
    "Trust",
    "correct",
    "match_plane",
    "match_scan",
    "match_stroke",
    "no_evidence",
    "outline_of",
    "predict",
    "surprise",
]
