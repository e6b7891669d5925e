"""Scores of the contract: paint on the wall, tracking, surface, one world and over worlds."""

from jaxpaint.clouds import Chamfer, chamfer
from sims.scoring.histogram import Histogram
from sims.scoring.log import Log
from sims.scoring.paint import PaintScore, score_paint, score_paint_worlds
from sims.scoring.summary import WorldScore, summarise, world_scores
from sims.scoring.surface import surface_samples
from sims.scoring.tracking import Tally, TrackingScore, accumulate, judge, tracking_score
from sims.scoring.wanted import Layer, Wanted, wanted_area

__all__ = [
    "Chamfer",
    "Histogram",
    "Layer",
    "Log",
    "PaintScore",
    "Tally",
    "TrackingScore",
    "Wanted",
    "WorldScore",
    "accumulate",
    "chamfer",
    "judge",
    "score_paint",
    "score_paint_worlds",
    "summarise",
    "surface_samples",
    "tracking_score",
    "wanted_area",
    "world_scores",
]
