"""The papers' tables and figures, one module each, imported when asked for."""

import importlib
from types import ModuleType

from experiments.reproduce.result import ReproduceResult, ReproduceSettings, Row

REPRODUCTIONS = {
    "mode-detection": "experiments.reproduce.mode_detection",
    "motion": "experiments.reproduce.motion",
    "s1-figure-11": "experiments.reproduce.s1_figure_11",
}
"""Module of each table or figure; it has NAME and `run(settings) -> ReproduceResult`."""

__all__ = ["REPRODUCTIONS", "ReproduceResult", "ReproduceSettings", "Row", "load"]


def load(name: str) -> ModuleType:
    """The module of one of `REPRODUCTIONS`."""
    return importlib.import_module(REPRODUCTIONS[name])
