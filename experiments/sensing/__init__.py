"""Depth pictures that were taken, and the planes in them that were marked by hand."""

from experiments.sensing.captures import (
    FILES,
    KINECT,
    RENDERED,
    Patch,
    Source,
    depths,
    fragment_residuals,
    missing_file,
    patches,
)

__all__ = [
    "FILES",
    "KINECT",
    "RENDERED",
    "Patch",
    "Source",
    "depths",
    "fragment_residuals",
    "missing_file",
    "patches",
]
