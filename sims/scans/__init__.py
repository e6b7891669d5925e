"""Random scans of walls with their truth, to train networks that refine clouds, and to score them."""

from sims.scans.closest import closest_point
from sims.scans.random_scenes import random_scene
from sims.scans.samples import SPLITS, Sample, Sampler, sample_keys, sample_scan
from sims.scans.scan import Scan, as_scan, take_scan
from sims.scans.settings import KINDS, ScanSettings
from sims.scans.visible import Visible, visible_surface
from sims.scans.window import random_window

__all__ = [
    "KINDS",
    "SPLITS",
    "Sample",
    "Sampler",
    "Scan",
    "ScanSettings",
    "Visible",
    "as_scan",
    "closest_point",
    "random_scene",
    "random_window",
    "sample_keys",
    "sample_scan",
    "take_scan",
    "visible_surface",
]
