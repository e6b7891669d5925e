"""What refines noisy clouds without learning: filters, local fits, planes; and the scales they go by."""

from jaxpaint.refinement.bilateral import BilateralSettings, bilateral_filter
from jaxpaint.refinement.local_scales import noise, spacing
from jaxpaint.refinement.moving_least_squares import MovingLeastSquaresSettings, moving_least_squares
from jaxpaint.refinement.plane_snapping import (
    PlaneSnappingSettings,
    PlaneStatistics,
    Snapped,
    snap_to_planes,
)
from jaxpaint.refinement.refined import Displacement, Refined

__all__ = [
    "BilateralSettings",
    "Displacement",
    "MovingLeastSquaresSettings",
    "PlaneSnappingSettings",
    "PlaneStatistics",
    "Refined",
    "Snapped",
    "bilateral_filter",
    "moving_least_squares",
    "noise",
    "snap_to_planes",
    "spacing",
]
