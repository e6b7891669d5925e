"""The residuals of planes as a picture: against distance, and how alike neighbours err."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from experiments.report.style import COVERED, EXCESS, INK, PAINT, SOFT, TRAVEL, look, new_figure
from experiments.sensing import Patch, Source
from sims.sensors import Camera, DepthNoise
from sims.sensors.noise_fit import NoiseFit, mean_variogram, noise_variogram
from sims.sensors.plane_residual import LAGS

_COLOURS, _MARKS = (PAINT, TRAVEL), ("o", "s")


@dataclass(frozen=True, eq=False)
class Fitted:
    """The planes of a source, the noise fitted to those that are, and the ends of its 95 % intervals."""

    source: Source
    patches: list[Patch]
    fit: NoiseFit
    low: NoiseFit
    high: NoiseFit


def sensor_noise_figure(
    found: tuple[Fitted, ...], fragment: Float[np.ndarray, "patches"], camera: Camera, noise: DepthNoise
) -> Figure:
    """Residual against distance, and autocorrelation; camera is the preset's at full resolution."""
    with look():
        figure = new_figure(4.4)
        left, right = figure.subplots(1, 2, width_ratios=(3, 2))
        _residuals(left, found, fragment, float(camera.fx * camera.baseline), noise)
        _autocorrelation(right, found, float(noise.correlation))
    return figure


def _residuals(axes: Axes, found, fragment, focal_baseline: float, noise: DepthNoise) -> None:
    distance = np.linspace(0.3, 2.7, 100)
    for one, colour, mark in zip(found, _COLOURS, _MARKS, strict=True):
        for fitted in (True, False):
            of = [p for p in one.patches if p.fitted == fitted]
            z = np.array([p.distance for p in of])
            rms = np.array([p.residual.rms / p.residual.disparity for p in of]) * z
            name = one.source.name + ("" if fitted else ", not fitted: seen slanted")
            face = colour if fitted else "none"
            if of:
                axes.scatter(z, 1e3 * rms, c=face, edgecolors=colour, marker=mark, s=28, label=name)
    kinect = found[0]
    for sigma, product, colour, name in (
        (
            np.sqrt(kinect.fit.sill),
            kinect.source.focal_baseline,
            PAINT,
            "model, fit to the Kinect, rounding too",
        ),
        (kinect.fit.sigma, kinect.source.focal_baseline, COVERED, "model, the same without rounding"),
        (float(noise.disparity_sigma), focal_baseline, INK, "model, preset D435"),
    ):
        axes.plot(distance, 1e3 * distance**2 * sigma / product, color=colour, label=name)
    axes.axhspan(1e3 * fragment.min(), 1e3 * fragment.max(), color=EXCESS, alpha=0.35, lw=0)
    middle, words = 1e3 * fragment.mean(), "fragment: fused, distance not known"
    axes.text(2.68, middle, words, color=SOFT, fontsize=8, ha="right", va="center")
    axes.set(xlabel="distance [m]", ylabel="plane residual, rms [mm]", xlim=(0.3, 2.7), ylim=(0, 26))
    axes.set_title("Residual of planes against distance")
    axes.legend(loc="upper left", fontsize=8)


def _autocorrelation(axes: Axes, found, preset: float) -> None:
    """What is slow is taken off by the fit; the rest is a share of the noise and rounding."""
    for one, colour, mark in zip(found, _COLOURS, _MARKS, strict=True):
        curves = mean_variogram([p.residual for p in one.patches if p.fitted], one.fit)
        alike = 1 - (curves - noise_variogram(one.fit)[1]) / one.fit.sill
        for axis, filled in ((0, True), (1, False)):
            face, name = (colour, one.source.name) if filled else ("none", None)
            axes.scatter(LAGS, alike[0, axis], c=face, edgecolors=colour, marker=mark, s=24, label=name)
        axes.plot(LAGS, alike[1].mean(0), color=colour)
    lag = np.linspace(0, LAGS[-1], 200)
    axes.plot(lag, np.exp(-0.5 * (lag / preset) ** 2), color=INK, ls="--", label=f"preset, {preset:g} px")
    axes.set(xlabel="pixels apart (filled: along rows)", ylabel="autocorrelation", ylim=(-0.35, 1.02))
    axes.set_title("How alike neighbours err")
    axes.legend(fontsize=8)
