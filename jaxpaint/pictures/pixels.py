"""PNG and JPEG files as pixels. Size and kind are checked by the header, before anything is decoded."""

import warnings
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from jaxtyping import Bool, Float
from PIL import Image, ImageOps

from jaxpaint.errors import InputError

MAX_PIXELS = 40_000_000
MIN_SIDE = 8
LONGEST = 2400
"""Pixels of the longer side at most: larger pictures are reduced to it, 0.5 mm each on 1.2 m of wall."""

_FORMATS = ("PNG", "JPEG", "MPO")  # MPO: a JPEG of a phone, with a preview behind it
_SIGNATURES = {
    b"GIF8": "a GIF picture",
    b"BM": "a BMP picture",
    b"II*\0": "a TIFF picture",
    b"MM\0*": "a TIFF picture",
    b"%PDF": "a PDF document",
    b"<svg": "an SVG drawing",
    b"<?xml": "an SVG drawing or other XML",
}
_ALLOWED = "allowed is a complete PNG or JPEG picture"
_BROKEN = (
    OSError,
    SyntaxError,
    ValueError,
    EOFError,
    IndexError,
    KeyError,
    TypeError,
    OverflowError,
    MemoryError,
)


@dataclass(frozen=True, eq=False)
class Pixels:
    """rgb: sRGB from 0 to 1, row 0 on top. opaque: from 0, where the paper shows, to 1. noted: what was
    converted, by name.
    """

    rgb: Float[np.ndarray, "rows columns 3"]
    opaque: Float[np.ndarray, "rows columns"]
    noted: tuple[str, ...] = ()

    @property
    def paper(self) -> Bool[np.ndarray, "rows columns"]:
        """Where more of the paper shows than of the picture."""
        return self.opaque < 0.5


def read_pixels(path: Path) -> Pixels:
    """The pixels of a PNG or JPEG file, turned as its camera was held (EXIF), at most 2400 on a side.

    Palettes, greys and 16 bits a channel are read; CMYK is converted without its colour profile (r = (1 - c)
    (1 - k)). Refused, as an InputError: other formats, more than 40 megapixels, less than 8 pixels on a side,
    several frames, and files that are broken or cut off.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of Pillow, about sizes that are refused here anyway
            with Image.open(path, formats=_FORMATS) as image:
                _check(image)
                return _decoded(image)
    except InputError:
        raise
    except Image.DecompressionBombError:
        raise InputError(
            f"found a picture of more than {2 * _mega(Image.MAX_IMAGE_PIXELS)} megapixels; "
            f"allowed are {_mega(MAX_PIXELS)}"
        ) from None
    except _BROKEN as error:
        raise InputError(_what_is_wrong(path, error)) from None


def _mega(pixels: int | None) -> int:
    return (pixels or 0) // 10**6


def _check(image: Image.Image) -> None:
    """Refuses what is too large, too small or moving, by what the header says."""
    width, height = image.size
    if width * height > MAX_PIXELS:
        found = f"found {width} x {height} pixels, {width * height / 1e6:.0f} megapixels"
        raise InputError(f"{found}; allowed are {_mega(MAX_PIXELS)}")
    if min(width, height) < MIN_SIDE:
        raise InputError(
            f"found {width} x {height} pixels; allowed are pictures of {MIN_SIDE} or more on a side"
        )
    frames = getattr(image, "n_frames", 1)
    if image.format == "PNG" and frames > 1:
        raise InputError(f"found an animation of {frames} frames; allowed is a picture of one")


def _decoded(image: Image.Image) -> Pixels:
    noted = ("cmyk",) if image.mode == "CMYK" else ()
    image.draft(image.mode, (LONGEST, LONGEST))  # a JPEG can be decoded smaller than it is
    image.load()
    turned = ImageOps.exif_transpose(image)
    if turned.mode.startswith("I") or turned.mode == "F":
        grey = _reduced(np.asarray(turned, np.float32)) / 65535
        rgb, opaque = np.repeat(grey[..., None], 3, axis=2), np.ones(grey.shape, np.float32)
    else:
        rgba = _reduced(np.asarray(turned.convert("RGBA")))
        rgb, opaque = rgba[..., :3].astype(np.float32) / 255, rgba[..., 3].astype(np.float32) / 255
    return Pixels(np.clip(rgb, 0, 1), np.clip(opaque, 0, 1), noted)


def _reduced(values: np.ndarray) -> np.ndarray:
    """Means of pixels so that the longer side has at most 2400."""
    rows, columns = values.shape[:2]
    scale = LONGEST / max(rows, columns)
    if scale >= 1:
        return values
    size = max(1, round(columns * scale)), max(1, round(rows * scale))
    return cv2.resize(values, size, interpolation=cv2.INTER_AREA)


def _what_is_wrong(path: Path, error: BaseException) -> str:
    """Why a file cannot be read, by its first bytes."""
    try:
        with path.open("rb") as file:
            head = file.read(16)
    except OSError as cause:
        return f"cannot be read ({cause.strerror}); allowed is a readable file"
    if not head:
        return f"found an empty file; {_ALLOWED}"
    if head.startswith((b"\x89PNG", b"\xff\xd8")):
        reason = (
            " ".join(str(error).split())[:60] if not isinstance(error, Image.UnidentifiedImageError) else ""
        )
        return f"found a broken or truncated picture{f' ({reason})' if reason else ''}; {_ALLOWED}"
    if head[:4] == b"RIFF" and head[8:12] == b"WEBP":
        return f"found a WebP picture; {_ALLOWED}"
    kinds = [kind for start, kind in _SIGNATURES.items() if head.startswith(start)]
    return f"found {kinds[0] if kinds else 'something that is no picture'}; {_ALLOWED}"
