"""PNG and JPEG files: what is read, what is refused, and that the header alone decides where it can."""

import struct
import zlib

import numpy as np
import pytest
from PIL import Image

from jaxpaint.errors import InputError
from jaxpaint.pictures import read_drawing
from jaxpaint.pictures.pixels import LONGEST, read_pixels


def cross(size: int = 40, mode: str = "RGB") -> Image.Image:
    """A black bar from the top left on white."""
    pixels = np.full((size, size), 255, np.uint8)
    pixels[4:14, 4:30] = 0
    return Image.fromarray(pixels).convert(mode)


def refused(path) -> str:
    with pytest.raises(InputError) as caught:
        read_drawing(path)
    message = str(caught.value)
    assert message.startswith(f"{path}: ") and "\n" not in message and "allowed" in message
    return message


def header_only(width: int, height: int) -> bytes:
    """A PNG that says how large it is, and has no pixels at all."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
    return b"\x89PNG\r\n\x1a\n" + header + chunk(b"IDAT", zlib.compress(b"")) + chunk(b"IEND", b"")


@pytest.mark.parametrize(
    ("size", "found"),
    [
        ((10_000, 10_000), "100 megapixels; allowed are 40"),
        ((8_000, 8_000), "64 megapixels; allowed are 40"),
        ((60_000, 60_000), "more than 178 megapixels; allowed are 40"),
        ((1, 1), "1 x 1 pixels; allowed are pictures of 8"),
        ((1000, 7), "1000 x 7 pixels"),
    ],
)
def test_sizes_are_refused_by_the_header(tmp_path, size, found):
    path = tmp_path / "a.png"
    path.write_bytes(header_only(*size))
    assert found in refused(path)


def test_a_single_pixel(tmp_path):
    path = tmp_path / "a.png"
    Image.new("RGB", (1, 1)).save(path)
    assert "1 x 1" in refused(path)


@pytest.mark.parametrize("suffix", ["png", "jpg"])
@pytest.mark.parametrize("tone", [0, 128, 255])
def test_blank(tmp_path, suffix, tone):
    path = tmp_path / f"a.{suffix}"
    Image.new("RGB", (50, 40), (tone, tone, tone)).save(path)
    assert "blank" in refused(path)


def test_blank_but_for_noise(tmp_path):
    path = tmp_path / "a.png"
    Image.fromarray(np.random.default_rng(0).integers(245, 256, (60, 60), np.uint8)).save(path)
    assert "blank" in refused(path)


def test_all_transparent(tmp_path):
    path = tmp_path / "a.png"
    Image.new("RGBA", (50, 40), (0, 0, 0, 0)).save(path)
    assert "blank" in refused(path)


def test_animated(tmp_path):
    path = tmp_path / "a.png"
    cross().save(path, save_all=True, append_images=[cross().rotate(90), cross().rotate(180)])
    assert "animation of 3 frames" in refused(path)


@pytest.mark.parametrize("suffix", ["png", "jpg"])
def test_truncated(tmp_path, suffix):
    path = tmp_path / f"a.{suffix}"
    noisy = np.random.default_rng(0).integers(0, 256, (200, 200, 3), np.uint8)
    Image.fromarray(noisy).save(path)
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    assert "broken or truncated" in refused(path)


def test_corrupt(tmp_path):
    path = tmp_path / "a.png"
    cross().save(path)
    content = bytearray(path.read_bytes())
    content[60:90] = bytes(30)
    path.write_bytes(bytes(content))
    assert "broken or truncated" in refused(path)


@pytest.mark.parametrize(
    ("content", "found"),
    [
        (b"", "empty file"),
        (b"hello, this is text", "no picture"),
        (b"GIF89a" + bytes(20), "a GIF picture"),
        (b"%PDF-1.7 ", "a PDF"),
        (b"RIFF\0\0\0\0WEBPVP8 ", "a WebP"),
        (b"\x89PNG\r\n\x1a\n", "broken or truncated"),
        (b"\xff\xd8\xff\xe0", "broken or truncated"),
    ],
)
def test_other_contents(tmp_path, content, found):
    path = tmp_path / "a.png"
    path.write_bytes(content)
    assert found in refused(path)


def test_contents_decide_between_png_and_jpeg(tmp_path):
    path = tmp_path / "a.jpg"
    cross().save(path, format="PNG")
    assert len(read_drawing(path).areas) == 1


@pytest.mark.parametrize("mode", ["1", "L", "P", "RGB", "RGBA", "LA"])
def test_kinds_of_png_agree(tmp_path, mode):
    path = tmp_path / "a.png"
    cross(mode=mode).save(path)
    pixels = read_pixels(path)
    np.testing.assert_allclose(pixels.rgb[..., 0], np.asarray(cross(mode="L")) / 255, atol=1e-6)
    assert pixels.opaque.min() == 1


def test_sixteen_bits_keep_their_steps(tmp_path):
    path = tmp_path / "a.png"
    values = np.arange(2500, dtype=np.uint16).reshape(50, 50) * 26
    Image.fromarray(values).save(path)
    np.testing.assert_allclose(read_pixels(path).rgb[..., 1] * 65535, values, atol=0.05)


def test_cmyk_is_converted_and_noted(tmp_path):
    path = tmp_path / "a.jpg"
    cross(160).convert("CMYK").save(path, quality=95)
    drawing = read_drawing(path)
    assert drawing.ignored == {"cmyk": 1} and len(drawing.areas) == 1
    red = Image.new("RGB", (40, 40), "white")
    red.paste((230, 20, 20), (8, 8, 30, 30))
    red.convert("CMYK").save(path, quality=95)
    r, g, b = read_pixels(path).rgb[20, 20]
    assert r > 0.8 and g < 0.25 and b < 0.25


@pytest.mark.parametrize("orientation", range(1, 9))
def test_exif_orientation(tmp_path, orientation):
    """However the camera was held, the picture is as it was seen."""
    upright = cross(160)
    back = {2: 0, 3: 3, 4: 1, 5: 5, 6: 2, 7: 6, 8: 4}
    stored = upright if orientation == 1 else upright.transpose(Image.Transpose(back[orientation]))
    exif = Image.Exif()
    exif[0x0112] = orientation
    path = tmp_path / "a.jpg"
    stored.save(path, exif=exif, quality=95)
    np.testing.assert_allclose(read_pixels(path).rgb[..., 0], np.asarray(upright)[..., 0] / 255, atol=0.2)


def test_large_pictures_are_reduced(tmp_path):
    path = tmp_path / "a.png"
    cross(40).resize((4000, 2000)).save(path)
    assert read_pixels(path).rgb.shape == (LONGEST // 2, LONGEST, 3)
