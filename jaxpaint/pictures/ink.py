"""Which pixels are ink: by their intensity against the paper's (S1 section III-B), or by their colour."""

from dataclasses import dataclass, replace

import cv2
import numpy as np
from jaxtyping import Bool, Float
from scipy import ndimage

from jaxpaint.errors import InputError
from jaxpaint.pictures.drawing import BLACK, Colour
from jaxpaint.pictures.ink_settings import RasterSettings
from jaxpaint.pictures.inks import colour_fields, colour_layers
from jaxpaint.pictures.light import levelled, paper_about
from jaxpaint.pictures.palette import lab
from jaxpaint.pictures.pixels import Pixels

_CONTRAST = 10.0  # of L (0 to 100) between ink and paper: less is a blank sheet
# Of Otsu's criterion: below it one threshold does not part ink from paper. Two clean tones have nearly 1, a
# page whose light falls by half has 0.6 to 0.8.
_SEPARABLE = 0.85
# Times the threshold: how dark a patch must be somewhere to count as ink in uneven light. The threshold lies
# midway between paper and ink, so ink reaches 2; noise and folds that just pass it do not reach 1.6.
_CLEAR = 1.6


@dataclass(frozen=True, eq=False)
class Ink:
    """One colour of a picture.

    field: above 0 where it is, the rim where it passes through 0. specked: where it is before specks are left
    out. others: how many more colours of the picture are painted in it.
    """

    colour: Colour
    field: Float[np.ndarray, "rows columns"]
    specked: Bool[np.ndarray, "rows columns"]
    others: int = 0


def inks_of(pixels: Pixels, settings: RasterSettings) -> list[Ink]:
    """The ink of each colour of a picture, specks left out.

    A picture in colour, or of a few flat tones, is parted by its palette; another has one ink. Raises
    InputError for a blank picture.
    """
    rgb = _on_paper(pixels, settings)
    tones = lab(rgb)
    if np.ptp(tones.reshape(-1, 3), axis=0).max() < _CONTRAST:
        raise InputError("found a blank picture, all of one tone; allowed is one with ink on paper")
    layers = (
        [] if settings.colours == 1 or settings.threshold != "auto" else colour_layers(tones, rgb, settings)
    )
    if len(layers) > 1 or (layers and settings.colours):
        inks = [tone for tone in layers if not tone.paper]
        fields = colour_fields(tones, layers)
        found = [
            Ink(tone.rgb, field, field > 0, len(tone.labs) - 1)
            for tone, field in zip(inks, fields, strict=True)
        ]
    else:
        found = [_one_ink(rgb, tones[..., 0], settings)]
    cleaned = [replace(ink, field=_despeckled(ink.field, settings)) for ink in found]
    return [ink for ink in cleaned if (ink.field > 0).any()]


def _on_paper(pixels: Pixels, settings: RasterSettings) -> Float[np.ndarray, "rows columns 3"]:
    """The picture on white paper; on black where what is opaque is nearly white itself."""
    if not pixels.paper.any():
        return pixels.rgb
    seen = pixels.rgb[~pixels.paper]
    white = settings.ink == "light" or (len(seen) and lab(seen)[:, 0].min() > 100 - 2 * _CONTRAST)
    paper = 0.0 if white else 1.0
    return pixels.rgb * pixels.opaque[..., None] + paper * (1 - pixels.opaque[..., None])


