"""Following a given curve on a wall: what S1's tables I and III measure, without scan and mapping."""

from experiments.tracking.curves import CURVES, Curve
from experiments.tracking.follow import Followed, follow, median_interval
from experiments.tracking.park import parked
from experiments.tracking.study import Study, study_of
from experiments.tracking.variants import Variant, literal, variants, varied

__all__ = [
    "CURVES",
    "Curve",
    "Followed",
    "Study",
    "Variant",
    "follow",
    "literal",
    "median_interval",
    "parked",
    "study_of",
    "variants",
    "varied",
]
