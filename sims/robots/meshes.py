"""The mesh files that a URDF names: found beside it, or refused by name."""

import xml.etree.ElementTree as ET
from pathlib import Path

from jaxpaint.errors import InputError

_READABLE = (".stl", ".obj", ".msh")
_PACKAGE = "package://"


def resolve_meshes(root: ET.Element, path: Path) -> None:
    """Leaves collision shapes alone in a URDF, and makes the paths of their meshes absolute.

    A link without collision shapes takes its visual ones that can be read. `package://NAME/PATH` is PATH
    below the nearest folder called NAME at or above the file's, or beside one of these. Raises InputError.
    """
    for link in root.findall("link"):
        visuals = link.findall("visual")
        for visual in visuals:
            link.remove(visual)
        if not link.findall("collision"):
            for visual in visuals:
                if _readable(visual):
                    visual.tag = "collision"
                    link.append(visual)
        for collision in link.findall("collision"):
            for mesh in collision.iter("mesh"):
                mesh.set("filename", str(_found(mesh.get("filename", ""), path, link.get("name", ""))))


def _readable(visual: ET.Element) -> bool:
    """Whether a picture may stand for the body: its material is dropped, which another link may own."""
    for material in visual.findall("material"):
        visual.remove(material)
    return all(Path(m.get("filename", "")).suffix.lower() in _READABLE for m in visual.iter("mesh"))


def _found(name: str, path: Path, link: str) -> Path:
    """The file that a URDF's mesh name means."""
    places = _places(name, path.resolve().parent)
    found = next((place for place in places if place.is_file()), None)
    if found is None:
        raise InputError(f"link '{link}': mesh file '{name}' is missing; looked for {places[0]}")
    if found.suffix.lower() not in _READABLE:
        raise InputError(f"link '{link}': mesh file '{name}'; allowed: {', '.join(_READABLE)}")
    return found


def _places(name: str, folder: Path) -> list[Path]:
    if name.startswith(_PACKAGE):
        package, _, rest = name.removeprefix(_PACKAGE).partition("/")
        above = [folder, *folder.parents]
        named = [place / rest for place in above if place.name == package]
        beside = [place / package / rest for place in above]
        return [*named, *beside]
    return [folder / name.removeprefix("file://")]
