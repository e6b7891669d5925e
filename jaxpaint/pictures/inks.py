"""The palette of a picture, and where each of its colours lies."""

from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Float

from jaxpaint.pictures.drawing import Colour
from jaxpaint.pictures.ink_settings import RasterSettings
from jaxpaint.pictures.palette import MOST

_STARTS = 12  # means that k-means begins with
_SAMPLE = 20_000  # pixels
# Means nearer than this in Lab are one: more than `palette.NEAR`, since means are measured and a JPEG
# spreads one colour by some units, where a drawing states it.
_NEAR = 15.0
_FLAT = 6.0  # pixels so near to a mean have its tone
_MOSTLY = 0.9  # share of pixels with the tone of a mean in a picture of flat tones
_CHROMA = 20.0  # ink further than this from grey is coloured
_SHARE = 0.002  # of the pixels: a rarer colour is none of its own
_EDGE = 8.0  # change of Lab from pixel to pixel at a blurred edge


@dataclass(frozen=True, eq=False)
class Tone:
    """A colour of the palette, and whether it is the paper's.

    labs: its own Lab, and that of the colours that there was no place for and that are painted in it too.
    """

    labs: Float[np.ndarray, "colours 3"]
    rgb: Colour
    paper: bool


def colour_layers(tones: np.ndarray, rgb: np.ndarray, settings: RasterSettings) -> list[Tone]:
    """The palette of a picture, its paper first, or nothing where it has one ink of no clear colour.

    Means come from pixels that lie on no edge, where colours mix. The paper is the mean of most of the
    border. Colours beyond the number of inks, the rarer ones, are painted in the ink that is nearest to them.
    """
    flat = tones[~_edges(tones)]
    if len(flat) < 100:
        return []
    sample = flat[:: max(1, len(flat) // _SAMPLE)].astype(float)
    means = _means(sample)
    share = _assigned(sample, means)[1]
    means, share = means[share >= _SHARE], share[share >= _SHARE]
    rim = np.concatenate([tones[0], tones[-1], tones[:, 0], tones[:, -1]])
    paper = int(np.bincount(_assigned(rim, means)[0].argmin(axis=1), minlength=len(means)).argmax())
    if settings.ink != "auto":
        paper = int((means[:, 0] * (1 if settings.ink == "dark" else -1)).argmax())
    others = np.array([k for k in range(len(means)) if k != paper], dtype=int)
    coloured = (np.hypot(*means[others, 1:].T) > _CHROMA).any() if len(others) else False
    is_flat = (_assigned(sample, means)[0].min(axis=1) < _FLAT).mean() > _MOSTLY
    if not len(others) or not (settings.colours or coloured or (is_flat and len(others) > 1)):
        return []
    most = settings.colours or MOST
    others = others[np.argsort(-share[others], kind="stable")]
    kept, left = means[others[:most]], means[others[most:]]
    inks = np.concatenate([np.arange(len(kept)), _assigned(left, kept)[0].argmin(axis=1)])
    palette = [Tone(means[[paper]], _rgb(means[paper], tones, rgb), True)]
    for k, mean in enumerate(kept):
        palette.append(Tone(means[others[inks == k]], _rgb(mean, tones, rgb), False))
    return palette


def colour_fields(tones: np.ndarray, palette: list[Tone]) -> Iterator[np.ndarray]:
    """In turn for each colour but the paper, how much nearer a pixel is to it than to any other, in Lab.

    At an edge only colours that lie beside it count: between black and white there is no grey ink.
    """
    distance = np.stack(
        [np.min([np.linalg.norm(tones - one, axis=-1) for one in tone.labs], axis=0) for tone in palette]
    )
    core = distance < _EDGE
    window = np.ones((5, 5), np.uint8)
    beside = np.stack([cv2.dilate(mask.astype(np.uint8), window) > 0 for mask in core])
    limited = np.where(beside, distance, np.inf)
    lost = ~np.isfinite(limited).any(axis=0)
    mixed = ~core.any(axis=0) & (beside.sum(axis=0) >= 2)
    usable = np.where(mixed & ~lost, np.where(beside, distance, distance + 100.0), distance)
    order = np.sort(usable, axis=0)
    for k, tone in enumerate(palette):
        if not tone.paper:
            second = np.where(usable[k] <= order[0], order[1] if len(palette) > 1 else 50.0, order[0])
            yield np.clip(second - usable[k], -50.0, 50.0)


def _edges(tones: np.ndarray) -> np.ndarray:
    """Where neighbours differ: pixels at the rim of something, whose colours are mixed."""
    kernel = np.ones((3, 3), np.uint8)
    light = np.ascontiguousarray(tones, np.float32)
    return (cv2.dilate(light, kernel) - cv2.erode(light, kernel)).max(axis=-1) > _EDGE


def _means(sample: np.ndarray) -> np.ndarray:
    """K-means begun at points far from each other, then near ones merged by their weights."""
    means = [np.median(sample, axis=0)]
    away = np.linalg.norm(sample - means[0], axis=1)
    while len(means) < _STARTS and away.max() > _NEAR:
        means.append(sample[away.argmax()])
        away = np.minimum(away, np.linalg.norm(sample - means[-1], axis=1))
    centres = np.array(means)
    for _ in range(10):
        nearest = _assigned(sample, centres)[0].argmin(axis=1)
        centres = np.array(
            [
                np.median(sample[nearest == k], axis=0) if (nearest == k).any() else c
                for k, c in enumerate(centres)
            ]
        )
    return _merged(sample, centres)


def _merged(sample: np.ndarray, centres: np.ndarray) -> np.ndarray:
    """Means, the two nearest joined while they are too near; the heavier one keeps its colour."""
    while len(centres) > 1:
        share = _assigned(sample, centres)[1]
        apart = np.linalg.norm(centres[:, None] - centres, axis=-1) + np.diag(np.full(len(centres), np.inf))
        a, b = np.unravel_index(int(apart.argmin()), apart.shape)
        if apart[a, b] >= _NEAR:
            break
        centres = np.delete(centres, a if share[a] < share[b] else b, axis=0)
    return centres


def _assigned(sample: np.ndarray, means: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Distances of pixels to means, and the share of the pixels that is nearest to each."""
    distance = np.linalg.norm(sample[:, None] - means, axis=-1)
    return distance, np.bincount(distance.argmin(axis=1), minlength=len(means)) / max(1, len(sample))


def _rgb(mean: np.ndarray, tones: np.ndarray, rgb: np.ndarray) -> Colour:
    """The sRGB of the pixels nearest to a mean."""
    distance = np.linalg.norm(tones - mean, axis=-1)
    near = rgb[distance <= max(2.0, float(distance.min()) + 1e-6)]
    red, green, blue = np.median(near, axis=0)
    return float(red), float(green), float(blue)
