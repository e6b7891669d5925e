"""The papers' tables and figures, one module each, imported when asked for."""

import importlib
from types import ModuleType

from experiments.reproduce.result import ReproduceResult, ReproduceSettings, Row

REPRODUCTIONS = {
    "mode-detection": "experiments.reproduce.mode_detection",
    "motion": "experiments.reproduce.motion",
    "fidelities": "experiments.reproduce.fidelities",
    "gradients": "experiments.reproduce.gradients",
    "s1-table-1": "experiments.reproduce.s1_table_1",
    "s1-table-3": "experiments.reproduce.s1_table_3",
    "halting": "experiments.reproduce.halting",
    "qp-accuracy": "experiments.reproduce.qp_accuracy",
    "s1-figure-11": "experiments.reproduce.s1_figure_11",
    "sensor-noise": "experiments.reproduce.sensor_noise",
}
"""Module of each table or figure; it has NAME and `run(settings) -> ReproduceResult`."""
MEASURED = ("sensor-noise",)
"""Those that are measured on captured data, which is not part of the program."""

__all__ = ["MEASURED", "REPRODUCTIONS", "ReproduceResult", "ReproduceSettings", "Row", "load"]


def load(name: str) -> ModuleType:
    """The module of one of `REPRODUCTIONS`; RuntimeError where it needs a package that is not there."""
    try:
        return importlib.import_module(REPRODUCTIONS[name])
    except ModuleNotFoundError as error:
        raise RuntimeError(f"{name} needs {error.name}: install jaxpaint with the extra 'bench'") from error
