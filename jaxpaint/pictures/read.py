"""Pictures from files."""

from pathlib import Path

from jaxpaint.errors import InputError
from jaxpaint.pictures.drawing import Drawing
from jaxpaint.pictures.ink_settings import RasterSettings
from jaxpaint.pictures.markup import check_file, load_markup
from jaxpaint.pictures.raster import raster_drawing
from jaxpaint.pictures.svg import SvgReader
from jaxpaint.pictures.vector import vector_drawing

RASTER = (".png", ".jpg", ".jpeg")


def read_drawing(path: Path, raster: RasterSettings | None = None) -> Drawing:
    """The drawing of a picture file: .svg, .png, .jpg or .jpeg; `raster`: how ink is found in the last three.

    SVG: strokes give their centre-lines (a dashed one as a whole), fills their areas, less what later fills
    cover; curves are flattened to 1e-4 of the drawing's size, corners kept. What has the paper's colour
    (white, or that of a first shape that fills the page) only covers. Text, raster images, clips and masks
    are left out and counted. PNG and JPEG: ink stands out from the paper, which most of the border shows;
    line art gives centre-lines, all else areas. Whatever is wrong with the file is an InputError of one line
    that names it.
    """
    path = Path(path)
    try:
        check_file(path)
        suffix = path.suffix.lower()
        if suffix in RASTER:
            return raster_drawing(path, raster or RasterSettings())
        if suffix != ".svg":
            raise InputError(f"found the extension '{suffix}'; allowed are .svg, .png, .jpg, .jpeg")
        return vector_drawing(SvgReader(load_markup(path)), path.stem)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
