"""What a person should know about a picture as it was read: what of it is not painted, or otherwise."""

from jaxpaint.pictures.drawing import Drawing
from jaxpaint.pictures.strokes import Strokes

_LEFT_OUT = {
    "text": ("text", "texts"),
    "image": ("image within the picture", "images within the picture"),
    "foreignObject": ("foreign object", "foreign objects"),
    "use": ("use of what is not in the file", "uses of what is not in the file"),
    "dot": ("line without length", "lines without length"),
}
_OTHERWISE = {
    "clip-path": ("clip path (painted unclipped)", "clip paths (painted unclipped)"),
    "mask": ("mask (painted unmasked)", "masks (painted unmasked)"),
    "gradient": ("gradient or pattern (painted black)", "gradients or patterns (painted black)"),
    "duplicate": ("line drawn more than once (painted once)", "lines drawn more than once (painted once)"),
    "background": ("background (taken for the paper)", "backgrounds (taken for the paper)"),
    "colour": ("colour too many (painted in the nearest)", "colours too many (painted in the nearest)"),
    "cmyk": (
        "CMYK picture (converted without its profile)",
        "CMYK pictures (converted without their profile)",
    ),
}


def reading_notes(drawing: Drawing, strokes: Strokes) -> list[str]:
    """Lines for a person: what of a picture is left out, what is painted otherwise, how well lines were read.

    drawing: as it was read or fitted; strokes: planned of it. Nothing to say is no line.
    """
    known = _LEFT_OUT.keys() | _OTHERWISE.keys()
    others = {name: (name, name) for name in drawing.ignored if name not in known}
    notes = [
        f"{title}: {', '.join(found)}"
        for title, words in (
            ("left out of the picture", _LEFT_OUT | others),
            ("painted otherwise than in the picture", _OTHERWISE),
        )
        if (found := _counted(drawing, words))
    ]
    if strokes.dropped:
        notes.append(f"left out, shorter than 1 mm: {_number(strokes.dropped, ('line', 'lines'))}")
    if drawing.reading is not None:
        ink, lines = (_per_cent(share) for share in (drawing.reading.ink_read, drawing.reading.lines_on_ink))
        notes.append(f"of the ink, {ink} lies under the lines that were read; of the lines, {lines} on ink")
    return notes


def _counted(drawing: Drawing, words: dict[str, tuple[str, str]]) -> list[str]:
    return [_number(drawing.ignored[name], words[name]) for name in words if drawing.ignored.get(name)]


def _number(count: int, words: tuple[str, str]) -> str:
    return f"{count} {words[count != 1]}"


def _per_cent(share: float) -> str:
    """A share; 100.0 % only where nothing is missing."""
    return f"{100.0 if share == 1 else min(100 * share, 99.9):.1f} %"
