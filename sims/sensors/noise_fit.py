"""The parameters of depth noise, fitted to pictures of planes.

The model of a residual is: noise that is correlated as exp(-(d / l)^2 / 2), noise that no neighbour shares,
something slow that is no noise (the wall's form, the camera's distortion), and then rounding to the quantum.
"""

from dataclasses import astuple, dataclass

import numpy as np
from jaxtyping import Float
from scipy.optimize import least_squares

from sims.sensors.plane_residual import LAGS, PlaneResidual, blocks, variogram

BLOCK = 60
"""About how wide the blocks are that a bootstrap draws [px]: much wider than noise is correlated."""

_HARMONICS = 1.0 + np.arange(24)
_START = (0.05, 3.0, 0.01, 0.04, 15.0)
_LEAST, _MOST = (1e-3, 0.5, 1e-4, 1e-4, 8.0), (1.0, 8.0, 0.5, 1.0, 60.0)
# Steps of delivered disparity that a picture may leave out and still show its quantum.
_STEPS = 10


@dataclass(frozen=True)
class NoiseFit:
    """sigma, correlation: standard deviation and length of the correlated noise, as in `DepthNoise` [px].

    white: standard deviation of noise that no neighbour shares [px]. slow, slow_length: standard deviation
    and length of what varies slowly, in the same form [px]; the lengths from 8 to 60 px are looked for, and
    only what of it is seen within 24 px matters. quantum: step in which disparity is delivered [px].
    """

    sigma: float
    correlation: float
    white: float
    slow: float
    slow_length: float
    quantum: float

    @property
    def sill(self) -> float:
        """Variance of a pixel without what is slow: noise and rounding [px^2]."""
        return self.sigma**2 + self.white**2 + self.quantum**2 / 12


def quantum_of(depth: Float[np.ndarray, "..."], focal_baseline: float) -> float:
    """The step in which a picture's disparity comes [px], 0 where it has none; focal_baseline in [px m].

    Depths [m] may have been rounded themselves (to millimetres, say) by much less than a step: the
    slope of a line through all the steps that occur does not mind.
    """
    levels = np.unique(focal_baseline / depth[np.isfinite(depth) & (depth > 0)])
    rises = np.diff(levels)
    # Of pixels without a quantum nearly all differ, by next to nothing.
    if len(rises) < _STEPS or len(levels) > 0.2 * depth.size:
        return 0.0
    step = float(np.median(rises))
    for _ in range(3):
        number = np.concatenate([[0], np.cumsum(np.rint(rises / step))])
        step = float(np.polyfit(number, levels, 1)[0])
    return step


def noise_variogram(fit: NoiseFit) -> tuple[Float[np.ndarray, "lags"], Float[np.ndarray, "lags"]]:
    """Of the noise alone, and of what is slow, before rounding, at LAGS [px^2]."""
    noise = fit.white**2 + fit.sigma**2 * (1 - np.exp(-0.5 * (LAGS / fit.correlation) ** 2))
    return noise, fit.slow**2 * (1 - np.exp(-0.5 * (LAGS / fit.slow_length) ** 2))


def rounded_variogram(
    before: Float[np.ndarray, "*lags"], shift: Float[np.ndarray, "*lags"], quantum: float
) -> Float[np.ndarray, "*lags"]:
    """The variogram after rounding to a quantum, from the one before and the plane's change of disparity.

    With e the rounding error, a sum of sines of 2 pi k x / q with amplitudes q / (pi k), and a Gaussian
    difference of variance 2 g between neighbours that the plane sets s apart, over all phases of the plane:
    g + sum over k of q^2 / (2 pi^2 k^2) (1 - cos(2 pi k s / q) exp(-(2 pi k / q)^2 g)). So rounding looks
    white only where noise is rough against q; on smooth noise its own error is smooth.
    """
    if quantum <= 0:
        return before
    k = _HARMONICS.reshape(-1, *[1] * before.ndim)
    fade = np.exp(-np.minimum((2 * np.pi * k / quantum) ** 2 * before, 500.0))
    waves = (1 - np.cos(2 * np.pi * k * shift / quantum) * fade) / k**2
    # Those beyond the last harmonic differ by their whole variance, or nearly: pi^2 / 6 of the sum is all.
    rest = np.pi**2 / 6 - (1 / _HARMONICS**2).sum()
    return before + quantum**2 / (2 * np.pi**2) * (waves.sum(0) + rest)


