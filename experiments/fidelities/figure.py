"""The ways that bases take in each fidelity, beside what they were told."""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Float
from matplotlib.figure import Figure

from experiments.fidelities.follow import Followed
from experiments.report.style import look
from sims.painting.job import CONTROL_PERIOD


def fidelity_figure(ways: Mapping[str, Followed], told: Mapping[str, Float[np.ndarray, "t 3"]]) -> Figure:
    """Two rows of plots, a column a motion: how far the base is from where it was told to be, and how far its
    heading is from odometry's, over time.
    """
    with look():
        figure = Figure(figsize=(14.0, 5.6), layout="constrained")
        axes = figure.subplots(2, len(told), sharex=True)
        for column, (motion, meant) in enumerate(told.items()):
            time = np.arange(len(meant)) * CONTROL_PERIOD
            for name, found in ways.items():
                off = np.linalg.norm(found.base[column, :, :2] - meant[:, :2], axis=1)
                turned = np.abs(found.base[column, :, 2] - found.odometry[column, :, 2])
                axes[0, column].plot(time, 1e3 * off, label=name)
                axes[1, column].plot(time, 1e3 * turned)
            axes[0, column].set_title(motion)
            axes[1, column].set_xlabel("time [s]")
        axes[0, 0].set_ylabel("base off what was told [mm]")
        axes[1, 0].set_ylabel("heading off odometry [mrad]")
        figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=len(ways))
        return figure
