"""Drawings that come with the program."""

from importlib.resources import files
from pathlib import Path

__all__ = ["built_in_drawing"]


def built_in_drawing() -> Path:
    """The default picture: hills, birds, a boat, the sun and the sea, made for a wall of 2.4 m by 0.6 m."""
    return Path(str(files("experiments.drawings") / "default.svg"))