def fit_noise(patches: list[PlaneResidual], quantum: float) -> NoiseFit:
    """The noise that explains the variograms of all patches' blocks together, each block with equal weight.

    ValueError where the patches are too small to tell.
    """
    return _fit(_Blocks.of(patches), quantum)


def bootstrap(
    patches: list[PlaneResidual], quantum: float, draws: int, seed: int
) -> tuple[NoiseFit, NoiseFit, NoiseFit]:
    """The fit, and the low and high ends of 95 % intervals of each figure over blocks drawn again."""
    found = _Blocks.of(patches)
    best = _fit(found, quantum)
    rng, count = np.random.default_rng(seed), len(found.curve)
    again = [
        astuple(
            _fit(found.weighted(np.bincount(rng.integers(count, size=count), minlength=count)), quantum, best)
        )
        for _ in range(draws)
    ]
    low, high = np.percentile(again, [2.5, 97.5], axis=0)
    return best, NoiseFit(*map(float, low)), NoiseFit(*map(float, high))


@dataclass(frozen=True, eq=False)
class _Blocks:
    """Variograms of all blocks, which patch each is of, the patches' slopes, and how often each counts."""

    curve: Float[np.ndarray, "blocks 2 lags"]
    patch: np.ndarray
    slope: Float[np.ndarray, "patches 2"]
    weight: np.ndarray

    @classmethod
    def of(cls, patches: list[PlaneResidual]) -> "_Blocks":
        curves = [np.array([variogram(b) for b in blocks(one.residual, BLOCK)]) for one in patches]
        patch = np.repeat(np.arange(len(curves)), [len(c) for c in curves])
        curve = np.concatenate(curves)
        whole = np.isfinite(curve).all(axis=(1, 2))
        if not whole.any():
            raise ValueError(
                f"patches: found none, or all smaller than the {LAGS[-1] + 1} px that are allowed"
            )
        curve, patch = curve[whole], patch[whole]
        return cls(curve, patch, np.array([one.slope for one in patches]), np.ones(len(curve)))

    def weighted(self, weight: np.ndarray) -> "_Blocks":
        return _Blocks(self.curve, self.patch, self.slope, weight)

    @property
    def mean(self) -> Float[np.ndarray, "2 lags"]:
        return np.average(self.curve, axis=0, weights=self.weight)

    def model(self, fit: NoiseFit) -> Float[np.ndarray, "2 lags"]:
        """What the mean should be."""
        before = np.broadcast_to(sum(noise_variogram(fit)), (len(self.slope), 2, len(LAGS)))
        curves = rounded_variogram(before, self.slope[:, :, None] * LAGS, fit.quantum)
        return np.average(curves, axis=0, weights=np.bincount(self.patch, self.weight, len(self.slope)))


def _fit(found: _Blocks, quantum: float, start: NoiseFit | None = None) -> NoiseFit:
    """By the logarithms of curve and parameters: errors of a variogram are shares of it."""
    mean = np.maximum(found.mean, 1e-12)

    def fit_of(logs: np.ndarray) -> NoiseFit:
        sigma, correlation, white, slow, slow_length = map(float, np.exp(logs))
        return NoiseFit(sigma, correlation, white, slow, slow_length, quantum)

    def misses(logs: np.ndarray) -> np.ndarray:
        return np.log(found.model(fit_of(logs)) / mean).ravel()

    bounds = np.log(_LEAST), np.log(_MOST)
    first = np.log(_START if start is None else astuple(start)[:-1])
    solved = least_squares(misses, np.clip(first, bounds[0] + 1e-6, bounds[1] - 1e-6), bounds=bounds)
    return fit_of(solved.x)


def mean_variogram(patches: list[PlaneResidual], fit: NoiseFit) -> Float[np.ndarray, "2 2 lags"]:
    """The variograms along u and v as measured, and as the fit has them [px^2], to be drawn."""
    found = _Blocks.of(patches)
    return np.stack([found.mean, found.model(fit)])
