"""What depth cameras err by on planes: fitted to real and to rendered pictures, beside the model's preset."""

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType

import numpy as np

from experiments.reproduce.result import ReproduceResult, ReproduceSettings, Row
from experiments.reproduce.sensor_noise_figure import Fitted, sensor_noise_figure
from experiments.sensing import KINECT, RENDERED, Patch, Source, depths, fragment_residuals, patches
from experiments.sensing.simulated import full_camera, simulated_patches
from sims.sensors import DepthNoise
from sims.sensors.fixed_pattern import fixed_pattern
from sims.sensors.noise_fit import NoiseFit, bootstrap, quantum_of

NAME = "sensor-noise"
DRAWS = 200
"""Of the bootstrap."""
SHIFT = 14
"""By which the wall moved along u between the Kinect's captures [px]: its normal turned by 1.5 degrees."""
PUBLISHED = {"sigma": 0.08, "quantum": 1 / 32}
"""Of a D435 [px]: subpixel RMS on well-textured surfaces, and the D4 chip's step."""
FIGURES = {
    "sigma": "correlated disparity noise [px]",
    "correlation": "its correlation length [px]",
    "white": "disparity noise that no neighbour shares [px]",
    "quantum": "quantum of disparity [px]",
}
"""What of a `NoiseFit` is told, in words."""


def run(settings: ReproduceSettings | None = None, draws: int = DRAWS) -> ReproduceResult:
    """Rows of each source, of the preset fitted from its own pictures, and the figure.

    `settings.data` is the folder with clouds/ and rgbd/; ValueError without it.
    """
    settings = settings or ReproduceSettings()
    if settings.data is None:
        raise ValueError("data: found none, allowed: the folder that has experiments.sensing.FILES")
    kinect, rendered = (measured(one, settings.data, draws, settings.seed) for one in (KINECT, RENDERED))
    fragment = fragment_residuals(settings.data)
    rows = [
        *preset_rows(draws, settings.seed),
        *source_rows(kinect),
        *pattern_rows(kinect),
        *source_rows(rendered),
        _fragment_row(fragment, settings.seed),
    ]
    figure = sensor_noise_figure((kinect, rendered), fragment, full_camera(), DepthNoise())
    return ReproduceResult.of(rows, {"plane residuals": figure})


def measured(source: Source, data: Path, draws: int, seed: int) -> Fitted:
    """The planes of a source and the noise fitted to them, with 95 % intervals over blocks of the planes."""
    pictures = depths(source, data)
    # Every picture has the same steps; that of the whole picture with most of them is the surest.
    quantum = float(np.median([quantum_of(depth, source.focal_baseline) for depth in pictures]))
    marked = patches(source, pictures)
    fit, low, high = bootstrap([one.residual for one in marked if one.fitted], quantum, draws, seed)
    return Fitted(source, marked, fit, low, high)


def source_rows(found: Fitted) -> list[Row]:
    """The fit, then distance and residual of each marked plane over all pictures."""
    name = found.source.name
    rows = fit_rows(name, found.fit, found.low, found.high)
    for mark in found.source.marks:
        of = [one for one in found.patches if one.name == mark.name]
        rms = np.sqrt(np.mean([one.residual.rms**2 for one in of]))
        distance = float(np.mean([one.distance for one in of]))
        rows += [
            Row(f"distance of the plane '{mark.name}' [m]", name, None, distance),
            Row(f"residual of the plane '{mark.name}' [px]", name, None, float(rms)),
            Row(f"residual of the plane '{mark.name}' [m]", name, None, _metres(of)),
        ]
    return rows


def pattern_rows(found: Fitted) -> list[Row]:
    """What the two captures of the wall share. Of one wall there is no interval."""
    first, second = (one.residual.residual for one in found.patches if one.name == found.source.marks[0].name)
    pattern = fixed_pattern(first, second, SHIFT)
    name = found.source.name
    return [
        Row("same at each pixel of both captures of the wall [px]", name, None, pattern.shared),
        Row("of which stays with the camera [px]", name, None, pattern.camera),
        Row("of which moves with the wall [px]", name, None, pattern.surface),
        Row("correlation length of both [px]", name, None, pattern.length),
    ]


def preset_rows(draws: int, seed: int) -> list[Row]:
    """What the fit finds in pictures with the shipped preset, beside what is published of a D435."""
    residuals, pictures = simulated_patches(DepthNoise(), seed)
    camera = full_camera()
    # Far pictures: their steps are few, and each occurs.
    quantum = quantum_of(pictures[-1], float(camera.fx * camera.baseline))
    fit, low, high = bootstrap(residuals, quantum, draws, seed)
    return fit_rows("ours", fit, low, high, ", simulated D435", PUBLISHED)


def fit_rows(
    variant: str,
    fit: NoiseFit,
    low: NoiseFit,
    high: NoiseFit,
    of: str = "",
    published: Mapping[str, float] = MappingProxyType({}),
) -> list[Row]:
    """The figures of a fit with their intervals; the quantum has none, it is no estimate of the bootstrap."""
    rows = []
    for field, what in FIGURES.items():
        ends = (None, None) if field == "quantum" else (getattr(low, field), getattr(high, field))
        rows.append(Row(what + of, variant, published.get(field), getattr(fit, field), *ends))
    return rows


def _metres(of: list[Patch]) -> float:
    """Root mean square of the depth's error, from that of the disparity at the planes' distance."""
    shares = [one.residual.rms / one.residual.disparity * one.distance for one in of]
    return float(np.sqrt(np.mean(np.square(shares))))


def _fragment_row(rms: np.ndarray, seed: int) -> Row:
    """Over patches drawn again; the cloud is fused, so at no known distance."""
    rng = np.random.default_rng(seed)
    again = rng.choice(rms**2, (2000, len(rms))).mean(axis=1)
    low, high = np.sqrt(np.percentile(again, [2.5, 97.5]))
    what = "residual of plaster, distance not known [m]"
    return Row(what, "fragment", None, float(np.sqrt(np.mean(rms**2))), float(low), float(high))