def _one_ink(rgb: np.ndarray, light: np.ndarray, settings: RasterSettings) -> Ink:
    """Ink parted from paper by intensity: one threshold, or one by neighbourhood where light is uneven."""
    threshold, separable = otsu(light)
    local = settings.threshold == "local" or (settings.threshold == "auto" and separable < _SEPARABLE)
    if local:
        # The side is seen where light and dark part most cleanly, with the slope of the light or without.
        level = max(light, levelled(light), key=lambda picture: otsu(picture)[1])
        dark = _ink_is_dark(level, otsu(level)[0], settings)
        field = _local_field(light if dark else 100 - light)
    else:
        dark = _ink_is_dark(light, threshold, settings)
        field = threshold - light if dark else light - threshold
    inside = field > 0
    if not inside.any() or inside.all():
        raise InputError(
            "found no ink that stands out from the paper; allowed is a picture with more contrast"
        )
    if abs(float(np.median(light[inside]) - np.median(light[~inside]))) < _CONTRAST:
        raise InputError("found a blank picture, nearly of one tone; allowed is one with ink on paper")
    grey = lab(rgb[inside])[:, 1:]
    colourless = float(np.median(np.hypot(*grey.T))) < 12
    red, green, blue = (float(c) for c in np.median(rgb[inside], axis=0))
    return Ink(BLACK if dark and colourless else (red, green, blue), field, inside)


def otsu(light: Float[np.ndarray, "rows columns"]) -> tuple[float, float]:
    """Otsu's threshold, and how much of the variance it explains (0 to 1: two clean tones)."""
    counts, edges = np.histogram(light, bins=256)
    middle = (edges[1:] + edges[:-1]) / 2
    below, above = np.cumsum(counts)[:-1], np.cumsum(counts[::-1])[::-1][1:]
    sums = np.cumsum(counts * middle)
    low = sums[:-1] / np.maximum(below, 1)
    high = (sums[-1] - sums[:-1]) / np.maximum(above, 1)
    between = below * above * (low - high) ** 2 / counts.sum() ** 2
    # Between two clean tones every threshold is as good: the middle one lies on the rim of a blurred edge.
    best = np.flatnonzero(between >= between.max() * (1 - 1e-6))
    k = int(best.mean())
    threshold = (low[k] + high[k]) / 2 if between[k] >= 0.98 * between.max() else edges[k + 1]
    return float(threshold), float(between.max() / max(light.var(), 1e-12))


def _ink_is_dark(light: np.ndarray, threshold: float, settings: RasterSettings) -> bool:
    """Whether ink is darker than paper: the paper is what most of the border shows."""
    if settings.ink != "auto":
        return settings.ink == "dark"
    return bool((border(light) > threshold).mean() >= 0.5)


def border(values: np.ndarray) -> np.ndarray:
    """The pixels along the border of a picture, one in fifty of its shorter side deep."""
    depth = max(1, min(values.shape[:2]) // 50)
    inner = np.zeros(values.shape[:2], bool)
    inner[depth:-depth, depth:-depth] = True
    return values[~inner]


def _local_field(light: Float[np.ndarray, "rows columns"]) -> Float[np.ndarray, "rows columns"]:
    """How much of the light of the paper about it a pixel lacks [%], less a threshold.

    Shares, because ink in a shadow is darker by less. Otsu's threshold parts ink from paper; a patch of ink
    counts only if some of it is clearly above that.
    """
    smooth = cv2.GaussianBlur(light.astype(np.float32), (0, 0), 0.7)
    darker = 100 * (1 - smooth / paper_about(smooth))
    threshold = otsu(np.clip(darker, 0, None))[0]
    field = darker - threshold
    label, count = ndimage.label(field > 0, structure=np.ones((3, 3)))
    peak = ndimage.maximum(darker, label, np.arange(count + 1)) if count else np.zeros(1)
    faint = np.asarray(peak) < _CLEAR * threshold
    faint[0] = False
    return np.where(faint[label], -1e-3, field)


def _despeckled(field: Float[np.ndarray, "rows columns"], settings: RasterSettings) -> np.ndarray:
    """Without islands of ink, and holes in it, of less than so many pixels."""
    least = settings.least_speck(max(field.shape))
    clean = np.array(field, float)
    for sign in (1, -1):
        inside = sign * clean > 0
        label, count = ndimage.label(inside, structure=np.ones((3, 3)) if sign > 0 else None)
        small = np.bincount(label.ravel(), minlength=count + 1) < least
        small[0] = False
        specks = small[label]
        # Just past the rim, so that contours nearby stay where they were.
        clean[ndimage.binary_dilation(specks) & (sign * clean > 0)] = -sign * 1e-3
    return clean
